//! From primary sample space to what a scene needs (section 2.2.1, eq. 2.6): warps of the unit square, each with the
//! density it gives and its inverse.
//!
//! - `u` is a point of the unit square. Both ends are accepted; what lies outside is clamped, and NaN counts as 0.
//! - Directions are unit vectors of a local frame whose pole is +z, their densities per solid angle (1/sr). Points of
//!   the disc and the triangle have densities per area.
//! - A density is 0 outside what the warp can reach, and for NaN; a warp onto a set without area has infinite density,
//!   the mark of a delta distribution in [`mis`](crate::mis).
//! - An inverse returns a point in 0..=1 for any argument. Where a warp folds a whole edge of the square onto one point
//!   (a pole), it returns one of the points that map there.
//!
//! Arithmetic is f64 inside and the same on every target; only results are rounded to f32.
//!
//! ```
//! use glam::Vec2;
//! use noisefloor::warp::{cosine_hemisphere, cosine_hemisphere_inverse, cosine_hemisphere_pdf};
//!
//! let u = Vec2::new(0.3, 0.8);
//! let direction = cosine_hemisphere(u);
//! assert!((cosine_hemisphere_pdf(direction) - direction.z / core::f32::consts::PI).abs() < 1e-6);
//! assert!(cosine_hemisphere_inverse(direction).distance(u) < 1e-5);
//! ```

mod cone;
mod disc;
mod hemisphere;
mod sphere;
mod triangle;

pub use cone::{uniform_cone, uniform_cone_inverse, uniform_cone_pdf};
pub use disc::{concentric_disc, concentric_disc_inverse, concentric_disc_pdf};
pub use hemisphere::{cosine_hemisphere, cosine_hemisphere_inverse, cosine_hemisphere_pdf};
pub use hemisphere::{uniform_hemisphere, uniform_hemisphere_inverse, uniform_hemisphere_pdf};
pub use sphere::{uniform_sphere, uniform_sphere_inverse, uniform_sphere_pdf};
pub use triangle::{uniform_triangle, uniform_triangle_inverse, uniform_triangle_pdf};

use core::f64::consts::TAU;
use glam::{Vec2, Vec3};

/// How far the squared length of a direction, or the squared radius of a disc point, may be off by rounding.
const TOLERANCE: f64 = 1e-5;

/// Into 0..=1, NaN to 0.
fn unit(x: f64) -> f64 {
    if x > 0.0 { if x < 1.0 { x } else { 1.0 } } else { 0.0 }
}

fn unit_square(u: Vec2) -> (f64, f64) {
    (unit(u.x.into()), unit(u.y.into()))
}

/// The direction at height z = 1 - drop, a turn of `turn` in 0..=1 about the pole.
fn direction(drop: f64, turn: f64) -> Vec3 {
    // 1 - z^2 without the cancellation that 1 - z * z has near the pole.
    let radius = libm::sqrt(drop * (2.0 - drop));
    let (sin, cos) = libm::sincos(TAU * turn);
    Vec3::new((radius * cos) as f32, (radius * sin) as f32, (1.0 - drop) as f32)
}

/// The (drop, turn) of a direction: the inverse of [`direction`].
fn drop_and_turn(direction: Vec3) -> (f64, f64) {
    let (x, y, z) = (f64::from(direction.x), f64::from(direction.y), f64::from(direction.z));
    // Near the pole z has lost what x and y still carry.
    let drop = if z > 0.0 { (x * x + y * y) / (1.0 + z) } else { 1.0 - z };
    let angle = libm::atan2(y, x) / TAU;
    (drop, if angle < 0.0 { angle + 1.0 } else { angle })
}

/// Whether a vector has unit length, up to rounding.
fn is_direction(direction: Vec3) -> bool {
    let (x, y, z) = (f64::from(direction.x), f64::from(direction.y), f64::from(direction.z));
    (x * x + y * y + z * z - 1.0).abs() <= TOLERANCE
}
