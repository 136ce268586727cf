//! What an animation is filtered by along time (section 5.8).

use crate::counted::counted;
use crate::{Error, error::Result};
use serde::Serialize;
use std::fmt;
use std::str::FromStr;

/// Frames per second that [`TemporalKernel::Mantiuk`] is sampled at.
pub const FRAME_RATE: f32 = 60.0;

/// Frames of [`TemporalKernel::Mantiuk`], a second: the eye has answered long before its end.
const EYE: usize = 60;

/// The largest weight, relative to the largest of a temporal kernel, that counts as none.
const CUT: f32 = 0.05;

/// The temporal class function of a frame: the weights of that frame and of those before it, those up to a twentieth of
/// the largest left out. Time wraps around like the image, so that the animation loops.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum TemporalKernel {
    /// The exponential moving average of temporal anti-aliasing, `a (1 - a)^k` for the frame k frames ago, cut
    /// at the animation's length: a from 1e-6 to 1.
    Ema(f32),
    /// The eye's response, sustained plus transient, at [`FRAME_RATE`]: R. Mantiuk et al., "FovVideoVDP: A Visible
    /// Difference Predictor for Wide Field-of-View Video", 2021.
    ///
    /// Sustained: `S(t) = exp(-(ln(t + 1e-4) - ln 0.06)^2 / (2 * 0.5^2))`, t in seconds, scaled to the sum 1 over a
    /// second's frames. Transient: `0.062170507756932 dS/dt`, here the analytic derivative. The sum has a negative
    /// tail, which a class function cannot have (it selects samples, it does not weigh them): its absolute value is
    /// used, so that the frames of the tail are stratified as well.
    Mantiuk,
    /// The weights of the frame itself, the one before it, and so on: 0 or positive.
    Tabulated(Vec<f32>),
}

impl TemporalKernel {
    /// The weights of the frame, of the one before it, and so on, the largest 1, for an animation of `frames` frames.
    /// An [`Error::Input`] if the kernel is not what its description asks for, or longer than the animation.
    pub fn weights(&self, frames: usize) -> Result<Vec<f32>> {
        let values = self.response(frames.max(1))?;
        let largest = values.iter().map(|value| value.abs()).fold(0.0, f32::max);
        if largest <= 0.0 {
            return Err(Error::input("a temporal kernel whose values are all 0 has no frames"));
        }
        let weights = values.iter().map(|value| value.abs() / largest);
        let mut weights: Vec<f32> = weights.map(|weight| if weight > CUT { weight } else { 0.0 }).collect();
        while weights.last() == Some(&0.0) {
            weights.pop();
        }
        if weights.len() > frames {
            return Err(Error::input(format!(
                "the temporal kernel {self} spans {}, the animation has {frames}",
                counted(weights.len(), "frame")
            )));
        }
        Ok(weights)
    }

    /// The signed impulse response, frame by frame into the past: `frames` of one that does not end.
    fn response(&self, frames: usize) -> Result<Vec<f32>> {
        match self {
            TemporalKernel::Ema(alpha) => {
                if !(*alpha >= 1e-6 && *alpha <= 1.0) {
                    return Err(Error::input(format!(
                        "an exponential moving average has a factor from 1e-6 to 1, not {alpha}"
                    )));
                }
                Ok(std::iter::successors(Some(*alpha), |weight| Some(weight * (1.0 - alpha))).take(frames).collect())
            }
            TemporalKernel::Mantiuk => Ok(eye()),
            TemporalKernel::Tabulated(values) => {
                if let Some(bad) = values.iter().find(|value| !(value.is_finite() && **value >= 0.0)) {
                    return Err(Error::input(format!("a temporal kernel's values are 0 or positive, not {bad}")));
                }
                Ok(values.clone())
            }
        }
    }
}

/// The sum of the sustained and the transient response at the middle of each frame.
fn eye() -> Vec<f32> {
    const PEAK: f64 = 0.06;
    const WIDTH: f64 = 0.5;
    const TRANSIENT: f64 = 0.062_170_507_756_932;
    let times: Vec<f64> = (0..EYE).map(|frame| (frame as f64 + 0.5) / f64::from(FRAME_RATE) + 1e-4).collect();
    let log = |t: f64| libm::log(t / PEAK);
    let sustained = |t: f64| libm::exp(-log(t) * log(t) / (2.0 * WIDTH * WIDTH));
    let total: f64 = times.iter().map(|&t| sustained(t)).sum();
    let response = |t: f64| sustained(t) / total * (1.0 - TRANSIENT * log(t) / (WIDTH * WIDTH * t));
    times.iter().map(|&t| response(t) as f32).collect()
}

impl FromStr for TemporalKernel {
    type Err = Error;

    /// `ema:A` or `mantiuk`.
    fn from_str(text: &str) -> Result<TemporalKernel> {
        let unknown = || Error::input(format!("'{text}' is not a temporal kernel: use ema:ALPHA or mantiuk"));
        let kernel = match text.trim().split_once(':') {
            None if text.trim() == "mantiuk" => TemporalKernel::Mantiuk,
            Some(("ema", alpha)) => TemporalKernel::Ema(alpha.parse().map_err(|_| unknown())?),
            _ => return Err(unknown()),
        };
        kernel.response(1)?;
        Ok(kernel)
    }
}

impl fmt::Display for TemporalKernel {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TemporalKernel::Ema(alpha) => write!(out, "ema:{alpha}"),
            TemporalKernel::Mantiuk => out.write_str("mantiuk"),
            TemporalKernel::Tabulated(values) => write!(out, "tabulated:{}", values.len()),
        }
    }
}
