//! Estimates from per-fold sums, whose fits are weighted by their errors on folds they have not seen.
//!
//! - [`pooled`], robust: between a fit to all folds and the cross-fit, weighted by all held-out errors. The fit to all
//!   keeps what is even about all samples together, the cross-fit has no bias: where samples lie says how much of each
//!   is used.
//! - [`nested`], K-fold: each fold is corrected by a fit to the others, and weighted by fits that know neither that
//!   fold nor the one that judges them. Exactly unbiased.

use super::config::{Config, Ridge};
use super::moments::{self, Centred, Moments};
use super::per_channel::{PerChannel, add, get, set};
use super::result::{self, Outcome};
use super::ridge::{self, MIXED};
use super::trust::{self, Centre};
use crate::arena::Arena;
use crate::basis::Basis;
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

/// Numbers that an estimate takes from its arena beyond one fit and one group of sums.
pub(crate) fn len(columns: usize, channels: usize) -> usize {
    CANDIDATES * columns * channels
}

impl<'a, R: Real> Groups<'a, R> {
    fn group(&self, fold: usize) -> Option<Moments<'a, R>> {
        let len = moments::len(self.columns + 1, self.channels);
        Moments::new(self.sums.get(fold * len..(fold + 1) * len)?, self.columns + 1, self.channels)
    }

    /// The folds that hold samples.
    fn each(&self) -> impl Iterator<Item = (usize, Moments<'a, R>)> {
        let filled = |fold| self.group(fold).filter(|group| group.count() > R::ZERO);
        (0..self.folds).filter_map(move |fold| Some((fold, filled(fold)?)))
    }

    /// Whether at least so many folds hold samples.
    pub(crate) fn has(&self, folds: usize) -> bool {
        self.each().count() >= folds
    }

    /// Writes the sums of all folds but those left out; None for a buffer that is too short.
    fn train<'b>(&self, left_out: &[usize], sums: &'b mut [R]) -> Option<Moments<'b, R>> {
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

/// What both estimates work with.
struct Problem<'p, 'a, R> {
    groups: &'p Groups<'a, R>,
    config: &'p Config,
    basis: &'p Basis,
    strengths: &'p [f64],
    /// Whether the one strength was asked for, so that nothing is weighed.
    is_fixed: bool,
}

