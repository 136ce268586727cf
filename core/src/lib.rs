#![no_std]
#![forbid(unsafe_code)]
//! noisefloor: less Monte Carlo noise for the samples a renderer or trainer already pays for.

pub mod error;

pub use error::Error;
