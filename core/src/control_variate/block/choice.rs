//! How far each fit of a block is trusted.

use super::super::config::Config;
use super::super::per_channel::{PerChannel, get, set};
use super::super::trust;
use super::panel::only_used;
use super::terms::{MAX_AXES, MAX_FITS};
use crate::lanes::{self, LANES, Lanes};
use crate::linalg::{ldlt, packed_len, row_mut};
use crate::real::Real;
use crate::rows::rows;

/// The estimates' spreads across pixels: sums of squares about their linear trend along the axes.
///
/// The signal's own spread is common to all candidates, so that the difference is the error's, however the samples are
/// correlated; what the trend takes away is almost only signal.
pub(super) struct Spreads<R> {
    /// The plain mean's first.
    sums: [PerChannel<R>; MAX_FITS + 1],
    pub(super) fits: usize,
    /// Pixels less the trend's coefficients.
    pub(super) freedom: R,
}

/// A number for the plain mean, then for each fit, of each channel.
pub(super) type Weights<R> = [PerChannel<R>; MAX_FITS + 1];

impl<R: Real> Spreads<R> {
    /// Panel after panel of eight pixels, `pixels` in all: `places` has the groups of lanes of
    /// [`Members::places`](super::members::Members::places), `fixed` of them, and `estimates` the plain means of all
    /// channels, then each fit's.
    #[inline(always)]
    pub(super) fn new(
        pixels: usize,
        places: &[Lanes<R>],
        fixed: usize,
        estimates: &[Lanes<R>],
        fits: usize,
        channels: usize,
        leaves_out: bool,
    ) -> Self {
        const FIXED: usize = 1 + MAX_AXES;
        let mut trend = [R::ZERO; packed_len(FIXED)];
        for places in rows(places, fixed) {
            for (j, place) in places.iter().enumerate() {
                for (sum, other) in row_mut(&mut trend, j).iter_mut().zip(places) {
                    *sum += lanes::sum(&lanes::zip(place, other, |a, b| a * b));
                }
            }
        }
        ldlt::factor(&mut trend, fixed);
        let rank = (0..fixed).filter(|&j| ldlt::inverse_pivot(&trend, j) > R::ZERO).count();
        // Those of pixels that are left out tell nothing.
        let read = |row: &[Lanes<R>], index: usize, places: &[Lanes<R>]| {
            let estimate = row.get(index).copied().unwrap_or([R::ZERO; LANES]);
            if leaves_out { only_used(&estimate, places) } else { estimate }
        };
        let freedom = R::from_usize(pixels.saturating_sub(rank));
        let mut sums = [PerChannel::default(); MAX_FITS + 1];
        for (fit, sums) in sums.iter_mut().enumerate().take(fits + 1) {
            for channel in 0..channels {
                let mut square = [R::ZERO; LANES];
                let mut products = [[R::ZERO; LANES]; FIXED];
                for (places, row) in rows(places, fixed).zip(rows(estimates, (fits + 1) * channels)) {
                    let estimate = read(row, fit * channels + channel, places);
                    lanes::add_product(&mut square, &estimate, &estimate);
                    for (product, place) in products.iter_mut().zip(places) {
                        lanes::add_product(product, &estimate, place);
                    }
                }
                let whole = lanes::sum(&square);
                let mut explained = products.map(|product| lanes::sum(&product));
                let explained = explained.get_mut(..fixed).unwrap_or(&mut []);
                ldlt::forward(&trend, explained);
                ldlt::scale_by_inverse_diagonal(&trend, explained);
                ldlt::backward(&trend, explained);
                // The difference of the sums of squares would lose the digits that matter beside a strong trend.
                let mut left = [R::ZERO; LANES];
                for (places, row) in rows(places, fixed).zip(rows(estimates, (fits + 1) * channels)) {
                    let mut rest = read(row, fit * channels + channel, places);
                    for (place, &slope) in places.iter().zip(explained.iter()) {
                        lanes::subtract_scaled(&mut rest, slope, place);
                    }
                    lanes::add_product(&mut left, &rest, &rest);
                }
                let left = lanes::sum(&left);
                // What is left of a signal that is its trend, or of as many pixels as the trend has coefficients, is
                // rounding noise.
                let noise = whole * R::EPSILON * R::EPSILON * R::from_f64(4096.0);
                set(sums, channel, if left <= noise || freedom <= R::ZERO { R::ZERO } else { left });
            }
        }
        Self { sums, fits, freedom }
    }

    /// The plain mean and the fits, each trusted by its spread.
    #[inline(always)]
    pub(super) fn weights(&self, channels: usize) -> Weights<R> {
        let mut weights = [PerChannel::default(); MAX_FITS + 1];
        for channel in 0..channels {
            let mut sums = [R::ZERO; MAX_FITS + 1];
            for (out, sum) in sums.iter_mut().zip(&self.sums) {
                *out = get(sum, channel);
            }
            let [plain, fits @ ..] = sums;
            let mut trusted = [R::ZERO; MAX_FITS];
            let power = self.freedom * R::from_f64(trust::SHARPNESS);
            let (fits, used) = (fits.get(..self.fits).unwrap_or(&[]), trusted.get_mut(..self.fits).unwrap_or(&mut []));
            let prior = R::from_f64(trust::PRIOR);
            let plain = trust::weigh(plain, fits, &[], power, self.freedom, prior, used);
            for (out, weight) in weights.iter_mut().zip([plain].into_iter().chain(trusted)) {
                set(out, channel, weight);
            }
        }
        weights
    }

    /// The spread of a mixture relative to the plain mean's, or 1 if there is no such number.
    #[inline(always)]
    pub(super) fn gain(&self, weights: &Weights<R>, channel: usize) -> R {
        let plain = get(&self.sums[0], channel);
        let gain = self.mixed(weights, channel) / plain.or_one();
        if plain > R::ZERO && gain.is_finite() { gain } else { R::ONE }
    }

    /// A mixture's spread per degree of freedom, of which there must be some: the variance of its estimates, and what
    /// signal is left in it.
    #[inline(always)]
    pub(super) fn variance(&self, weights: &Weights<R>, channel: usize) -> R {
        self.mixed(weights, channel) / self.freedom
    }

    fn mixed(&self, weights: &Weights<R>, channel: usize) -> R {
        let pairs = self.sums.iter().zip(weights).take(self.fits + 1);
        pairs.fold(R::ZERO, |sum, (spread, weight)| sum + get(weight, channel) * get(spread, channel))
    }
}

/// All trust in the last of `fits` fits.
pub(super) fn last_only<R: Real>(fits: usize) -> Weights<R> {
    let mut weights = [PerChannel::default(); MAX_FITS + 1];
    if let Some(last) = weights.get_mut(fits) {
        *last = [R::ONE; Config::MAX_CHANNELS];
    }
    weights
}
