//! The hemisphere about +z, uniform and in proportion to the cosine with the pole.

use super::disc::{concentric_disc_f64, concentric_disc_inverse};
use super::frame::{direction, drop_and_turn, is_direction, unit, unit_square};
use core::f64::consts::{FRAC_1_PI, TAU};
use glam::{Vec2, Vec3};

/// A uniform direction with z >= 0: u.x is the drop from the pole, u.y the turn about it.
pub fn uniform_hemisphere(u: Vec2) -> Vec3 {
    let (drop, turn) = unit_square(u);
    direction(drop, turn)
}

/// The density of [`uniform_hemisphere`] per solid angle: 1/(2 pi) for z >= 0, else 0.
pub fn uniform_hemisphere_pdf(direction: Vec3) -> f32 {
    if is_direction(direction) && direction.z >= 0.0 { (1.0 / TAU) as f32 } else { 0.0 }
}

/// The point of the unit square that [`uniform_hemisphere`] takes to `direction`.
pub fn uniform_hemisphere_inverse(direction: Vec3) -> Vec2 {
    let (drop, turn) = drop_and_turn(direction);
    Vec2::new(unit(drop) as f32, unit(turn) as f32)
}

/// A direction with z >= 0, with a density in proportion to z: a point of [`concentric_disc`](super::concentric_disc)
/// lifted onto the hemisphere (Malley's method). The rim of the square gives z = 0, where the density is 0.
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let (x, y) = concentric_disc_f64(u);
    let z_squared = 1.0 - x * x - y * y;
    let z = if z_squared > 0.0 { libm::sqrt(z_squared) } else { 0.0 };
    // Rounding leaves up to a few 1e-16 of z^2 on the rim.
    let z = if z < 1e-7 { 0.0 } else { z };
    Vec3::new(x as f32, y as f32, z as f32)
}

/// The density of [`cosine_hemisphere`] per solid angle: z/pi for z >= 0, else 0.
pub fn cosine_hemisphere_pdf(direction: Vec3) -> f32 {
    if is_direction(direction) && direction.z >= 0.0 { (f64::from(direction.z) * FRAC_1_PI) as f32 } else { 0.0 }
}

/// The point of the unit square that [`cosine_hemisphere`] takes to `direction`.
pub fn cosine_hemisphere_inverse(direction: Vec3) -> Vec2 {
    concentric_disc_inverse(Vec2::new(direction.x, direction.y))
}
