//! How far each fit of a group is trusted.

use super::super::config::Config;
use super::super::trust;
use super::Call;
use super::batch::{Batch, COLOURS, Eight, MAX_FIXED, MAX_VALUES, NONE, only, plus};
use super::fit::{Colours, Fits, OfFits};
use super::terms::{MAX_FITS, Terms};
use crate::lanes::{self, LANES};
use crate::linalg::{ldlt, packed_len, row, row_mut};
use crate::real::Real;
use crate::rows::row_at;
use core::f32::consts::LOG2_E;
use core::hint::black_box;

/// How much what independent samples say for a fit within their pixels counts, beside what the pixels' spread says.
/// What they say against one counts whole.
const WITHIN: f32 = 0.25;
/// The most estimates to choose from: the plain mean and that with each fit, then the same less what is known.
pub(super) const MAX_CHOICES: usize = 2 * (1 + MAX_FITS);

/// For each of them, a number.
pub(super) type Each = [Eight; MAX_CHOICES];

/// The estimates' spreads across pixels: sums of squares about their linear trend along the axes.
///
/// The signal's own spread is common to all candidates, so that the difference is the error's, however the samples are
/// correlated; what the trend takes away is almost only signal.
pub(super) struct Spreads {
    /// Of each channel.
    pub(super) sums: [Each; Config::MAX_CHANNELS],
    /// The trends of each channel.
    trends: [[[Eight; MAX_FIXED]; MAX_CHOICES]; Config::MAX_CHANNELS],
    /// Pixels less the trend's coefficients, at least 0.
    pub(super) freedom: Eight,
    pub(super) choices: Choices,
    /// What the fits leave of the samples of each colour about their pixels' means; see [`Fits::within`].
    within: [[OfFits; COLOURS]; MAX_VALUES],
    /// Pixels of each colour, if they have several samples.
    pixels: [Eight; COLOURS],
    taken: Colours,
}

impl Spreads {
    /// Of pixels of the colours `taken`.
    #[inline(always)]
    pub(super) fn new(call: &Call<'_>, terms: &Terms, batch: &Batch<'_>, fits: &Fits<'_>, taken: Colours) -> Self {
        let (fixed, channels) = (terms.fixed(), call.config.channels);
        let joined = |sum: &Eight| if batch.is_joined { [lanes::sum(sum); LANES] } else { *sum };
        let mut factor = [NONE; packed_len(MAX_FIXED)];
        for slot in (0..batch.slots).filter(|&slot| taken.has(slot)) {
            let inside = batch.inside.get(slot).copied().unwrap_or(NONE);
            let places = row_at(batch.places, fixed, slot);
            for (j, place) in places.iter().enumerate() {
                let place = lanes::zip(place, &inside, |place, inside| place * inside);
                for (sum, other) in row_mut(&mut factor, j).iter_mut().zip(places) {
                    lanes::add_product(sum, &place, other);
                }
            }
        }
        factor.iter_mut().for_each(|sum| *sum = joined(sum));
        let mut freedom = factor[0];
        ldlt::factor_each(&mut factor, fixed);
        for j in 0..fixed {
            let inverse = row(&factor, j).last().copied().unwrap_or(NONE);
            freedom = lanes::zip(&freedom, &inverse, |freedom, inverse| {
                Real::max(if inverse > 0.0 { freedom - 1.0 } else { freedom }, 0.0)
            });
        }
        let mut spreads = Self {
            sums: [[NONE; MAX_CHOICES]; Config::MAX_CHANNELS],
            trends: [[[NONE; MAX_FIXED]; MAX_CHOICES]; Config::MAX_CHANNELS],
            freedom,
            choices: Choices {
                fits: terms.ends.len(),
                channels,
                count: (1 + terms.ends.len()) * batch.values / channels.max(1),
            },
            within: fits.within,
            pixels: [NONE; COLOURS],
            taken,
        };
        for slot in 0..batch.slots {
            let inside = batch.inside.get(slot).copied().unwrap_or(NONE);
            spreads.pixels[slot % COLOURS] = lanes::zip(&spreads.pixels[slot % COLOURS], &inside, |sum, inside| {
                sum + if call.n > 1 { inside } else { 0.0 }
            });
        }
        spreads.pixels.iter_mut().for_each(|sum| *sum = joined(sum));
        for channel in 0..channels {
            for choice in 0..spreads.choices.count {
                let mut square = NONE;
                let mut trend = [NONE; MAX_FIXED];
                for slot in (0..batch.slots).filter(|&slot| taken.has(slot)) {
                    let estimate = spreads.choices.estimate(batch, fits, (slot, channel, choice));
                    lanes::add_product(&mut square, &estimate, &estimate);
                    for (sum, place) in trend.iter_mut().zip(row_at(batch.places, fixed, slot)) {
                        lanes::add_product(sum, &estimate, place);
                    }
                }
                trend.iter_mut().for_each(|sum| *sum = joined(sum));
                ldlt::solve_each(&factor, trend.get_mut(..fixed).unwrap_or(&mut []));
                if let Some(out) = spreads.trends.get_mut(channel).and_then(|trends| trends.get_mut(choice)) {
                    *out = trend;
                }
                // The difference of the sums of squares would lose the digits that matter beside a strong trend.
                let mut left = NONE;
                for slot in (0..batch.slots).filter(|&slot| taken.has(slot)) {
                    let rest = spreads.rest(batch, fits, (slot, channel, choice));
                    lanes::add_product(&mut left, &rest, &rest);
                }
                // What is left of a signal that is its trend is rounding noise.
                let (left, square) = (joined(&left), joined(&square));
                let sum = spreads.sums.get_mut(channel).and_then(|sums| sums.get_mut(choice));
                for (l, sum) in sum.into_iter().flatten().enumerate() {
                    let noise = square[l % LANES] * (f32::EPSILON * f32::EPSILON * 4096.0);
                    let is_some = left[l % LANES] > noise && freedom[l % LANES] > 0.0;
                    *sum = if is_some { left[l % LANES] } else { 0.0 };
                }
            }
        }
        spreads
    }

