//! The error of samplers in rendered scenes: tables of pixels' integrands, which `tests/embree` writes.
//!
//! Each pixel's error is relative to its value (with a hundredth of the image's mean squared added to its square), and
//! its energy to that of as many independent samples, filtered alike. Integrands are bilinear between the cells.
//!
//! - [`SceneTable::errors`]: the first n samples, alike in all pixels, or of pixels that stop at different numbers.
//! - [`SceneTable::raw`]: each pixel's own error, at every number of samples.
//! - [`SceneTable::frames`]: sample t in frame t, frames averaged as they are shown.

mod frames;

use crate::error::{Error, Result};
use crate::random::stream;
use crate::read;
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;

/// Places of the image in the plane of samples that errors are averaged over.
pub const PLACES: usize = 24;
/// Widths of the Gaussian filters, in pixels; 0 is none.
const FILTERS: [f64; 3] = [2.1, 1.0, 0.0];
/// The most that a table's side or cells may be.
const MOST: usize = 1024;
/// The most that a value may be: sums of such are finite.
const BRIGHTEST: f32 = 1e30;
/// A pixel's relative variance that rounding alone makes, and more.
const FLAT: f64 = 1e-12;

/// Pixels' integrands.
#[derive(Debug)]
pub struct SceneTable {
    width: usize,
    height: usize,
    cells: usize,
    values: Vec<f32>,
    /// Each pixel's value, and the variance of one sample.
    moments: Vec<(f64, f64)>,
}

/// The samples of a plane of pixels that repeats.
#[derive(Debug)]
pub struct Plane {
    /// Pixels along each side.
    pub size: usize,
    /// Samples of each pixel.
    pub samples: usize,
    /// `[y][x][sample]`
    pub points: Vec<[f32; 2]>,
}

/// Energies of an error, relative to that of independent samples.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Energies {
    /// Filtered by a Gaussian of 2.1 pixels.
    pub wide: f64,
    /// Filtered by a Gaussian of one pixel.
    pub narrow: f64,
    /// Not filtered.
    pub raw: f64,
}

/// How many samples pixels have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Count {
    /// So many.
    All(usize),
    /// 1, 2, 4 or 8: a quarter of the pixels each, more where the variance is larger, as an adaptive renderer has them.
    Adapted,
    /// 1, 2, 4 or 8 by chance.
    Mixed,
}

/// How frames are averaged: the average so far, and a tenth of the new frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frames {
    /// The picture stands still.
    Still,
    /// The picture moves by a pixel each frame, and the average with it.
    Moving,
    /// It stands still, and the average is clamped to what the new frame has in the 3 x 3 pixels around, as temporal
    /// anti-aliasing does.
    Clamped,
}

impl Plane {
    /// A pixel's first samples; pixels repeat.
    fn pixel(&self, (x, y): (usize, usize), samples: usize) -> &[[f32; 2]] {
        &self.points[(y % self.size * self.size + x % self.size) * self.samples..][..samples]
    }

    fn check(&self, samples: usize) -> Result<()> {
        if self.samples < samples {
            let has = self.samples;
            return Err(Error::Input(format!("a pixel has {has} samples, and {samples} are asked for")));
        }
        Ok(())
    }
}

/// Where the image lies in the plane, one after the other.
fn places(plane: &Plane) -> [(usize, usize); PLACES] {
    let mut rng = stream(11, 0, 0);
    let mut shift = || rng.below(plane.size as u32) as usize;
    std::array::from_fn(|_| (shift(), shift()))
}

