//! Estimates from samples in caller arrays.

use super::accumulator::Accumulator;
use super::config::{Config, Estimate};
use super::design::{self, Design};
use super::fit::descent;
use super::fitter;
use super::k_fold;
use super::plan::{Method, Plan};
use super::result::{Outcome, Summary};
use super::samples::{Reader, Samples, Subset};
use crate::arena::Arena;
use crate::basis::Basis;
use crate::error::Error;
use crate::real::Real;

/// Numbers of workspace that [`estimate`] needs for up to `n` samples.
///
/// # Errors
/// [`Error::Range`] or [`Error::Unsupported`] for a configuration that cannot be, [`Error::Range`] also for more
/// samples than [`estimate`] takes, [`Error::Memory`] if no memory could be large enough.
#[inline]
pub fn workspace_len<R: Real>(config: &Config, n: usize) -> Result<usize, Error> {
    let plan = Plan::new::<R>(config, config.checked_shape()?.columns(), n)?;
    if plan.method.streams() {
        return Accumulator::<R>::new(config).map(|stream| stream.len() + stream.needed());
    }
    size(config, &plan, n).ok_or(Error::Memory)
}

/// The same of what does not stream.
fn size(config: &Config, plan: &Plan, n: usize) -> Option<usize> {
    let (columns, channels) = (plan.columns, config.regressed());
    let solve = match plan.method {
        Method::Plain | Method::Incremental | Method::SquareRoot => 0,
        Method::Descent => descent::size(columns, channels),
        Method::KFold => k_fold::size(config, columns, channels, n)?,
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
/// - [`Error::Range`]: a field of `config`, a coordinate outside [0, 1], array lengths that do not belong together, or
///   more samples than `u32::MAX`, in `f32` 2^25 (2^22 where they are [added one by one](Accumulator::add)).
/// - [`Error::NotFinite`]: a NaN or infinity among the control functions' integrals, or among the samples, unless
///   `config` says to skip them.
/// - [`Error::NoSamples`]: no samples, or none left.
/// - [`Error::Memory`]: `workspace` is shorter than [`workspace_len`] says.
/// - [`Error::Unsupported`]: options that exclude each other.
///
/// ```
/// use noisefloor::control_variate::{Config, Estimator, Samples, estimate};
///
/// // A polynomial of the fit's order is integrated exactly.
/// let config = Config { estimator: Estimator::LeastSquares, ..Config::new(1, 1, 1) };
/// let samples = Samples::new(&[0.1, 0.3, 0.9], &[1.1, 1.3, 1.9]);
/// let estimate = estimate(&config, samples, &mut [0.0_f64; 128])?;
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
    let design = Design::load(&reader, &basis, plan.columns, Subset::All, true, &mut arena).ok_or(Error::NoSamples)?;
    let summary = Summary::of(&design, &reader);
    let outcome = match plan.method {
        _ if design.n == 1 => Outcome::default(),
        Method::Robust | Method::LeaveOneOut | Method::LeastSquares => {
            fitter::fit(&design, config, &basis, &plan, None, &mut arena).outcome()
        }
        Method::KFold => k_fold::estimate(&reader, &design, config, &basis, &mut arena)?,
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
