//! The slow, obvious reference for the control-variate estimators: plain `f64`, textbook formulas, allocation
//! everywhere.
//!
//! `linear` solves least squares, [`pixels`] fits to several samples of each of several pixels, `regression` fits and
//! leaves samples out, `robust` mixes fits. Nothing here shares code with the library.

mod linear;
pub mod pixels;
mod regression;
mod robust;

pub use linear::{Matrix, least_squares};
pub use regression::{Design, LeftOut, Regression, gradient_descent, incremental};
pub use robust::{RobustRule, runs, stream_folds};
