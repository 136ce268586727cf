//! Directions of the same density from the pole +z down to a rim: the sphere, the hemisphere, and a cone, the
//! directions towards a sphere for one.
//!
//! A cone's `cos_max` is the cosine of its half-angle: 1 is the direction +z alone, 0 the hemisphere, -1 every
//! direction. What lies outside -1..=1 is clamped, and NaN counts as 1.

use super::frame::{is_direction, square, unit_square};
use core::f64::consts::TAU;
use glam::{Vec2, Vec3};

/// Rounding of z to f32 may push a direction on the rim out of the cone by this much.
const RIM: f64 = 1e-7;

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

/// A uniform direction with z >= `cos_max`: u.x is the part of the drop from the pole to the rim, u.y the turn.
pub fn uniform_cone(u: Vec2, cos_max: f32) -> Vec3 {
    cap(u, depth(cos_max))
}

/// The density of [`uniform_cone`] per solid angle: 1/(2 pi (1 - cos_max)) in the cone, 0 outside. A cone of no width
/// has infinite density.
pub fn uniform_cone_pdf(direction: Vec3, cos_max: f32) -> f32 {
    let depth = depth(cos_max);
    if is_direction(direction) && 1.0 - f64::from(direction.z) <= depth + RIM {
        (1.0 / (TAU * depth)) as f32
    } else {
        0.0
    }
}

/// The point of the unit square that [`uniform_cone`] takes to `direction`.
pub fn uniform_cone_inverse(direction: Vec3, cos_max: f32) -> Vec2 {
    cap_inverse(direction, depth(cos_max))
}

/// From the pole down to the rim, 1 - cos_max: in 0..=2.
fn depth(cos_max: f32) -> f64 {
    let depth = 1.0 - f64::from(cos_max);
    if depth > 0.0 { if depth < 2.0 { depth } else { 2.0 } } else { 0.0 }
}

/// The direction at height z = 1 - u.x `depth`, u.y turns about the pole.
fn cap(u: Vec2, depth: f64) -> Vec3 {
    let (part, turn) = unit_square(u);
    let drop = part * depth;
    // 1 - z^2 without the cancellation that 1 - z * z has near the pole.
    let radius = libm::sqrt(drop * (2.0 - drop));
    let (sin, cos) = libm::sincos(TAU * turn);
    Vec3::new((radius * cos) as f32, (radius * sin) as f32, (1.0 - drop) as f32)
}

fn cap_inverse(direction: Vec3, depth: f64) -> Vec2 {
    let [x, y, z] = direction.to_array().map(f64::from);
    // Near the pole z has lost what x and y still carry.
    let drop = if z > 0.0 { (x * x + y * y) / (1.0 + z) } else { 1.0 - z };
    let turn = libm::atan2(y, x) / TAU;
    square(drop / depth, if turn < 0.0 { turn + 1.0 } else { turn })
}
