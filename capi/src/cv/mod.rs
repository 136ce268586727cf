//! Regression control variates.

mod accumulator;
mod batch;
mod config;

pub use accumulator::*;
pub use batch::*;
pub use config::*;
