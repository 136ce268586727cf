//! One fit shared by a block of pixels (4.3.6): an estimate for each, corrected by a fit to the other pixels' samples.
//!
//! With a fixed ridge each estimate is exactly unbiased, as b never saw the pixel's own samples:
//! mean f_p - b' mean phi_p, and it keeps whatever stratification the samples have, in the pixel and across pixels.
//! By default four fits and the plain mean are weighted by the variance across the pixels of their estimates. The
//! signal's own variance is common to all of them, so the difference is the error's, however the samples are
//! correlated. That choice is made from the same samples: it is unbiased only as the block grows.

use super::config::{Config, Estimate, Ridge};
use super::design::Units;
use super::moments::{self, Centred, Moments, MomentsMut};
use super::per_channel::{PerChannel, add, get, set};
use super::result::{self, Outcome, Summary};
use super::ridge;
use super::samples::{Reader, Samples, Subset};
use super::trust;
use crate::arena::Arena;
use crate::basis::{Basis, MAX_DIMS, MAX_TERMS};
use crate::error::Error;
use crate::real::Real;
use crate::rows::{rows, rows_mut};

/// Ridge strengths, per sample of the block.
const STRENGTHS: [f64; 2] = [0.02, 0.3];
/// Fits: each strength with the columns of degree one and with all.
const CANDIDATES: usize = 2 * STRENGTHS.len();
/// Numbers of workspace that [`estimate_block`] needs for `pixels` pixels of `n` samples.
///
/// # Errors
/// As for [`estimate_block`].
pub fn block_workspace_len<R: Real>(config: &Config, pixels: usize, n: usize) -> Result<usize, Error> {
    check_supported(config)?;
    let shape = config.checked_shape()?;
    let (columns, channels) = (config.controls + shape.columns(), config.channels);
    let sums = moments::len(columns + 1, channels);
    let fit = moments::centred_len(columns, channels) + moments::solve_len(columns);
    let estimates = (CANDIDATES + 1) * channels;
    pixels.checked_mul(n).ok_or(Error::Memory)?;
    let pixel = sums.checked_add(estimates).ok_or(Error::Memory)?;
    let fixed = 2 * sums + columns * (1 + channels) + fit;
    pixels.checked_mul(pixel).and_then(|len| len.checked_add(fixed)).ok_or(Error::Memory)
}

/// Which samples count must not depend on the pixel, and the fit is of the channels.
fn check_supported(config: &Config) -> Result<(), Error> {
    let supported = config.color == super::Color::PerChannel && config.non_finite == super::NonFinite::Error;
    if supported { Ok(()) } else { Err(Error::Unsupported) }
}

/// Estimates the integral of each of `pixels` pixels, all with `samples.f.len() / (pixels channels)` samples, pixel after
/// pixel. `out` is called once for each pixel in order, and only if all succeed. The standard errors are the plain
/// mean's times the root of the block's gain.
///
/// # Errors
/// As for [`estimate`](super::estimate); [`Error::Unsupported`] for a luminance ratio or for skipping samples.
pub fn estimate_block<R: Real>(
    config: &Config,
    samples: Samples<'_>,
    pixels: usize,
    workspace: &mut [R],
    mut out: impl FnMut(usize, Estimate),
) -> Result<(), Error> {
    let mut basis = Basis::empty();
    basis.set(config.basis, config.checked_shape()?)?;
    check_supported(config)?;
    let reader = Reader::new(config, samples)?;
    let n = reader.len().checked_div(pixels).ok_or(Error::NoSamples)?;
    if n * pixels != reader.len() {
        return Err(Error::Range);
    }
    reader.check()?;
    if workspace.len() < block_workspace_len::<R>(config, pixels, n)? {
        return Err(Error::Memory);
    }
    let mut arena = Arena::new(workspace);
    let block = Block::new(config, &basis, &reader, pixels, n, &mut arena)?;
    block.estimate(config, &basis, &mut out, &mut arena)
}

/// The sums of a block's pixels.
struct Block<'a, R> {
    columns: usize,
    channels: usize,
    pixels: usize,
    n: usize,
    /// Sums pixel after pixel.
    sums: &'a mut [R],
    total: &'a mut [R],
    units: [Units<R>; Config::MAX_CHANNELS],
}