impl SceneTable {
    /// Reads a file of `embree_tables`.
    ///
    /// # Errors
    /// It cannot be read, or is none; a value is no number, or beyond what averages can hold; no pixel's values differ.
    pub fn read(path: &Path) -> Result<SceneTable> {
        const NONE: &str = "no table of a scene, or not a whole one";
        let refuse = |why: &str| Err(Error::Input(format!("{} is {why}", path.display())));
        let (numbers, values) = read::floats(path, "noisefloor-scene ", NONE)?;
        let [width, height, cells] = numbers[..] else { return refuse(NONE) };
        if [width, height, cells].iter().any(|side| !(2..=MOST).contains(side))
            || width * height * cells * cells != values.len()
        {
            return refuse(NONE);
        }
        if let Some(index) = values.iter().position(|value| !(-BRIGHTEST..=BRIGHTEST).contains(value)) {
            return Err(Error::Input(format!(
                "{}: value {} is {}: values must be numbers of at most {BRIGHTEST:e}",
                path.display(),
                index + 1,
                values[index]
            )));
        }
        let table = SceneTable::new([width, height], cells, values);
        let white = table.white(&table.scale());
        if !(white.is_finite() && white > FLAT * table.moments.len() as f64) {
            return Err(Error::Input(format!(
                "{} has one value in each of its pixels, or 0 in the mean: no sampler has an error there; leave it out",
                path.display()
            )));
        }
        Ok(table)
    }

    fn new([width, height]: [usize; 2], cells: usize, values: Vec<f32>) -> SceneTable {
        let mut table = SceneTable { width, height, cells, values, moments: Vec::new() };
        table.moments = (0..width * height).into_par_iter().map(|pixel| table.moments_of(pixel)).collect();
        table
    }

    fn pixel(&self, pixel: usize) -> &[f32] {
        let cells = self.cells * self.cells;
        &self.values[pixel * cells..][..cells]
    }

    /// A pixel's integrand.
    fn at(&self, pixel: usize, [x, y]: [f32; 2]) -> f32 {
        let place = |c: f32| (c * self.cells as f32 - 0.5).clamp(0.0, (self.cells - 1) as f32);
        let (x, y) = (place(x), place(y));
        let (column, row) = ((x as usize).min(self.cells - 2), (y as usize).min(self.cells - 2));
        let (a, b) = (x - column as f32, y - row as f32);
        let values = &self.pixel(pixel)[row * self.cells + column..];
        let along = |values: &[f32]| (1.0 - a) * values[0] + a * values[1];
        (1.0 - b) * along(values) + b * along(&values[self.cells..])
    }

    /// Exact. Each value has the same share of the mean. Of the squares, with two Gauss points between the middles of
    /// cells, and one in each half cell at a border, where the integrand is constant, all weights are the same.
    fn moments_of(&self, pixel: usize) -> (f64, f64) {
        /// Where they are in a cell: 1 / (2 sqrt 3), and as far from its end.
        const GAUSS: [f32; 2] = [0.288_675_13, 0.711_324_9];
        let values = self.pixel(pixel);
        let mean = values.iter().map(|value| f64::from(*value)).sum::<f64>() / values.len() as f64;
        let fine = 2 * self.cells;
        let place = |i: usize| ((i / 2) as f32 + GAUSS[i % 2]) / self.cells as f32;
        let squares = (0..fine * fine).map(|i| {
            let offset = f64::from(self.at(pixel, [place(i % fine), place(i / fine)])) - mean;
            offset * offset
        });
        (mean, squares.sum::<f64>() / (fine * fine) as f64)
    }

    /// The errors of a plane's first samples, for as many as each of `counts` says.
    ///
    /// # Errors
    /// A pixel of the plane has fewer samples.
    pub fn errors(&self, plane: &Plane, counts: &[Count]) -> Result<Vec<Energies>> {
        let scale = self.scale();
        let counts: Vec<Vec<usize>> = counts.iter().map(|count| self.counts(*count, &scale)).collect();
        let most = counts.iter().flatten().copied().max().unwrap_or(0);
        plane.check(most)?;
        let pixel = |pixel: usize| {
            let wanted: Vec<usize> = counts.iter().map(|counts| counts[pixel]).collect();
            let mut errors = vec![0.0; counts.len() * PLACES];
            for (number, place) in places(plane).into_iter().enumerate() {
                let mut sum = 0.0;
                for (i, point) in plane.pixel(self.moved(pixel, place), most).iter().enumerate() {
                    sum += f64::from(self.at(pixel, *point));
                    for (count, _) in wanted.iter().enumerate().filter(|(_, wanted)| **wanted == i + 1) {
                        errors[count * PLACES + number] = self.error(pixel, sum / (i + 1) as f64, &scale);
                    }
                }
            }
            errors
        };
        let pixels: Vec<Vec<f64>> = (0..self.width * self.height).into_par_iter().map(pixel).collect();
        let image = |image: usize| pixels.iter().map(|errors| errors[image]).collect();
        let energies = counts.iter().enumerate().map(|(number, counts)| {
            let images: Vec<Vec<f64>> = (number * PLACES..(number + 1) * PLACES).map(image).collect();
            self.energies(&images, &scale, |pixel| 1.0 / counts[pixel] as f64)
        });
        Ok(energies.collect())
    }

