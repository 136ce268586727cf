//! Estimates from samples in caller arrays.

use super::accumulator::Accumulator;
use super::config::{Config, Estimate};
use super::design::{self, Design};
use super::fit::descent;
use super::fitter;
use super::folds::Subset;
use super::per_channel::PerChannel;
use super::plan::{Method, Plan};
use super::result::{Outcome, Summary};
use super::ridge::MAX_FITS;
use super::samples::{Reader, Samples};
use super::sums;
use crate::arena::Arena;
use crate::basis::Basis;
use crate::error::Error;
use crate::lanes::{self, LANES};
use crate::matrix::{rows, rows_mut};
use crate::real::Real;

/// Numbers of workspace that [`estimate`] needs for up to `n` samples.
///
/// # Errors
/// [`Error::Range`] or [`Error::Unsupported`] for a configuration that cannot be, [`Error::Range`] also for more
/// samples than [`estimate`] takes, or than any memory could be large enough for.
#[inline]
pub fn workspace_len<R: Real>(config: &Config, n: usize) -> Result<usize, Error> {
    let plan = Plan::new::<R>(config, config.checked_shape()?.columns(), n)?;
    if plan.method.streams() {
        return Accumulator::<R>::new(config).map(|stream| stream.len() + stream.needed());
    }
    size(config, &plan, n).ok_or(Error::Range)
}

/// The same of what does not stream.
fn size(config: &Config, plan: &Plan, n: usize) -> Option<usize> {
    let (columns, channels) = (plan.columns, config.regressed());
    let solve = match plan.method {
        Method::Plain | Method::Incremental | Method::SquareRoot => 0,
        Method::Descent => descent::size(columns, channels),
        Method::KFold => k_fold_size(config, columns, channels, n)?,
        Method::Robust | Method::LeaveOneOut | Method::LeastSquares => fitter::size(config, n, columns, channels),
    };
    design::size(n, columns, channels)?.checked_add(solve)
}

/// Estimates the integral over primary sample space from a pixel's samples.
///
/// Deterministic: the same samples give the same bits. Nothing is written but `workspace`, whose content does not
/// matter and must not be relied on.
///
/// # Errors
/// - [`Error::Range`]: a field of `config`, a coordinate outside [0, 1], or more samples than `u32::MAX`, in `f32` 2^25
///   (2^22 where they are [added one by one](Accumulator::add)).
/// - [`Error::Length`]: arrays' lengths do not belong together.
/// - [`Error::NotFinite`]: a NaN or infinity among the control functions' integrals, or among the samples, unless
///   `config` says to skip them.
/// - [`Error::NoSamples`]: no samples, or none left.
/// - [`Error::Memory`]: `workspace` is shorter than [`workspace_len`] says.
/// - [`Error::Unsupported`]: options that exclude each other.
///
/// ```
/// use noisefloor::control_variate::{Config, Estimator, Samples, estimate, workspace_len};
///
/// // A polynomial of the fit's order is integrated exactly.
/// let config = Config { estimator: Estimator::LeastSquares, ..Config::new(1, 1, 1) };
/// let samples = Samples::new(&[0.1, 0.3, 0.9], &[1.1, 1.3, 1.9]);
/// let mut workspace = vec![0.0; workspace_len::<f64>(&config, 3)?];
/// let estimate = estimate(&config, samples, &mut workspace)?;
/// assert!((estimate.mean[0] - 1.5).abs() < 1e-4);
/// # Ok::<(), noisefloor::Error>(())
/// ```
// Once for each precision: inlined, it is most of the code of whatever calls it.
#[inline(never)]
pub fn estimate<R: Real>(config: &Config, samples: Samples<'_>, workspace: &mut [R]) -> Result<Estimate, Error> {
    estimate_inlined(config, samples, workspace)
}

/// [`estimate`], compiled anew into each function that calls it, for the vector registers that this has.
///
/// # Errors
/// As for [`estimate`].
#[inline(always)]
pub fn estimate_inlined<R: Real>(
    config: &Config,
    samples: Samples<'_>,
    workspace: &mut [R],
) -> Result<Estimate, Error> {
    let shape = config.checked_shape()?;
    if Method::of(config, config.controls + shape.columns()).streams() {
        return streamed(config, samples, workspace);
    }
    let mut basis = Basis::empty();
    basis.set(config.basis, shape);
    let reader = Reader::new(config, samples)?;
    let plan = Plan::new::<R>(config, shape.columns(), reader.len())?;
    reader.check()?;
    let mut arena = Arena::new(workspace, size(config, &plan, reader.len()))?;
    let design = Design::load(&reader, &basis, plan.columns, Subset::ALL, true, &mut arena).ok_or(Error::NoSamples)?;
    let summary = Summary::of(&design, &reader);
    let outcome = match plan.method {
        _ if design.n == 1 => Outcome::default(),
        Method::Robust | Method::LeaveOneOut | Method::LeastSquares => {
            fitter::fit(&design, config, &basis, &plan, None, &mut arena).outcome()
        }
        Method::KFold => k_fold(&reader, &design, config, &basis, &mut arena)?,
        Method::Descent => {
            let coefficients = arena.zeros(design.columns * design.channels);
            descent::descend(&design, config, &basis, coefficients, summary.variance, &mut arena)
        }
        // What streams went its own way above.
        Method::Plain | Method::Incremental | Method::SquareRoot => Outcome::default(),
    };
    Ok(summary.finish(outcome))
}

