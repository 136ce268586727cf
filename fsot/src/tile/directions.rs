//! The directions that the samples are projected on.

use super::problem::TileProblem;
use crate::random;
use core::f64::consts::PI;
use noisefloor::rng::Rng;

/// The directions of a step, unit vectors.
pub(super) fn draw(problem: &TileProblem, rng: &mut Rng) -> Vec<Vec<f32>> {
    let first = rng.uniform_f64();
    (0..problem.directions)
        .map(|index| {
            // In the plane the directions of a step are evenly spread; elsewhere they are independent.
            let turn = (index as f64 + first) / problem.directions as f64;
            let kind = rng.uniform_f32();
            if kind < problem.projections.axis || problem.dims == 1 {
                axis(problem.dims, rng)
            } else if problem.dims == 2 {
                vec![libm::cos(PI * turn) as f32, libm::sin(PI * turn) as f32]
            } else if kind < problem.projections.axis + problem.projections.plane {
                plane(problem.dims, turn, rng)
            } else {
                random::direction(problem.dims, rng).into_iter().map(|value| value as f32).collect()
            }
        })
        .collect()
}

/// One of the axes.
fn axis(dims: usize, rng: &mut Rng) -> Vec<f32> {
    let mut direction = vec![0.0; dims];
    direction[rng.below(dims as u32) as usize] = 1.0;
    direction
}

/// In the plane of two axes, `turn` half turns from the first.
fn plane(dims: usize, turn: f64, rng: &mut Rng) -> Vec<f32> {
    let first = rng.below(dims as u32) as usize;
    let second = (first + 1 + rng.below(dims as u32 - 1) as usize) % dims;
    let mut direction = vec![0.0; dims];
    direction[first] = libm::cos(PI * turn) as f32;
    direction[second] = libm::sin(PI * turn) as f32;
    direction
}
