//! Estimates from samples in caller arrays.

use super::config::{Color, Config, Estimate, Estimator, Solver};
use super::design::Design;
use super::fit::{descent, givens};
use super::fitter::{self, Fitter, Rule};
use super::k_fold;
use super::plan::{Plan, is_plain};
use super::result::{self, Outcome};
use super::samples::{Reader, Samples, Subset};
use super::state::State;
use crate::arena::Arena;
use crate::basis::Basis;
use crate::error::Error;
use crate::real::Real;

/// Numbers of workspace that [`estimate`] needs for `n` samples.
///
/// # Errors
/// [`Error::Range`] or [`Error::Unsupported`] for a configuration that cannot be, [`Error::Memory`] if no memory could
/// be large enough.
///
/// ```
/// use noisefloor::control_variate::{Config, workspace_len};
/// let mut workspace = vec![0.0_f64; workspace_len::<f64>(&Config::new(2, 2, 1), 64)?];
/// # assert!(workspace.len() > 64);
/// # Ok::<(), noisefloor::Error>(())
/// ```
#[inline]
pub fn workspace_len<R: Real>(config: &Config, n: usize) -> Result<usize, Error> {
    let mut plan = Plan::new(config, config.checked_shape()?.columns(), n)?;
    if is_plain(config, plan.columns) {
        plan.columns = 0;
    }
    let channels = if config.color == Color::LuminanceRatio { 1 } else { config.channels };
    let design = Design::<R>::size(n, plan.columns, channels).ok_or(Error::Memory)?;
    if plan.columns == 0 && config.estimator != Estimator::Incremental {
        return Ok(design);
    }
    let solve = match config.estimator {
        Estimator::GradientDescent => descent::size(plan.columns, channels),
        Estimator::KFold => k_fold::size::<R>(config, plan.columns, channels, n).ok_or(Error::Memory)?,
        Estimator::Incremental => {
            let state = State::<R>::new(config)?;
            return state.len().checked_add(state.workspace_len()).ok_or(Error::Memory);
        }
        Estimator::LeastSquares if config.solver == Solver::SquareRoot => givens::size(plan.columns, channels),
        _ => fitter::size(n, plan.dual, plan.columns, channels).ok_or(Error::Memory)?,
    };
    design.checked_add(solve).ok_or(Error::Memory)
}

/// Estimates the integral over primary sample space from a pixel's samples.
///
/// Deterministic: the same samples give the same bits. Nothing is written but `workspace`, whose content does not
/// matter and must not be relied on.
///
/// # Errors
/// - [`Error::Range`]: a field of `config`, a coordinate outside [0, 1], or array lengths that do not belong together.
/// - [`Error::NotFinite`]: a NaN or infinity among the samples, unless `config` says to skip them.
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
/// let estimate = estimate(&config, samples, &mut [0.0_f64; 64])?;
/// assert!((estimate.mean[0] - 1.5).abs() < 1e-4);
/// # Ok::<(), noisefloor::Error>(())
/// ```
#[inline(always)]
pub fn estimate<R: Real>(config: &Config, samples: Samples<'_>, workspace: &mut [R]) -> Result<Estimate, Error> {
    if config.estimator == Estimator::Incremental {
        return incremental(config, samples, workspace);
    }
    let mut basis = Basis::empty();
    basis.set(config.basis, config.checked_shape()?)?;
    let reader = Reader::new(config, samples)?;
    let plan = Plan::new(config, basis.columns(), reader.len())?;
    reader.check()?;
    let mut arena = Arena::new(workspace);
    let is_plain = is_plain(config, plan.columns);
    let columns = if is_plain { 0 } else { plan.columns };
    let design = Design::load(&reader, &basis, columns, Subset::All, true, &mut arena)?;
    let outcome = if is_plain || design.n == 1 {
        Outcome { correction: Default::default(), variance: result::plain_variance(&design) }
    } else {
        match config.estimator {
            Estimator::KFold => k_fold::estimate(&reader, &design, config, &basis, &mut arena)?,
            Estimator::GradientDescent => descent::estimate(&design, config, &basis, None, &mut arena)?,
            Estimator::LeastSquares if config.solver == Solver::SquareRoot => {
                givens::least_squares(&design, config, &basis, &mut arena)?
            }
            // The incremental estimate went its own way above.
            Estimator::Robust | Estimator::LeaveOneOut | Estimator::LeastSquares | Estimator::Incremental => {
                fit(&design, config, &basis, plan, &mut arena)?
            }
        }
    };
    Ok(result::finish(result::Summary::of(&design, &reader), outcome))
}

/// (4.30) is about a stream: the batch form streams.
fn incremental<R: Real>(config: &Config, samples: Samples<'_>, workspace: &mut [R]) -> Result<Estimate, Error> {
    let mut state = State::<R>::new(config)?;
    let (sums, scratch) = workspace.split_at_mut_checked(state.len()).ok_or(Error::Memory)?;
    state.reset(sums)?;
    state.add(sums, samples)?;
    state.estimate(sums, scratch)
}

/// The estimators that fit all samples at once through the normal equations or their dual.
#[inline(always)]
fn fit<'a, R: Real>(
    design: &Design<'a, R>,
    config: &Config,
    basis: &Basis,
    plan: Plan,
    arena: &mut Arena<'a, R>,
) -> Result<Outcome<R>, Error> {
    let rule = match config.estimator {
        Estimator::LeastSquares => Rule::LeastSquares(config.ridge),
        Estimator::LeaveOneOut => Rule::Single(config.ridge),
        _ => Rule::Robust,
    };
    let fitter = Fitter::new(design, config, basis, plan.dual, arena)?;
    let blend = fitter.solve(rule, None, arena)?;
    // Algorithm 1 for least squares: its residuals have mean zero, so the estimate is the fit's constant term.
    let correction = blend.correction();
    let variance = match rule {
        Rule::LeastSquares(_) if design.n <= design.columns + 1 => result::plain_variance(design),
        _ => blend.variance(design, &correction),
    };
    Ok(Outcome { correction, variance })
}
