#![no_std]
#![forbid(unsafe_code)]
//! noisefloor: less Monte Carlo noise for the samples a renderer or trainer already pays for.

#[cfg(feature = "control-variate")]
mod arena;
#[cfg(feature = "control-variate")]
pub mod basis;
#[cfg(feature = "control-variate")]
pub mod control_variate;
pub mod error;
#[cfg(feature = "control-variate")]
mod lanes;
#[cfg(feature = "control-variate")]
mod linalg;
#[cfg(feature = "mis")]
pub mod mis;
#[cfg(feature = "control-variate")]
pub mod real;
pub mod rng;
#[cfg(feature = "control-variate")]
mod rows;
#[cfg(feature = "warp")]
pub mod warp;

pub use error::Error;
