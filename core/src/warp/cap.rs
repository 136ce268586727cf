//! Directions of the same density from the pole +z down to a rim: the sphere, the hemisphere, and a cap, the directions
//! of a cone.
//!
//! A cap's `height` is 1 - cos of the half-angle of its cone: 0 is the direction +z alone, 1 the hemisphere, 2 every
//! direction. What lies outside 0..=2 is clamped, and NaN counts as 0. The cosine itself would not do: next to 1 floats
//! are 6e-8 apart, which is all of a small light. A sphere of radius r, its centre at distance d, fills the cap of
//! height s / (1 + sqrt(1 - s)), s = r^2 / d^2: that has all digits, however small it is.

use super::frame::{is_direction, square, unit, unit_square};
use core::f64::consts::TAU;
use glam::{Vec2, Vec3};

/// Rounding to f32 may push a direction on the rim down by this part of the height.
const RIM: f64 = 3e-7;

/// A uniform direction: u.x goes from the pole +z (0) to -z (1), u.y once around.
pub fn uniform_sphere(u: Vec2) -> Vec3 {
    cap(u, 2.0)
}

/// The density of [`uniform_sphere`] per solid angle: 1/(4 pi).
pub fn uniform_sphere_pdf(direction: Vec3) -> f32 {
    if is_direction(direction) { (0.5 / TAU) as f32 } else { 0.0 }
}

/// The point of the unit square that [`uniform_sphere`] takes to `direction`.
pub fn uniform_sphere_inverse(direction: Vec3) -> Vec2 {
    cap_inverse(direction, 2.0)
}

/// A uniform direction with z >= 0: u.x is the drop from the pole, u.y the turn about it.
pub fn uniform_hemisphere(u: Vec2) -> Vec3 {
    cap(u, 1.0)
}

/// The density of [`uniform_hemisphere`] per solid angle: 1/(2 pi) for z >= 0, else 0.
pub fn uniform_hemisphere_pdf(direction: Vec3) -> f32 {
    if is_direction(direction) && direction.z >= 0.0 { (1.0 / TAU) as f32 } else { 0.0 }
}

/// The point of the unit square that [`uniform_hemisphere`] takes to `direction`.
pub fn uniform_hemisphere_inverse(direction: Vec3) -> Vec2 {
    cap_inverse(direction, 1.0)
}

/// A uniform direction with z >= 1 - `height`: u.x is the part of the drop from the pole to the rim, u.y the turn.
pub fn uniform_cap(u: Vec2, height: f32) -> Vec3 {
    cap(u, clamped(height))
}

/// The density of [`uniform_cap`] per solid angle: 1/(2 pi height) in the cap, 0 outside. A cap of no height has
/// infinite density. A sample that was turned into the world and back may lie just outside a small one: its density is
/// that from before.
pub fn uniform_cap_pdf(direction: Vec3, height: f32) -> f32 {
    let height = clamped(height);
    let is_inside = is_direction(direction) && drop(direction) <= height * (1.0 + RIM);
    if is_inside { (1.0 / (TAU * height)) as f32 } else { 0.0 }
}

/// The point of the unit square that [`uniform_cap`] takes to `direction`.
pub fn uniform_cap_inverse(direction: Vec3, height: f32) -> Vec2 {
    cap_inverse(direction, clamped(height))
}

/// Into 0..=2, NaN to 0.
fn clamped(height: f32) -> f64 {
    2.0 * unit(0.5 * f64::from(height))
}

/// The direction that is u.x `height` below the pole, u.y turns about it.
fn cap(u: Vec2, height: f64) -> Vec3 {
    let (part, turn) = unit_square(u);
    let drop = part * height;
    // 1 - z^2 without the cancellation that 1 - z * z has near the pole.
    let radius = libm::sqrt(drop * (2.0 - drop));
    let (sin, cos) = libm::sincos(TAU * turn);
    Vec3::new((radius * cos) as f32, (radius * sin) as f32, (1.0 - drop) as f32)
}

fn cap_inverse(direction: Vec3, height: f64) -> Vec2 {
    let turn = libm::atan2(direction.y.into(), direction.x.into()) / TAU;
    square(drop(direction) / height, if turn < 0.0 { turn + 1.0 } else { turn })
}

/// How far below the pole a direction is: 1 - z.
fn drop(direction: Vec3) -> f64 {
    let [x, y, z] = direction.to_array().map(f64::from);
    // Near the pole z has lost what x and y still carry.
    if z > 0.0 { (x * x + y * y) / (1.0 + z) } else { 1.0 - z }
}
