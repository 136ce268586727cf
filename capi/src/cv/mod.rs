//! Regression control variates.

mod accumulator;
mod batch;
mod block;
mod config;
mod many;

pub use accumulator::*;
pub use batch::*;
pub use block::*;
pub use config::*;
pub use many::*;
