//! How a picture becomes dots, for one picture and for many.

use super::separation::{Ink, Tone, cmyk, grey};
use crate::error::{Error, Result};
use crate::optimize::Quality;
use crate::picture::{BLACK, Blend, Drawing, Photo, WHITE};

/// How a picture becomes dots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Dots of all inks.
    pub points: usize,
    /// Cyan, magenta, yellow and black dots instead of black ones.
    pub cmyk: bool,
    /// White dots on black paper instead of black ones on white; not with `cmyk`.
    pub invert: bool,
    /// What "half as dark" means.
    pub tone: Tone,
    /// The part of what is common to the three colours that black replaces, in [0, 1].
    pub grey_component: f32,
    /// Chooses all random numbers.
    pub seed: u64,
    /// How long to optimise: draft, standard and high are 400, 4,000 and 16,000 iterations here; of animations for each
    /// window's number of points.
    pub quality: Quality,
}

/// Pictures gain from more iterations than even sets: small features are the last to settle. `sets` is how many times
/// as many points there are as a slice moves at most: so many times as many slices move each as often.
pub(super) fn effort(quality: Quality, sets: f64) -> Quality {
    let steps = |base: f64| Quality::Iterations(libm::ceil(base * sets.max(1.0)) as u64);
    match quality {
        Quality::Draft => steps(400.0),
        Quality::Standard => steps(4000.0),
        Quality::High => steps(16_000.0),
        other => other,
    }
}

impl Options {
    /// Black dots at standard quality.
    pub fn new(points: usize) -> Options {
        Options {
            points,
            cmyk: false,
            invert: false,
            tone: Tone::Encoded,
            grey_component: 1.0,
            seed: 1,
            quality: Quality::Standard,
        }
    }
}

/// The drawing without dots.
pub(super) fn paper(extent: [f32; 2], options: &Options) -> Drawing {
    Drawing {
        paper: if options.invert { BLACK } else { WHITE },
        blend: if options.invert { Blend::Over } else { Blend::Multiply },
        linear: options.tone == Tone::Linear,
        ..Drawing::new(extent)
    }
}

/// The mean distance between dots: the side of a square of the area that there is for each.
pub(super) fn spacing(blank: &Drawing, dots: usize) -> f32 {
    (blank.size[0] * blank.size[1] / dots as f32).sqrt()
}

/// The inks of a picture that has more than one tone, for so many dots.
pub(super) fn inks(photo: &Photo, options: &Options, points: usize) -> Result<Vec<Ink>> {
    let all = |black: bool| {
        let end = if black { 0.0 } else { 1.0 };
        photo.pixels.iter().all(|rgb| rgb.iter().all(|value| (value - end).abs() < 0.5 / 255.0))
    };
    for (black, name) in [(true, "black"), (false, "white")] {
        if all(black) {
            return Err(Error::Input(format!(
                "the picture is {name} all over: there is nothing to show with dots; \
                 for evenly spread points see `fsot points`"
            )));
        }
    }
    Ok(if options.cmyk {
        cmyk(photo, options.tone, options.grey_component, points)
    } else {
        grey(photo, options.tone, options.invert, points)
    })
}
