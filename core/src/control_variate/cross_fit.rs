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
use super::trust::{Centre, Judge, Mixture};
use crate::arena::Arena;
use crate::basis::Basis;
use crate::matrix::{at, first, rows, rows_mut, set};
use crate::real::Real;

/// The number of candidates besides the plain mean.
const FITS: usize = MIXED.len();

/// An accumulator's sums, fold after fold, and how they are fitted.
pub(crate) struct Groups<'a, R> {
    pub(crate) sums: &'a [R],
    pub(crate) folds: usize,
    pub(crate) layout: Layout,
    pub(crate) config: &'a Config,
    pub(crate) basis: &'a Basis,
}

/// Numbers that an estimate takes from its arena beyond one fit.
pub(crate) fn len(layout: Layout) -> usize {
    FITS * layout.coefficients() + layout.len()
}

impl<'a, R: Real> Groups<'a, R> {
    /// The folds that hold samples.
    fn each(&self) -> impl Iterator<Item = (usize, Sums<&'a [R]>)> {
        let groups = (0..self.folds).map(|fold| (fold, self.layout.group(self.sums, fold)));
        groups.filter(|(_, group)| group.count() > R::ZERO)
    }

    /// How many folds hold samples.
    pub(crate) fn filled(&self) -> usize {
        self.each().count()
    }

    /// Writes the sums of all folds but those left out.
    fn train<'b>(&self, left_out: &[usize], sums: &'b mut [R]) -> Sums<&'b [R]> {
        sums.fill(R::ZERO);
        for (fold, group) in rows(self.sums, self.layout.len()).take(self.folds).enumerate() {
            if !left_out.contains(&fold) {
                sums::add(sums, group);
            }
        }
        self.layout.group(sums, 0)
    }

    /// Writes the coefficients of a fit of each strength to a training set, zero where there is no sample, and says
    /// where its samples lie.
    fn fit(
        &self,
        strengths: &[f64],
        train: &Sums<&[R]>,
        coefficients: &mut [R],
        arena: &mut Arena<'_, R>,
    ) -> [Centre<R>; FITS] {
        let mut arena = arena.scratch();
        let mut centres = [Centre::new(R::ZERO, R::ZERO, R::ZERO); FITS];
        coefficients.fill(R::ZERO);
        if train.count() > R::ZERO {
            let penalties = arena.take(self.layout.columns);
            // From the training set alone, as the coefficients.
            ridge::penalties(self.config, self.basis, |j| train.mean_square(j), penalties);
            let centred = Centred::new(train, &mut arena);
            let each = rows_mut(coefficients, self.layout.coefficients());
            for ((&strength, coefficients), centre) in strengths.iter().zip(each).zip(&mut centres) {
                let mut arena = arena.scratch();
                let penalty = Penalty { strength: R::from_f64(strength), relative: penalties };
                let factor = centred.normal.solve(penalty, coefficients, &mut arena);
                *centre = centred.normal.centre(&factor, penalty, arena);
            }
        }
        centres
    }
}

/// What is added to the plain `mean`, robust, of two folds or more; `variance` is the mean's.
pub(crate) fn pooled<R: Real>(
    groups: &Groups<'_, R>,
    mean: PerChannel<R>,
    variance: PerChannel<R>,
    arena: &mut Arena<'_, R>,
) -> Outcome<R> {
    let each = groups.layout.coefficients();
    let coefficients = arena.take(FITS * each);
    let train = arena.take(groups.layout.len());
    let mut errors = Errors::default();
    // Sums of f - b'p over the folds, b from the others.
    let mut crossed = [PerChannel::default(); FITS];
    for (fold, held_out) in groups.each() {
        let train = groups.train(&[fold], train);
        groups.fit(&MIXED, &train, coefficients, arena);
        errors.add(&train, &held_out, rows(coefficients, each));
        for (crossed, b) in crossed.iter_mut().zip(rows(coefficients, each)) {
            *crossed += held_out.residual_totals(b);
        }
    }
    let all = groups.train(&[], train);
    let centres = groups.fit(&MIXED, &all, coefficients, arena);
    let (n, inverse) = (all.count(), R::ONE / all.count());
    let mut corrections = [PerChannel::default(); FITS];
    let mut discounts = [PerChannel::default(); FITS];
    let fits = corrections.iter_mut().zip(&mut discounts).zip(&centres).zip(crossed).zip(rows(coefficients, each));
    for ((((correction, discount), centre), crossed), b) in fits {
        let whole = all.residual_totals(b) * inverse - mean;
        (*correction, *discount) = centre.judge(whole, crossed * inverse - mean, variance);
    }
    let (plain_weight, weights) = errors.weigh(&discounts);
    let mixture = Mixture { plain_weight, weights, corrections };
    let factor = result::press_factor(n);
    let mut own = errors.fits;
    for (own, centre) in own.iter_mut().zip(centres) {
        *own = *own * factor * centre.inflation;
    }
    let (correction, variance) = mixture.estimate(errors.plain * factor, own);
    Outcome { correction, variance: Some(variance) }
}

