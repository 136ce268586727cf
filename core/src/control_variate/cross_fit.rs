//! Cross-fit estimates from per-fold sums.
//!
//! Each fold's samples are corrected by fits to the other folds, and the fits are weighted by their held-out errors.
//! Pooled weights, from all held-out errors, are the sharper choice and make the weights depend a little on the samples
//! they weight. Nested weights, for fold j from fits that know neither fold j nor the fold that judges them, keep the
//! estimate exactly unbiased.

use super::config::Ridge;
use super::moments::{self, Centred, Moments};
use super::per_channel::{PerChannel, add, get, set};
use super::result::{self, Outcome};
use super::ridge::{self, MIXED};
use super::trust;
use crate::arena::Arena;
use crate::error::Error;
use crate::real::Real;
use crate::rows::{rows, rows_mut};

/// The number of candidates besides the plain mean.
const CANDIDATES: usize = MIXED.len();

/// An accumulator's sums, fold after fold.
pub(crate) struct Groups<'a, R> {
    pub(crate) sums: &'a [R],
    pub(crate) folds: usize,
    pub(crate) columns: usize,
    pub(crate) channels: usize,
}

/// Candidate fits and their squared errors.
type Errors<R> = [PerChannel<R>; CANDIDATES];

/// Numbers that [`estimate`] takes from its arena beyond one fit and one group of sums.
pub(crate) fn len(columns: usize, channels: usize) -> usize {
    CANDIDATES * columns * channels
}

impl<'a, R: Real> Groups<'a, R> {
    fn group(&self, fold: usize) -> Option<Moments<'a, R>> {
        let len = moments::len(self.columns + 1, self.channels);
        Moments::new(self.sums.get(fold * len..(fold + 1) * len)?, self.columns + 1, self.channels)
    }

    /// Writes the sums of all folds but those left out; None for a buffer that is too short.
    fn train<'b>(&self, left_out: [usize; 2], sums: &'b mut [R]) -> Option<Moments<'b, R>> {
        for value in sums.iter_mut() {
            *value = R::ZERO;
        }
        let len = moments::len(self.columns + 1, self.channels);
        for (fold, group) in rows(self.sums, len).take(self.folds).enumerate() {
            if !left_out.contains(&fold) {
                moments::add_sums(sums, group);
            }
        }
        Moments::new(sums, self.columns + 1, self.channels)
    }
}

/// The estimate in the sums' units.
pub(crate) fn estimate<R: Real>(
    groups: &Groups<'_, R>,
    penalties: &[R],
    ridge: Ridge,
    nested: bool,
    arena: &mut Arena<'_, R>,
) -> Result<Outcome<R>, Error> {
    // The mixture has its own ridges. With two nested folds no third is left to judge a fit: one ridge it is.
    let ridge = if nested { ridge } else { Ridge::Default };
    let ridge = if nested && groups.folds < 3 { Ridge::Fixed(ridge::single::<R>(ridge) as f32) } else { ridge };
    let fixed = [ridge::single::<R>(ridge)];
    let strengths: &[f64] = if matches!(ridge, Ridge::Default | Ridge::Auto) { &MIXED } else { &fixed };
    let channels = groups.channels;
    let coefficients = arena.take(CANDIDATES * groups.columns * channels)?;
    let train = arena.take(moments::len(groups.columns + 1, channels))?;
    let mut pooled = Judge::default();
    // Means of f - b'p over each fold, for each candidate and for the plain mean, summed with the folds' weights.
    let mut sums = [PerChannel::<R>::default(); CANDIDATES];
    let mut plain_sum = PerChannel::default();
    let mut nested_sum = PerChannel::default();
    let mut nested_press = PerChannel::default();
    let mut count = R::ZERO;
    for fold in 0..groups.folds {
        let Some(held_out) = groups.group(fold).filter(|group| group.count() > R::ZERO) else { continue };
        count += held_out.count();
        let weights = if nested {
            let mut judge = Judge::default();
            for other in (0..groups.folds).filter(|&other| other != fold) {
                let Some(judging) = groups.group(other).filter(|group| group.count() > R::ZERO) else { continue };
                let train = groups.train([fold, other], train).ok_or(Error::Memory)?;
                let discounts = fit(&train, groups, penalties, strengths, coefficients, &mut arena.scratch())?;
                judge.add(&train, &judging, groups, &discounts, coefficients);
            }
            Some(judge.weights(channels, strengths.len(), ridge))
        } else {
            None
        };
        let train = groups.train([fold, fold], train).ok_or(Error::Memory)?;
        let discounts = fit(&train, groups, penalties, strengths, coefficients, &mut arena.scratch())?;
        let mut own = Judge::default();
        own.add(&train, &held_out, groups, &discounts, coefficients);
        for channel in 0..channels {
            let plain = held_out.total(channel);
            add(&mut plain_sum, channel, plain);
            for (candidate, sum) in sums.iter_mut().enumerate().take(strengths.len()) {
                let b = row_of(coefficients, candidate, channel, groups);
                let total = held_out.residual_total(channel, b);
                add(sum, channel, total);
                if let Some((_, weights)) = &weights {
                    let weight = weights.get(candidate).map_or(R::ZERO, |weights| get(weights, channel));
                    add(&mut nested_sum, channel, weight * total);
                    let error = own.errors.get(candidate).map_or(R::ZERO, |errors| get(errors, channel));
                    add(&mut nested_press, channel, weight * error);
                }
            }
            if let Some((plain_weights, _)) = &weights {
                let weight = get(plain_weights, channel);
                add(&mut nested_sum, channel, weight * plain);
                add(&mut nested_press, channel, weight * get(&own.plain, channel));
            }
        }
        pooled.merge(&own);
    }
    let mut outcome = Outcome { correction: PerChannel::default(), variance: None };
    let mut press = nested_press;
    let (plain_weights, weights) = pooled.weights(channels, strengths.len(), ridge);
    for channel in 0..channels {
        let total = if nested {
            get(&nested_sum, channel)
        } else {
            let mut total = get(&plain_weights, channel) * get(&plain_sum, channel);
            let mut error = get(&plain_weights, channel) * get(&pooled.plain, channel);
            for ((weights, sum), errors) in weights.iter().zip(&sums).zip(&pooled.errors) {
                total += get(weights, channel) * get(sum, channel);
                error += get(weights, channel) * get(errors, channel);
            }
            set(&mut press, channel, error);
            total
        };
        set(&mut outcome.correction, channel, total / count);
    }
    outcome.variance = result::variance_of_press(&press, count.to_f64() as usize);
    Ok(outcome)
}