/// (4.30) is about a stream, and Givens rotations take one row at a time: their batch form streams.
fn streamed<R: Real>(config: &Config, samples: Samples<'_>, workspace: &mut [R]) -> Result<Estimate, Error> {
    let mut stream = Accumulator::<R>::new(config)?;
    let (sums, workspace) = workspace.split_at_mut_checked(stream.len()).ok_or(Error::Memory)?;
    stream.reset(sums)?;
    stream.add(sums, samples)?;
    stream.estimate(sums, workspace)
}

/// Numbers that [`k_fold`] takes from its arena.
fn k_fold_size(config: &Config, columns: usize, channels: usize, n: usize) -> Option<usize> {
    // The largest training set leaves out the smallest fold, and the held-out fold is no larger than that.
    let train = n - n / config.fold_count();
    let designs = design::size(train, columns, channels)?.checked_mul(2)?;
    // Coefficients of each fit, and of all together.
    let coefficients = (MAX_FITS + 1) * columns * channels;
    designs.checked_add(fitter::size(config, train, columns, channels) + coefficients)
}

/// Cross-fit: each of `config.folds` folds is corrected by a fit to the others, so that no sample shapes its own
/// correction. If the samples are even as a whole, what a fold lacks and what the others have does not cancel: the fits
/// then count for less. `whole` holds all samples.
#[inline(never)]
fn k_fold<R: Real>(
    reader: &Reader<'_>,
    whole: &Design<'_, R>,
    config: &Config,
    basis: &Basis,
    arena: &mut Arena<'_, R>,
) -> Result<Outcome<R>, Error> {
    let channels = whole.channels;
    let [mut totals, mut squares, mut inflations] = [PerChannel::default(); 3];
    let coefficients = arena.take(whole.columns * channels);
    for index in 0..config.fold_count().get() {
        let fold = Subset::fold(index, config.fold_count(), reader.len());
        let mut arena = arena.scratch();
        let mut load = |subset, centre| Design::load(reader, basis, whole.columns, subset, centre, &mut arena);
        let Some(held_out) = load(fold, false) else { continue };
        let train = load(fold.others(), true);
        coefficients.fill(R::ZERO);
        let mut inflation = PerChannel::all(R::ONE);
        if let Some(train) = train.filter(|train| train.n > 1) {
            let plan = Plan::new::<R>(config, basis.columns(), train.n)?;
            let blend = fitter::fit(&train, config, basis, &plan, Some(coefficients), &mut arena);
            inflation = blend.inflation();
            // Everything meets in the units of all samples, which are the largest.
            for (channel, row) in rows_mut(coefficients, whole.columns).enumerate() {
                row.iter_mut().for_each(|value| *value = whole.units.converted(channel, *value, &train.units));
            }
        }
        inflations += inflation * R::from_usize(held_out.n);
        for (panel_index, (panel, values)) in held_out.each_panel().enumerate() {
            let used = held_out.n.saturating_sub(panel_index * LANES);
            let each = values.iter().zip(rows(coefficients, whole.columns)).enumerate();
            for (channel, (values, coefficients)) in each {
                // Relative to the whole design's mean.
                let mut residuals = values.map(|value| whole.units.relative(channel, value, &held_out.units));
                // f - b'p, where the columns' integrals are zero.
                for (column, &b) in panel.iter().zip(coefficients) {
                    residuals = lanes::minus_product(residuals, [b; LANES], *column);
                }
                for &residual in residuals.iter().take(used) {
                    totals[channel] += residual;
                    squares[channel] += residual * residual;
                }
            }
        }
    }
    let n = R::from_usize(whole.n);
    let correction = totals.map(|total| total / n);
    let spread = sums::spread(squares, totals, correction) * inflations;
    let variance = spread.map(|spread| spread / (n * n * (n - R::ONE).max(R::ONE)));
    Ok(Outcome { correction, variance: Some(variance) })
}