    /// What an estimate of a slot leaves of its trend.
    #[inline(always)]
    fn rest(&self, batch: &Batch<'_>, fits: &Fits<'_>, (slot, channel, choice): (usize, usize, usize)) -> Eight {
        let places = batch.places.len().checked_div(batch.slots).unwrap_or(0);
        let trend = self.trends.get(channel).and_then(|trends| trends.get(choice)).into_iter().flatten();
        let rest = self.choices.estimate(batch, fits, (slot, channel, choice));
        let places = row_at(batch.places, places, slot);
        let rest =
            places.iter().zip(trend).fold(rest, |rest, (place, slope)| lanes::minus_product(rest, *place, *slope));
        only(&batch.inside.get(slot).copied().unwrap_or(NONE), &rest)
    }

    /// What the samples say about a channel within their pixels, and how many pixels.
    #[inline(always)]
    fn inside(&self, channel: usize) -> (Each, Eight) {
        let mut within = [NONE; MAX_CHOICES];
        let mut count = NONE;
        for (_, pixels) in self.pixels.iter().enumerate().filter(|&(colour, _)| self.taken.has(colour)) {
            count = plus(&count, pixels);
        }
        for (choice, sum) in within.iter_mut().enumerate().take(self.choices.count) {
            let (value, fit) = self.choices.value_and_fit(channel, choice);
            let colours = self.within.get(value).into_iter().flatten().enumerate();
            for (_, each) in colours.filter(|&(colour, _)| self.taken.has(colour)) {
                *sum = plus(sum, &each.get(fit).copied().unwrap_or(NONE));
            }
        }
        (within, count)
    }

    /// How a channel's correction is shared out.
    #[inline(always)]
    pub(super) fn shares(&self, channel: usize, is_stratified: bool) -> Each {
        let sums = self.sums.get(channel).copied().unwrap_or([NONE; MAX_CHOICES]);
        let (within, pixels) = self.inside(channel);
        // Stratified samples' means differ by less than their variance within pixels tells: it may only warn.
        share(&sums, self.choices.count, &self.freedom, &within, &pixels, if is_stratified { 0.0 } else { WITHIN })
    }

    /// A mixture's spread relative to the plain mean's, by the samples within pixels where `inside`.
    #[inline(always)]
    pub(super) fn ratio(&self, channel: usize, shares: &Each, inside: bool) -> Eight {
        let sums = if inside {
            self.inside(channel).0
        } else {
            self.sums.get(channel).copied().unwrap_or([NONE; MAX_CHOICES])
        };
        let mixed = sums.iter().zip(shares).take(self.choices.count);
        let mixed = mixed.fold(NONE, |mixed, (sum, share)| lanes::plus_product(mixed, *sum, *share));
        // Behind a black box, or compilers divide a lane or two, and what else their vector holds.
        let mut ratio =
            black_box(lanes::zip(&mixed, &lanes::divisor(&no_less(&sums[0])), |mixed, plain| mixed / plain));
        for l in 0..LANES {
            ratio[l] = if sums[0][l] > 0.0 && ratio[l].is_finite() { ratio[l] } else { 1.0 };
        }
        ratio
    }
}

/// The estimates to choose from.
#[derive(Clone, Copy)]
pub(super) struct Choices {
    channels: usize,
    /// Candidates for each value.
    fits: usize,
    pub(super) count: usize,
}

