//! What an image is filtered by before its error is judged: reconstruction by the renderer, perception by the eye.

use crate::class::MIN_SIGMA;
use crate::{Error, error::Result};
use serde::Serialize;
use std::fmt;
use std::str::FromStr;

/// The standard deviation, in pixels, of [`Kernel::Perceptual`].
///
/// The thesis's authors' code has `exp(-r^2 / 2.1^2)`, a standard deviation of 1.48 pixels, cut to 7x7 pixels: that one
/// is `gaussian:1.48`.
pub const PERCEPTUAL_SIGMA: f32 = 2.1;

/// The standard deviation, in pixels, of the Gaussian reconstruction filter when none is given.
pub const RECONSTRUCTION_SIGMA: f32 = 0.5;

/// The largest standard deviation of a Gaussian kernel, in pixels.
const MAX_SIGMA: f32 = 16.0;

/// The largest sum of the radii of two kernels that are convolved, in pixels. A Gaussian of standard deviation s counts
/// 4.29 s: the result needs more of it than it will keep.
const MAX_RADIUS: usize = 96;

/// The weight, relative to the largest, below which a kernel ends: a Gaussian of standard deviation s has radius 2.86
/// s.
const CUT: f32 = 1.0 / 60.0;

/// The weight of the samples of the pixel at (x + `dx`, y + `dy`), `frame` frames ago, in the class of (x, y).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap {
    /// Pixels to the right.
    pub dx: i32,
    /// Pixels down.
    pub dy: i32,
    /// Frames into the past.
    pub frame: i32,
    /// The class function's value, from 0 to 1.
    pub weight: f32,
}

/// The spatial class function of every pixel, relative to its centre. The samples of a pixel count as being at its
/// centre.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Kernel {
    /// A pixel's own samples only: what box reconstruction integrates.
    Box,
    /// A Gaussian, for a renderer that reconstructs with one: the standard deviation in pixels, 1e-18 to 16.
    Gaussian(f32),
    /// A Gaussian of standard deviation [`PERCEPTUAL_SIGMA`]: what the eye makes of the pixels at a usual distance.
    Perceptual,
    /// The convolution of two kernels, themselves no convolutions: `p * r` in 5.6.1. A Gaussian's radius is 4.29
    /// standard deviations here; the radii of both add up to at most 96 pixels.
    Convolution(Box<Kernel>, Box<Kernel>),
    /// Any non-negative function: an odd number of rows as long as there are rows, the pixel itself in the centre.
    Tabulated(Vec<Vec<f32>>),
}

impl Kernel {
    /// Its values, the largest 1, in rows from top to bottom. An [`Error::Input`] if it is not what its description
    /// asks for.
    pub fn taps(&self) -> Result<Vec<Tap>> {
        let table = self.table(1.0)?;
        let radius = (table.len() / 2) as i32;
        let largest = table.iter().flatten().copied().fold(0.0, f32::max);
        if largest <= 0.0 {
            return Err(Error::input("a kernel whose values are all 0 has no samples"));
        }
        let tap = |y: usize, x: usize, value: f32| Tap {
            dx: x as i32 - radius,
            dy: y as i32 - radius,
            frame: 0,
            weight: value / largest,
        };
        let rows = table.iter().enumerate();
        let all = rows.flat_map(|(y, row)| row.iter().enumerate().map(move |(x, &value)| tap(y, x, value)));
        let cut = if self.is_sharp() { 0.0 } else { CUT };
        Ok(all.filter(|tap| tap.weight > cut).collect())
    }

    /// Whether it is used as far as it is not 0.
    fn is_sharp(&self) -> bool {
        matches!(self, Kernel::Box | Kernel::Tabulated(_))
    }

