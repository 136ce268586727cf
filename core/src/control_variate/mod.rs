//! Regression control variates (chapter 4): a pixel's own samples, made into a lower-error estimate.
//!
//! The integrand's samples are fitted by a combination of functions with known integrals, and the estimate is the
//! integral of the fit plus the mean of what the fit leaves (4.9).

mod accumulator;
mod batch;
mod config;
mod cross_fit;
mod design;
mod fit;
mod fitter;
mod folds;
mod image;
mod incremental;
mod per_channel;
mod plan;
mod regressor;
mod result;
mod ridge;
mod samples;
mod sums;
mod trust;

pub use accumulator::Accumulator;
pub use batch::{estimate, estimate_inlined, workspace_len};
pub use config::{Color, Config, Estimate, Estimator, NonFinite, Optimizer, Ridge, Solver};
pub use fit::descent::estimate_from as gradient_descent;
pub use image::{Image, Rectangle, estimate_image, estimate_image_by, image_workspace_len};
pub use regressor::Regressor;
pub use samples::Samples;
