//! What a target is.

use noisefloor::rng::Rng;
use std::fmt::Debug;

/// The most dimensions that points have here.
pub const MAX_DIMS: usize = 8;

/// A target distribution on `[0, 1]^dims`.
pub trait Target: Debug + Send + Sync {
    /// Coordinates of its points, 1 to 8.
    fn dims(&self) -> usize;

    /// Cuts the target, projected on a unit `direction`, into `means.len()` bins of equal mass: the mean of each (the
    /// integral in (5.23), times the number of bins), and the density in each (5.24), relative to that of the same mass
    /// spread evenly over a length which does not depend on the direction: the mean length of the domain's projections.
    /// Ascending in the projected coordinate x . direction. `scratch` may hold anything; its content is lost.
    ///
    /// `means` and `density` have one length, at least 1, and may hold anything: write all of both, means finite and
    /// ascending, densities finite and above 0. Nothing checks that. A mean that is NaN makes the energy of the step
    /// NaN, and coordinates, with which no checkpoint can be continued.
    ///
    /// (5.24) as printed is relative to the length of the projection at hand. That weighs the diagonals of a square
    /// more than its sides, and long runs then end in a square grid. With a fixed length the mean force is the gradient
    /// of an isotropic energy.
    ///
    /// Classes that give the same points different targets go without densities, as if all were 1.
    fn bins(&self, direction: &[f32], means: &mut [f32], density: &mut [f32], scratch: &mut Vec<f32>);

    /// Draws a point.
    fn sample(&self, rng: &mut Rng, point: &mut [f32]);

    /// Whether it is the uniform distribution. Only that one may be shifted around a torus, or cut into windows.
    fn is_uniform(&self) -> bool {
        false
    }
}

/// The mean size of a component of a unit vector, by the number of dimensions: the mean projected length of the unit
/// cube's edges. The projection of the cube is `dims` times as long.
pub(crate) const MEAN_COMPONENT: [f32; MAX_DIMS + 1] = [
    1.0,
    1.0,
    std::f32::consts::FRAC_2_PI,
    0.5,
    2.0 / 3.0 * std::f32::consts::FRAC_2_PI,
    0.375,
    8.0 / 15.0 * std::f32::consts::FRAC_2_PI,
    0.3125,
    16.0 / 35.0 * std::f32::consts::FRAC_2_PI,
];
