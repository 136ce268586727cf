//! The sliced Wasserstein distance to the uniform distribution (5.6), exact along every slice.
//!
//! Let p_i be the sorted projections on a direction, m_i the means of n parts of equal mass of the projected cube. The
//! distance is the root of the mean over directions of `mean (p_i - m_i)^2 + (1/12 - mean m_i^2)`. The second term is
//! the lower bound.

use super::projection::Projection;
use crate::points::Points;
use crate::random::{self, direction};
use rayon::prelude::*;
use serde::Serialize;

/// Slices of the distance itself.
const SLICES: usize = 512;
/// Toroidal shifts, and slices of each.
const SHIFTS: usize = 8;
const SLICES_PER_SHIFT: usize = 128;
const SEED: u64 = 0x51_1ced;

/// Sliced 2-Wasserstein distances to the uniform distribution on the unit cube: roots of means of squared distances.
#[derive(Clone, Debug, Serialize)]
pub struct Transport {
    /// Over 512 directions: stratified in two dimensions, random in more.
    pub sliced_w2: f64,
    /// What no set of as many points can go below on the same slices: every point the mean of its part of the projected
    /// square.
    pub lower_bound: f64,
    /// Over 8 random toroidal shifts of 128 directions each (32 above 65,536 points): the quality as a tile.
    pub shifted: f64,
}

/// Sliced Wasserstein distances of valid points.
pub fn transport(points: &Points) -> Transport {
    let centred: Vec<f64> = points.coordinates().iter().map(|&x| f64::from(x) - 0.5).collect();
    let (distance, bound) = sliced(&centred, points.dims(), SLICES, 0);
    let slices = if points.len() > 1 << 16 { SLICES_PER_SHIFT / 4 } else { SLICES_PER_SHIFT };
    let mut shifted = 0.0;
    for shift in 1..=SHIFTS as u64 {
        let mut rng = random::stream(SEED, shift, u64::MAX);
        let by: Vec<f64> = (0..points.dims()).map(|_| rng.uniform_f64()).collect();
        let moved: Vec<f64> = points
            .coordinates()
            .iter()
            .enumerate()
            .map(|(i, &x)| {
                let sum = f64::from(x) + by[i % by.len()];
                sum - sum.floor() - 0.5
            })
            .collect();
        shifted += sliced(&moved, points.dims(), slices, shift).0;
    }
    Transport { sliced_w2: distance.sqrt(), lower_bound: bound.sqrt(), shifted: (shifted / SHIFTS as f64).sqrt() }
}

/// Mean squared distance and mean lower bound over slices of points about the origin.
fn sliced(centred: &[f64], dims: usize, slices: usize, set: u64) -> (f64, f64) {
    // In one dimension there is one direction.
    let slices = if dims == 1 { 1 } else { slices };
    let one = |slice: usize| {
        let mut rng = random::stream(SEED, set, slice as u64);
        let along = match dims {
            1 => vec![1.0],
            2 => {
                let angle = (slice as f64 + rng.uniform_f64()) / slices as f64 * std::f64::consts::PI;
                vec![libm::cos(angle), libm::sin(angle)]
            }
            _ => direction(dims, &mut rng),
        };
        slice_distance(centred, &along)
    };
    let all: Vec<(f64, f64)> = (0..slices).into_par_iter().map(one).collect();
    let mean = |f: fn(&(f64, f64)) -> f64| all.iter().map(f).sum::<f64>() / slices as f64;
    (mean(|r| r.0).max(0.0), mean(|r| r.1).max(0.0))
}

/// The squared semi-discrete distance between points about the origin, projected on a unit direction, and the projected
/// cube; and its lower bound for as many points.
pub fn slice_distance(centred: &[f64], direction: &[f64]) -> (f64, f64) {
    let along = |p: &[f64]| p.iter().zip(direction).map(|(x, a)| x * a).sum();
    let projected: Vec<f64> = centred.chunks_exact(direction.len()).map(along).collect();
    let law = Projection::new(direction);
    let projected = sorted(&projected, law.half_width());
    let mut means = vec![0.0; projected.len()];
    law.bins(&mut means);
    let count = projected.len() as f64;
    let between = projected.iter().zip(&means).map(|(p, m)| (p - m) * (p - m)).sum::<f64>() / count;
    // The cube's second moment along any unit direction is 1/12; what the bins' means do not have of it is spread
    // within the bins.
    let within = (1.0 / 12.0 - means.iter().map(|m| m * m).sum::<f64>() / count).max(0.0);
    (between + within, within)
}

/// The values, most of them in [-half, half], in ascending order: shared out to as many buckets first, each of which is
/// then sorted.
fn sorted(values: &[f64], half: f64) -> Vec<f64> {
    let count = values.len();
    let scale = count as f64 / (2.0 * half);
    let bucket = |x: f64| (((x + half) * scale) as usize).min(count - 1);
    let mut ends = vec![0_u32; count + 1];
    values.iter().for_each(|&x| ends[bucket(x) + 1] += 1);
    (0..count).for_each(|i| ends[i + 1] += ends[i]);
    let mut next = ends.clone();
    let mut sorted = vec![0.0; count];
    for &x in values {
        let place = &mut next[bucket(x)];
        sorted[*place as usize] = x;
        *place += 1;
    }
    for ends in ends.windows(2) {
        let part = &mut sorted[ends[0] as usize..ends[1] as usize];
        if part.len() > 1 {
            part.sort_unstable_by(f64::total_cmp);
        }
    }
    sorted
}
