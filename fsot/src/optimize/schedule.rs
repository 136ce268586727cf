//! How long an optimisation runs.

use super::window::windows_per_axis;
use super::{Problem, Quality};

/// Slices per iteration. Few slices in many iterations beat many in few: at equal slices, 4096 points reach a nearest-neighbour distance
/// of .856 of the maximum with 16, .830 with 64, .738 with 256.
pub(crate) const SLICES: usize = 16;

/// Points per window of a large set.
pub(crate) const WINDOW: usize = 1024;
/// Sets of more points than this are optimised in windows.
pub(crate) const WINDOWED_FROM: usize = 16_384;
/// Iterations inside each window before the set is cut into other windows.
pub(crate) const WINDOW_ITERATIONS: usize = 4;
/// Steps of all points together before and behind those in windows.
const OPENING: u64 = 16;
const CLOSING: u64 = 24;

/// The steps of an optimisation: of all points together, or, for large uniform sets, first so, then in windows, then again together.
///
/// Windows bring the points into order with their neighbours; the first steps spread them evenly over the domain, the last remove what the
/// windows left to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Schedule {
    opening: u64,
    windowed: u64,
    closing: u64,
}

impl Schedule {
    /// `objectives` is the number of subclasses that compete, see [`objectives`].
    pub(crate) fn new(problem: &Problem, objectives: usize) -> Schedule {
        let windowed = problem.points > WINDOWED_FROM
            && windows_per_axis(problem.points, problem.dims) >= 2
            && problem.dims <= 3
            && problem.classes.iter().all(|class| class.target.is_uniform());
        let iterations = iterations(problem, objectives, windowed);
        if windowed {
            // Few iterations are shared among the three.
            let opening = OPENING.min(iterations / 8);
            let closing = CLOSING.min(iterations / 8);
            Schedule { opening, windowed: iterations - opening - closing, closing }
        } else {
            Schedule { opening: 0, windowed: 0, closing: iterations }
        }
    }

    pub(crate) fn iterations(&self) -> u64 {
        self.opening + self.windowed + self.closing
    }

    /// Whether an iteration is one of windows.
    pub(crate) fn in_windows(&self, iteration: u64) -> bool {
        (self.opening..self.opening + self.windowed).contains(&iteration)
    }

    /// The step of an iteration, relative to the way to the targets. It falls exponentially from twice the way, which leaves bad places
    /// behind, to a small part of it, which averages over many directions.
    pub(crate) fn step(&self, iteration: u64) -> f32 {
        let falling = |from: f64, to: f64, k: u64, of: u64| (from * libm::pow(to / from, k as f64 / of as f64)) as f32;
        if self.windowed == 0 {
            falling(2.0, 0.06, iteration, self.closing)
        } else if iteration < self.opening {
            1.0
        } else if iteration < self.opening + self.windowed {
            falling(2.0, 0.1, iteration - self.opening, self.windowed)
        } else {
            falling(1.0, 0.1, iteration - self.opening - self.windowed, self.closing)
        }
    }
}

/// The number of subclasses that compete for the points: class functions count with the number of their values, up to [`MOST_OBJECTIVES`].
pub(crate) fn objectives(values: impl Iterator<Item = usize>) -> usize {
    values.sum::<usize>().clamp(1, MOST_OBJECTIVES)
}

/// More objectives do not make an optimisation longer.
pub(crate) const MOST_OBJECTIVES: usize = 8;

fn iterations(problem: &Problem, objectives: usize, windowed: bool) -> u64 {
    if let Quality::Iterations(iterations) = problem.quality {
        return iterations;
    }
    // An iteration in windows brings a large set as far as several bring a small one, whatever its size.
    let (draft, standard, high) = if windowed { (60.0, 600.0, 2400.0) } else { (6.0, 32.0, 220.0) };
    let base = match problem.quality {
        Quality::Draft => draft,
        Quality::High => high,
        _ => standard,
    };
    let size = if windowed { 1.0 } else { (problem.points as f64).sqrt().max(4.0) };
    libm::ceil(base * size * objectives as f64) as u64
}
