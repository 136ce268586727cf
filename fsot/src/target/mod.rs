//! What the points of a class shall be distributed like.

mod cdf;
mod distribution;
mod function;
pub mod image;
mod uniform;

pub use cdf::bins_of_cdf;
pub(crate) use distribution::MEAN_COMPONENT;
pub use distribution::{MAX_DIMS, Target};
pub use function::Function;
pub use uniform::{Uniform, uniform_bins};
