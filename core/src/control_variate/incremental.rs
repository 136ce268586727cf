//! The incremental estimate (4.30): each sample is corrected by a fit to the samples before it.
//!
//! As no sample shapes its own correction the estimate is exactly unbiased after every sample (4.31). The fit is renewed
//! after each of the first samples and then each time their number has grown by a sixteenth, which costs little and
//! keeps the guarantee: the fit in use is always one to preceding samples.

use super::config::{Config, Ridge};
use super::moments::{self, Centred, Moments};
use super::per_channel::{PerChannel, get};
use super::result::Outcome;
use super::ridge;
use crate::arena::Arena;
use crate::real::Real;

/// Ridge strength per sample, if the caller names none.
const STRENGTH: f64 = 0.1;

/// Where an incremental estimate stands.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Progress<R> {
    /// Sums of corrected values and of their squares.
    total: PerChannel<R>,
    square: PerChannel<R>,
    /// The number of samples at which the next fit is due.
    next_fit: u64,
}

/// Numbers that follow the sums in an accumulator's buffer: coefficients, and room to renew them.
pub(crate) fn len(columns: usize, channels: usize) -> usize {
    columns * channels + columns + moments::centred_len(columns, channels) + moments::solve_len(columns)
}

/// Adds f - b'p for the fit so far.
#[inline(always)]
pub(crate) fn correct<R: Real>(progress: &mut Progress<R>, coefficients: &[R], p: &[R], f: &[R]) {
    for (channel, ((&f, total), square)) in f.iter().zip(&mut progress.total).zip(&mut progress.square).enumerate() {
        let b = coefficients.get(channel * p.len()..).unwrap_or(&[]);
        let value = b.iter().zip(p).fold(f, |value, (&b, &p)| value - b * p);
        *total += value;
        *square += value * value;
    }
}

/// Renews the fit if it is due.
pub(crate) fn refit<R: Real>(
    samples: u64,
    progress: &mut Progress<R>,
    config: &Config,
    sums: &[R],
    rest: &mut [R],
    terms: usize,
    channels: usize,
) {
    if samples < progress.next_fit.max(2) {
        return;
    }
    progress.next_fit = samples + (samples / 16).max(1);
    let columns = terms - 1;
    let strength = match config.ridge {
        Ridge::Fixed(strength) => R::from_f32(strength),
        Ridge::Default | Ridge::Auto => R::from_f64(STRENGTH),
    };
    let mut solve = || {
        let sums = Moments::new(sums, terms, channels)?;
        let basis = config.checked_basis().ok()?;
        let mut arena = Arena::new(rest);
        let coefficients = arena.take(columns * channels).ok()?;
        let penalties = arena.take(columns).ok()?;
        ridge::penalties(config, &basis, |j| sums.column_square(j) / sums.count(), penalties);
        let centred = Centred::new(&sums, columns, channels, &mut arena).ok()??;
        centred.solve(penalties, strength, coefficients, false, &mut arena).ok().map(drop)
    };
    // The buffer was measured for this, so there is nothing to fail; a fit that is not renewed is still a valid one.
    let _: Option<()> = solve();
}

/// The mean of the corrected values.
pub(crate) fn outcome<R: Real>(progress: &Progress<R>, samples: u64) -> Outcome<R> {
    let n = R::from_f64(samples as f64);
    let mut correction = PerChannel::default();
    let mut variance = PerChannel::default();
    for (channel, (correction, variance)) in correction.iter_mut().zip(&mut variance).enumerate() {
        let (total, square) = (get(&progress.total, channel), get(&progress.square, channel));
        *correction = total / n;
        *variance = (square - total * total / n).max(R::ZERO) / (n * (n - R::ONE));
    }
    Outcome { correction, variance: (samples > 1).then_some(variance) }
}

impl<R: Real> Progress<R> {
    /// Adds another estimate's corrected values, of values that are `shift` + `factors` times as they were.
    pub(crate) fn merge(&mut self, other: &Self, factors: &PerChannel<R>, shift: &PerChannel<R>, samples: u64) {
        let n = R::from_f64(samples as f64);
        for (channel, (total, square)) in self.total.iter_mut().zip(&mut self.square).enumerate() {
            let (factor, shift) = (get(factors, channel), get(shift, channel));
            let added = factor * get(&other.total, channel);
            *total += added + shift * n;
            *square += factor * factor * get(&other.square, channel) + shift * (added + added + shift * n);
        }
    }

    /// Makes the next fit due at once.
    pub(crate) fn refit_now(&mut self) {
        self.next_fit = 0;
    }

    /// Multiplies values, and with them the coefficients in front of `rest`.
    pub(crate) fn rescale(&mut self, factors: &PerChannel<R>, rest: &mut [R], columns: usize) {
        for ((total, square), &factor) in self.total.iter_mut().zip(&mut self.square).zip(factors) {
            *total *= factor;
            *square *= factor * factor;
        }
        for (coefficients, &factor) in rest.chunks_exact_mut(columns.max(1)).zip(factors) {
            for value in coefficients {
                *value *= factor;
            }
        }
    }
}
