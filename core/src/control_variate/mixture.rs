//! The robust mixture: plain mean and ridge fits, weighted by leave-one-out error.
//!
//! Least squares alone is not "never worse" than the mean at low sample counts (4.16 holds in the limit): its worst
//! RMSE ratio over the test integrands is 17 at 8 samples.

use super::Config;
use super::config::Ridge;
use super::design::Design;
use super::per_channel::{PerChannel, get, set};
use super::ridge_fit::{self, Choice, Dual, RidgeFit};
use crate::arena::Arena;
use crate::error::Error;
use crate::linalg::packed_len;
use crate::real::Real;

/// Ridge strengths, per sample, of the candidates. A study over 24 integrands found that three do what seven did.
pub(crate) const STRENGTHS: [f64; 3] = [5e-5, 5e-3, 0.1];
/// The number of candidates besides the plain mean.
pub(crate) const CANDIDATES: usize = STRENGTHS.len();
/// How much the plain mean is trusted before any sample is seen, with 1 for all candidates together.
const PRIOR: f64 = 16.0;
/// Trust in a candidate is its error, relative to the mean's, to the power of minus this times the sample count.
const SHARPNESS: f64 = 1.0 / 6.0;
/// The fit of [`Config::ridge`]'s default for estimators that make only one.
pub(crate) const DEFAULT_STRENGTH: f64 = 0.05;
/// What keeps a least-squares system with too few samples solvable, for `f64` and for narrower types.
pub(crate) const FLOOR: [f64; 2] = [1e-10, 1e-6];
/// Relative penalty of a control function: next to none, as its maker vouches for it.
const CONTROL_PENALTY: f64 = 1e-7;

/// A mixture in the design's units.
#[derive(Clone, Copy, Default)]
pub(crate) struct Mixture<R> {
    /// What to add to the plain mean.
    pub(crate) correction: PerChannel<R>,
    /// The sum of squared leave-one-out residuals.
    pub(crate) press: PerChannel<R>,
    /// The same for the plain mean.
    pub(crate) plain_press: PerChannel<R>,
}

/// The systems of a design that every fit starts from.
pub(crate) struct Fitter<'a, 'd, R> {
    design: &'d Design<'a, R>,
    gram: &'a [R],
    rhs: &'a [R],
    penalties: &'a [R],
    dual: Option<Dual<'a, R>>,
}

/// How many numbers a [`Fitter`] and its fits take, for up to `n` samples.
pub(crate) fn size(n: usize, dual: bool, columns: usize, channels: usize) -> Option<usize> {
    let dual = if dual { ridge_fit::dual_size(n, channels)? } else { 0 };
    let systems = packed_len(columns) + columns * (1 + channels) + CANDIDATES * columns * channels;
    systems.checked_add(ridge_fit::primal_size(columns, channels).max(dual))
}

impl<'a, 'd, R: Real> Fitter<'a, 'd, R> {
    #[inline(always)]
    pub(crate) fn new(
        design: &'d Design<'a, R>,
        config: &Config,
        basis: &crate::basis::Basis,
        use_dual: bool,
        arena: &mut Arena<'a, R>,
    ) -> Result<Self, Error> {
        let columns = design.columns;
        let gram = arena.take(packed_len(columns))?;
        let rhs = arena.take(columns * design.channels)?;
        let penalties = arena.take(columns)?;
        if !use_dual {
            let partial = arena.scratch().take_lanes(columns)?;
            design.normal_equations(gram, rhs, partial);
        }
        let per_sample = R::ONE / R::from_usize(design.n);
        self::penalties(config, basis, |j| ridge_fit::diagonal_entry(gram, j) * per_sample, penalties);
        let dual = if use_dual { Some(Dual::new(design, penalties, arena)?) } else { None };
        Ok(Self { design, gram, rhs, penalties, dual })
    }

    /// One fit.
    #[inline(always)]
    pub(crate) fn fit(
        &self,
        strength: f64,
        leave_one_out: bool,
        coefficients: Option<&mut [R]>,
        arena: &mut Arena<'_, R>,
    ) -> Result<RidgeFit<R>, Error> {
        let choice = Choice { strength: R::from_f64(strength), penalties: self.penalties, leave_one_out };
        match &self.dual {
            Some(dual) => dual.fit(self.design, choice, coefficients, arena.scratch()),
            None => ridge_fit::primal(self.design, self.gram, self.rhs, choice, coefficients, arena.scratch()),
        }
    }

    /// The fit that least squares without a penalty tends to, or with the penalty the caller chose.
    #[inline(always)]
    pub(crate) fn least_squares(&self, ridge: Ridge, arena: &mut Arena<'_, R>) -> Result<RidgeFit<R>, Error> {
        match ridge {
            Ridge::Default => self.fit(FLOOR[usize::from(R::NARROW)], false, None, arena),
            Ridge::Fixed(_) | Ridge::Auto => self.single(ridge, None, arena),
        }
    }

