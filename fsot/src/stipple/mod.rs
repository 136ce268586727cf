//! Stippling: pictures drawn with dots (section 5.5.1, figures 5.10-5.13).

mod animation;
mod options;
mod separation;

pub use animation::{Animation, Windows};
pub use options::Options;
pub use separation::{Ink, Tone, cmyk, grey, ink_for};

use crate::class::{Class, ClassCoordinates, ClassFunction, Step};
use crate::error::{Error, Result};
use crate::export::points::Labels;
use crate::optimize::{Domain, Problem};
use crate::picture::{Drawing, Photo};
use crate::points::Points;
use crate::random::stream;
use crate::target::image::{ImageTarget, spread};
use options::{effort, inks, paper, spacing};
use separation::radius;
use std::ops::Range;
use std::sync::Arc;

/// The dots of one ink.
#[derive(Clone, Debug, PartialEq)]
pub struct Dots {
    /// The ink's letter.
    pub name: &'static str,
    /// The ink's colour.
    pub colour: [u8; 3],
    /// Which points are of this ink.
    pub range: Range<usize>,
}

/// A picture about to be stippled.
#[derive(Debug)]
pub struct Stipple {
    /// What to optimise. Points lie in [0, width / longer side] x [0, height / longer side] of the picture, y
    /// downwards from its top.
    pub problem: Problem,
    /// The inks that have dots, in the order of the points.
    pub inks: Vec<Dots>,
    /// The radius of every dot, in units of the picture's longer side: all dots together have the area that the inks
    /// need.
    pub radius: f32,
    blank: Drawing,
}

impl Stipple {
    /// Separates a picture into inks and gives each a number of dots that is proportional to the area it shall cover.
    /// Every subset of the inks is a class, with the density that its inks have together: 15 for four inks.
    ///
    /// # Errors
    ///
    /// [`Error::Input`] if there are no points, the picture has one tone only, or the options contradict each other.
    pub fn new(photo: &Photo, options: &Options) -> Result<Stipple> {
        if options.cmyk && options.invert {
            return Err(Error::input("white ink does not go with cyan, magenta and yellow: leave out one of the two"));
        }
        check_points(options.points)?;
        let inks = inks(photo, options, options.points)?;
        let energies: Vec<f64> = inks.iter().map(|ink| ink.density.iter().map(|d| f64::from(*d)).sum()).collect();
        let counts = apportion(options.points, &energies);
        let mut targets = Vec::new();
        let mut dots: Vec<Dots> = Vec::new();
        for (ink, count) in inks.iter().zip(&counts).filter(|(_, count)| **count > 0) {
            let first = dots.last().map_or(0, |dots| dots.range.end);
            dots.push(Dots { name: ink.name, colour: ink.colour, range: first..first + count });
            // All inks at the resolution of the whole set: their densities are to be mixed.
            targets.push(ImageTarget::new(photo.width, photo.height, &ink.density, options.points)?);
        }
        let initial = starting(&targets, &dots, options.seed);
        let problem = Problem {
            classes: classes(targets, &dots)?,
            class_coordinates: ClassCoordinates::Index,
            domain: Domain::Bounded,
            seed: options.seed,
            quality: effort(options.quality, 1.0),
            initial: Some(initial),
            ..Problem::new(options.points, 2)
        };
        let ink_area = energies.iter().sum::<f64>() / photo.pixels.len() as f64;
        let [width, height] = photo.extent().map(f64::from);
        let radius = radius(ink_area * width * height, options.points);
        Ok(Stipple { problem, inks: dots, radius, blank: paper(photo.extent(), options) })
    }

    /// The points as dots of their inks, in units of the picture's longer side.
    pub fn drawing(&self, points: &Points) -> Drawing {
        let mut drawing = self.blank.clone();
        let points: Vec<&[f32]> = points.iter().collect();
        for dots in &self.inks {
            let own = points.get(dots.range.clone()).unwrap_or_default();
            drawing.dots(own.iter().copied(), self.radius, dots.colour);
        }
        drawing
    }

    /// Which ink each point is of.
    pub fn labels(&self) -> Labels {
        let index = self.inks.iter().enumerate().flat_map(|(ink, dots)| dots.range.clone().map(move |_| ink));
        Labels { names: self.inks.iter().map(|dots| dots.name.to_owned()).collect(), index: index.collect() }
    }

