//! From pictures to densities of ink.

use crate::picture::{Photo, blurred, decode, luminance};

/// What "half as dark" means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
pub enum Tone {
    /// Of sRGB-encoded values: even steps of lightness.
    ///
    /// Middle grey is half covered: the mean of the drawing's pixel values is the picture's.
    #[default]
    Encoded,
    /// Of linear light: right where dots are too small to be told apart.
    ///
    /// Middle grey reflects 21 % and is 79 % covered.
    Linear,
}

impl Tone {
    fn value(self, encoded: f32) -> f32 {
        match self {
            Tone::Encoded => encoded,
            Tone::Linear => decode(encoded),
        }
    }
}

/// Where an ink is needed.
#[derive(Clone, Debug, PartialEq)]
pub struct Ink {
    /// One letter: `c`, `m`, `y`, `k`; `w` is white ink on black paper.
    pub name: &'static str,
    /// Its colour.
    pub colour: [u8; 3],
    /// Area of dots per area of paper at each pixel of the picture, at least 0.
    pub density: Vec<f32>,
}

/// What part of the paper equal discs cover that are spread as evenly as optimised points, when their areas sum to
/// 0.60, 0.65, ... of it: measured on 4,000 points. Up to the first value none overlap.
const COVERED: [f32; 15] = [
    0.600, 0.6438, 0.6886, 0.7313, 0.7713, 0.8084, 0.8415, 0.8707, 0.8962, 0.9183, 0.9366, 0.9511, 0.9632, 0.9730,
    0.9804,
];
/// Area of dots per area of paper where the paper shall be black: the last percent would take as many dots as all of
/// a light grey.
const BLACK_INK: f32 = 1.4;

/// Area of dots per area of paper that cover a part of it: more than that part from where dots begin to overlap.
pub fn ink_for(coverage: f32) -> f32 {
    let (first, last) = (COVERED[0], COVERED[COVERED.len() - 1]);
    let ink = |step: f32| first + 0.05 * step;
    if coverage <= first {
        return coverage.max(0.0);
    }
    let step = COVERED.partition_point(|covered| *covered < coverage);
    match COVERED.get(step) {
        Some(upper) => {
            let lower = COVERED[step - 1];
            ink(step as f32 - (upper - coverage) / (upper - lower))
        }
        None => {
            let full = ink((COVERED.len() - 1) as f32);
            full + (BLACK_INK - full) * ((coverage.min(1.0) - last) / (1.0 - last))
        }
    }
}

/// Black dots, or white ones on black paper; `points` of them.
pub fn grey(photo: &Photo, tone: Tone, invert: bool, points: usize) -> Vec<Ink> {
    let coverage = photo.pixels.iter().map(|rgb| {
        let light = luminance(rgb.map(|value| tone.value(value)));
        if invert { light } else { 1.0 - light }
    });
    let coverage: Vec<f32> = coverage.collect();
    let radius = radius(coverage.iter().map(|part| f64::from(*part)).sum(), points);
    let (name, colour) = if invert { ("w", [255; 3]) } else { ("k", [0; 3]) };
    vec![Ink { name, colour, density: density(photo.width, photo.height, coverage, radius) }]
}

/// Cyan, magenta, yellow and black; `points` of all together.
///
/// Dots of different inks are spread evenly together, so they add up rather than fall on one another at random: cyan
/// and black together cover what the picture lacks in red, magenta and black what it lacks in green, yellow and black
/// what it lacks in blue. Black takes the part `grey_component`, in [0, 1], of what is common to all three.
pub fn cmyk(photo: &Photo, tone: Tone, grey_component: f32, points: usize) -> Vec<Ink> {
    let lacks = |channel: usize| photo.pixels.iter().map(move |rgb| 1.0 - tone.value(rgb[channel]));
    let lack = [0, 1, 2].map(|channel| lacks(channel).collect::<Vec<f32>>());
    let common = |pixel: usize| lack[0][pixel].min(lack[1][pixel]).min(lack[2][pixel]);
    let part = grey_component.clamp(0.0, 1.0);
    let black: Vec<f32> = (0..photo.pixels.len()).map(|pixel| common(pixel) * part).collect();
    let all = |i: usize| f64::from(lack[0][i] + lack[1][i] + lack[2][i] - 2.0 * black[i]);
    let radius = radius((0..black.len()).map(all).sum(), points);
    let inked = |coverage| density(photo.width, photo.height, coverage, radius);
    let black = inked(black);
    let rest = |lack| inked(lack).into_iter().zip(&black).map(|(all, black)| (all - black).max(0.0)).collect();
    let [cyan, magenta, yellow] = lack.map(rest);
    vec![
        Ink { name: "c", colour: [0, 255, 255], density: cyan },
        Ink { name: "m", colour: [255, 0, 255], density: magenta },
        Ink { name: "y", colour: [255, 255, 0], density: yellow },
        Ink { name: "k", colour: [0; 3], density: black },
    ]
}