/// What is added to the plain `mean`, unbiased, of two folds, or three or more.
pub(crate) fn nested<R: Real>(groups: &Groups<'_, R>, mean: PerChannel<R>, arena: &mut Arena<'_, R>) -> Outcome<R> {
    // With two folds no third is left to judge a fit: one ridge it is.
    let is_fixed = groups.folds < 3 || matches!(groups.config.ridge, Ridge::Fixed(_));
    let fixed = [ridge::single::<R>(groups.config.ridge)];
    let strengths: &[f64] = if is_fixed { &fixed } else { &MIXED };
    let alone = (PerChannel::default(), [R::ONE, R::ZERO].map(PerChannel::all));
    let (each, columns) = (groups.layout.coefficients(), groups.layout.columns);
    let coefficients = arena.take(FITS * each);
    let train = arena.take(groups.layout.len());
    let (mut sums, mut press) = (PerChannel::default(), PerChannel::default());
    let (mut count, others) = (R::ZERO, R::from_usize(groups.filled().saturating_sub(1)));
    for (fold, held_out) in groups.each() {
        count += held_out.count();
        let mut errors = Errors::default();
        let mut discounts = [R::ZERO; FITS];
        // Where there is one fit there is nothing to judge.
        for (other, judging) in groups.each().filter(|&(other, _)| other != fold && !is_fixed) {
            let train = groups.train(&[fold, other], train);
            let centres = groups.fit(strengths, &train, coefficients, arena);
            errors.add(&train, &judging, rows(coefficients, each));
            for (discount, centre) in discounts.iter_mut().zip(centres) {
                *discount += centre.discount();
            }
        }
        let discounts = discounts.map(|total| PerChannel::all(total / others));
        let train = groups.train(&[fold], train);
        let centres = groups.fit(strengths, &train, coefficients, arena);
        let (mut inflation, weights) = if is_fixed { alone } else { errors.weigh(&discounts) };
        let mut kept = weights;
        if !is_fixed {
            keep_independent(&mut kept, &centres);
        }
        for ((&weights, &kept), centre) in weights.iter().zip(&kept).zip(centres) {
            inflation += weights - kept + kept * centre.inflation;
        }
        // The mixture's coefficients, in place of the first candidate's.
        for index in 0..each {
            let mut mixed = R::ZERO;
            for (b, weights) in rows(coefficients, each).zip(&kept) {
                mixed += weights[index / columns.max(1)] * at(b, index);
            }
            set(coefficients, index, mixed);
        }
        let b = first(coefficients, each);
        sums += held_out.residual_totals(b);
        press += held_out.residual_squares(train.intercepts(b), b) * inflation;
    }
    let correction = sums.map(|sum| sum / count) - mean;
    Outcome { correction, variance: Some(press * result::press_factor(count)) }
}

/// Takes from fits what [`Centre::independence`] says; the mean gets it.
// Not inlined, as `weigh` is not: compilers order what they hold in vector registers now one way, now another, so that
// the same source would not make the same bytes.
#[inline(never)]
fn keep_independent<R: Real>(weights: &mut [PerChannel<R>; FITS], centres: &[Centre<R>; FITS]) {
    for (weights, centre) in weights.iter_mut().zip(centres) {
        *weights = *weights * centre.independence();
    }
}

/// Squared errors on groups that the fits have not seen, of how many samples.
#[derive(Default)]
struct Errors<R> {
    fits: [PerChannel<R>; FITS],
    plain: PerChannel<R>,
    count: R,
}

impl<R: Real> Errors<R> {
    /// The weights of the plain mean and of the fits.
    #[inline(never)]
    fn weigh(&self, discounts: &[PerChannel<R>; FITS]) -> (PerChannel<R>, [PerChannel<R>; FITS]) {
        Judge::informed(self.count).weigh(self.plain, &self.fits, discounts, FITS)
    }

    /// Adds those on one group of the fits to another.
    fn add<'c>(&mut self, train: &Sums<&[R]>, judging: &Sums<&[R]>, fits: impl Iterator<Item = &'c [R]>)
    where
        R: 'c,
    {
        self.count += judging.count();
        self.plain += judging.residual_squares(train.intercepts(&[]), &[]);
        for (errors, b) in self.fits.iter_mut().zip(fits) {
            *errors += judging.residual_squares(train.intercepts(b), b);
        }
    }
}