    /// The mean distance between dots, in units of the picture's longer side: the side of a square of the area that
    /// there is for each.
    pub fn spacing(&self) -> f32 {
        spacing(&self.blank, self.problem.points)
    }
}

/// The most dots of a picture.
pub const MAX_POINTS: usize = 1 << 24;

fn check_points(points: usize) -> Result<()> {
    match points {
        1..=MAX_POINTS => Ok(()),
        _ => Err(Error::Input(format!("{points} dots cannot be made: give 1 to {MAX_POINTS}"))),
    }
}

/// Whole numbers that sum to `points`, proportional to the energies: rounded down, and the largest remainders rounded
/// up.
fn apportion(points: usize, energies: &[f64]) -> Vec<usize> {
    let total: f64 = energies.iter().sum();
    let exact: Vec<f64> = energies.iter().map(|energy| energy / total * points as f64).collect();
    let mut counts: Vec<usize> = exact.iter().map(|exact| *exact as usize).collect();
    let mut order: Vec<usize> = (0..counts.len()).collect();
    order.sort_by(|a, b| exact[*b].fract().total_cmp(&exact[*a].fract()));
    let missing = points.saturating_sub(counts.iter().sum());
    order.iter().take(missing).for_each(|ink| counts[*ink] += 1);
    counts
}

/// The stream of starting positions, which no iteration reaches.
const STARTING: u64 = u64::MAX - 1;

fn starting(targets: &[ImageTarget], dots: &[Dots], seed: u64) -> Points {
    let targets: Vec<&ImageTarget> = targets.iter().collect();
    let counts: Vec<usize> = dots.iter().map(|dots| dots.range.len()).collect();
    Points::new(2, spread(&targets, &counts, &mut stream(seed, STARTING, 0)))
}

/// A class for every subset of the inks.
fn classes(targets: Vec<ImageTarget>, dots: &[Dots]) -> Result<Vec<Class>> {
    let points = dots.last().map_or(0, |dots| dots.range.end);
    let mut classes = Vec::new();
    for subset in 1_usize..1 << targets.len() {
        let inks: Vec<usize> = (0..targets.len()).filter(|ink| subset >> ink & 1 == 1).collect();
        let parts: Vec<(f32, &ImageTarget)> =
            inks.iter().map(|ink| (dots[*ink].range.len() as f32, &targets[*ink])).collect();
        let target = if let [(_, only)] = parts[..] { only.clone() } else { ImageTarget::mixture(&parts)? };
        let name = inks.iter().map(|ink| dots[*ink].name).collect::<String>();
        let function = members(dots, points, |ink| inks.contains(&ink));
        let weight = weight(&name);
        classes.push(Class { function, target: Arc::new(target), weight, name });
    }
    Ok(classes)
}

/// How much a subset of inks counts. Black with one of the others is what the eye sees as red, green or blue, and so
/// counts most: a photograph at 20,000 dots then has a blurred PSNR 2.4 dB above that of equal weights. Subsets
/// without black are what a person looks at least.
fn weight(inks: &str) -> f32 {
    match (inks.len(), inks.contains('k')) {
        (2, true) => 4.0,
        (_, true) => 1.0,
        (_, false) => 0.3,
    }
}

/// 1 for the points of the inks that are chosen, else 0.
fn members(dots: &[Dots], points: usize, chosen: impl Fn(usize) -> bool) -> ClassFunction {
    let steps = dots.iter().enumerate().map(|(ink, dots)| Step {
        to: (dots.range.end as f64 / points as f64) as f32,
        value: if chosen(ink) { 1.0 } else { 0.0 },
    });
    ClassFunction::Staircase(steps.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_proportional_and_complete() {
        assert_eq!(apportion(10, &[1.0, 1.0, 1.0]).iter().sum::<usize>(), 10);
        assert_eq!(apportion(7, &[2.0, 0.0, 5.0]), [2, 0, 5]);
        assert_eq!(apportion(100, &[1e-12, 1.0]), [0, 100]);
        assert_eq!(apportion(3, &[0.4, 0.35, 0.25]), [1, 1, 1]);
    }
}
