//! How far a fit is trusted beside the plain mean.
//!
//! Least squares alone is not "never worse" than the mean at low sample counts ((4.16) holds in the limit): its worst
//! RMSE ratio over the test integrands is 17 at 8 samples. A soft mixture of the mean and a few ridge fits, each
//! trusted by its error on samples it has not seen, is. Three things besides that error tell how far:
//!
//! - where the samples' centre lies ([`Centre`]): far from the cube's, a fit extrapolates;
//! - how far the fit moves the mean ([`surprise`]): a fit that explains the values moves it by about its error, one
//!   that follows noise by more;
//! - how few samples there are ([`Judge::informed`]).

use super::per_channel::PerChannel;
use crate::matrix::{at, first_mut};
use crate::real::Real;
use core::hint::black_box;

/// Trust in a candidate is its error, relative to the mean's, to the power of minus this times the number of samples
/// (of pixels, where pixels are compared) that judge it.
pub(crate) const SHARPNESS: f64 = 1.0 / 6.0;
/// How much the plain mean is trusted before anything is seen, with 1 for all candidates together.
pub(crate) const PRIOR: f64 = 8.0;
/// The same where [`Centre`] and [`surprise`] are asked too.
const INFORMED_PRIOR: f64 = 5.0;
/// The fourth power of the sample count where that prior doubles.
const FEW: f64 = 128.0;

/// How many samples it takes to be sure: the mean keeps at least e^-(n^2 / this) of any candidate's trust, whatever the
/// candidate's errors.
pub(crate) const CAUTION: f64 = 14.0;

/// The F statistic that is still nothing to worry about.
const USUAL_F: f64 = 0.5;
/// Trust is divided by the F statistic over the usual one, to this power.
const DISCOUNT: f64 = 0.8;
/// The F statistic at which half of what leaving samples out adds to a fit's estimate is used. All of it is unbiased.
/// Samples that lie far more evenly than independent ones, as those of a Sobol sequence, have a smaller F: their fit
/// has next to no bias, and what leaving some out adds is error.
const EVEN_F: f64 = 0.2;
/// Trust loses this times the square of how far a fit moves the mean, in standard errors of the mean.
const SURPRISE: f64 = 0.25;
/// And no more than for this many standard errors: fits that are nearly exact are right to move the mean that far.
const FAR: f64 = 4.0;
/// How much likelier it must be that samples are even before folds are trusted less, as the logarithm of its square.
const DOUBT: f64 = 6.0;

/// Where the centre of the samples lies as a fit to them measures distance, from the cube's.
///
/// For q = n sum_i (m'A^-1 p_i)^2, with m the columns' means and p_i the centred columns, and k =
/// `freedom` effective coefficients, F = (q / k) (n - 1 - k) tells: Hotelling's, but for its n - k, and about 1 for
/// independent samples. If all lie in one part of the cube, errors on held-out samples are small and yet the fit's
/// integral is an extrapolation: F is large. If they were placed to be even it is small.
#[derive(Clone, Copy)]
pub(crate) struct Centre<R> {
    f: R,
    freedom: R,
    /// The factor, (1 + q) times [`few_left`], that a variance takes which residuals tell: for the error of the fit's
    /// coefficients, and for how few samples are left to tell it.
    pub(crate) inflation: R,
}

impl<R: Real> Centre<R> {
    /// Of a fit to `n` samples; with less than two nothing speaks against the fit.
    pub(crate) fn new(eccentricity: R, freedom: R, n: R) -> Self {
        let freedom = freedom.min(n - R::from_f64(1.5)).max(R::EPSILON);
        let f = eccentricity * (n - R::ONE - freedom) / freedom;
        Self { f, freedom, inflation: (R::ONE + eccentricity) * few_left(freedom, n) }
    }

    /// The logarithm of what trust in the fit is divided by because its samples lie to one side.
    pub(crate) fn discount(&self) -> R {
        let f = self.f * R::from_f64(1.0 / USUAL_F);
        if f <= R::ONE {
            R::ZERO
        } else if f.is_finite() {
            R::from_f64(DISCOUNT) * f.ln()
        } else {
            // A place that is no number earns no trust.
            R::ONE / R::EPSILON
        }
    }

    /// What the fit adds to the mean, from what it does by its own estimate and by the one that leaves samples out, and
    /// the logarithm of what trust in that is divided by.
    pub(crate) fn judge(
        &self,
        in_sample: PerChannel<R>,
        left_out: PerChannel<R>,
        variance: PerChannel<R>,
    ) -> (PerChannel<R>, PerChannel<R>) {
        let (f, aside) = (self.f.max(R::ZERO), self.discount());
        let correction = in_sample + (left_out - in_sample) * (f / (f + R::from_f64(EVEN_F)));
        (correction, correction.zip(variance, |correction, variance| aside + surprise(correction, variance)))
    }

    /// From 1 for samples that may well be independent to 0 for such as are too even for it, from the logarithm of the
    /// square of the two's likelihood ratio, k (F - 1 - ln F).
    ///
    /// A fit to some folds that corrects another undoes what is even about all of them together.
    pub(crate) fn independence(&self) -> R {
        let f = self.f.max(R::from_f64(1e-12));
        if f >= R::ONE {
            return R::ONE;
        }
        let evidence = self.freedom * (f - R::ONE - f.ln()) - R::from_f64(DOUBT);
        // exp(80) is within the range of both types, and leaves nothing.
        R::ONE / (R::ONE + evidence.min(R::from_f64(80.0)).exp())
    }
}