/// Every candidate's coefficients for a training set, zero where there is no sample, and the discounts of their trust.
fn fit<R: Real>(
    train: &Moments<'_, R>,
    groups: &Groups<'_, R>,
    penalties: &[R],
    strengths: &[f64],
    coefficients: &mut [R],
    arena: &mut Arena<'_, R>,
) -> Result<[R; CANDIDATES], Error> {
    let mut discounts = [R::ZERO; CANDIDATES];
    for value in coefficients.iter_mut() {
        *value = R::ZERO;
    }
    let each = groups.columns * groups.channels;
    if let Some(centred) = Centred::new(train, groups.columns, groups.channels, arena)? {
        let candidates = strengths.iter().zip(rows_mut(coefficients, each)).zip(&mut discounts);
        for ((&strength, coefficients), discount) in candidates {
            *discount = centred.solve(penalties, R::from_f64(strength), coefficients, true, &mut arena.scratch())?;
        }
    }
    Ok(discounts)
}

fn row_of<'c, R>(coefficients: &'c [R], candidate: usize, channel: usize, groups: &Groups<'_, R>) -> &'c [R] {
    let start = (candidate * groups.channels + channel) * groups.columns;
    coefficients.get(start..start + groups.columns).unwrap_or(&[])
}

/// Held-out errors.
#[derive(Clone, Copy)]
struct Judge<R> {
    errors: Errors<R>,
    plain: PerChannel<R>,
    count: R,
    /// Sums of the fits' discounts, and their number.
    discounts: [R; CANDIDATES],
    fits: R,
}

impl<R: Real> Default for Judge<R> {
    fn default() -> Self {
        Self {
            errors: Default::default(),
            plain: Default::default(),
            count: R::ZERO,
            discounts: [R::ZERO; CANDIDATES],
            fits: R::ZERO,
        }
    }
}

impl<R: Real> Judge<R> {
    /// Adds the errors on one group of the fits to another.
    fn add(
        &mut self,
        train: &Moments<'_, R>,
        judging: &Moments<'_, R>,
        groups: &Groups<'_, R>,
        discounts: &[R; CANDIDATES],
        coefficients: &[R],
    ) {
        self.count += judging.count();
        self.fits += R::ONE;
        for (total, &discount) in self.discounts.iter_mut().zip(discounts) {
            *total += discount;
        }
        let inverse = if train.count() > R::ZERO { R::ONE / train.count() } else { R::ZERO };
        for channel in 0..groups.channels {
            let mean = train.total(channel) * inverse;
            let error = judging.residual_square(channel, groups.channels, mean, &[]);
            add(&mut self.plain, channel, error);
            for (candidate, errors) in self.errors.iter_mut().enumerate() {
                let b = row_of(coefficients, candidate, channel, groups);
                let a = train.residual_total(channel, b) * inverse;
                let error = judging.residual_square(channel, groups.channels, a, b);
                add(errors, channel, error);
            }
        }
    }

    fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.fits += other.fits;
        for (ours, &theirs) in self.discounts.iter_mut().zip(&other.discounts) {
            *ours += theirs;
        }
        let pairs = self.errors.iter_mut().zip(&other.errors).chain([(&mut self.plain, &other.plain)]);
        for (ours, theirs) in pairs {
            for (ours, &theirs) in ours.iter_mut().zip(theirs) {
                *ours += theirs;
            }
        }
    }

    /// Weights of the plain mean and of the candidates; a ridge of the caller's choice gets all.
    fn weights(&self, channels: usize, candidates: usize, ridge: Ridge) -> (PerChannel<R>, Errors<R>) {
        let mut plain_weights = PerChannel::default();
        let mut weights = Errors::default();
        for channel in 0..channels {
            if matches!(ridge, Ridge::Fixed(_)) {
                if let Some(weights) = weights.first_mut() {
                    set(weights, channel, R::ONE);
                }
                continue;
            }
            let mut errors = [R::ZERO; CANDIDATES];
            for (error, all) in errors.iter_mut().zip(&self.errors).take(candidates) {
                *error = get(all, channel);
            }
            let power = self.count * R::from_f64(trust::SHARPNESS);
            let discounts = self.discounts.map(|total| total / self.fits.max(R::ONE));
            let mut each = [R::ZERO; CANDIDATES];
            let plain = trust::weigh(get(&self.plain, channel), &errors, &discounts, power, self.count, &mut each);
            set(&mut plain_weights, channel, plain);
            for (weights, weight) in weights.iter_mut().zip(each) {
                set(weights, channel, weight);
            }
        }
        (plain_weights, weights)
    }
}
