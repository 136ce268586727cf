//! How long an optimisation runs.

use super::problem::{Problem, Quality};

/// Slices per iteration. At 48,000 slices in all, 4096 points reach a nearest-neighbour distance of .873 of the maximum
/// with 8 or 16 slices, .870 with 32; hundreds are much worse. Sixteen keep as many threads busy.
pub(crate) const SLICES: usize = 16;

/// Points per window of a large set, at least, in the mean.
const WINDOW: usize = 1024;
/// Sets of more points than this are optimised in windows.
pub(crate) const WINDOWED_FROM: usize = 8192;
/// Iterations inside each window before the set is cut into other windows.
pub(crate) const WINDOW_ITERATIONS: usize = 4;
/// Iterations of all points together, before those in windows.
const OPENING: u64 = 4;
/// The same after them, for each objective: they remove most of the error of low frequencies that windows leave, and
/// cost a little of the nearest-neighbour distance.
const CLOSING: u64 = 24;

/// How many windows each axis has for a number of points; fewer than 2: none.
pub(super) fn windows_per_axis(points: usize, dims: usize) -> usize {
    let windows = points as f64 / WINDOW as f64;
    match dims {
        1 => windows as usize,
        2 => windows.sqrt() as usize,
        _ => libm::cbrt(windows) as usize,
    }
}

/// How many windows a set is cut into.
pub(super) fn window_count(points: usize, dims: usize) -> usize {
    windows_per_axis(points, dims).max(2).pow(dims as u32)
}

/// Whether a set is one that windows are for.
pub(super) fn is_windowed(problem: &Problem) -> bool {
    problem.points > WINDOWED_FROM
        && windows_per_axis(problem.points, problem.dims) >= 2
        && problem.dims <= 3
        && problem.classes.iter().all(|class| class.target.is_uniform())
}

/// The iterations of an optimisation: of all points together, or, for large uniform sets, of windows, but for a few at
/// the beginning, which spread the points evenly over the domain, and some at the end, which remove the errors that are
/// larger than a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Schedule {
    opening: u64,
    /// The first after those of windows.
    closing: u64,
    iterations: u64,
}

impl Schedule {
    /// `objectives` is the number of subclasses that compete, see [`objectives`].
    pub(crate) fn new(problem: &Problem, objectives: usize) -> Schedule {
        let windowed = is_windowed(problem);
        let iterations = iterations(problem, objectives, windowed);
        let (opening, closing) = if windowed {
            let last = (CLOSING * objectives as u64).min(iterations / 4);
            (OPENING.min(iterations / 8), iterations - last)
        } else {
            (0, 0)
        };
        Schedule { opening, closing, iterations }
    }

    pub(crate) fn iterations(&self) -> u64 {
        self.iterations
    }

    /// Whether any iteration is one of windows.
    pub(crate) fn has_windows(&self) -> bool {
        self.opening < self.closing
    }

    /// Whether an iteration is one of windows.
    pub(crate) fn in_windows(&self, iteration: u64) -> bool {
        (self.opening..self.closing).contains(&iteration)
    }

    /// The step of an iteration, relative to the way to the targets. It falls exponentially from twice the way, which
    /// leaves bad places behind, to a small part of it, which averages over many directions; once in windows, and once
    /// again behind them. Before windows it is 1.
    pub(crate) fn step(&self, iteration: u64) -> f32 {
        let falling = |to: f64, from: u64, until: u64| {
            (2.0 * libm::pow(to / 2.0, (iteration - from) as f64 / (until - from) as f64)) as f32
        };
        if iteration < self.opening {
            1.0
        } else if iteration < self.closing {
            falling(0.08, self.opening, self.closing)
        } else {
            falling(0.03, self.closing, self.iterations)
        }
    }
}

