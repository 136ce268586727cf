//! One integrand, one degree, one sample count: errors and times of every estimator on the same samples.

use noisefloor_bench::method::{LEAST_SQUARES, LEAVE_ONE_OUT, MEAN, METHODS, ROBUST};
use noisefloor_bench::{Extent, Method};
use noisefloor_tests::integrands::Integrand;
use noisefloor_tests::random::{SplitMix64, mix};
use noisefloor_tests::statistics::{self, Ratio, median, rmse_ratio, root_mean_square};
use std::hint::black_box;
use std::time::Instant;

pub(crate) const COUNTS: [usize; 6] = [8, 16, 32, 64, 128, 256];
/// The largest total degrees that are measured.
pub(crate) const DEGREES: [usize; 2] = [3, 2];
/// What the library admits.
const MAX_TERMS: usize = 136;

/// Which integrands.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Set {
    Nine,
    HeldOut,
    Adversarial,
}

impl Set {
    pub(crate) const ALL: [Self; 3] = [Self::Nine, Self::HeldOut, Self::Adversarial];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Nine => "nine",
            Self::HeldOut => "held out",
            Self::Adversarial => "adversarial",
        }
    }
}

/// A method's figures.
#[derive(Clone)]
pub(crate) struct Cell {
    pub(crate) set: Set,
    pub(crate) integrand: &'static str,
    /// The degree asked for, and the one that the limit of terms leaves.
    pub(crate) degree: usize,
    pub(crate) order: usize,
    pub(crate) n: usize,
    pub(crate) method: &'static str,
    /// RMSE over the mean's, 95 % interval.
    pub(crate) ratio: Ratio,
    /// For an `f32` method, how it differs from its `f64` twin on the same samples.
    pub(crate) narrow: Option<Narrow>,
    /// Nanoseconds per sample.
    pub(crate) ns: f64,
}

/// What `f32` changes.
#[derive(Clone, Copy)]
pub(crate) struct Narrow {
    /// RMSE over the `f64` path's; infinite where that path is exact.
    pub(crate) ratio: Ratio,
    /// The root mean square of the difference between the two estimates, over the plain mean's RMSE.
    pub(crate) difference: f64,
}

/// (chunks, repetitions in a chunk) of the mean and the robust estimator; others see every [`step`]-th chunk.
fn chunks(extent: Extent, dims: usize, n: usize) -> (usize, usize) {
    let (repetitions, size) = match (dims, n) {
        (..=5, ..=16) => (8192, 32),
        (..=5, 17..=32) => (2048, 32),
        (..=5, 33..=64) => (1536, 32),
        (..=5, _) => (1024, 32),
        (_, ..=64) => (512, 8),
        _ => (256, 8),
    };
    let chunks = repetitions / size;
    (extent.choose((chunks / 64).max(2), chunks, 8 * chunks), size)
}

/// Which chunks a method sees: targets are the robust estimator's; what takes longest shows its time and about how it
/// errs, and the grid of `estimators` has it too.
fn step(extent: Extent, method: &Method) -> usize {
    match method.name {
        name if name == MEAN.name || name == ROBUST.name => 1,
        _ if method.narrow || extent != Extent::Default => 4,
        name if [LEAST_SQUARES.name, LEAVE_ONE_OUT.name].contains(&name) => 4,
        _ => 16,
    }
}

/// Binomial (dims + degree) choose degree.
fn terms(dims: usize, degree: usize) -> usize {
    (1..=degree).fold(1, |terms, i| terms * (dims + i) / i)
}

struct Track {
    method: Method,
    prepared: noisefloor_bench::Prepared,
    /// It sees chunks 0, `step`, 2 `step`, ...
    step: usize,
    /// Errors in the chunks that it sees, and how many each has.
    errors: Vec<f64>,
    size: usize,
    ns: Vec<f64>,
}

impl Track {
    /// Errors in every `step`-th chunk: of a method that sees more, those that another one saw too.
    fn errors(&self, step: usize) -> Vec<f64> {
        self.errors.chunks(self.size).step_by(step / self.step).flatten().copied().collect()
    }
}

