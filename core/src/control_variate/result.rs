//! From a correction in a design's units to an [`Estimate`] in the caller's.

use super::config::Estimate;
use super::design::{Design, Units};
use super::per_channel::PerChannel;
use super::samples::Reader;
use super::sums::{self, Sums};
use super::trust::Centre;
use crate::real::Real;
pub(crate) use crate::real::saturate;
use core::hint::black_box;

/// What an estimator found, in a design's units; by default the plain mean.
#[derive(Default)]
pub(crate) struct Outcome<R> {
    /// What to add to the plain mean.
    pub(crate) correction: PerChannel<R>,
    /// The variance of the estimate, infinite where the samples are too few to tell it; None for the plain mean's.
    pub(crate) variance: Option<PerChannel<R>>,
}

/// What a sum of squared deviations of `n` values is divided by to be the variance of their mean; for one, which has
/// none, still no zero.
pub(crate) fn mean_divisor<R: Real>(n: R) -> R {
    n * (n - R::ONE).max(R::ONE)
}

/// What a sum of squared leave-one-out residuals of `n` samples, at least two, is multiplied by to be a variance: exact
/// for the plain mean.
pub(crate) fn press_factor<R: Real>(n: R) -> R {
    (n - R::ONE) / (n * n * n)
}

/// The variance of the constant term of a fit of so many columns to `n` samples, from the sum of its squared residuals
/// and its `eccentricity` ([`Centre`]); infinite if no residual is left over to tell.
///
/// For no column that of the plain mean. With f = n - 1 - k degrees of freedom left, residuals of samples that a fit
/// has not seen are (n - 1) / f times as long, and, as measured on integrands that no fit follows, so is its own error
/// once more.
pub(crate) fn residual_variance<R: Real>(
    residual: PerChannel<R>,
    columns: usize,
    n: R,
    eccentricity: R,
) -> PerChannel<R> {
    let columns = R::from_usize(columns);
    let freedom = n - R::ONE - columns;
    // A count that comes from a square root is not exact: a half tells one from none.
    if freedom < R::from_f64(0.5) {
        return PerChannel::all(R::INFINITY);
    }
    let (all, square) = (n - R::ONE, freedom * freedom);
    let factor = Centre::new(eccentricity, columns, n).inflation * all * all * all / (n * square * square);
    residual * factor
}

/// What samples say without a fit.
pub(crate) struct Summary<R> {
    samples: u64,
    channels: usize,
    /// Units whose zero is the plain mean.
    pub(crate) units: Units<R>,
    /// The plain mean in the units that sums are in; of a design, whose units are those above, zero.
    pub(crate) mean: PerChannel<R>,
    /// The plain mean's variance, None for one sample.
    pub(crate) variance: Option<PerChannel<R>>,
    /// For a luminance ratio: the mean colour and its luminance.
    pub(crate) colour: Option<PerChannel<f64>>,
}

impl<R: Real> Summary<R> {
    pub(crate) fn of(design: &Design<'_, R>, reader: &Reader<'_>) -> Self {
        let factor = R::ONE / mean_divisor(R::from_usize(design.n));
        Self {
            samples: design.n as u64,
            channels: design.channels,
            units: design.units,
            mean: PerChannel::default(),
            variance: (design.n > 1).then_some(design.squares() * factor),
            colour: reader.mean_colour(),
        }
    }

    /// Of groups of sums over so many samples together.
    pub(crate) fn of_sums<'a>(
        groups: impl Iterator<Item = Sums<&'a [R]>>,
        samples: u64,
        channels: usize,
        mut units: Units<R>,
    ) -> Self {
        let (mut totals, mut squares) = (PerChannel::default(), PerChannel::default());
        for group in groups {
            totals += group.totals();
            squares += group.squares();
        }
        let n = R::from_f64(samples as f64);
        let mean = totals.map(|total| total / n);
        units.offsets += mean;
        let variance = sums::spread(squares, totals, mean).map(|spread| spread / mean_divisor(n));
        Self { samples, channels, units, mean, variance: (samples > 1).then_some(variance), colour: None }
    }

    /// Puts an estimate together; for a luminance ratio, the colours too.
    ///
    /// A correction that left the type's range, as control functions of extreme size can make it, is none: the plain
    /// mean.
    pub(crate) fn finish(self, outcome: Outcome<R>) -> Estimate {
        let (mut mean, mut error) = (PerChannel::<f64>::default(), PerChannel::<f64>::default());
        let (mut gain, mut counted) = (0.0, 0.0);
        let variance = outcome.variance.or(self.variance);
        for channel in 0..self.channels {
            let correction = outcome.correction[channel];
            let is_usable = correction.is_finite();
            mean[channel] = self.units.value(channel, if is_usable { correction } else { R::ZERO });
            error[channel] = f64::INFINITY;
            if let (Some(variance), Some(plain)) = (&variance, &self.variance) {
                let (variance, plain) = (variance[channel], plain[channel]);
                // Of what is no number all that is known is the mean's; and a constant is no fit's to get wrong.
                let is_known = is_usable && (variance < R::INFINITY || plain > R::ZERO && variance == R::INFINITY);
                let variance = if is_known { variance.max(R::ZERO) } else { plain };
                error[channel] = self.units.length(channel, variance.sqrt());
                if plain > R::ZERO {
                    // Behind a black box, so that no compiler divides by zero ahead of the decision.
                    gain += (variance / black_box(plain)).to_f64();
                    counted += 1.0;
                }
            }
        }
        if let Some(PerChannel([red, green, blue, luminance])) = self.colour {
            // Section 4.3: the colour of the plain mean, with the regressed luminance.
            let (regressed, deviation) = (mean[0], error[0]);
            let is_zero = luminance == 0.0;
            let divisor = black_box(if is_zero { 1.0 } else { luminance });
            let ratio = if is_zero { 1.0 } else { regressed / divisor };
            // One sample's error is unknown in every channel, also where its colour is 0; and that of values which
            // cancel.
            let is_known = deviation.is_finite() && (!is_zero || deviation == 0.0);
            for ((mean, error), colour) in mean.0.iter_mut().zip(&mut error.0).zip([red, green, blue]) {
                *mean = ratio * colour;
                *error = if is_known { libm::fabs(deviation * colour / divisor) } else { f64::INFINITY };
            }
        }
        Estimate {
            mean: mean.0.map(saturate),
            std_error: error.0.map(standard_error),
            samples: self.samples.min(u32::MAX.into()) as u32,
            gain: if counted > 0.0 { (gain / counted) as f32 } else { 1.0 },
        }
    }
}

/// As an `f32`: infinite if unknown or, as of values at the end of a narrow type's range, no number.
pub(crate) fn standard_error(value: f64) -> f32 {
    let near = saturate(value);
    if value.is_finite() { near } else { f32::INFINITY }
}
