//! What warps share: points of the square, and unit vectors.

use glam::{Vec2, Vec3};

/// How far the squared length of a direction, or the squared radius of a disc point, may be off by rounding.
pub(super) const TOLERANCE: f64 = 1e-5;

/// Into 0..=1, NaN to 0.
pub(super) fn unit(x: f64) -> f64 {
    if x > 0.0 { if x < 1.0 { x } else { 1.0 } } else { 0.0 }
}

pub(super) fn unit_square(u: Vec2) -> (f64, f64) {
    (unit(u.x.into()), unit(u.y.into()))
}

/// A point of the square, for an inverse.
pub(super) fn square(x: f64, y: f64) -> Vec2 {
    Vec2::new(unit(x) as f32, unit(y) as f32)
}

/// Whether a vector has unit length, up to rounding.
pub(super) fn is_direction(direction: Vec3) -> bool {
    let [x, y, z] = direction.to_array().map(f64::from);
    (x * x + y * y + z * z - 1.0).abs() <= TOLERANCE
}
