#![no_std]
#![forbid(unsafe_code)]
//! noisefloor: less Monte Carlo noise for the samples a renderer or trainer already pays for.

pub mod error;
#[cfg(feature = "mis")]
pub mod mis;
pub mod rng;
#[cfg(feature = "warp")]
pub mod warp;

pub use error::Error;
