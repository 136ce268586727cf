//! The whole sphere of directions.

use super::frame::{direction, drop_and_turn, is_direction, unit, unit_square};
use core::f64::consts::TAU;
use glam::{Vec2, Vec3};

/// A uniform direction: u.x goes from the pole +z (0) to -z (1), u.y once around.
pub fn uniform_sphere(u: Vec2) -> Vec3 {
    let (fall, turn) = unit_square(u);
    direction(2.0 * fall, turn)
}

/// The density of [`uniform_sphere`] per solid angle: 1/(4 pi).
pub fn uniform_sphere_pdf(direction: Vec3) -> f32 {
    if is_direction(direction) { (0.5 / TAU) as f32 } else { 0.0 }
}

/// The point of the unit square that [`uniform_sphere`] takes to `direction`.
pub fn uniform_sphere_inverse(direction: Vec3) -> Vec2 {
    let (drop, turn) = drop_and_turn(direction);
    Vec2::new(unit(0.5 * drop) as f32, unit(turn) as f32)
}
