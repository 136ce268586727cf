//! Where points begin.

use super::problem::Problem;
use crate::points::BELOW_ONE;
use crate::random::stream;
use std::collections::HashSet;

/// Points that begin at one place are moved by up to this much, else they would be told apart by their number alone.
const APART: f32 = 1.0 / 4096.0;

/// The stream of the initial points, which no iteration reaches.
const INITIAL: u64 = u64::MAX;

/// The coordinates of iteration 0.
pub(super) fn coordinates(problem: &Problem) -> Vec<f32> {
    let (points, dims) = (problem.points, problem.dims);
    let mut rng = stream(problem.seed, INITIAL, 0);
    let Some(initial) = &problem.initial else {
        let mut coordinates = vec![0.0; points * dims];
        if problem.classes.len() == 1 {
            coordinates.chunks_exact_mut(dims).for_each(|point| problem.classes[0].target.sample(&mut rng, point));
        } else {
            coordinates.fill_with(|| rng.uniform_f32());
        }
        coordinates.iter_mut().for_each(|x| *x = x.clamp(0.0, BELOW_ONE));
        return coordinates;
    };
    let mut coordinates = initial.coordinates().to_vec();
    let mut places = HashSet::with_capacity(points);
    for point in coordinates.chunks_exact_mut(dims) {
        let mut place = [0; crate::target::MAX_DIMS];
        for (place, x) in place.iter_mut().zip(&*point) {
            *place = (x + 0.0).to_bits();
        }
        if !places.insert(place) {
            for x in point {
                let moved = *x + APART * (2.0 * rng.uniform_f32() - 1.0);
                *x = if moved < 0.0 { -moved } else { moved.min(BELOW_ONE) };
            }
        }
    }
    coordinates
}
