//! The directions within an angle of +z: those towards a sphere, for one.
//!
//! `cos_max` is the cosine of the half-angle: 1 is the direction +z alone, 0 the hemisphere, -1 every direction. What
//! lies outside -1..=1 is clamped, and NaN counts as 1.

use super::frame::{direction, drop_and_turn, is_direction, unit, unit_square};
use core::f64::consts::TAU;
use glam::{Vec2, Vec3};

/// Rounding of z to f32 may push a direction on the rim out of the cone by this much.
const RIM: f64 = 1e-7;

/// A uniform direction with z >= `cos_max`: u.x is the part of the drop from the pole to the rim, u.y the turn.
pub fn uniform_cone(u: Vec2, cos_max: f32) -> Vec3 {
    let (part, turn) = unit_square(u);
    direction(part * depth(cos_max), turn)
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
    let (drop, turn) = drop_and_turn(direction);
    Vec2::new(unit(drop / depth(cos_max)) as f32, unit(turn) as f32)
}

/// From the pole down to the rim, 1 - cos_max: in 0..=2.
fn depth(cos_max: f32) -> f64 {
    let depth = 1.0 - f64::from(cos_max);
    if depth > 0.0 { if depth < 2.0 { depth } else { 2.0 } } else { 0.0 }
}
