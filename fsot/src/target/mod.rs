//! What the points of a class shall be distributed like.

mod cdf;
pub mod image;
mod uniform;

pub use cdf::bins_of_cdf;
pub use uniform::{Uniform, uniform_bins};

use noisefloor::rng::Rng;

/// The most dimensions that points have here.
pub const MAX_DIMS: usize = 8;

/// A target distribution on `[0, 1]^dims`.
pub trait Target: Send + Sync {
    /// Coordinates of its points, 1 to 8.
    fn dims(&self) -> usize;

    /// Cuts the target, projected on a unit `direction`, into `means.len()` bins of equal mass: the mean of each (the integral in
    /// (5.23), times the number of bins), and the density in each relative to the mean density, (5.24): average bin length / length of
    /// this bin. Ascending in the projected coordinate x . direction. `scratch` may hold anything; its content is lost.
    fn bins(&self, direction: &[f32], means: &mut [f32], density: &mut [f32], scratch: &mut Vec<f32>);

    /// Draws a point.
    fn sample(&self, rng: &mut Rng, point: &mut [f32]);

    /// Whether it is the uniform distribution. Only that one may be shifted around a torus, or cut into windows.
    fn is_uniform(&self) -> bool {
        false
    }
}
