//! How long an optimisation runs.

use super::{Problem, Quality};

/// Slices per iteration. Few slices in many iterations beat many in few: at equal slices, 4096 points reach a nearest-neighbour distance
/// of .856 of the maximum with 16, .830 with 64, .738 with 256.
pub(crate) const SLICES: usize = 16;
pub(crate) static P: std::sync::LazyLock<Vec<f64>> = std::sync::LazyLock::new(|| {
    std::env::var("P").unwrap_or("1 1 1 1 0".into()).split_whitespace().map(|x| x.parse().unwrap()).collect()
});

/// Points per window of a large set.
pub(crate) const WINDOW: usize = 1024;
/// Sets of more points than this begin in windows.
pub(crate) const WINDOWED_FROM: usize = 8192;
/// Iterations inside each window before the set is cut into other windows.
pub(crate) const WINDOW_ITERATIONS: usize = 4;

/// The steps of an optimisation: in windows first, then of all points together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Schedule {
    pub(crate) windowed: u64,
    pub(crate) global: u64,
}

impl Schedule {
    pub(crate) fn new(problem: &Problem) -> Schedule {
        let base = match problem.quality {
            Quality::Draft => 96,
            Quality::Standard => 768,
            Quality::High => 4096,
            Quality::Iterations(iterations) => iterations,
        };
        if problem.points >= WINDOWED_FROM
            && problem.dims <= 3
            && problem.classes.iter().all(|class| class.target.is_uniform())
        {
            let global = (base as f64 * P[4]) as u64;
            return Schedule { windowed: base - global, global };
        }
        Schedule { windowed: 0, global: base }
    }

    pub(crate) fn iterations(&self) -> u64 {
        self.windowed + self.global
    }

    /// The step of an iteration, relative to the full way to the targets.
    pub(crate) fn step(&self, iteration: u64) -> f32 {
        let u = iteration as f64 / self.iterations() as f64;
        (P[0] * libm::pow(P[1], libm::pow(u, P[2]))) as f32
    }
}
