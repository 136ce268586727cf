//! Point sets that are even in an order, randomised: what users have where independent samples are assumed.

use crate::random::{SplitMix64, mix};
use noisefloor::tile::{Builtin, Sampler};

/// A point set whose runs are even too, or are not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// Sobol points with Owen's scrambling, in their own order.
    Sobol,
    /// The same in Gray code order.
    Gray,
    /// A rank-1 lattice with Korobov's generators, shifted.
    Lattice,
    /// The additive recurrence on powers of the generalised golden ratio, shifted.
    R2,
    /// Successive samples of a pixel of a shipped tile.
    Tile(Builtin),
}

/// Degree, coefficients and initial direction numbers of Sobol's dimensions from the second on (Joe and Kuo 2008).
const DIRECTIONS: [(usize, u32, &[u32]); 14] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
    (5, 4, &[1, 1, 5, 5, 5]),
    (5, 7, &[1, 1, 7, 11, 19]),
    (5, 11, &[1, 1, 5, 1, 1]),
    (5, 13, &[1, 1, 1, 3, 11]),
    (5, 14, &[1, 3, 5, 5, 31]),
    (6, 1, &[1, 3, 3, 9, 7, 49]),
    (6, 13, &[1, 1, 1, 15, 21, 21]),
];

fn directions(dimension: usize) -> [u32; 32] {
    let Some(&(degree, coefficients, first)) = dimension.checked_sub(1).and_then(|index| DIRECTIONS.get(index)) else {
        return core::array::from_fn(|bit| 1 << (31 - bit));
    };
    let mut all = [0; 32];
    for bit in 0..32 {
        all[bit] = if bit < degree {
            first[bit] << (31 - bit)
        } else {
            let own = all[bit - degree] ^ (all[bit - degree] >> degree);
            let others = (1..degree).filter(|k| coefficients >> (degree - 1 - k) & 1 == 1);
            others.fold(own, |sum, k| sum ^ all[bit - k])
        };
    }
    all
}

/// Flips each bit by a hash of those before it: a random permutation of every binary interval's halves.
fn owen(x: u32, seed: u64) -> u32 {
    (0..24).fold(0, |out, bit| {
        let before = u64::from(x) >> (32 - bit) | 1 << bit;
        out | (x >> (31 - bit) & 1 ^ (mix(seed ^ mix(before)) & 1) as u32) << (31 - bit)
    })
}

/// The Korobov generator of the best of 40 lattices, by the sum of squared errors over smooth periodic functions (P2).
fn korobov(n: usize, dims: usize) -> u64 {
    let mut rng = SplitMix64::new(5);
    let square = |x: f64| 1.0 + 2.0 * core::f64::consts::PI.powi(2) * (x * x - x + 1.0 / 6.0);
    let quality = |generator: u64| -> f64 {
        let point = |i: usize| lattice_point(i, n, generator).take(dims).map(square).product::<f64>();
        (0..n).map(point).sum()
    };
    let candidates =
        (0..40).map(|_| 1 + 2 * rng.below((n / 2).max(1)) as u64).map(|generator| (quality(generator), generator));
    candidates.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(1, |best| best.1)
}

fn lattice_point(i: usize, n: usize, generator: u64) -> impl Iterator<Item = f64> {
    let n = n as u64;
    core::iter::successors(Some(1), move |z| Some(z * generator % n)).map(move |z| (i as u64 * z % n) as f64 / n as f64)
}

fn shifted(x: f64, shift: f64) -> f32 {
    ((x + shift).fract() as f32).min(1.0 - f32::EPSILON / 2.0)
}

impl Order {
    /// `repetitions` randomisations of `n` points; none for a tile of fewer dimensions.
    pub fn sets(self, n: usize, dims: usize, repetitions: u64) -> Vec<Vec<f32>> {
        let generator = if self == Order::Lattice { korobov(n, dims) } else { 0 };
        let directions: Vec<_> = (0..dims).map(directions).collect();
        (0..repetitions)
            .filter_map(|seed| self.set(n, dims, generator, &directions, SplitMix64::new(mix(seed))))
            .collect()
    }

    fn set(
        self,
        n: usize,
        dims: usize,
        generator: u64,
        directions: &[[u32; 32]],
        mut rng: SplitMix64,
    ) -> Option<Vec<f32>> {
        let mut u = vec![0.0; n * dims];
        if let Order::Tile(builtin) = self {
            let tile = builtin.tile().ok().filter(|tile| tile.shape().dims as usize >= dims)?;
            let [x, y, frame] = core::array::from_fn(|_| rng.below(4096) as u32);
            for (i, out) in u.chunks_mut(dims).enumerate() {
                out.copy_from_slice(&Sampler::pixel(&tile, x, y, frame, i as u32).draw::<4>()[..dims]);
            }
            return Some(u);
        }
        // The root of x^(dims + 1) = x + 1.
        let root = (0..100).fold(1.5_f64, |x, _| (1.0 + x).powf(1.0 / (dims as f64 + 1.0)));
        for (d, directions) in directions.iter().enumerate() {
            let (seed, shift) = (rng.next_u64(), rng.uniform());
            for i in 0..n {
                let digits =
                    |i: usize| (0..32).filter(|bit| i >> bit & 1 == 1).fold(0, |sum, bit| sum ^ directions[bit]);
                let unit = |x: u32| (x >> 8) as f32 / (1 << 24) as f32;
                u[i * dims + d] = match self {
                    Order::Sobol => unit(owen(digits(i), seed)),
                    Order::Gray => unit(owen(digits(i ^ (i >> 1)), seed)),
                    Order::Lattice => shifted(lattice_point(i, n, generator).nth(d).unwrap_or(0.0), shift),
                    _ => shifted((i + 1) as f64 / root.powi(d as i32 + 1), shift),
                };
            }
        }
        Some(u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each sixteenth of every axis holds one of 16 Sobol points, in every aligned run of 16.
    #[test]
    fn sobol_runs_are_even() {
        for order in [Order::Sobol, Order::Gray] {
            for set in order.sets(64, 15, 4) {
                for run in set.chunks(16 * 15) {
                    for d in 0..15 {
                        let cells = run.iter().skip(d).step_by(15).fold(0, |cells, u| cells | 1 << (u * 16.0) as u32);
                        assert_eq!(cells, 0xffff, "{order:?} {d}");
                    }
                }
            }
        }
    }
}