/// What is added to the plain mean, robust, of two folds or more; `plain` is the mean and its variance in the sums'
/// units.
pub(crate) fn pooled<R: Real>(
    groups: &Groups<'_, R>,
    config: &Config,
    basis: &Basis,
    plain: (&PerChannel<R>, &PerChannel<R>),
    arena: &mut Arena<'_, R>,
) -> Result<Outcome<R>, Error> {
    let problem = Problem { groups, config, basis, strengths: &MIXED, is_fixed: false };
    let channels = groups.channels;
    let coefficients = arena.take(CANDIDATES * groups.columns * channels)?;
    let train = arena.take(moments::len(groups.columns + 1, channels))?;
    let mut judge = Judge::default();
    // Sums of f - b'p over the folds, b from the others.
    let mut crossed = Errors::default();
    for (fold, held_out) in groups.each() {
        let train = groups.train(&[fold], train).ok_or(Error::Memory)?;
        problem.fit(&train, coefficients, arena)?;
        judge.add(&train, &held_out, groups, coefficients);
        for channel in 0..channels {
            for (candidate, crossed) in crossed.iter_mut().enumerate() {
                let b = row_of(coefficients, candidate, channel, groups);
                add(crossed, channel, held_out.residual_total(channel, b));
            }
        }
    }
    let all = groups.train(&[], train).ok_or(Error::Memory)?;
    let centres = problem.fit(&all, coefficients, arena)?;
    let (n, inverse) = (all.count(), R::ONE / all.count());
    let factor = result::press_factor(n);
    let mut outcome = Outcome { correction: PerChannel::default(), variance: None };
    let mut variance = PerChannel::default();
    for channel in 0..channels {
        let (mean, mean_variance) = (get(plain.0, channel), get(plain.1, channel));
        let mut corrections = [R::ZERO; CANDIDATES];
        let mut discounts = [R::ZERO; CANDIDATES];
        let each = corrections.iter_mut().zip(&mut discounts).zip(&centres).zip(&crossed).enumerate();
        for (candidate, (((correction, discount), centre), crossed)) in each {
            let b = row_of(coefficients, candidate, channel, groups);
            let whole = all.residual_total(channel, b) * inverse - mean;
            let share = centre.map_or(R::ZERO, |centre| centre.share());
            *correction = whole + share * (get(crossed, channel) * inverse - mean - whole);
            *discount = trust::surprise(*correction, mean_variance);
            *discount += centre.map_or(R::ZERO, |centre| centre.discount());
        }
        let (plain_weight, weights) = judge.weigh(channel, &problem, &discounts);
        let mut total = R::ZERO;
        for (&weight, &correction) in weights.iter().zip(&corrections) {
            total += weight * correction;
        }
        let mut sum = plain_weight * (get(&judge.plain, channel) * factor + total * total);
        for (candidate, (&weight, &correction)) in weights.iter().zip(&corrections).enumerate() {
            let inflation = centres.get(candidate).copied().flatten().map_or(R::ONE, |centre| centre.inflation);
            let error = judge.errors.get(candidate).map_or(R::ZERO, |errors| get(errors, channel));
            sum += weight * (error * factor * inflation + (correction - total) * (correction - total));
        }
        set(&mut outcome.correction, channel, total);
        set(&mut variance, channel, sum);
    }
    outcome.variance = Some(variance);
    Ok(outcome)
}

/// What is added to the plain `mean`, unbiased, of two folds, or three or more.
pub(crate) fn nested<R: Real>(
    groups: &Groups<'_, R>,
    config: &Config,
    basis: &Basis,
    mean: &PerChannel<R>,
    arena: &mut Arena<'_, R>,
) -> Result<Outcome<R>, Error> {
    // With two folds no third is left to judge a fit: one ridge it is.
    let is_fixed = groups.folds < 3 || matches!(config.ridge, Ridge::Fixed(_));
    let fixed = [ridge::single::<R>(config.ridge)];
    let strengths: &[f64] = if is_fixed { &fixed } else { &MIXED };
    let problem = Problem { groups, config, basis, strengths, is_fixed };
    let channels = groups.channels;
    let coefficients = arena.take(CANDIDATES * groups.columns * channels)?;
    let train = arena.take(moments::len(groups.columns + 1, channels))?;
    let mut sums = PerChannel::default();
    let mut press = PerChannel::default();
    let mut count = R::ZERO;
    for (fold, held_out) in groups.each() {
        count += held_out.count();
        let mut judge = Judge::default();
        let mut discounts = [R::ZERO; CANDIDATES];
        for (other, judging) in groups.each().filter(|&(other, _)| other != fold) {
            let train = groups.train(&[fold, other], train).ok_or(Error::Memory)?;
            let centres = problem.fit(&train, coefficients, arena)?;
            judge.add(&train, &judging, groups, coefficients);
            for (discount, centre) in discounts.iter_mut().zip(centres) {
                *discount += centre.map_or(R::ZERO, |centre| centre.discount());
            }
        }
        let discounts = discounts.map(|total| total / judge.fits.max(R::ONE));
        let train = groups.train(&[fold], train).ok_or(Error::Memory)?;
        let centres = problem.fit(&train, coefficients, arena)?;
        let inverse = if train.count() > R::ZERO { R::ONE / train.count() } else { R::ZERO };
        for channel in 0..channels {
            let (mut inflation, mut weights) = judge.weigh(channel, &problem, &discounts);
            for (weight, centre) in weights.iter_mut().zip(&centres) {
                let (mut share, mut factor) = (R::ONE, R::ONE);
                if let Some(centre) = centre {
                    factor = centre.inflation;
                    share = if is_fixed { R::ONE } else { centre.independence() };
                }
                let kept = *weight * share;
                inflation += *weight - kept + kept * factor;
                *weight = kept;
            }
            // The mixture's coefficients, in place of the first candidate's.
            for j in 0..groups.columns {
                let mut mixed = R::ZERO;
                for (candidate, &weight) in weights.iter().enumerate() {
                    mixed +=
                        weight * row_of(coefficients, candidate, channel, groups).get(j).copied().unwrap_or(R::ZERO);
                }
                if let Some(out) = coefficients.get_mut(channel * groups.columns + j) {
                    *out = mixed;
                }
            }
            let b = row_of(coefficients, 0, channel, groups);
            let a = train.residual_total(channel, b) * inverse;
            add(&mut sums, channel, held_out.residual_total(channel, b));
            add(&mut press, channel, held_out.residual_square(channel, channels, a, b) * inflation);
        }
    }
    let mut correction = PerChannel::default();
    for ((correction, sum), &mean) in correction.iter_mut().zip(sums).zip(mean) {
        *correction = sum / count - mean;
    }
    let factor = result::press_factor(count);
    Ok(Outcome { correction, variance: Some(press.map(|press| press * factor)) })
}

