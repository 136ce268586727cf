//! The fits of an estimator to one design, and how they are weighed.

use super::config::{Config, Ridge};
use super::design::Design;
use super::fit::dual::{self, Dual};
use super::fit::normal::{self, Normal};
use super::fit::{Fit, Penalty};
use super::per_channel::PerChannel;
use super::result;
use super::ridge::{self, CHOICES, MAX_FITS, MIXED};
use super::trust::{self, Centre};
use crate::arena::Arena;
use crate::basis::Basis;
use crate::error::Error;
use crate::matrix::{at, first_mut, packed_len};
use crate::real::Real;
use crate::rows::{rows, rows_mut};

/// Which fits are made and how one is made of them.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Rule {
    /// The mixture of all strengths and the plain mean.
    Robust,
    /// The same for a fit that corrects other samples, which is not used where these samples are too even.
    Fold,
    /// One strength, each sample corrected by the fit to the others.
    Single(Ridge),
    /// One strength, next to none by default, and the fit's own estimate.
    LeastSquares(Ridge),
}

pub(crate) struct Blend<R> {
    fits: [Fit<R>; MAX_FITS],
    /// What each fit adds to the mean.
    corrections: [PerChannel<R>; MAX_FITS],
    weights: [PerChannel<R>; MAX_FITS],
    plain_weight: PerChannel<R>,
}

