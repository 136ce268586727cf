//! Perceptual sample tiles (5.6 to 5.8): sample points for every pixel of a toroidal tile, such that what the eye or a
//! temporal filter keeps of the rendering error is small.
//!
//! Every pixel (of every frame) is a class: its function is the kernel centred there, its target the uniform
//! distribution on the unit cube of sample space. [`TileProblem`] says what is wanted, [`TileOptimizer`] does it.
//! `docs/fsot_tiles.md` has the formulation, the parameters and what they were measured to give.

mod directions;
mod kernel;
mod optimizer;
mod order;
mod presets;
mod problem;
mod projection;
mod rank;
mod samples;
mod stencil;
mod temporal;

pub use kernel::{Kernel, PERCEPTUAL_SIGMA, RECONSTRUCTION_SIGMA, Tap};
pub use optimizer::TileOptimizer;
pub use presets::preset;
pub use problem::{ClassShare, Projections, Steps, TileProblem, iterations};
pub use samples::TileSamples;
pub use temporal::{FRAME_RATE, TemporalKernel};