    /// The mixture. `coefficients`, if wanted, gets the mixed fit's, a row for each channel.
    #[inline(always)]
    pub(crate) fn robust(
        &self,
        mut coefficients: Option<&mut [R]>,
        arena: &mut Arena<'_, R>,
    ) -> Result<Mixture<R>, Error> {
        let design = self.design;
        let each = design.columns * design.channels;
        let mut mixture = Mixture { plain_press: self.plain_press(), ..Mixture::default() };
        let kept = arena.take(if coefficients.is_some() { CANDIDATES * each } else { 0 })?;
        let mut fits = [RidgeFit::default(); CANDIDATES];
        for (index, (&strength, fit)) in STRENGTHS.iter().zip(&mut fits).enumerate() {
            let kept = kept.get_mut(index * each..(index + 1) * each);
            *fit = self.fit(strength, true, kept, arena)?;
        }
        for channel in 0..design.channels {
            let plain = get(&mixture.plain_press, channel);
            let press = fits.map(|fit| get(&fit.press, channel));
            let error = fits.map(|fit| get(&fit.press, channel) * fit.extrapolation.max(R::ONE));
            let power = R::from_usize(design.n) * R::from_f64(SHARPNESS);
            let (plain_weight, weights) = weights(plain, &error, power);
            let mut mixed_press = plain_weight * plain;
            let mut correction = R::ZERO;
            for ((fit, press), &weight) in fits.iter().zip(press).zip(&weights) {
                mixed_press += weight * press;
                correction += weight * get(&fit.leave_one_out, channel);
            }
            set(&mut mixture.press, channel, mixed_press);
            set(&mut mixture.correction, channel, correction);
            if let Some(coefficients) = coefficients.as_deref_mut() {
                let row = channel * design.columns..(channel + 1) * design.columns;
                let out = coefficients.get_mut(row.clone()).unwrap_or(&mut []);
                for (j, out) in out.iter_mut().enumerate() {
                    let of = |index: usize| kept.get(index * each + row.start + j).copied().unwrap_or(R::ZERO);
                    *out = weights.iter().enumerate().fold(R::ZERO, |sum, (index, &weight)| sum + weight * of(index));
                }
            }
        }
        Ok(mixture)
    }

    /// The leave-one-out errors of the plain mean.
    #[inline(always)]
    pub(crate) fn plain_press(&self) -> PerChannel<R> {
        plain_press(self.design)
    }

    /// The fit of one ridge: fixed, the default, or for [`Ridge::Auto`] the best of a few by leave-one-out error summed
    /// over the channels, each relative to its plain mean's.
    #[inline(always)]
    pub(crate) fn single(
        &self,
        ridge: Ridge,
        mut coefficients: Option<&mut [R]>,
        arena: &mut Arena<'_, R>,
    ) -> Result<RidgeFit<R>, Error> {
        let strength = match ridge {
            Ridge::Default => DEFAULT_STRENGTH,
            Ridge::Fixed(strength) => f64::from(strength),
            Ridge::Auto => {
                let plain = self.plain_press();
                let mut best = (R::ZERO, DEFAULT_STRENGTH);
                for (index, &strength) in STRENGTHS.iter().enumerate() {
                    let fit = self.fit(strength, true, None, arena)?;
                    let mut error = R::ZERO;
                    for (&press, &plain) in fit.press.iter().zip(&plain).filter(|(_, plain)| **plain > R::ZERO) {
                        error += press / plain;
                    }
                    if index == 0 || error < best.0 {
                        best = (error, strength);
                    }
                }
                best.1
            }
        };
        self.fit(strength, true, coefficients.as_deref_mut(), arena)
    }
}

/// Relative penalties of control functions and basis, where `mean_square` is that of a control function's column.
#[inline(always)]
pub(crate) fn penalties<R: Real>(
    config: &Config,
    basis: &crate::basis::Basis,
    mean_square: impl Fn(usize) -> R,
    out: &mut [R],
) {
    let (controls, functions) = out.split_at_mut_checked(config.controls).unwrap_or((&mut [], &mut []));
    for (j, penalty) in controls.iter_mut().enumerate() {
        *penalty = R::from_f64(CONTROL_PENALTY) * mean_square(j);
    }
    basis.penalties(functions);
}

/// The sum of squared leave-one-out residuals of the plain mean.
#[inline(always)]
pub(crate) fn plain_press<R: Real>(design: &Design<'_, R>) -> PerChannel<R> {
    let n = R::from_usize(design.n);
    // f_i minus the mean of the others is n / (n - 1) times f_i minus the mean.
    let factor = if design.n > 1 { n / (n - R::ONE) } else { R::ZERO };
    let mut press = PerChannel::default();
    for channel in 0..design.channels {
        set(&mut press, channel, design.sum_of_squares(channel) * factor * factor);
    }
    press
}

/// Weights of the plain mean and of the candidates: (error / plain error)^(-power) / C for a candidate, 16 for the mean,
/// normalised. Errors are sums of squares.
#[inline(always)]
pub(crate) fn weights<R: Real, const C: usize>(plain: R, press: &[R; C], power: R) -> (R, [R; C]) {
    let mut weights = [R::ZERO; C];
    // Constant values: the mean is exact. A NaN cannot come from finite samples, but trust would go to the mean.
    if !(plain > R::ZERO) {
        return (R::ONE, weights);
    }
    let smallest = R::from_f64(1e-30);
    let prior = R::from_f64(PRIOR * C as f64).ln();
    let mut largest = prior;
    for (weight, &press) in weights.iter_mut().zip(press) {
        *weight = -power * (press / plain).max(smallest).ln();
        if !weight.is_finite() {
            *weight = -R::ONE / R::EPSILON;
        }
        largest = largest.max(*weight);
    }
    let plain_weight = (prior - largest).exp();
    let mut total = plain_weight;
    for weight in &mut weights {
        *weight = (*weight - largest).exp();
        total += *weight;
    }
    for weight in &mut weights {
        *weight = *weight / total;
    }
    (plain_weight / total, weights)
}
