//! The incremental estimate (4.30): each sample is corrected by fits to the samples before it.
//!
//! As no sample shapes its own correction the estimate is exactly unbiased after every sample (4.31). Two ridge fits
//! and the plain value are weighed by how well they predicted the samples so far, which keeps the early fits, which
//! (4.30) never forgets, from doing harm. The fits are renewed after each of the first samples and then each time their
//! number has grown by a sixteenth: they are always fits to preceding samples.

use super::config::{Config, Ridge};
use super::fit::Penalty;
use super::fit::normal::{self, Centred};
use super::per_channel::PerChannel;
use super::result::{self, Outcome};
use super::sums::{self, Change, Layout};
use super::{ridge, trust};
use crate::arena::Arena;
use crate::basis::{Basis, Shape};
use crate::matrix::{row_at, rows_mut};
use crate::real::Real;

/// Total ridge strengths: not per sample, as the fits of few samples need them most.
const STRENGTHS: [f64; 2] = [0.1, 1.0];
/// The most fits.
const FITS: usize = STRENGTHS.len();
/// Trust in a fit is its prediction error, relative to the mean's, to the power of minus this times the sample count.
const SHARPNESS: f64 = 0.25;

/// How many fits there are: those of a strength of the caller's would all be the same.
fn fits(ridge: Ridge) -> usize {
    if matches!(ridge, Ridge::Fixed(_)) { 1 } else { FITS }
}

/// Where an incremental estimate stands.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Progress<R> {
    /// Sums of corrected values and of their squares.
    total: PerChannel<R>,
    square: PerChannel<R>,
    /// Sums of squared prediction errors, of each fit and of the mean of the samples before.
    errors: [PerChannel<R>; FITS],
    plain_error: PerChannel<R>,
    /// How many predictions were made.
    predictions: R,
    /// What the fits, and the mean, predict where all functions are zero.
    intercepts: [PerChannel<R>; FITS],
    mean: PerChannel<R>,
    /// The number of samples at which the next fit is due.
    next_fit: u64,
}

/// Numbers that follow the sums in an accumulator's buffer: coefficients, and room to renew them.
pub(crate) fn len(layout: Layout) -> usize {
    FITS * layout.coefficients() + normal::len(layout)
}

/// The mean of the corrected values.
pub(crate) fn outcome<R: Real>(progress: &Progress<R>, samples: u64) -> Outcome<R> {
    let n = R::from_f64(samples as f64);
    let correction = progress.total.map(|total| total / n);
    let spread = sums::spread(progress.square, progress.total, correction);
    Outcome { correction, variance: Some(spread.map(|spread| spread / result::mean_divisor(n))) }
}

impl<R: Real> Progress<R> {
    /// Adds a sample's value, corrected by the fits so far.
    pub(crate) fn correct(&mut self, ridge: Ridge, coefficients: &[R], p: &[R], f: &[R]) {
        let (channels, f) = (f.len(), PerChannel::from_row(f));
        let mut value = f;
        if self.next_fit > 0 {
            let weights = match ridge {
                Ridge::Fixed(_) => [R::ONE, R::ZERO].map(PerChannel::all),
                Ridge::Default | Ridge::Auto => {
                    let n = self.predictions;
                    let judge = trust::Judge { n, power: n * R::from_f64(SHARPNESS), prior: R::from_f64(trust::PRIOR) };
                    judge.weigh(self.plain_error, &self.errors, &Default::default(), FITS).1
                }
            };
            let each = self.errors.iter_mut().zip(&self.intercepts).zip(weights).enumerate();
            for (fit, ((errors, &intercepts), weights)) in each.take(fits(ridge)) {
                let slopes = PerChannel::of(channels, |channel| {
                    let b = row_at(coefficients, p.len(), fit * channels + channel);
                    b.iter().zip(p).fold(R::ZERO, |sum, (&b, &p)| sum + b * p)
                });
                value = value - weights * slopes;
                let error = f - intercepts - slopes;
                *errors += error * error;
            }
            let error = f - self.mean;
            self.plain_error += error * error;
            self.predictions += R::ONE;
        }
        self.total += value;
        self.square += value * value;
    }

    /// Renews the fits if they are due.
    pub(crate) fn refit(
        &mut self,
        samples: u64,
        config: &Config,
        shape: Shape,
        layout: Layout,
        sums: &[R],
        rest: &mut [R],
    ) {
        if samples < self.next_fit.max(2) {
            return;
        }
        // `Normal::solve` takes strengths per sample.
        let strengths = STRENGTHS.map(|own| R::from_f64(ridge::strength::<R>(config.ridge, own / samples as f64)));
        let sums = layout.group(sums, 0);
        // The buffer was measured for this.
        let Ok(mut arena) = Arena::new(rest, Some(len(layout))) else { return };
        let coefficients = arena.take(FITS * layout.coefficients());
        let penalties = arena.take(layout.columns);
        if self.next_fit == 0 || config.controls > 0 {
            // They stay in the buffer: only those of control functions depend on the samples.
            let mut basis = Basis::empty();
            basis.set(config.basis, shape);
            ridge::penalties(config, &basis, |j| sums.mean_square(j), penalties);
        }
        let centred = Centred::new(&sums, &mut arena);
        let each = rows_mut(coefficients, layout.coefficients()).zip(strengths).zip(&mut self.intercepts);
        for ((coefficients, strength), intercepts) in each.take(fits(config.ridge)) {
            let penalty = Penalty { strength, relative: penalties };
            centred.normal.solve(penalty, coefficients, &mut arena.scratch());
            *intercepts = centred.intercepts(coefficients);
        }
        self.mean = centred.value_means;
        self.next_fit = samples.saturating_add((samples / 16).max(1));
    }

    /// Adds another estimate's corrected values, of `samples` values that were changed since. The next fits are then
    /// due at once.
    pub(crate) fn merge(&mut self, other: &Self, change: &Change<R>, samples: u64) {
        let n = R::from_f64(samples as f64);
        self.total += change.totals(other.total, n);
        self.square += change.squares(other.square, other.total, n);
        let errors = self.errors.iter_mut().chain([&mut self.plain_error]);
        for (ours, &theirs) in errors.zip(other.errors.iter().chain([&other.plain_error])) {
            *ours += change.squares(theirs, PerChannel::default(), R::ZERO);
        }
        self.predictions += other.predictions;
        self.next_fit = 0;
    }

    /// Changes the values of `samples` samples, and with them the coefficients in front of `rest`.
    pub(crate) fn change(&mut self, change: &Change<R>, samples: u64, rest: &mut [R], layout: Layout) {
        let n = R::from_f64(samples as f64);
        self.square = change.squares(self.square, self.total, n);
        self.total = change.totals(self.total, n);
        for value in self.intercepts.iter_mut().chain([&mut self.mean]) {
            *value = change.totals(*value, R::ONE);
        }
        for error in self.errors.iter_mut().chain([&mut self.plain_error]) {
            *error = change.squares(*error, PerChannel::default(), R::ZERO);
        }
        for fit in rows_mut(rest, layout.coefficients()).take(FITS) {
            for (coefficients, &factor) in rows_mut(fit, layout.columns).zip(&change.factors.0) {
                coefficients.iter_mut().for_each(|value| *value *= factor);
            }
        }
    }
}

#[cfg(test)]
#[path = "../../tests/parts/incremental.rs"]
mod tests;