/// What few residual degrees of freedom, n - 1 - k, add to a variance that is estimated from residuals.
pub(crate) fn few_left<R: Real>(freedom: R, n: R) -> R {
    let two = R::ONE + R::ONE;
    let left = (n - R::ONE - freedom).max(R::from_f64(0.5));
    let all = (n - R::ONE).max(R::from_f64(0.5));
    // (1 + 2 / left) / (1 + 2 / all).
    (left + two) * all / (left * (all + two))
}

/// The logarithm of what trust in a fit that adds `correction` to the mean is divided by; nothing for a mean without
/// variance, which is exact.
fn surprise<R: Real>(correction: R, variance: R) -> R {
    let error = if variance > R::ZERO { variance.sqrt() } else { R::INFINITY };
    let errors = correction.abs() / error;
    // A correction that is no number is as surprising as can be.
    let most = R::from_f64(FAR);
    let errors = if errors < most { errors } else { most };
    R::from_f64(SURPRISE) * errors * errors
}

/// How errors on samples that a fit has not seen become trust.
#[derive(Clone, Copy)]
pub(crate) struct Judge<R> {
    /// How many samples.
    pub(crate) n: R,
    /// Trust is the error, relative to the mean's, to the power of minus this.
    pub(crate) power: R,
    /// The trust in the plain mean before anything is seen.
    pub(crate) prior: R,
}

impl<R: Real> Judge<R> {
    /// Where fits are discounted for where their samples lie and how far they move the mean.
    pub(crate) fn informed(n: R) -> Self {
        let square = n * n;
        let prior = R::from_f64(INFORMED_PRIOR) * (R::ONE + R::from_f64(FEW) / (square * square));
        Self { n, power: n * R::from_f64(SHARPNESS), prior }
    }

    /// The weights of the plain mean and of the first `used` fits, from their errors and what else tells against a fit.
    pub(crate) fn weigh<const C: usize>(
        &self,
        plain: PerChannel<R>,
        errors: &[PerChannel<R>; C],
        discounts: &[PerChannel<R>; C],
        used: usize,
    ) -> (PerChannel<R>, [PerChannel<R>; C]) {
        let (mut plain_weight, mut weights) = (PerChannel::default(), [PerChannel::default(); C]);
        for (channel, plain_weight) in plain_weight.0.iter_mut().enumerate() {
            let of = |all: &[PerChannel<R>; C]| all.map(|each| each[channel]);
            let mut each = [R::ZERO; C];
            *plain_weight = weigh(self, plain[channel], &of(errors), &of(discounts), first_mut(&mut each, used));
            for (weights, weight) in weights.iter_mut().zip(each) {
                weights[channel] = weight;
            }
        }
        (plain_weight, weights)
    }
}

/// The plain mean and fits, weighed in each channel.
pub(crate) struct Mixture<R, const C: usize> {
    pub(crate) plain_weight: PerChannel<R>,
    pub(crate) weights: [PerChannel<R>; C],
    /// What each fit adds to the mean.
    pub(crate) corrections: [PerChannel<R>; C],
}

impl<R: Real, const C: usize> Mixture<R, C> {
    /// What the mixture adds to the mean, and the variance of its estimate from the plain mean's and each fit's: of
    /// what it is made of, and of what its parts disagree in.
    pub(crate) fn estimate(&self, plain: PerChannel<R>, fits: [PerChannel<R>; C]) -> (PerChannel<R>, PerChannel<R>) {
        let parts = || self.weights.iter().zip(&self.corrections);
        let total = parts().fold(PerChannel::default(), |sum, (&weights, &correction)| sum + weights * correction);
        let mut variance = self.plain_weight * (plain + total * total);
        for ((&weights, &correction), own) in parts().zip(fits) {
            let apart = correction - total;
            variance += weights * (own + apart * apart);
        }
        (total, variance)
    }
}

/// Sets `weights` to those of C candidates, (error / plain error)^(-power) / C less a discount, and returns the plain
/// mean's, all normalised. Errors are sums of squares.
fn weigh<R: Real>(judge: &Judge<R>, plain: R, errors: &[R], discounts: &[R], weights: &mut [R]) -> R {
    let Judge { n, power, prior } = *judge;
    // Constant values: the mean is exact. A NaN cannot come from finite samples, but trust would go to the mean.
    let varies = plain > R::ZERO;
    if !varies {
        weights.fill(R::ZERO);
        return R::ONE;
    }
    let smallest = R::from_f64(1e-30);
    let mut largest = R::ZERO;
    for (weight, &error) in weights.iter_mut().zip(errors) {
        let ratio = error / plain;
        *weight = if ratio.is_finite() { -power * ratio.max(smallest).ln() } else { -R::ONE / R::EPSILON };
        largest = largest.max(*weight);
    }
    let caution = (largest - n * n / R::from_f64(CAUTION)).max(R::ZERO);
    let prior = (prior * R::from_usize(weights.len())).ln() + caution;
    largest = prior;
    for (index, weight) in weights.iter_mut().enumerate() {
        *weight -= at(discounts, index);
        largest = largest.max(*weight);
    }
    let plain_weight = (prior - largest).exp();
    let mut total = plain_weight;
    for weight in weights.iter_mut() {
        *weight = (*weight - largest).exp();
        total += *weight;
    }
    // Behind a black box, or two are divided in four lanes, two of them 0 / 0: FE_INVALID.
    for weight in weights {
        *weight = black_box(*weight / total);
    }
    plain_weight / total
}
