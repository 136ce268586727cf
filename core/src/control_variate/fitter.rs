//! The fits of an estimator to one design, and how they are weighed.

use super::config::{Config, Ridge};
use super::design::Design;
use super::fit::dual::{self, Dual};
use super::fit::normal::{self, Normal};
use super::fit::{Fit, Penalty};
use super::per_channel::PerChannel;
use super::plan::{self, Method, Plan};
use super::result::{self, Outcome};
use super::ridge::{self, CHOICES, MAX_FITS, MIXED};
use super::trust::{self, Centre, Judge, Mixture};
use crate::arena::Arena;
use crate::basis::Basis;
use crate::matrix::{at, packed_len, rows, rows_mut};
use crate::real::Real;
use core::array;

/// The fits to a design, and how much each counts.
pub(crate) struct Blend<R> {
    fits: [Fit<R>; MAX_FITS],
    mixture: Mixture<R, MAX_FITS>,
    /// Samples that they are to, and the sum of squared leave-one-out residuals of their plain mean.
    n: R,
    plain: PerChannel<R>,
    /// Whether residuals tell the error: as many terms as samples leave least squares none.
    is_told: bool,
}

/// The system that all fits to a design start from.
enum System<'a, R> {
    Normal(Normal<'a, R>),
    Dual(Dual<'a, R>),
}

/// How many numbers [`fit`] takes from its arena, coefficients apart, for up to `n` samples: few may take more than
/// many, by the dual.
pub(crate) fn size(config: &Config, n: usize, columns: usize, channels: usize) -> usize {
    let short = n.min(plan::most_dual(config, columns));
    let system = packed_len(columns) + columns * channels;
    let primal = if n > short { system + normal::fit_len(columns, channels) } else { 0 };
    columns + primal.max(dual::len(short, channels))
}

/// Makes and weighs the fits of a method. `coefficients`, if wanted, gets the blended fit's, a row for each channel.
// Without, and without it on `Normal::of`, estimates of one pixel take 20 to 29 % more instructions.
#[inline(always)]
pub(crate) fn fit<'a, R: Real>(
    design: &Design<'a, R>,
    config: &Config,
    basis: &Basis,
    plan: &Plan,
    coefficients: Option<&mut [R]>,
    arena: &mut Arena<'a, R>,
) -> Blend<R> {
    let penalties = arena.take(design.columns);
    // Penalties of control functions come from the matrix, but the dual has no control functions.
    let system = if plan.dual {
        ridge::penalties(config, basis, |_| R::ZERO, penalties);
        System::Dual(Dual::new(design, penalties, arena))
    } else {
        let normal = Normal::of(design, arena);
        let per_sample = R::ONE / normal.count;
        ridge::penalties(config, basis, |j| normal.gram.diagonal(j) * per_sample, penalties);
        let factor = ridge::control_factor::<R>(config);
        for penalty in penalties.iter_mut().take(config.controls) {
            *penalty *= factor;
        }
        System::Normal(normal)
    };
    let is_least_squares = plan.method == Method::LeastSquares;
    let is_mixed = matches!((plan.method, config.ridge), (Method::Robust, _) | (Method::KFold, Ridge::Default));
    let single = [if is_least_squares { ridge::least_squares::<R> } else { ridge::single::<R> }(config.ridge)];
    let strengths = match config.ridge {
        _ if is_mixed => &MIXED[..],
        Ridge::Auto => &CHOICES[..],
        Ridge::Default | Ridge::Fixed(_) => &single[..],
    };
    let is_told = !is_least_squares || design.n > design.columns + 1;
    let leave_one_out = is_told || strengths.len() > 1;
    let each = design.columns * design.channels;
    let kept = arena.take(if coefficients.is_some() { strengths.len() * each } else { 0 });
    let mut fits = [Fit::default(); MAX_FITS];
    for (index, (&strength, fit)) in strengths.iter().zip(&mut fits).enumerate() {
        let kept = kept.get_mut(index * each..(index + 1) * each).filter(|kept| !kept.is_empty());
        let penalty = Penalty { strength: R::from_f64(strength), relative: penalties };
        *fit = match &system {
            System::Normal(normal) => normal.fit(design, penalty, leave_one_out, kept, arena.scratch()),
            System::Dual(dual) => dual.fit(design, penalty, leave_one_out, kept, arena.scratch()),
        };
    }
    let n = R::from_usize(design.n);
    // f_i minus the mean of the others is n / (n - 1) times f_i minus the mean.
    let factor = if design.n > 1 { n / (n - R::ONE) } else { R::ZERO };
    let plain = design.squares() * factor * factor;
    let mixture = if is_mixed {
        mix(n, plain, plan.method, &fits, strengths.len())
    } else {
        let best = if strengths.len() > 1 { best_of(&fits, &plain) } else { 0 };
        let weights = array::from_fn(|fit| PerChannel::all(if fit == best { R::ONE } else { R::ZERO }));
        let corrections = fits.map(|fit| if is_least_squares { fit.in_sample } else { fit.leave_one_out });
        Mixture { plain_weight: PerChannel::default(), weights, corrections }
    };
    for (channel, out) in coefficients.into_iter().flat_map(|all| rows_mut(all, design.columns)).enumerate() {
        for (j, out) in out.iter_mut().enumerate() {
            *out = R::ZERO;
            for (kept, weights) in rows(kept, each).zip(&mixture.weights) {
                *out += weights[channel] * at(kept, channel * design.columns + j);
            }
        }
    }
    Blend { fits, mixture, n, plain, is_told }
}