impl<'a, R: Real> Block<'a, R> {
    fn new(
        config: &Config,
        basis: &Basis,
        reader: &Reader<'_>,
        pixels: usize,
        n: usize,
        arena: &mut Arena<'a, R>,
    ) -> Result<Self, Error> {
        let (columns, channels) = (config.controls + basis.columns(), config.channels);
        let len = moments::len(columns + 1, channels);
        let sums = arena.take(pixels.checked_mul(len).ok_or(Error::Memory)?)?;
        let total = arena.take(len)?;
        for value in sums.iter_mut().chain(total.iter_mut()) {
            *value = R::ZERO;
        }
        let units = super::design::units(reader, Subset::All);
        let factors = units.map(|unit: Units<R>| R::ONE.scale(-unit.exponent));
        let mut x = [[R::ZERO; 1]; MAX_DIMS];
        let mut h = [[R::ZERO; 1]; Config::MAX_CONTROLS];
        let mut p = [[R::ONE]; MAX_TERMS];
        let p = p.get_mut(..columns + 1).unwrap_or(&mut []);
        let mut index = 0usize;
        reader.each(Subset::All, |sample| {
            sample.put(0, &mut x, &mut h);
            reader.columns(basis, &x, &h, p.get_mut(1..).unwrap_or(&mut []));
            let mut f = reader.values::<R>(sample);
            for ((f, factor), unit) in f.iter_mut().zip(factors).zip(&units) {
                *f = *f * factor - unit.offset;
            }
            let pixel = index.checked_div(n).unwrap_or(0);
            let group = sums.get_mut(pixel * len..(pixel + 1) * len).unwrap_or(&mut []);
            if let Some(mut moments) = MomentsMut::new(group, columns + 1, channels) {
                moments.add(p.as_flattened(), f.get(..channels).unwrap_or(&[]));
            }
            index += 1;
        });
        for group in rows(sums, len) {
            moments::add_sums(total, group);
        }
        Ok(Self { columns, channels, pixels, n, sums, total, units })
    }

    fn estimate(
        &self,
        config: &Config,
        basis: &Basis,
        out: &mut impl FnMut(usize, Estimate),
        arena: &mut Arena<'_, R>,
    ) -> Result<(), Error> {
        let (columns, channels) = (self.columns, self.channels);
        let len = moments::len(columns + 1, channels);
        let each = (CANDIDATES + 1) * channels;
        let train = arena.take(len)?;
        let penalties = arena.take(columns)?;
        let coefficients = arena.take(columns * channels)?;
        // Of each pixel: the plain mean's estimates, then each fit's.
        let estimates = arena.take(self.pixels * each)?;
        for value in estimates.iter_mut() {
            // A fit that is not made has weight zero, which would not help against a NaN that the buffer held.
            *value = R::ZERO;
        }
        let whole = Moments::new(self.total, columns + 1, channels).ok_or(Error::Memory)?;
        ridge::penalties(config, basis, |j| whole.column_square(j) / whole.count(), penalties);
        let first_degree = (config.controls + basis.first_degree()).min(columns);
        let fits: [(usize, f64); CANDIDATES] = match config.ridge {
            Ridge::Fixed(_) => [(columns, ridge::single::<R>(config.ridge)); CANDIDATES],
            Ridge::Default | Ridge::Auto => {
                let [weak, strong] = STRENGTHS;
                [(columns, weak), (columns, strong), (first_degree, weak), (first_degree, strong)]
            }
        };
        let used = if matches!(config.ridge, Ridge::Fixed(_)) { 1 } else { CANDIDATES };
        for (own, estimates) in rows(self.sums, len).zip(rows_mut(estimates, each)) {
            for ((train, &total), &own) in train.iter_mut().zip(self.total.iter()).zip(own) {
                *train = total - own;
            }
            let (Some(train), Some(own)) =
                (Moments::new(train, columns + 1, channels), Moments::new(own, columns + 1, channels))
            else {
                return Err(Error::Memory);
            };
            let inverse = R::ONE / own.count();
            let (plain, fitted) = estimates.split_at_mut_checked(channels).ok_or(Error::Memory)?;
            for (channel, out) in plain.iter_mut().enumerate() {
                *out = own.total(channel) * inverse;
            }
            for (&(columns, strength), out) in fits.iter().zip(rows_mut(fitted, channels)).take(used) {
                let mut arena = arena.scratch();
                let coefficients = coefficients.get_mut(..columns * channels).unwrap_or(&mut []);
                for value in coefficients.iter_mut() {
                    *value = R::ZERO;
                }
                // A block of one pixel has nothing to train on: the plain mean.
                if let Some(centred) = Centred::new(&train, columns, channels, &mut arena)? {
                    centred.solve(penalties, R::from_f64(strength), coefficients, false, &mut arena)?;
                }
                for (channel, out) in out.iter_mut().enumerate() {
                    let b = coefficients.get(channel * columns..(channel + 1) * columns).unwrap_or(&[]);
                    *out = own.residual_total(channel, b) * inverse;
                }
            }
        }
        let (weights, gain) = self.weigh(estimates, each, config.ridge);
        for (pixel, (own, estimates)) in rows(self.sums, len).zip(rows(estimates, each)).enumerate() {
            let own = Moments::new(own, columns + 1, channels).ok_or(Error::Memory)?;
            out(pixel, self.pixel(&own, estimates, &weights, &gain));
        }
        Ok(())
    }