    /// Each pixel's own error, not filtered: `[count - 1][place]`, up to the plane's samples, relative to independent
    /// samples. The same place of two planes of one size is the same.
    #[must_use]
    pub fn raw(&self, plane: &Plane) -> Vec<[f64; PLACES]> {
        let scale = self.scale();
        let white = self.white(&scale);
        let place = |place| {
            let mut sums = vec![0.0; plane.samples];
            for pixel in 0..self.width * self.height {
                let mut sum = 0.0;
                for (i, point) in plane.pixel(self.moved(pixel, place), plane.samples).iter().enumerate() {
                    sum += f64::from(self.at(pixel, *point));
                    let error = self.error(pixel, sum / (i + 1) as f64, &scale);
                    sums[i] += error * error * (i + 1) as f64 / white;
                }
            }
            sums
        };
        let columns: Vec<Vec<f64>> = places(plane).into_par_iter().map(place).collect();
        (0..plane.samples).map(|i| std::array::from_fn(|place| columns[place][i])).collect()
    }

    /// Each pixel's number of samples.
    fn counts(&self, count: Count, scale: &[f64]) -> Vec<usize> {
        let pixels = self.moments.len();
        match count {
            Count::All(count) => vec![count; pixels],
            Count::Mixed => (0..pixels).map(|pixel| 1 << stream(12, 0, pixel as u64).below(4)).collect(),
            Count::Adapted => {
                let variance = |pixel: &usize| self.moments[*pixel].1 * scale[*pixel];
                let mut order: Vec<usize> = (0..pixels).collect();
                order.sort_by(|a, b| variance(a).total_cmp(&variance(b)));
                let mut counts = vec![0; pixels];
                (0..).zip(order).for_each(|(rank, pixel)| counts[pixel] = 1 << (4 * rank / pixels));
                counts
            }
        }
    }

    /// One over each pixel's value, squared.
    fn scale(&self) -> Vec<f64> {
        let average = self.moments.iter().map(|(mean, _)| mean).sum::<f64>() / self.moments.len() as f64;
        self.moments.iter().map(|(mean, _)| 1.0 / (mean * mean + 0.01 * average * average)).collect()
    }

    /// The energy of one independent sample, not filtered.
    fn white(&self, scale: &[f64]) -> f64 {
        self.moments.iter().zip(scale).map(|((_, variance), scale)| variance * scale).sum()
    }

    fn error(&self, pixel: usize, estimate: f64, scale: &[f64]) -> f64 {
        (estimate - self.moments[pixel].0) * libm::sqrt(scale[pixel])
    }

    /// Where a pixel of the image is in the plane.
    fn moved(&self, pixel: usize, (dx, dy): (usize, usize)) -> (usize, usize) {
        (pixel % self.width + dx, pixel / self.width + dy)
    }

    /// The energies of images of errors, relative to those of independent samples of which each pixel's estimate has
    /// `weight` times the variance of one.
    fn energies(&self, images: &[Vec<f64>], scale: &[f64], weight: impl Fn(usize) -> f64) -> Energies {
        let white = |(pixel, (_, variance)): (usize, &(f64, f64))| variance * scale[pixel] * weight(pixel);
        let white: Vec<f64> = self.moments.iter().enumerate().map(white).collect();
        let [wide, narrow, raw] = FILTERS.map(|sigma| {
            let filter = gaussian(sigma);
            let squared: Vec<f64> = filter.iter().map(|weight| weight * weight).collect();
            let expected: f64 = self.filtered(&white, &squared).iter().sum();
            let energy = |image: &Vec<f64>| self.filtered(image, &filter).iter().map(|e| e * e).sum::<f64>();
            let sum: f64 = images.par_iter().map(energy).collect::<Vec<_>>().iter().sum();
            sum / images.len() as f64 / expected
        });
        Energies { wide, narrow, raw }
    }

