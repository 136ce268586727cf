//! From pictures to densities of ink.

use crate::picture::{Photo, decode, luminance};

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

/// Black dots, or white ones on black paper.
pub fn grey(photo: &Photo, tone: Tone, invert: bool) -> Vec<Ink> {
    let density = photo.pixels.iter().map(|rgb| {
        let light = luminance(rgb.map(|value| tone.value(value)));
        ink_for(if invert { light } else { 1.0 - light })
    });
    let (name, colour) = if invert { ("w", [255; 3]) } else { ("k", [0; 3]) };
    vec![Ink { name, colour, density: density.collect() }]
}

/// Cyan, magenta, yellow and black.
///
/// Dots of different inks are spread evenly together, so they add up rather than fall on one another at random: cyan
/// and black together cover what the picture lacks in red, magenta and black what it lacks in green, yellow and black
/// what it lacks in blue. Black takes the part `grey_component`, in [0, 1], of what is common to all three.
pub fn cmyk(photo: &Photo, tone: Tone, grey_component: f32) -> Vec<Ink> {
    let mut inks = [("c", [0, 255, 255]), ("m", [255, 0, 255]), ("y", [255, 255, 0]), ("k", [0, 0, 0])]
        .map(|(name, colour)| Ink { name, colour, density: Vec::with_capacity(photo.pixels.len()) });
    for rgb in &photo.pixels {
        let lack = rgb.map(|value| 1.0 - tone.value(value));
        let common = lack[0].min(lack[1]).min(lack[2]);
        let black = ink_for(common * grey_component.clamp(0.0, 1.0));
        for (ink, lack) in inks.iter_mut().zip(lack) {
            ink.density.push((ink_for(lack) - black).max(0.0));
        }
        inks[3].density.push(black);
    }
    inks.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inks_add_up_to_what_each_primary_lacks() {
        let photo = Photo::from_fn(7, 9, |x, y| [x as f32 / 6.0, y as f32 / 8.0, 0.4]);
        for tone in [Tone::Encoded, Tone::Linear] {
            for grey_component in [0.0, 0.7, 1.0] {
                let inks = cmyk(&photo, tone, grey_component);
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
    fn white_paper_needs_no_ink_and_black_dots_are_for_dark_places() {
        let photo = Photo::from_fn(2, 1, |x, _| [1.0 - x as f32; 3]);
        assert!(cmyk(&photo, Tone::Encoded, 1.0).iter().all(|ink| ink.density[0] == 0.0));
        assert_eq!(grey(&photo, Tone::Encoded, false)[0].density, [0.0, ink_for(1.0)]);
        assert_eq!(grey(&photo, Tone::Linear, true)[0].density, [ink_for(1.0), 0.0]);
    }

    #[test]
    fn more_coverage_takes_more_ink() {
        let inks: Vec<f32> = (0..=1000).map(|k| ink_for(k as f32 / 1000.0)).collect();
        assert!(inks.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!(ink_for(0.5), 0.5);
    }
}
