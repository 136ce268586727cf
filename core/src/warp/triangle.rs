//! The triangle: E. Heitz, "A Low-Distortion Map Between Triangle and Square", 2019.

use super::frame::{square, unit, unit_square};
use glam::{Vec2, Vec3};

/// Barycentric coordinates of a uniform point of any triangle: at least 0, with sum 1. The point is
/// `b.x * v0 + b.y * v1 + b.z * v2`.
///
/// The square is folded along its diagonal u.x = u.y, which becomes the line from v2 to the middle of v0 v1.
pub fn uniform_triangle(u: Vec2) -> Vec3 {
    let (u0, u1) = unit_square(u);
    let (b0, b1) = if u0 < u1 { (0.5 * u0, u1 - 0.5 * u0) } else { (u0 - 0.5 * u1, 0.5 * u1) };
    Vec3::new(b0 as f32, b1 as f32, unit(1.0 - b0 - b1) as f32)
}

/// The density of [`uniform_triangle`] per area: 1 over the triangle's area, infinite for a triangle without area, 0 if
/// a vertex is not finite.
pub fn uniform_triangle_pdf(vertices: [Vec3; 3]) -> f32 {
    // In f64: products of short edges far from the origin would lose their digits in f32.
    let [v0, v1, v2] = vertices.map(|vertex| vertex.to_array().map(f64::from));
    let edge = |to: [f64; 3]| [to[0] - v0[0], to[1] - v0[1], to[2] - v0[2]];
    let ([ax, ay, az], [bx, by, bz]) = (edge(v1), edge(v2));
    let (x, y, z) = (ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx);
    let area = 0.5 * libm::sqrt(x * x + y * y + z * z);
    if area.is_finite() { (1.0 / area) as f32 } else { 0.0 }
}

/// The point of the unit square that [`uniform_triangle`] takes to the barycentric coordinates `b`.
pub fn uniform_triangle_inverse(b: Vec3) -> Vec2 {
    let (b0, b1) = (f64::from(b.x), f64::from(b.y));
    let (u0, u1) = if b0 < b1 { (2.0 * b0, b0 + b1) } else { (b0 + b1, 2.0 * b1) };
    square(u0, u1)
}
