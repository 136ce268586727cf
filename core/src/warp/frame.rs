//! What warps share: points of the square, and directions by height and turn.

use core::f64::consts::TAU;
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

/// The direction at height z = 1 - drop, a turn of `turn` in 0..=1 about the pole.
pub(super) fn direction(drop: f64, turn: f64) -> Vec3 {
    // 1 - z^2 without the cancellation that 1 - z * z has near the pole.
    let radius = libm::sqrt(drop * (2.0 - drop));
    let (sin, cos) = libm::sincos(TAU * turn);
    Vec3::new((radius * cos) as f32, (radius * sin) as f32, (1.0 - drop) as f32)
}

/// The (drop, turn) of a direction: the inverse of [`direction`].
pub(super) fn drop_and_turn(direction: Vec3) -> (f64, f64) {
    let (x, y, z) = (f64::from(direction.x), f64::from(direction.y), f64::from(direction.z));
    // Near the pole z has lost what x and y still carry.
    let drop = if z > 0.0 { (x * x + y * y) / (1.0 + z) } else { 1.0 - z };
    let angle = libm::atan2(y, x) / TAU;
    (drop, if angle < 0.0 { angle + 1.0 } else { angle })
}

/// Whether a vector has unit length, up to rounding.
pub(super) fn is_direction(direction: Vec3) -> bool {
    let (x, y, z) = (f64::from(direction.x), f64::from(direction.y), f64::from(direction.z));
    (x * x + y * y + z * z - 1.0).abs() <= TOLERANCE
}