impl<R: Real> Problem<'_, '_, R> {
    /// Writes every candidate's coefficients for a training set, zero where there is no sample, and says where its
    /// samples lie.
    fn fit(
        &self,
        train: &Moments<'_, R>,
        coefficients: &mut [R],
        arena: &mut Arena<'_, R>,
    ) -> Result<[Option<Centre<R>>; CANDIDATES], Error> {
        let mut arena = arena.scratch();
        let mut centres = [None; CANDIDATES];
        for value in coefficients.iter_mut() {
            *value = R::ZERO;
        }
        let (columns, channels) = (self.groups.columns, self.groups.channels);
        let penalties = arena.take(columns)?;
        if let Some(centred) = Centred::new(train, columns, channels, &mut arena)? {
            // From the training set alone, as the coefficients.
            ridge::penalties(self.config, self.basis, |j| train.mean_square(j), penalties);
            let candidates = self.strengths.iter().zip(rows_mut(coefficients, columns * channels)).zip(&mut centres);
            for ((&strength, coefficients), centre) in candidates {
                let strength = R::from_f64(strength);
                *centre = centred.solve(penalties, strength, coefficients, true, &mut arena.scratch())?;
            }
        }
        Ok(centres)
    }
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
    /// How many fits were judged.
    fits: R,
}

impl<R: Real> Default for Judge<R> {
    fn default() -> Self {
        Self { errors: Default::default(), plain: Default::default(), count: R::ZERO, fits: R::ZERO }
    }
}

impl<R: Real> Judge<R> {
    /// Adds the errors on one group of the fits to another.
    fn add(&mut self, train: &Moments<'_, R>, judging: &Moments<'_, R>, groups: &Groups<'_, R>, coefficients: &[R]) {
        self.count += judging.count();
        self.fits += R::ONE;
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

    /// A channel's weights of the plain mean and of the candidates; a ridge of the caller's choice gets all.
    fn weigh(&self, channel: usize, problem: &Problem<'_, '_, R>, discounts: &[R; CANDIDATES]) -> (R, [R; CANDIDATES]) {
        let mut weights = [R::ZERO; CANDIDATES];
        if problem.is_fixed {
            weights[0] = R::ONE;
            return (R::ZERO, weights);
        }
        let power = self.count * R::from_f64(trust::SHARPNESS);
        let errors = self.errors.map(|errors| get(&errors, channel));
        let prior = trust::prior(self.count);
        let plain = trust::weigh(get(&self.plain, channel), &errors, discounts, power, self.count, prior, &mut weights);
        (plain, weights)
    }
}