/// The number of subclasses that compete for the points: class functions count with the number of their values, up to
/// [`MOST_OBJECTIVES`].
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
    let (draft, standard, high) = if windowed { (80.0, 800.0, 3200.0) } else { (32.0, 170.0, 1000.0) };
    let base = match problem.quality {
        Quality::Draft => draft,
        Quality::High => high,
        _ => standard,
    };
    let size = if windowed { 1.0 } else { libm::log2(problem.points as f64).max(4.0) };
    libm::ceil(base * size * objectives as f64) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::class::three_colors;
    use std::sync::Arc;

    fn of(points: usize, dims: usize, quality: Quality) -> Problem {
        Problem { quality, ..Problem::new(points, dims) }
    }

    fn near(a: f32, b: f64) -> bool {
        (f64::from(a) / b - 1.0).abs() < 1e-5
    }

    #[test]
    fn steps_fall_exponentially() {
        let schedule = Schedule::new(&of(1000, 2, Quality::Iterations(100)), 1);
        assert!(!schedule.has_windows() && !schedule.in_windows(0));
        assert!(near(schedule.step(0), 2.0) && near(schedule.step(50), 0.06f64.sqrt()));
        assert!(near(schedule.step(99), 2.0 * 0.015f64.powf(0.99)));
    }

    #[test]
    fn windows_are_between_iterations_of_all_points() {
        let schedule = Schedule::new(&of(20_000, 2, Quality::Iterations(200)), 1);
        let windowed: Vec<u64> = (0..200).filter(|iteration| schedule.in_windows(*iteration)).collect();
        assert!(windowed.into_iter().eq(4..176) && schedule.has_windows());
        assert!((0..4).all(|iteration| schedule.step(iteration) == 1.0));
        assert!(near(schedule.step(4), 2.0) && near(schedule.step(90), 0.16f64.sqrt()));
        assert!(near(schedule.step(176), 2.0) && near(schedule.step(188), 0.06f64.sqrt()));
        // Of few iterations an eighth are before, a quarter behind; of many objectives more are behind.
        let few = Schedule::new(&of(20_000, 2, Quality::Iterations(16)), 1);
        assert!((0..16).filter(|iteration| few.in_windows(*iteration)).eq(2..12));
        let many = Schedule::new(&of(20_000, 2, Quality::Iterations(1000)), 3);
        assert!((0..1000).filter(|iteration| many.in_windows(*iteration)).eq(4..928));
        assert!(!Schedule::new(&of(20_000, 2, Quality::Iterations(0)), 1).has_windows());
    }

    #[test]
    fn large_uniform_sets_have_windows() {
        for (points, dims, windowed) in [(8192, 2, false), (8193, 2, true), (8193, 3, true), (1 << 20, 4, false)] {
            assert_eq!(is_windowed(&of(points, dims, Quality::Draft)), windowed, "{points} of {dims}");
        }
        let mut problem = Problem { classes: three_colors(2), ..of(9000, 2, Quality::Draft) };
        assert!(is_windowed(&problem));
        let image = crate::target::image::ImageTarget::new(1, 2, &[1.0, 2.0], 9000).unwrap();
        problem.classes[2].target = Arc::new(image);
        assert!(!is_windowed(&problem));
        assert_eq!([1, 2, 3].map(|dims| windows_per_axis(16_384, dims)), [16, 4, 2]);
        assert_eq!([(16_384, 2), (8193, 3), (100, 1)].map(|(points, dims)| window_count(points, dims)), [16, 8, 2]);
    }

    #[test]
    fn iterations_grow_with_the_points_and_their_objectives() {
        let of = |points, quality, objectives| Schedule::new(&of(points, 2, quality), objectives).iterations();
        let all = |points, objectives| {
            [Quality::Draft, Quality::Standard, Quality::High].map(|quality| of(points, quality, objectives))
        };
        assert_eq!(all(1024, 1), [320, 1700, 10_000]);
        assert_eq!(all(1024, 3), [960, 5100, 30_000]);
        assert_eq!(all(2, 1), all(16, 1), "of very few, too, some are needed");
        assert_eq!(all(10_000, 1), all(100_000, 1), "in windows the size does not matter");
        assert_eq!(all(10_000, 2), [160, 1600, 6400]);
        let of = |values: &[usize]| objectives(values.iter().copied());
        assert_eq!([of(&[0]), of(&[1, 1]), of(&[5, 0, 2]), of(&[5, 5])], [1, 2, 7, 8]);
    }
}
