//! Regression control variates.

mod accumulator;
mod batch;
mod block;
mod config;

pub use accumulator::*;
pub use batch::*;
pub use block::*;
pub use config::*;