/// Adds a cell for each method.
#[allow(clippy::too_many_arguments, reason = "one value for each axis of the table")]
pub(crate) fn measure(
    cells: &mut Vec<Cell>,
    set: Set,
    integrand: &Integrand,
    seed: u64,
    degree: usize,
    n: usize,
    extent: Extent,
) {
    let dims = integrand.dims;
    let order = (1..=degree).rev().find(|&order| terms(dims, order) <= MAX_TERMS).unwrap_or(1);
    let same = |cell: &&Cell| (cell.integrand, cell.order, cell.n) == (integrand.name, order, n);
    let known: Vec<Cell> = cells.iter().filter(same).cloned().collect();
    if !known.is_empty() {
        cells.extend(known.into_iter().map(|cell| Cell { degree, ..cell }));
        return;
    }
    let (chunks, size) = chunks(extent, dims, n);
    let mut tracks: Vec<Track> = METHODS
        .iter()
        .map(|&method| Track {
            method,
            prepared: method.prepare(dims, order, n),
            step: step(extent, &method),
            errors: vec![],
            size,
            ns: vec![],
        })
        .collect();
    let mut u = vec![0.0_f32; size * n * dims];
    let mut f = vec![0.0_f32; size * n];
    let mut rng = SplitMix64::new(mix(seed << 16 | n as u64));
    let mut point = vec![0.0; dims];
    for chunk in 0..chunks {
        u.iter_mut().for_each(|u| *u = rng.uniform_f32());
        for (f, u) in f.iter_mut().zip(u.chunks_exact(dims)) {
            point.iter_mut().zip(u).for_each(|(x, &u)| *x = u.into());
            *f = (integrand.evaluate)(&point) as f32;
        }
        for track in tracks.iter_mut().filter(|track| chunk % track.step == 0) {
            let mut errors = [0.0; 32];
            let start = Instant::now();
            for ((error, u), f) in errors.iter_mut().zip(u.chunks_exact(n * dims)).zip(f.chunks_exact(n)) {
                *error = f64::from(black_box(track.prepared.estimate(black_box(u), black_box(f))));
            }
            track.ns.push(start.elapsed().as_secs_f64() * 1e9 / (size * n) as f64);
            for value in &errors[..size] {
                assert!(value.is_finite(), "{}: {} gave {value}", integrand.name, track.method.name);
                track.errors.push(value - integrand.integral);
            }
        }
    }
    for track in &tracks {
        let mean = tracks[0].errors(track.step);
        let wide = |other: &&Track| {
            track.method.narrow
                && !other.method.narrow
                && track.method.name.strip_suffix(" f32") == Some(other.method.name)
        };
        cells.push(Cell {
            set,
            integrand: integrand.name,
            degree,
            order,
            n,
            method: track.method.name,
            ratio: rmse_ratio(&track.errors, &mean),
            narrow: tracks.iter().find(wide).map(|wide| narrow(&track.errors, &wide.errors(track.step), &mean)),
            ns: median(&track.ns),
        });
    }
}

fn narrow(narrow: &[f64], wide: &[f64], mean: &[f64]) -> Narrow {
    let differences: Vec<f64> = narrow.iter().zip(wide).map(|(narrow, wide)| narrow - wide).collect();
    let difference = root_mean_square(&differences) / root_mean_square(mean);
    Narrow { ratio: rmse_ratio(narrow, wide), difference }
}

/// The cell with the largest ratio.
pub(crate) fn worst<'a>(cells: impl Iterator<Item = &'a Cell>) -> Option<&'a Cell> {
    cells.max_by(|a, b| a.ratio.value.total_cmp(&b.ratio.value))
}

/// The geometric mean of independent ratios; the interval is that of the mean logarithm, to first order.
pub(crate) fn geometric_mean<'a>(cells: impl Iterator<Item = &'a Cell>) -> Ratio {
    let ratios: Vec<Ratio> = cells.map(|cell| cell.ratio).collect();
    let value = statistics::geometric_mean(&ratios.iter().map(|ratio| ratio.value).collect::<Vec<_>>());
    let spread: f64 = ratios.iter().map(|ratio| (ratio.half_width / ratio.value).ln_1p().powi(2)).sum();
    Ratio { value, half_width: value * (spread.sqrt() / ratios.len() as f64).exp_m1() }
}