    /// Its values in a square, in f32; tails are `reach` times as long as they will be used.
    fn table(&self, reach: f32) -> Result<Vec<Vec<f32>>> {
        match self {
            Kernel::Box => Ok(vec![vec![1.0]]),
            Kernel::Perceptual => gaussian(PERCEPTUAL_SIGMA, reach),
            Kernel::Gaussian(sigma) => gaussian(*sigma, reach),
            Kernel::Convolution(first, second) => {
                let nested = |kernel: &Kernel| matches!(kernel, Kernel::Convolution(..));
                if nested(first) || nested(second) {
                    return Err(Error::input("a kernel is the convolution of two others at most"));
                }
                let (first, second) = (first.table(1.5)?, second.table(1.5)?);
                let (a, b) = (first.len() / 2, second.len() / 2);
                if a + b > MAX_RADIUS {
                    return Err(Error::input(format!(
                        "kernels of radius {a} and {b} pixels, tails included, are too wide to convolve: the radii add \
                         up to at most {MAX_RADIUS}"
                    )));
                }
                Ok(convolve(&first, &second))
            }
            Kernel::Tabulated(rows) => {
                let side = rows.len();
                let square = side % 2 == 1 && rows.iter().all(|row| row.len() == side);
                if !square {
                    return Err(Error::input(format!(
                        "a tabulated kernel is a square with an odd side, not {side} rows of other lengths"
                    )));
                }
                if let Some(bad) = rows.iter().flatten().find(|value| !(value.is_finite() && **value >= 0.0)) {
                    return Err(Error::input(format!("a kernel's values are 0 or positive, not {bad}")));
                }
                Ok(rows.clone())
            }
        }
    }
}

/// A Gaussian in the square that holds it down to [`CUT`], the circle beyond it included.
fn gaussian(sigma: f32, reach: f32) -> Result<Vec<Vec<f32>>> {
    if !(MIN_SIGMA..=MAX_SIGMA).contains(&sigma) {
        return Err(Error::input(format!(
            "a Gaussian kernel has a standard deviation of {MIN_SIGMA:e} to {MAX_SIGMA} pixels, not {sigma}"
        )));
    }
    let radius = libm::floorf(reach * sigma * libm::sqrtf(-2.0 * libm::logf(CUT))) as i32;
    let value = |x: i32, y: i32| libm::expf(-((x * x + y * y) as f32) / (2.0 * sigma * sigma));
    Ok((-radius..=radius).map(|y| (-radius..=radius).map(|x| value(x, y)).collect()).collect())
}

/// The discrete convolution of two squares.
fn convolve(first: &[Vec<f32>], second: &[Vec<f32>]) -> Vec<Vec<f32>> {
    let side = first.len() + second.len() - 1;
    let mut sum = vec![vec![0.0; side]; side];
    for (y, row) in first.iter().enumerate() {
        for (x, value) in row.iter().enumerate() {
            for (dy, other) in second.iter().enumerate() {
                for (dx, factor) in other.iter().enumerate() {
                    sum[y + dy][x + dx] += value * factor;
                }
            }
        }
    }
    sum
}

impl FromStr for Kernel {
    type Err = Error;

    /// `box`, `perceptual`, `gaussian`, `gaussian:S`, or two of them with a `*` between.
    fn from_str(text: &str) -> Result<Kernel> {
        let unknown = || {
            Error::input(format!(
                "'{text}' is not a kernel: use box, perceptual, gaussian:SIGMA, or a convolution such as \
                 perceptual*gaussian:0.5"
            ))
        };
        let kernel = match text.split_once('*') {
            Some((_, second)) if second.contains('*') => {
                let factors = text.split('*').count();
                return Err(Error::input(format!(
                    "a kernel is the convolution of two others at most, not of {factors}"
                )));
            }
            Some((first, second)) => Kernel::Convolution(Box::new(first.parse()?), Box::new(second.parse()?)),
            None => match text.trim().split_once(':') {
                None => match text.trim() {
                    "box" => Kernel::Box,
                    "perceptual" => Kernel::Perceptual,
                    "gaussian" => Kernel::Gaussian(RECONSTRUCTION_SIGMA),
                    _ => return Err(unknown()),
                },
                Some(("gaussian", sigma)) => Kernel::Gaussian(sigma.parse().map_err(|_| unknown())?),
                Some(_) => return Err(unknown()),
            },
        };
        kernel.taps()?;
        Ok(kernel)
    }
}

impl fmt::Display for Kernel {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Kernel::Box => out.write_str("box"),
            Kernel::Perceptual => out.write_str("perceptual"),
            Kernel::Gaussian(sigma) => write!(out, "gaussian:{sigma}"),
            Kernel::Convolution(first, second) => write!(out, "{first}*{second}"),
            Kernel::Tabulated(rows) => write!(out, "tabulated:{}", rows.len()),
        }
    }
}
