//! The disc (P. Shirley and K. Chiu, "A Low Distortion Map Between Disk and Square", 1997), and the hemisphere about +z
//! above it, in proportion to the cosine with the pole.

use super::frame::{TOLERANCE, is_direction, square, unit_square};
use core::f64::consts::{FRAC_1_PI, FRAC_PI_4};
use glam::{Vec2, Vec3};

/// A uniform point of the unit disc. Concentric squares become concentric circles, so that well-spread points of the
/// square stay well spread.
pub fn concentric_disc(u: Vec2) -> Vec2 {
    let (x, y) = disc(u);
    Vec2::new(x as f32, y as f32)
}

fn disc(u: Vec2) -> (f64, f64) {
    let (u0, u1) = unit_square(u);
    let (a, b) = (2.0 * u0 - 1.0, 2.0 * u1 - 1.0);
    // In the wedges left and right the radius is |a|, in those above and below it is |b|; its sign chooses the wedge.
    if a.abs() > b.abs() {
        let (sin, cos) = libm::sincos(FRAC_PI_4 * (b / a));
        (a * cos, a * sin)
    } else if b != 0.0 {
        let (sin, cos) = libm::sincos(FRAC_PI_4 * (a / b));
        (b * sin, b * cos)
    } else {
        (0.0, 0.0)
    }
}

/// The density of [`concentric_disc`] per area: 1/pi on the unit disc, 0 outside.
pub fn concentric_disc_pdf(point: Vec2) -> f32 {
    let (x, y) = (f64::from(point.x), f64::from(point.y));
    if x * x + y * y <= 1.0 + TOLERANCE { FRAC_1_PI as f32 } else { 0.0 }
}

/// The point of the unit square that [`concentric_disc`] takes to `point`.
pub fn concentric_disc_inverse(point: Vec2) -> Vec2 {
    let (x, y) = (f64::from(point.x), f64::from(point.y));
    let radius = libm::sqrt(x * x + y * y);
    // The angle from the axis of the wedge is within pi/4, and its part of that is b/a (or a/b).
    let (a, b) = if x.abs() > y.abs() {
        let a = radius.copysign(x);
        (a, a * (libm::atan(y / x) / FRAC_PI_4))
    } else if y != 0.0 {
        let b = radius.copysign(y);
        (b * (libm::atan(x / y) / FRAC_PI_4), b)
    } else {
        (0.0, 0.0)
    };
    square(0.5 * (a + 1.0), 0.5 * (b + 1.0))
}

/// A direction with z >= 0, with a density in proportion to z: a point of [`concentric_disc`] lifted onto the
/// hemisphere (Malley's method). The rim of the square gives z = 0, where the density is 0.
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let (x, y) = disc(u);
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
