//! What a nested-net tile is optimised for.

use crate::error::{Result, check};
use crate::optimize::Quality;
use serde::Serialize;

/// Octaves of samples that are looked at: the first 1, 2, 4, ... 64.
pub const OCTAVES: usize = 7;

/// An optimisation of a nested-net tile.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SamplerProblem {
    /// Pixels along each side: 32, 64 or 128.
    pub size: usize,
    /// Each pixel has 2^bits offsets for each axis, 1 to 6.
    pub bits: u32,
    /// The weight of the first 1, 2, 4, ... 64 samples' energies; that of n samples counts n^1.5 times it.
    pub weights: [f32; OCTAVES],
    /// The energy of two points is minus their distance to this power.
    pub exponent: f32,
    /// The share of a pixel's energy with the sum of all others', at any distance.
    pub mean: f32,
    /// How much a marginal counts that is not uniform.
    pub border: f32,
    /// Arrangements that a visit of a pixel tries.
    pub candidates: usize,
    /// Steps: visits of every pixel [`SWEEPS`](super::optimizer::SWEEPS) times.
    pub iterations: u64,
    /// Seeds everything.
    pub seed: u64,
}

impl Default for SamplerProblem {
    fn default() -> SamplerProblem {
        SamplerProblem {
            size: 32,
            bits: 6,
            weights: [3.0, 2.0, 2.8, 1.7, 2.8, 0.3, 0.7],
            exponent: 0.65,
            mean: 0.05,
            border: 0.3,
            candidates: 256,
            iterations: iterations(Quality::Standard),
            seed: 1,
        }
    }
}

/// A part of the steps.
struct Stage {
    /// Where it ends.
    end: f64,
    /// How many octaves it looks at, from the first.
    octaves: usize,
    /// The temperature at its start and at its end.
    temperatures: [f64; 2],
}

/// Short octaves freeze first, and their steps are cheap.
const STAGES: [Stage; 3] = [
    Stage { end: 0.2, octaves: 3, temperatures: [0.15, 0.02] },
    Stage { end: 0.45, octaves: 5, temperatures: [0.02, 0.004] },
    Stage { end: 1.0, octaves: OCTAVES, temperatures: [0.004, 0.000_01] },
];

/// The steps of an optimisation: minutes, half an hour, or three hours of one core's time.
pub fn iterations(quality: Quality) -> u64 {
    match quality {
        Quality::Draft => 16,
        Quality::Standard => 128,
        Quality::High => 640,
        Quality::Iterations(iterations) => iterations,
    }
}

impl SamplerProblem {
    /// Says what is not possible.
    ///
    /// # Errors
    /// A field is out of its range.
    pub fn validate(&self) -> Result<()> {
        let amount = |value: f32, most: f32| (0.0..=most).contains(&value);
        check([32, 64, 128].contains(&self.size), "size", self.size, "32, 64 or 128 pixels")?;
        check((1..=6).contains(&self.bits), "bits", self.bits, "1 to 6")?;
        self.weights.iter().try_for_each(|weight| check(amount(*weight, 1e3), "a weight", weight, "0 to 1000"))?;
        check(self.weights[0] > 0.0, "the first weight", self.weights[0], "more than 0")?;
        check((0.1..=1.5).contains(&self.exponent), "exponent", self.exponent, "0.1 to 1.5")?;
        check(amount(self.mean, 10.0), "mean", self.mean, "0 to 10")?;
        check(amount(self.border, 100.0), "border", self.border, "0 to 100")?;
        check((1..=1 << 20).contains(&self.candidates), "candidates", self.candidates, "1 to 1048576")?;
        check(self.iterations <= 1 << 40, "iterations", self.iterations, "at most 2^40")
    }

    /// What so many steps cost, in about the time that a point of one takes.
    pub(crate) fn work(&self, steps: f64) -> f64 {
        // What a step takes beside its points is as four of them.
        let cost = |octaves: usize| f64::from(4 + (1_u32 << (octaves - 1)));
        let (mut begin, mut sum) = (0.0, 0.0);
        for Stage { end, octaves, .. } in STAGES {
            // The first step of the next, as `stage` has it.
            let end = libm::ceil(end * self.iterations as f64 - 0.5);
            sum += (steps.min(end) - begin).max(0.0) * cost(octaves);
            begin = end;
        }
        sum
    }

    /// The octaves' weights at a step, and the temperature.
    pub(crate) fn stage(&self, iteration: u64) -> ([f32; OCTAVES], f32) {
        let part = (iteration as f64 + 0.5) / self.iterations.max(1) as f64;
        let mut begin = 0.0;
        for Stage { end, octaves, temperatures: [hot, cold] } in STAGES {
            if part < end {
                let mut weights = self.weights;
                weights[octaves..].fill(0.0);
                let along = (part - begin) / (end - begin);
                return (weights, (hot * libm::pow(cold / hot, along)) as f32);
            }
            begin = end;
        }
        (self.weights, 0.0)
    }
}