/// The plain mean of `n` samples and the first `used` fits, weighed. Fits that are to correct other samples are trusted
/// less where their own are too even.
fn mix<R: Real>(
    n: R,
    plain: PerChannel<R>,
    method: Method,
    fits: &[Fit<R>; MAX_FITS],
    used: usize,
) -> Mixture<R, MAX_FITS> {
    let variance = plain * result::press_factor(n);
    let [mut corrections, mut discounts] = [[PerChannel::default(); MAX_FITS]; 2];
    let mut parts = [R::ONE; MAX_FITS];
    for (((fit, correction), discount), part) in fits.iter().zip(&mut corrections).zip(&mut discounts).zip(&mut parts) {
        let centre = Centre::new(fit.eccentricity, fit.freedom, n);
        (*correction, *discount) = centre.judge(fit.in_sample, fit.leave_one_out, variance);
        if method == Method::KFold {
            *part = centre.independence();
        }
    }
    let press = fits.map(|fit| fit.press);
    let (mut plain_weight, mut weights) = Judge::informed(n).weigh(plain, &press, &discounts, used);
    for (weights, part) in weights.iter_mut().zip(parts) {
        let kept = *weights * part;
        plain_weight += *weights - kept;
        *weights = kept;
    }
    Mixture { plain_weight, weights, corrections }
}

/// Of fits the one with the smallest leave-one-out error summed over the channels, each relative to its plain mean's.
fn best_of<R: Real>(fits: &[Fit<R>; MAX_FITS], plain: &PerChannel<R>) -> usize {
    let mut best = (0, 0.0);
    for (index, fit) in fits.iter().enumerate() {
        let mut error = 0.0;
        for (press, &plain) in fit.press.0.iter().zip(&plain.0) {
            // Of a channel that is constant nothing counts.
            error += press.to_f64() / if plain > R::ZERO { plain.to_f64() } else { f64::INFINITY };
        }
        if index == 0 || error < best.1 {
            best = (index, error);
        }
    }
    best.0
}

impl<R: Real> Blend<R> {
    /// What is added to the plain mean, and the variance of that.
    pub(crate) fn outcome(&self) -> Outcome<R> {
        let factor = result::press_factor(self.n);
        let own = |fit: Fit<R>| fit.influence * factor * trust::few_left(fit.freedom, self.n);
        let (correction, variance) = self.mixture.estimate(self.plain * factor, self.fits.map(own));
        Outcome { correction, variance: Some(if self.is_told { variance } else { PerChannel::all(R::INFINITY) }) }
    }

    /// What the error of the mixture's coefficients adds to the variance of an estimate that is corrected by them, as a
    /// factor.
    pub(crate) fn inflation(&self) -> PerChannel<R> {
        let fits = self.fits.iter().zip(&self.mixture.weights);
        fits.fold(self.mixture.plain_weight, |sum, (fit, &weights)| {
            sum + weights * Centre::new(fit.eccentricity, fit.freedom, self.n).inflation
        })
    }
}