/// The radius of dots that together have this area.
pub(super) fn radius(area: f64, dots: usize) -> f32 {
    (area / (dots.max(1) as f64 * std::f64::consts::PI)).sqrt() as f32
}

/// Area of dots per area of paper for a coverage of each pixel. How much dots overlap depends on how many there are
/// around, within a radius or so, and not on what is finer than they are.
fn density(width: usize, height: usize, coverage: Vec<f32>, radius: f32) -> Vec<f32> {
    let around = blurred(&coverage, width, height, radius);
    let more = |around: f32| if around > 0.0 { ink_for(around) / around } else { 1.0 };
    coverage.into_iter().zip(around).map(|(part, around)| part.max(0.0) * more(around)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Dots far smaller than pixels, each of which then counts for itself.
    const MANY: usize = 1 << 24;

    #[test]
    fn inks_add_up_to_what_each_primary_lacks() {
        let photo = Photo::from_fn(7, 9, |x, y| [x as f32 / 6.0, y as f32 / 8.0, 0.4]);
        for tone in [Tone::Encoded, Tone::Linear] {
            for grey_component in [0.0, 0.7, 1.0] {
                let inks = cmyk(&photo, tone, grey_component, MANY);
                for (pixel, rgb) in photo.pixels.iter().enumerate() {
                    for (ink, value) in inks[..3].iter().zip(rgb) {
                        let total = ink.density[pixel] + inks[3].density[pixel];
                        assert!(ink.density[pixel] >= 0.0);
                        assert!((total - ink_for(1.0 - tone.value(*value))).abs() < 1e-6);
                    }
                }
                let least = |pixel| inks[..3].iter().map(|ink| ink.density[pixel]).fold(f32::INFINITY, f32::min);
                assert!(grey_component < 1.0 || (0..63).all(|pixel| least(pixel) == 0.0));
            }
        }
    }

    #[test]
    fn dots_overlap_by_what_is_around_them() {
        // Left of pixels one by one, right of halves.
        let photo = Photo::from_fn(128, 128, |x, y| {
            let dark = if x < 64 { (x + y) % 2 == 0 } else { y < 64 };
            [if dark { 0.0 } else { 1.0 }; 3]
        });
        let mean = |density: &[f32], columns: std::ops::Range<usize>, rows: std::ops::Range<usize>| {
            let of = |y: usize| density[y * 128..][columns.clone()].iter().sum::<f32>() / columns.len() as f32;
            rows.clone().map(of).sum::<f32>() / rows.len() as f32
        };
        // Of a radius of a few pixels, or of many.
        for points in [600, 20] {
            for inks in [grey(&photo, Tone::Encoded, false, points), cmyk(&photo, Tone::Encoded, 0.7, points)] {
                let black = &inks.last().unwrap().density;
                let all = if inks.len() == 1 {
                    black.clone()
                } else {
                    inks[0].density.iter().zip(black).map(|(cyan, black)| cyan + black).collect()
                };
                let fine = mean(&all, 4..36, 32..96);
                assert!((fine - 0.5).abs() < 0.01, "{points}: {fine}");
                if points == 600 {
                    assert!((mean(&all, 80..120, 8..52) - ink_for(1.0)).abs() < 1e-3, "{points}");
                    assert_eq!(mean(&all, 80..120, 76..120), 0.0);
                }
            }
        }
    }

    #[test]
    fn white_paper_needs_no_ink_and_black_dots_are_for_dark_places() {
        let photo = Photo::from_fn(2, 1, |x, _| [1.0 - x as f32; 3]);
        assert!(cmyk(&photo, Tone::Encoded, 1.0, MANY).iter().all(|ink| ink.density[0] == 0.0));
        assert_eq!(grey(&photo, Tone::Encoded, false, MANY)[0].density, [0.0, ink_for(1.0)]);
        assert_eq!(grey(&photo, Tone::Linear, true, MANY)[0].density, [ink_for(1.0), 0.0]);
    }

    #[test]
    fn more_coverage_takes_more_ink() {
        let inks: Vec<f32> = (0..=1000).map(|k| ink_for(k as f32 / 1000.0)).collect();
        assert!(inks.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!(ink_for(0.5), 0.5);
    }
}