    /// An image, seen through a filter in both directions; there is nothing beyond its borders.
    fn filtered(&self, image: &[f64], filter: &[f64]) -> Vec<f64> {
        let reach = filter.len() / 2;
        let along = |from: &[f64], length: usize, stride: usize| {
            let mut to = vec![0.0; from.len()];
            for (i, to) in to.iter_mut().enumerate() {
                let place = i / stride % length;
                for (k, weight) in filter.iter().enumerate() {
                    if (reach..length + reach).contains(&(place + k)) {
                        *to += weight * from[i + k * stride - reach * stride];
                    }
                }
            }
            to
        };
        along(&along(image, self.width, 1), self.height, self.width)
    }
}

/// A Gaussian filter along one axis.
fn gaussian(sigma: f64) -> Vec<f64> {
    let reach = libm::ceil(3.5 * sigma) as i32;
    let weight = |i: i32| if i == 0 { 1.0 } else { libm::exp(-f64::from(i * i) / (2.0 * sigma * sigma)) };
    let weights: Vec<f64> = (-reach..=reach).map(weight).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / sum).collect()
}

/// Independent samples.
#[must_use]
pub fn white(size: usize, samples: usize) -> Plane {
    let mut rng = stream(1, 2, 3);
    let points = (0..size * size * samples).map(|_| [rng.uniform_f32(), rng.uniform_f32()]).collect();
    Plane { size, samples, points }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x + y in every pixel.
    pub(super) fn ramp() -> SceneTable {
        let (side, cells) = (24, 16);
        let value = |i: usize| ((i % cells) as f32 + (i / cells) as f32 + 1.0) / cells as f32;
        let values = (0..side * side).flat_map(|_| (0..cells * cells).map(value)).collect();
        SceneTable::new([side; 2], cells, values)
    }

    /// Values that have nothing to do with their neighbours', and a step: as a sum over a fine grid says.
    #[test]
    fn moments_are_those_of_the_integrand() {
        let cells = 8;
        let mut rng = stream(7, 0, 0);
        let noise = (0..cells * cells).map(|_| rng.uniform_f32());
        let step = (0..cells * cells).map(|i| if i % cells < 3 { 0.0 } else { 1.0 });
        let table = SceneTable::new([1, 2], cells, noise.chain(step).collect());
        let fine = 64 * cells;
        let place = |i: usize| (i as f32 + 0.5) / fine as f32;
        for (pixel, (mean, variance)) in table.moments.iter().enumerate() {
            let values = (0..fine * fine).map(|i| f64::from(table.at(pixel, [place(i % fine), place(i / fine)])));
            let (sum, squares) =
                values.fold((0.0, 0.0), |(sum, squares), value| (sum + value, squares + value * value));
            let expected = sum / (fine * fine) as f64;
            assert!((mean - expected).abs() < 1e-5, "{mean}, not {expected}");
            let expected = squares / (fine * fine) as f64 - expected * expected;
            assert!((variance / expected - 1.0).abs() < 1e-3, "{variance}, not {expected}");
        }
    }

    /// x + y in every pixel: samples in the middle have no error, independent ones that of one random sample.
    #[test]
    fn errors_are_relative_to_independent_samples() {
        let table = ramp();
        let middle = Plane { size: 1, samples: 1, points: vec![[0.5, 0.5]] };
        assert!(table.errors(&middle, &[Count::All(1)]).unwrap()[0].raw < 1e-9);
        let white = white(128, 8);
        let energies = table.errors(&white, &[Count::All(1), Count::All(3), Count::Mixed, Count::Adapted]).unwrap();
        let every = table.raw(&white);
        for energies in &energies {
            assert!((energies.raw - 1.0).abs() < 0.2 && (energies.wide - 1.0).abs() < 0.6, "{energies:?}");
        }
        let mean = every[2].iter().sum::<f64>() / PLACES as f64;
        assert!((mean / energies[1].raw - 1.0).abs() < 1e-9, "{mean} {energies:?}");
        assert!(table.errors(&white, &[Count::All(9)]).is_err());
    }
}
