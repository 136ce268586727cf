//! From primary sample space to what a scene needs (section 2.2.1, eq. 2.6): warps of the unit square, each with the
//! density it gives and its inverse.
//!
//! - `u` is a point of the unit square. Both ends are accepted; what lies outside is clamped, and NaN counts as 0.
//! - Directions are unit vectors of a local frame whose pole is +z, their densities per solid angle (1/sr). Points of
//!   the disc and the triangle have densities per area.
//! - A density at a point is 0 outside what the warp can reach, and for NaN; a warp onto a set without area has
//!   infinite density, the mark of a delta distribution in [`mis`](crate::mis).
//! - An inverse returns a point in 0..=1 for any argument. Where a warp folds a whole edge of the square onto one point
//!   (a pole), it returns one of the points that map there.
//!
//! Arithmetic is f64 inside, the same wherever it is that of IEEE 754; only results are rounded to f32.
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

mod cap;
mod disc;
mod frame;
mod triangle;

/// The version whose vectors these functions take.
pub use glam;

pub use cap::{uniform_cap, uniform_cap_inverse, uniform_cap_pdf};
pub use cap::{uniform_hemisphere, uniform_hemisphere_inverse, uniform_hemisphere_pdf};
pub use cap::{uniform_sphere, uniform_sphere_inverse, uniform_sphere_pdf};
pub use disc::{concentric_disc, concentric_disc_inverse, concentric_disc_pdf};
pub use disc::{cosine_hemisphere, cosine_hemisphere_inverse, cosine_hemisphere_pdf};
pub use triangle::{uniform_triangle, uniform_triangle_inverse, uniform_triangle_pdf};
