//! Regression control variates.

mod accumulator;
mod batch;
mod config;
mod image;
mod many;

pub use accumulator::*;
pub use batch::*;
pub use config::*;
pub use image::*;
pub use many::*;
