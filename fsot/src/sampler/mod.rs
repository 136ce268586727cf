//! Nested-net tiles: one sequence for each pixel of a torus, all of whose prefixes of 2^m points are nets, so arranged
//! that the error of an image is small through a filter, at every number of samples.

mod basis;
mod border;
mod energy;
mod fields;
pub mod optimizer;
mod pixels;
mod power;
mod prices;
pub mod problem;
pub mod report;
pub mod sidecar;
pub mod table;
mod visit;

pub use optimizer::SamplerOptimizer;
pub use problem::SamplerProblem;
pub use sidecar::SamplerSidecar;
pub use table::SamplerTable;
