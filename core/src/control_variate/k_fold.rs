//! Cross-fit: each fold is corrected by a fit to the other folds, so that no sample shapes its own correction.
//!
//! If the samples are even as a whole, what a fold lacks and what the others have does not cancel: the fits then
//! count for less.

use super::config::Config;
use super::design::{self, Design};
use super::fitter;
use super::folds::Fold;
use super::per_channel::PerChannel;
use super::plan::Plan;
use super::result::Outcome;
use super::ridge::MAX_FITS;
use super::samples::{Reader, Subset};
use super::sums;
use crate::arena::Arena;
use crate::basis::Basis;
use crate::error::Error;
use crate::lanes::{self, LANES};
use crate::real::Real;
use crate::rows::{rows, rows_mut};

/// Numbers that [`estimate`] takes from its arena.
pub(crate) fn size(config: &Config, columns: usize, channels: usize, n: usize) -> Option<usize> {
    // The largest training set leaves out the smallest fold, and the held-out fold is no larger than that.
    let train = n - n / config.fold_count();
    let designs = design::size(train, columns, channels)?.checked_mul(2)?;
    // Coefficients of each fit, and of all together.
    let coefficients = (MAX_FITS + 1) * columns * channels;
    designs.checked_add(fitter::size(config, train, columns, channels) + coefficients)
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
    let [mut totals, mut squares, mut inflations] = [PerChannel::default(); 3];
    let coefficients = arena.take(whole.columns * channels);
    for index in 0..config.fold_count().get() {
        let fold = Fold::new(index, config.fold_count(), reader.len());
        let mut arena = arena.scratch();
        let mut load = |subset, centre| Design::load(reader, basis, whole.columns, subset, centre, &mut arena);
        let Some(held_out) = load(Subset::Fold(fold), false) else { continue };
        let train = load(Subset::Complement(fold), true);
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
