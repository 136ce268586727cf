//! Points to measure, and what tests of statistics need.

use fsot::points::Points;
use fsot::random::stream;

/// Independent uniform points.
pub(crate) fn random(points: usize, dims: usize, seed: u64) -> Points {
    let mut rng = stream(seed, points as u64, dims as u64);
    Points::new(dims, (0..points * dims).map(|_| rng.uniform_f32()).collect())
}

/// Coordinates that are multiples of 1/8, 0 and 1 among them: many equal ones.
pub(crate) fn coarse(points: usize, dims: usize, seed: u64) -> Points {
    let mut rng = stream(seed, points as u64, dims as u64);
    Points::new(dims, (0..points * dims).map(|_| rng.below(9) as f32 / 8.0).collect())
}

/// The centres of the cells of a square grid.
pub(crate) fn grid(side: usize) -> Points {
    let centre = |i: usize| (i as f32 + 0.5) / side as f32;
    Points::new(2, (0..side * side).flat_map(|i| [centre(i % side), centre(i / side)]).collect())
}

/// Asserts that the mean of independent values is `expected`, at a significance level of 1e-5 (two-sided, normal).
pub(crate) fn assert_mean(values: &[f64], expected: f64, what: &str) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    let z = (mean - expected) / (variance / n).sqrt();
    assert!(z.abs() < 4.417, "{what}: mean {mean}, expected {expected}, z = {z}");
}

/// Asserts |a - b| <= tolerance.
pub(crate) fn assert_near(a: f64, b: f64, tolerance: f64, what: &str) {
    assert!((a - b).abs() <= tolerance, "{what}: {a} and {b} differ by {:e}, more than {tolerance:e}", (a - b).abs());
}