/// The system that all fits to a design start from.
enum System<'a, R> {
    Normal(Normal<'a, R>),
    Dual(Dual<'a, R>),
}

/// The fits that can be made to a design.
pub(crate) struct Fitter<'a, 'd, R> {
    design: &'d Design<'a, R>,
    system: System<'a, R>,
    penalties: &'a [R],
}

/// How many numbers a [`Fitter`] and its fits take, for up to `n` samples.
pub(crate) fn size(n: usize, dual: bool, columns: usize, channels: usize) -> Option<usize> {
    let gram = if dual { 0 } else { packed_len(columns) };
    let dual = if dual { dual::len(n, channels)? } else { 0 };
    let systems = gram + columns * (1 + channels) + MAX_FITS * columns * channels;
    systems.checked_add(normal::fit_len(columns, channels).max(dual))
}

impl<'a, 'd, R: Real> Fitter<'a, 'd, R> {
    #[inline(always)]
    pub(crate) fn new(
        design: &'d Design<'a, R>,
        config: &Config,
        basis: &Basis,
        use_dual: bool,
        arena: &mut Arena<'a, R>,
    ) -> Result<Self, Error> {
        let penalties = arena.take(design.columns)?;
        // Penalties of control functions come from the matrix, but the dual has no control functions.
        let system = if use_dual {
            ridge::penalties(config, basis, |_| R::ZERO, penalties);
            System::Dual(Dual::new(design, penalties, arena)?)
        } else {
            let normal = Normal::of(design, arena)?;
            let per_sample = R::ONE / normal.count;
            ridge::penalties(config, basis, |j| normal.gram.diagonal(j) * per_sample, penalties);
            let factor = ridge::control_factor::<R>(config);
            for penalty in penalties.iter_mut().take(config.controls) {
                *penalty *= factor;
            }
            System::Normal(normal)
        };
        Ok(Self { design, system, penalties })
    }

    /// Makes and weighs the fits. `coefficients`, if wanted, gets the blended fit's, a row for each channel.
    #[inline(always)]
    pub(crate) fn solve(
        &self,
        rule: Rule,
        coefficients: Option<&mut [R]>,
        arena: &mut Arena<'_, R>,
    ) -> Result<Blend<R>, Error> {
        let design = self.design;
        let single = [match rule {
            Rule::LeastSquares(ridge) => ridge::least_squares::<R>(ridge),
            Rule::Single(ridge) => ridge::single::<R>(ridge),
            Rule::Robust | Rule::Fold => 0.0,
        }];
        let (strengths, leave_one_out) = match rule {
            Rule::Robust | Rule::Fold => (&MIXED[..], true),
            Rule::Single(Ridge::Auto) | Rule::LeastSquares(Ridge::Auto) => (&CHOICES[..], true),
            Rule::Single(_) => (&single[..], true),
            // As many terms as samples leave nothing to tell the error from.
            Rule::LeastSquares(_) => (&single[..], design.n > design.columns + 1),
        };
        let each = design.columns * design.channels;
        let kept = arena.take(if coefficients.is_some() { strengths.len() * each } else { 0 })?;
        let mut fits = [Fit::default(); MAX_FITS];
        for (index, (&strength, fit)) in strengths.iter().zip(&mut fits).enumerate() {
            let kept = kept.get_mut(index * each..(index + 1) * each).filter(|kept| !kept.is_empty());
            let penalty = Penalty { strength: R::from_f64(strength), relative: self.penalties };
            *fit = match &self.system {
                System::Normal(normal) => normal.fit(design, penalty, leave_one_out, kept, arena.scratch())?,
                System::Dual(dual) => dual.fit(design, penalty, leave_one_out, kept, arena.scratch())?,
            };
        }
        let blend = self.weigh(rule, fits, strengths.len());
        for (channel, out) in coefficients.into_iter().flat_map(|all| rows_mut(all, design.columns)).enumerate() {
            for (j, out) in out.iter_mut().enumerate() {
                *out = R::ZERO;
                for (kept, weights) in rows(kept, each).zip(&blend.weights) {
                    let b = at(kept, channel * design.columns + j);
                    *out += weights[channel] * b;
                }
            }
        }
        Ok(blend)
    }

    fn weigh(&self, rule: Rule, fits: [Fit<R>; MAX_FITS], used: usize) -> Blend<R> {
        let corrections =
            fits.map(|fit| if let Rule::LeastSquares(_) = rule { fit.in_sample } else { fit.leave_one_out });
        let (weights, plain_weight) = Default::default();
        let mut blend = Blend { fits, corrections, weights, plain_weight };
        let plain = plain_press(self.design);
        if !matches!(rule, Rule::Robust | Rule::Fold) {
            let best = if used > 1 { best_of(&fits, &plain) } else { 0 };
            if let Some(weights) = blend.weights.get_mut(best) {
                *weights = PerChannel([R::ONE; Config::MAX_CHANNELS]);
            }
            return blend;
        }
        let n = R::from_usize(self.design.n);
        let centres = fits.map(|fit| Centre::new(fit.eccentricity, fit.freedom, n));
        let power = n * R::from_f64(trust::SHARPNESS);
        let shares = centres.map(|centre| centre.share());
        for ((correction, fit), share) in blend.corrections.iter_mut().zip(&fits).zip(shares) {
            for (all, one) in correction.iter_mut().zip(fit.in_sample.iter()) {
                *all = *one + share * (*all - *one);
            }
        }
        let discounts = centres.map(|centre| centre.discount());
        for channel in 0..self.design.channels {
            let press = fits.map(|fit| fit.press[channel]);
            let plain = plain[channel];
            let variance = plain * result::press_factor(n);
            let mut discounts = discounts;
            for (discount, correction) in discounts.iter_mut().zip(&blend.corrections) {
                *discount += trust::surprise(correction[channel], variance);
            }
            let mut weights = [R::ZERO; MAX_FITS];
            let each = first_mut(&mut weights, used);
            let mut plain_weight = trust::weigh(plain, &press, &discounts, power, n, trust::prior(n), each);
            if rule == Rule::Fold {
                for (weight, centre) in weights.iter_mut().zip(&centres) {
                    let kept = *weight * centre.independence();
                    plain_weight += *weight - kept;
                    *weight = kept;
                }
            }
            blend.plain_weight[channel] = plain_weight;
            for (slot, weight) in blend.weights.iter_mut().zip(weights) {
                slot[channel] = weight;
            }
        }
        blend
    }
}

/// Of fits the one with the smallest leave-one-out error summed over the channels, each relative to its plain mean's.
fn best_of<R: Real>(fits: &[Fit<R>; MAX_FITS], plain: &PerChannel<R>) -> usize {
    let error = |fit: &Fit<R>| {
        // Of a channel that is constant nothing counts.
        let ratio = |press: R, plain: R| press.to_f64() / if plain > R::ZERO { plain.to_f64() } else { f64::INFINITY };
        fit.press.iter().zip(plain.iter()).map(|(&press, &plain)| ratio(press, plain)).sum::<f64>()
    };
    let mut best = (0, 0.0);
    for (index, fit) in fits.iter().enumerate() {
        let error = error(fit);
        if index == 0 || error < best.1 {
            best = (index, error);
        }
    }
    best.0
}

impl<R: Real> Blend<R> {
    /// What the mixture adds to the plain mean.
    pub(crate) fn correction(&self) -> PerChannel<R> {
        let mut total = PerChannel::default();
        for (correction, weights) in self.corrections.iter().zip(&self.weights) {
            for ((total, &correction), &weight) in total.iter_mut().zip(correction.iter()).zip(weights.iter()) {
                *total += weight * correction;
            }
        }
        total
    }

    /// The variance of the mixture's estimate, which adds `total` to the mean: of what it is made of, and of what its
    /// parts disagree in.
    pub(crate) fn variance(&self, design: &Design<'_, R>, total: &PerChannel<R>) -> Option<PerChannel<R>> {
        let n = R::from_usize(design.n);
        let factor = result::press_factor(n);
        let plain = plain_press(design);
        let mut variance = PerChannel::default();
        for channel in 0..design.channels {
            let spread = |value: R| (value - total[channel]) * (value - total[channel]);
            let mut sum = self.plain_weight[channel] * (plain[channel] * factor + spread(R::ZERO));
            let fits = self.fits.iter().zip(&self.corrections).zip(&self.weights);
            for ((fit, correction), weights) in fits {
                let own = fit.influence[channel] * factor * trust::few_left(fit.freedom, n);
                sum += weights[channel] * (own + spread(correction[channel]));
            }
            variance[channel] = sum;
        }
        (design.n > 1).then_some(variance)
    }

    /// What the error of the mixture's coefficients adds to the variance of an estimate that is corrected by them, as a
    /// factor, of fits to `n` samples.
    pub(crate) fn inflation(&self, channel: usize, n: R) -> R {
        let fits = self.fits.iter().zip(&self.weights);
        fits.fold(self.plain_weight[channel], |sum, (fit, weights)| {
            sum + weights[channel] * Centre::new(fit.eccentricity, fit.freedom, n).inflation
        })
    }
}

/// The sum of squared leave-one-out residuals of the plain mean.
#[inline(always)]
pub(crate) fn plain_press<R: Real>(design: &Design<'_, R>) -> PerChannel<R> {
    let n = R::from_usize(design.n);
    // f_i minus the mean of the others is n / (n - 1) times f_i minus the mean.
    let factor = if design.n > 1 { n / (n - R::ONE) } else { R::ZERO };
    let mut press = PerChannel::default();
    for channel in 0..design.channels {
        press[channel] = design.sum_of_squares(channel) * factor * factor;
    }
    press
}