impl Choices {
    /// Which value of a sample a choice is of, and which fit it has: 0 for none.
    #[inline(always)]
    pub(super) fn value_and_fit(&self, channel: usize, choice: usize) -> (usize, usize) {
        if choice <= self.fits { (channel, choice) } else { (self.channels + channel, choice - self.fits - 1) }
    }

    /// An estimate of a slot's pixels.
    #[inline(always)]
    fn of_all(&self, batch: &Batch<'_>, fits: &Fits<'_>, (slot, channel, choice): (usize, usize, usize)) -> Eight {
        let (value, fit) = self.value_and_fit(channel, choice);
        let mean = batch.means.get(slot * batch.values + value).copied().unwrap_or(NONE);
        match fit.checked_sub(1) {
            Some(fit) => plus(&mean, &fits.correction((slot, value, fit))),
            None => mean,
        }
    }

    /// The same; 0 outside.
    #[inline(always)]
    fn estimate(&self, batch: &Batch<'_>, fits: &Fits<'_>, at: (usize, usize, usize)) -> Eight {
        let inside = batch.inside.get(at.0).copied().unwrap_or(NONE);
        only(&inside, &self.of_all(batch, fits, at))
    }
}

/// Sums of squares, none below what is nothing beside the unit and yet has quotients that are numbers.
#[inline(always)]
fn no_less(sums: &Eight) -> Eight {
    sums.map(|sum| Real::max(sum, 1e-24))
}

/// All trust in the last of `choices`.
pub(super) fn last_only(choices: usize) -> Each {
    let mut shares = [NONE; MAX_CHOICES];
    if let Some(last) = choices.checked_sub(1).and_then(|last| shares.get_mut(last)) {
        *last = [1.0; LANES];
    }
    shares
}

/// Trust by spreads, of the plain mean first: [`trust::weigh`] in each lane.
#[inline(always)]
fn share(spreads: &Each, choices: usize, freedom: &Eight, within: &Each, pixels: &Eight, part: f32) -> Each {
    let [plain, spreads @ ..] = spreads;
    let [noise, within @ ..] = within;
    let [inverse, inverse_noise] = [plain, noise].map(|plain| lanes::divisor(&no_less(plain)).map(|plain| 1.0 / plain));
    let [power, power_within] = [freedom, pixels].map(|count| count.map(|count| count * -trust::SHARPNESS as f32));
    let has_samples = pixels[0] > 0.0;
    let mut shares = [NONE; MAX_CHOICES];
    let [mean, rest @ ..] = &mut shares;
    let rest = rest.get_mut(..choices.saturating_sub(1)).unwrap_or(&mut []);
    let mut largest = NONE;
    for ((share, spread), within) in rest.iter_mut().zip(spreads).zip(within) {
        // What is no number is trusted least.
        let limited = |ratio: f32| {
            if ratio < 1e-30 {
                1e-30
            } else if ratio < 1e30 {
                ratio
            } else {
                1e30
            }
        };
        let ratio = lanes::zip(spread, &inverse, |spread, inverse| limited(spread * inverse));
        *share = lanes::zip(&lanes::log2(&ratio), &power, |logarithm, power| logarithm * power);
        if has_samples {
            let ratio = lanes::zip(within, &inverse_noise, |within, inverse| limited(within * inverse));
            let logarithm = lanes::log2(&ratio).map(|value| if value < 0.0 { part * value } else { value });
            *share = lanes::plus_product(*share, logarithm, power_within);
        }
        largest = lanes::zip(&largest, share, |largest, share| if share > largest { share } else { largest });
    }
    let prior = Real::ln(trust::PRIOR as f32 * rest.len() as f32) * LOG2_E;
    *mean = lanes::zip(&largest, freedom, |largest, freedom| {
        let caution = largest - freedom * freedom * (LOG2_E / trust::CAUTION as f32);
        if caution > 0.0 { prior + caution } else { prior }
    });
    largest = lanes::zip(&largest, mean, |largest, mean| if mean > largest { mean } else { largest });
    let mut total = NONE;
    for share in [&mut *mean].into_iter().chain(rest.iter_mut()) {
        *share = lanes::exp2(&lanes::zip(share, &largest, |share, largest| share - largest));
        total = plus(&total, share);
    }
    // Without a spread, or noise within pixels, the mean is exact.
    let varies =
        lanes::zip(plain, noise, |plain, noise| if plain > 0.0 && (noise > 0.0 || !has_samples) { 1.0 } else { 0.0 });
    let scale = lanes::zip(&varies, &lanes::divisor(&total), |varies, total| varies / total);
    let exact = varies.map(|varies| 1.0 - varies);
    *mean = plus(&exact, &lanes::zip(mean, &scale, |share, scale| share * scale));
    for share in rest {
        *share = lanes::zip(share, &scale, |share, scale| share * scale);
    }
    shares
}
