//! Regression control variates.

mod accumulator;
mod batch;
mod config;
mod descent;
mod image;
mod samples;

pub use accumulator::*;
pub use batch::*;
pub use config::*;
pub use descent::*;
pub use image::*;
pub use samples::*;