    /// Weights of the plain mean and of each fit, and the variance across pixels relative to the plain mean's.
    fn weigh(&self, estimates: &[R], each: usize, ridge: Ridge) -> ([PerChannel<R>; CANDIDATES + 1], PerChannel<R>) {
        let mut weights = [PerChannel::default(); CANDIDATES + 1];
        let mut gain = [R::ONE; Config::MAX_CHANNELS];
        for channel in 0..self.channels {
            let spread = |candidate: usize| {
                let values = || {
                    let row = rows(estimates, each);
                    row.filter_map(move |row| row.get(candidate * self.channels + channel)).copied()
                };
                let mean = values().fold(R::ZERO, |sum, value| sum + value) / R::from_usize(self.pixels);
                values().fold(R::ZERO, |sum, value| sum + (value - mean) * (value - mean))
            };
            let plain = spread(0);
            let mut spreads = [R::ZERO; CANDIDATES];
            for (candidate, value) in spreads.iter_mut().enumerate() {
                *value = spread(candidate + 1);
            }
            let (plain_weight, fit_weights) = if matches!(ridge, Ridge::Fixed(_)) {
                let mut only = [R::ZERO; CANDIDATES];
                only[0] = R::ONE;
                (R::ZERO, only)
            } else {
                let power = R::from_usize(self.pixels) * R::from_f64(trust::SHARPNESS);
                let mut weights = [R::ZERO; CANDIDATES];
                let pixels = R::from_usize(self.pixels);
                let plain = trust::weigh(plain, &spreads, &[], power, pixels, &mut weights);
                (plain, weights)
            };
            let all = [plain_weight].into_iter().chain(fit_weights);
            let mut mixed = R::ZERO;
            for ((slot, weight), value) in weights.iter_mut().zip(all).zip([plain].into_iter().chain(spreads)) {
                set(slot, channel, weight);
                mixed += weight * value;
            }
            if plain > R::ZERO {
                set(&mut gain, channel, mixed / plain);
            }
        }
        (weights, gain)
    }

    fn pixel(
        &self,
        own: &Moments<'_, R>,
        estimates: &[R],
        weights: &[PerChannel<R>; CANDIDATES + 1],
        gain: &PerChannel<R>,
    ) -> Estimate {
        let mut outcome = Outcome { correction: PerChannel::default(), variance: None };
        let mut variance = PerChannel::default();
        let mut plain_variance = PerChannel::default();
        // As everywhere the zero is the pixel's plain mean, which is what remains of a correction that is not finite.
        let mut units = self.units;
        let n = own.count();
        for (channel, unit) in units.iter_mut().enumerate().take(self.channels) {
            let total = own.total(channel);
            let mean = total / n;
            unit.offset += mean;
            for (row, weights) in rows(estimates, self.channels).zip(weights) {
                let value = row.get(channel).copied().unwrap_or(R::ZERO);
                add(&mut outcome.correction, channel, get(weights, channel) * (value - mean));
            }
            let plain = (own.square(channel) - total * mean).max(R::ZERO) / (n * (n - R::ONE));
            set(&mut plain_variance, channel, plain);
            set(&mut variance, channel, plain * get(gain, channel));
        }
        outcome.variance = (self.n > 1).then_some(variance);
        let plain_variance = (self.n > 1).then_some(plain_variance);
        let is_usable = outcome.correction.iter().all(|value| value.is_finite());
        let summary = Summary { samples: self.n, channels: self.channels, units, plain_variance, colour: None };
        let mut estimate = result::finish(summary, outcome);
        let sum = gain.iter().take(self.channels).fold(R::ZERO, |sum, &gain| sum + gain);
        // The block's, which also one sample a pixel has.
        estimate.gain = if is_usable { (sum / R::from_usize(self.channels.max(1))).to_f32() } else { 1.0 };
        estimate
    }
}
