//! Estimates from per-fold sums, whose fits are weighted by their errors on folds they have not seen.
//!
//! - [`pooled`], robust: between a fit to all folds and the cross-fit, weighted by all held-out errors. The fit to all
//!   keeps what is even about all samples together, the cross-fit has no bias: where samples lie says how much of each
//!   is used.
//! - [`nested`], K-fold: each fold is corrected by a fit to the others, and weighted by fits that know neither that
//!   fold nor the one that judges them. Exactly unbiased.

use super::config::{Config, Ridge};
use super::fit::Penalty;
use super::fit::normal::Centred;
use super::per_channel::PerChannel;
use super::result::{self, Outcome};
use super::ridge::{self, MIXED};
use super::sums::{self, Layout, Sums};
use super::trust::{self, Centre};
use crate::arena::Arena;
use crate::basis::Basis;
use crate::error::Error;
use crate::matrix::{at, row_at};
use crate::real::Real;
use crate::rows::{rows, rows_mut};

/// The number of candidates besides the plain mean.
const FITS: usize = MIXED.len();

/// An accumulator's sums, fold after fold.
pub(crate) struct Groups<'a, R> {
    pub(crate) sums: &'a [R],
    pub(crate) folds: usize,
    pub(crate) layout: Layout,
}

/// Candidate fits and their squared errors.
type Errors<R> = [PerChannel<R>; FITS];

/// Numbers that an estimate takes from its arena beyond one fit.
pub(crate) fn len(layout: Layout) -> usize {
    FITS * layout.columns * layout.channels + layout.len()
}

impl<'a, R: Real> Groups<'a, R> {
    /// The folds that hold samples.
    fn each(&self) -> impl Iterator<Item = (usize, Sums<&'a [R]>)> {
        let filled = |fold| self.layout.group(self.sums, fold).ok().filter(|group| group.count() > R::ZERO);
        (0..self.folds).filter_map(move |fold| Some((fold, filled(fold)?)))
    }

    /// Whether at least so many folds hold samples.
    pub(crate) fn has(&self, folds: usize) -> bool {
        self.each().count() >= folds
    }

    /// Writes the sums of all folds but those left out.
    fn train<'b>(&self, left_out: &[usize], sums: &'b mut [R]) -> Result<Sums<&'b [R]>, Error> {
        sums.fill(R::ZERO);
        for (fold, group) in rows(self.sums, self.layout.len()).take(self.folds).enumerate() {
            if !left_out.contains(&fold) {
                sums::add(sums, group);
            }
        }
        self.layout.group(sums, 0)
    }
}

