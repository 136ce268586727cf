//! Cross-fit: each fold is corrected by a fit to the other folds, so that no sample shapes its own correction.
//!
//! If the samples are even as a whole, what a fold lacks and what the others have does not cancel: [`Rule::Fold`] then
//! trusts the mean.

use super::config::{Config, Ridge, Solver};
use super::design::Design;
use super::fitter::{self, Fitter, Rule};
use super::folds::Fold;
use super::per_channel::PerChannel;
use super::plan::Plan;
use super::result::Outcome;
use super::samples::{Reader, Subset};
use super::sums;
use crate::arena::Arena;
use crate::basis::Basis;
use crate::error::Error;
use crate::lanes::{LANES, Lanes};
use crate::real::Real;
use crate::rows::{rows, rows_mut};

/// Numbers that [`estimate`] takes from its arena.
pub(crate) fn size<R: Real>(config: &Config, columns: usize, channels: usize, n: usize) -> Option<usize> {
    // The largest training set leaves out the smallest fold, and the held-out fold is no larger than that.
    let train = n - n / config.fold_count();
    let designs = Design::<R>::size(train, columns, channels)?.checked_mul(2)?;
    let primal = fitter::size(train, false, columns, channels)?;
    // Training sets differ in size, and skipped samples make them smaller: some may be short where the largest is not.
    let short = if config.solver == Solver::Dual { train } else { train.min(columns) };
    let dual = fitter::size(short, true, columns, channels)?;
    primal.max(dual).checked_add(designs)?.checked_add(columns * channels)
}

/// The estimate over `config.folds` folds. `whole` holds all samples.
#[inline(never)]
pub(crate) fn estimate<R: Real>(
    reader: &Reader<'_>,
    whole: &Design<'_, R>,
    config: &Config,
    basis: &Basis,
    arena: &mut Arena<'_, R>,
) -> Result<Outcome<R>, Error> {
    let channels = whole.channels;
    let mut totals = PerChannel::<R>::default();
    let mut squares = PerChannel::<R>::default();
    let mut inflations = PerChannel::default();
    let coefficients = arena.take(whole.columns * channels)?;
    for index in 0..config.fold_count().get() {
        let fold = Fold::new(index, config.fold_count(), reader.len());
        let mut arena = arena.scratch();
        let held_out = match load(reader, basis, whole.columns, Subset::Fold(fold), false, &mut arena) {
            Err(Error::NoSamples) => continue,
            other => other?,
        };
        let train = match load(reader, basis, whole.columns, Subset::Complement(fold), true, &mut arena) {
            Err(Error::NoSamples) => None,
            other => Some(other?),
        };
        coefficients.fill(R::ZERO);
        let mut inflation = [R::ONE; Config::MAX_CHANNELS];
        if let Some(train) = train.filter(|train| train.n > 1) {
            let plan = Plan::new(config, basis.columns(), train.n)?;
            let fitter = Fitter::new(&train, config, basis, plan.dual, &mut arena)?;
            let rule = if config.ridge == Ridge::Default { Rule::Fold } else { Rule::Single(config.ridge) };
            let blend = fitter.solve(rule, Some(coefficients), &mut arena)?;
            for (channel, inflation) in inflation.iter_mut().enumerate().take(channels) {
                *inflation = blend.inflation(channel, R::from_usize(train.n));
            }
            // Everything meets in the units of all samples, which are the largest.
            for (coefficients, (from, to)) in
                rows_mut(coefficients, whole.columns).zip(train.units.iter().zip(&whole.units))
            {
                for value in coefficients {
                    *value = to.converted(*value, from);
                }
            }
        }
        for (total, inflation) in inflations.iter_mut().zip(inflation) {
            *total += R::from_usize(held_out.n) * inflation;
        }
        for (panel_index, (panel, values)) in held_out.each_panel().enumerate() {
            let used = held_out.n.saturating_sub(panel_index * LANES);
            for (channel, (values, coefficients)) in values.iter().zip(rows(coefficients, whole.columns)).enumerate() {
                let (Some(from), Some(to)) = (held_out.units.get(channel), whole.units.get(channel)) else {
                    continue;
                };
                // Relative to the whole design's mean.
                let residuals = residuals(panel, &values.map(|value| to.relative(value, from)), coefficients);
                for &residual in residuals.iter().take(used) {
                    totals[channel] += residual;
                    squares[channel] += residual * residual;
                }
            }
        }
    }
    let n = R::from_usize(whole.n);
    let mut outcome = Outcome { correction: PerChannel::default(), variance: None };
    let mut variance = PerChannel::default();
    for channel in 0..channels {
        let (total, mean) = (totals[channel], totals[channel] / n);
        outcome.correction[channel] = mean;
        let spread = sums::spread(squares[channel], total, mean);
        // Not `mean_divisor`: with that, the compiler divides by zero in lanes of a vector that nobody reads.
        variance[channel] = spread * inflations[channel] / (n * n * (n - R::ONE).max(R::ONE));
    }
    outcome.variance = (whole.n > 1).then_some(variance);
    Ok(outcome)
}

/// [`Design::load`], of which the two callers share one copy.
#[inline(never)]
fn load<'a, R: Real>(
    reader: &Reader<'_>,
    basis: &Basis,
    columns: usize,
    subset: Subset,
    centre: bool,
    arena: &mut Arena<'a, R>,
) -> Result<Design<'a, R>, Error> {
    Design::load(reader, basis, columns, subset, centre, arena)
}

/// f - b'p, where the columns' integrals are zero.
#[inline]
fn residuals<R: Real>(panel: &[Lanes<R>], values: &Lanes<R>, coefficients: &[R]) -> Lanes<R> {
    let mut residuals = *values;
    for (column, &weight) in panel.iter().zip(coefficients) {
        for (residual, &value) in residuals.iter_mut().zip(column) {
            *residual -= weight * value;
        }
    }
    residuals
}