struct Candidates<'p, 'a, R> {
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
    let candidates = Candidates { groups, config, basis, strengths: &MIXED, is_fixed: false };
    let Layout { columns, channels, .. } = groups.layout;
    let coefficients = arena.take(FITS * columns * channels)?;
    let train = arena.take(groups.layout.len())?;
    let mut judge = Judge::default();
    // Sums of f - b'p over the folds, b from the others.
    let mut crossed = Errors::<R>::default();
    for (fold, held_out) in groups.each() {
        let train = groups.train(&[fold], train)?;
        candidates.fit(&train, coefficients, arena)?;
        judge.add(&train, &held_out, groups, coefficients);
        for channel in 0..channels {
            for (candidate, crossed) in crossed.iter_mut().enumerate() {
                let b = row_of(coefficients, candidate, channel, groups);
                crossed[channel] += held_out.residual_total(channel, b);
            }
        }
    }
    let all = groups.train(&[], train)?;
    let centres = candidates.fit(&all, coefficients, arena)?;
    let (n, inverse) = (all.count(), R::ONE / all.count());
    let factor = result::press_factor(n);
    let mut outcome = Outcome { correction: PerChannel::default(), variance: None };
    let mut variance = PerChannel::default();
    for channel in 0..channels {
        let (mean, mean_variance) = (plain.0[channel], plain.1[channel]);
        let mut corrections = [R::ZERO; FITS];
        let mut discounts = [R::ZERO; FITS];
        let each = corrections.iter_mut().zip(&mut discounts).zip(&centres).zip(&crossed).enumerate();
        for (candidate, (((correction, discount), centre), crossed)) in each {
            let b = row_of(coefficients, candidate, channel, groups);
            let whole = all.residual_total(channel, b) * inverse - mean;
            let share = centre.map_or(R::ZERO, |centre| centre.share());
            *correction = whole + share * (crossed[channel] * inverse - mean - whole);
            *discount = trust::surprise(*correction, mean_variance);
            *discount += centre.map_or(R::ZERO, |centre| centre.discount());
        }
        let (plain_weight, weights) = judge.weigh(channel, &candidates, &discounts);
        let mut total = R::ZERO;
        for (&weight, &correction) in weights.iter().zip(&corrections) {
            total += weight * correction;
        }
        let mut sum = plain_weight * (judge.plain[channel] * factor + total * total);
        for (candidate, (&weight, &correction)) in weights.iter().zip(&corrections).enumerate() {
            let inflation = centres.get(candidate).copied().flatten().map_or(R::ONE, |centre| centre.inflation);
            let error = judge.errors.get(candidate).map_or(R::ZERO, |errors| errors[channel]);
            sum += weight * (error * factor * inflation + (correction - total) * (correction - total));
        }
        outcome.correction[channel] = total;
        variance[channel] = sum;
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
    let candidates = Candidates { groups, config, basis, strengths, is_fixed };
    let Layout { columns, channels, .. } = groups.layout;
    let coefficients = arena.take(FITS * columns * channels)?;
    let train = arena.take(groups.layout.len())?;
    let mut sums = PerChannel::<R>::default();
    let mut press = PerChannel::<R>::default();
    let mut count = R::ZERO;
    for (fold, held_out) in groups.each() {
        count += held_out.count();
        let mut judge = Judge::default();
        let mut discounts = [R::ZERO; FITS];
        for (other, judging) in groups.each().filter(|&(other, _)| other != fold) {
            let train = groups.train(&[fold, other], train)?;
            let centres = candidates.fit(&train, coefficients, arena)?;
            judge.add(&train, &judging, groups, coefficients);
            for (discount, centre) in discounts.iter_mut().zip(centres) {
                *discount += centre.map_or(R::ZERO, |centre| centre.discount());
            }
        }
        let discounts = discounts.map(|total| total / judge.fits.max(R::ONE));
        let train = groups.train(&[fold], train)?;
        let centres = candidates.fit(&train, coefficients, arena)?;
        let inverse = if train.count() > R::ZERO { R::ONE / train.count() } else { R::ZERO };
        for channel in 0..channels {
            let (mut inflation, mut weights) = judge.weigh(channel, &candidates, &discounts);
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
            for j in 0..columns {
                let mut mixed = R::ZERO;
                for (candidate, &weight) in weights.iter().enumerate() {
                    mixed += weight * at(row_of(coefficients, candidate, channel, groups), j);
                }
                if let Some(out) = coefficients.get_mut(channel * columns + j) {
                    *out = mixed;
                }
            }
            let b = row_of(coefficients, 0, channel, groups);
            let a = train.residual_total(channel, b) * inverse;
            sums[channel] += held_out.residual_total(channel, b);
            press[channel] += held_out.residual_square(channel, a, b) * inflation;
        }
    }
    let mut correction = PerChannel::default();
    for ((correction, &sum), &mean) in correction.iter_mut().zip(sums.iter()).zip(mean.iter()) {
        *correction = sum / count - mean;
    }
    let factor = result::press_factor(count);
    Ok(Outcome { correction, variance: Some(press.map(|press| press * factor)) })
}

impl<R: Real> Candidates<'_, '_, R> {
    /// Writes every candidate's coefficients for a training set, zero where there is no sample, and says where its
    /// samples lie.
    fn fit(
        &self,
        train: &Sums<&[R]>,
        coefficients: &mut [R],
        arena: &mut Arena<'_, R>,
    ) -> Result<[Option<Centre<R>>; FITS], Error> {
        let mut arena = arena.scratch();
        let mut centres = [None; FITS];
        coefficients.fill(R::ZERO);
        let Layout { columns, channels, .. } = self.groups.layout;
        let penalties = arena.take(columns)?;
        if let Some(centred) = Centred::new(train, &mut arena)? {
            // From the training set alone, as the coefficients.
            ridge::penalties(self.config, self.basis, |j| train.mean_square(j), penalties);
            let candidates = self.strengths.iter().zip(rows_mut(coefficients, columns * channels)).zip(&mut centres);
            for ((&strength, coefficients), centre) in candidates {
                let mut arena = arena.scratch();
                let penalty = Penalty { strength: R::from_f64(strength), relative: penalties };
                let factor = centred.normal.solve(penalty, coefficients, &mut arena)?;
                *centre = centred.normal.centre(&factor, penalty, arena)?;
            }
        }
        Ok(centres)
    }
}

fn row_of<'c, R>(coefficients: &'c [R], candidate: usize, channel: usize, groups: &Groups<'_, R>) -> &'c [R] {
    row_at(coefficients, groups.layout.columns, candidate * groups.layout.channels + channel)
}

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
    fn add(&mut self, train: &Sums<&[R]>, judging: &Sums<&[R]>, groups: &Groups<'_, R>, coefficients: &[R]) {
        self.count += judging.count();
        self.fits += R::ONE;
        let inverse = if train.count() > R::ZERO { R::ONE / train.count() } else { R::ZERO };
        for channel in 0..groups.layout.channels {
            let mean = train.total(channel) * inverse;
            let error = judging.residual_square(channel, mean, &[]);
            self.plain[channel] += error;
            for (candidate, errors) in self.errors.iter_mut().enumerate() {
                let b = row_of(coefficients, candidate, channel, groups);
                let a = train.residual_total(channel, b) * inverse;
                let error = judging.residual_square(channel, a, b);
                errors[channel] += error;
            }
        }
    }

    /// A channel's weights of the plain mean and of the candidates; a ridge of the caller's choice gets all.
    fn weigh(&self, channel: usize, candidates: &Candidates<'_, '_, R>, discounts: &[R; FITS]) -> (R, [R; FITS]) {
        let mut weights = [R::ZERO; FITS];
        if candidates.is_fixed {
            weights[0] = R::ONE;
            return (R::ZERO, weights);
        }
        let power = self.count * R::from_f64(trust::SHARPNESS);
        let errors = self.errors.map(|errors| errors[channel]);
        let prior = trust::prior(self.count);
        let plain = trust::weigh(self.plain[channel], &errors, discounts, power, self.count, prior, &mut weights);
        (plain, weights)
    }
}
