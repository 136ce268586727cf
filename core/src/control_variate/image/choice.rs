//! How far each fit of a group is trusted.

use super::super::trust;
use super::batch::{Batch, MAX_FIXED};
use super::call::Call;
use super::fit::Fits;
use super::products::*;
use super::terms::Terms;
use core::f32::consts::LOG2_E;
use core::hint::black_box;

/// How much what samples say for a fit within their pixels counts, beside what the pixels' spread says. What they say
/// against one counts whole.
const WITHIN: f32 = 0.25;
/// The same for fits to stratified samples, whose means differ by less, unless to what is left of light that is known.
const WITHIN_STRATIFIED: f32 = 0.05;
/// How much what a colour's own pixels say counts where it is chosen for it.
const OWN: f32 = 0.85;
/// How much sharper that choice is.
const SHARPER: f32 = 1.05;
/// With less freedom a colour has too few pixels to do without any: all choose alike.
const ENOUGH: f32 = 16.0;

/// The estimates to choose from: the plain mean and that with each fit, then the same less what is known.
#[derive(Clone, Copy)]
pub(super) struct Choices {
    channels: usize,
    /// Candidates for each value.
    fits: usize,
    /// Whether the last of them is an edge.
    has_edges: bool,
    pub(super) count: usize,
}

impl Choices {
    pub(super) fn new(call: &Call<'_>, terms: &Terms) -> Self {
        let (channels, fits, has_edges) = (call.config.channels, terms.candidates(), terms.has_edges);
        Self { channels, fits, has_edges, count: (1 + fits) * (call.values() / channels.max(1)) }
    }

    /// Whether a choice is an edge.
    fn is_edge(&self, choice: usize) -> bool {
        self.has_edges && [self.fits, 2 * self.fits + 1].contains(&choice)
    }

    /// How many choices the trust in the plain mean counts: those that every group has.
    fn counted(&self) -> usize {
        let edges = (0..self.count).filter(|&choice| self.is_edge(choice)).count();
        (self.count - 1 - edges).max(1)
    }

    /// Which value of a sample a choice is of, and which fit it has: 0 for none.
    fn value_and_fit(&self, channel: usize, choice: usize) -> (usize, usize) {
        if choice <= self.fits { (channel, choice) } else { (self.channels + channel, choice - self.fits - 1) }
    }

    /// Writes the estimates of a channel of a block's pixels that fits are made to.
    #[inline(always)]
    fn estimate(&self, batch: &Batch<'_>, fits: &Fits<'_>, (block, channel): (usize, usize), estimates: &mut [Four]) {
        let inside = batch.inside.get(block).copied().unwrap_or([NONE; AT_ONCE]);
        for (kind, estimates) in rows_mut(estimates, 1 + self.fits).enumerate() {
            let value = channel + kind * self.channels;
            let Some(mean) = row_at(batch.means, batch.values, block).get(value) else { return };
            let Some((plain, corrected)) = estimates.split_first_mut() else { return };
            *plain = zip_four(&inside, mean, only);
            for (out, correction) in corrected.iter_mut().zip(fits.corrections(block, value)) {
                for row in 0..AT_ONCE {
                    out[row] = only(&inside[row], &plus(&mean[row], &correction[row]));
                }
                lanes::keep_together();
            }
        }
    }
}

/// How often is chosen: for all pixels, and for those of each colour; or, as the first two, for either half.
const CHOSEN: usize = 1 + COLOURS;

/// How far each choice is trusted: of each time that is chosen, channel and choice.
pub(super) struct Shares<'a> {
    all: &'a mut [Eight],
    choices: Choices,
}

impl<'a> Shares<'a> {
    /// All trust in the last choice.
    pub(super) fn last(choices: Choices, arena: &mut Arena<'a, f32>) -> Self {
        let all = arena.take_lanes(CHOSEN * choices.channels * choices.count);
        for shares in rows_mut(all, choices.count) {
            shares.iter_mut().rev().enumerate().for_each(|(k, share)| *share = [if k == 0 { 1.0 } else { 0.0 }; LANES]);
        }
        Self { all, choices }
    }

    /// How a channel's correction is shared out.
    pub(super) fn of(&self, time: usize, channel: usize) -> &[Eight] {
        row_at(self.all, self.choices.count, time * self.choices.channels + channel)
    }

    fn of_mut(&mut self, time: usize, channel: usize) -> &mut [Eight] {
        row_at_mut(self.all, self.choices.count, time * self.choices.channels + channel)
    }
}

/// The estimates' spreads across pixels: sums of squares about their linear trend along the axes.
///
/// The signal's own spread is common to all candidates, so that the difference is the error's, however the samples are
/// correlated; what the trend takes away is almost only signal.
pub(super) struct Spreads<'a> {
    /// Of each channel and choice, of the pixels of each colour.
    across: &'a mut [Four],
    /// The same of what a choice leaves of the samples about their pixels' means; see [`Fits::within`].
    within: &'a mut [Four],
    /// Pixels less the trend's coefficients, at least 0.
    pub(super) freedom: Eight,
    /// Pixels of the colours.
    pixels: Eight,
    has_several: bool,
    choices: Choices,
}

/// What [`Spreads`] are made in: for each channel and choice spreads, a sum of squares and the trend; for each choice
/// an estimate.
pub(super) struct Room<'a> {
    spreads: [&'a mut [Four]; 2],
    squares: &'a mut [Eight],
    trends: &'a mut [Eight],
    estimates: &'a mut [Four],
}

impl<'a> Room<'a> {
    pub(super) fn new(choices: Choices, fixed: usize, arena: &mut Arena<'a, f32>) -> Self {
        let all = choices.channels * choices.count;
        Self {
            spreads: [arena.take_fours(all), arena.take_fours(all)],
            squares: arena.take_lanes(all),
            trends: arena.take_lanes(all * fixed),
            estimates: arena.take_fours(choices.count),
        }
    }
}

impl<'a> Spreads<'a> {
    /// Of pixels of the colours `taken`.
    #[inline(always)]
    pub(super) fn new(
        choices: Choices,
        batch: &Batch<'_>,
        fits: &Fits<'_>,
        taken: Colours,
        arena: &mut Arena<'a, f32>,
    ) -> Self {
        let fixed = batch.terms.fixed();
        let Room { spreads: [across, within], squares, trends, estimates } = Room::new(choices, fixed, arena);
        let sums = [&mut *squares, trends, across.as_flattened_mut(), within.as_flattened_mut()];
        sums.into_iter().flatten().for_each(|sum| *sum = NONE);
        let mut factor = [NONE; packed_len(MAX_FIXED)];
        for block in batch.blocks(taken) {
            let places = row_at(batch.places, fixed, block);
            let Some(inside) = batch.inside.get(block) else { continue };
            for (j, place) in places.iter().enumerate() {
                let place = zip_four(inside, place, only);
                add_products(row_mut(&mut factor, j), &place, places);
            }
            for channel in 0..choices.channels {
                choices.estimate(batch, fits, (block, channel), estimates);
                let squares = row_at_mut(squares, choices.count, channel);
                let trends = rows_mut(row_at_mut(trends, choices.count * fixed, channel), fixed);
                for ((estimate, square), trend) in estimates.iter().zip(squares).zip(trends) {
                    *square = plus_four(*square, estimate, estimate);
                    add_products(trend, estimate, places);
                }
            }
        }
        factor.iter_mut().for_each(|sum| *sum = batch.joined(sum));
        let pixels = factor[0];
        ldlt::factor_each(&mut factor, fixed);
        let mut freedom = pixels;
        for j in 0..fixed {
            let inverse = row(&factor, j).last().copied().unwrap_or(NONE);
            freedom = lanes::zip(&freedom, &inverse, |freedom, inverse| {
                Real::max(if inverse > 0.0 { freedom - 1.0 } else { freedom }, 0.0)
            });
        }
        for trend in rows_mut(trends, fixed) {
            trend.iter_mut().for_each(|sum| *sum = batch.joined(sum));
            ldlt::solve_each(&factor, trend);
        }
        // The difference of the sums of squares would lose the digits that matter beside a strong trend.
        for block in batch.blocks(taken) {
            let places = row_at(batch.places, fixed, block);
            let Some(inside) = batch.inside.get(block) else { continue };
            for channel in 0..choices.channels {
                choices.estimate(batch, fits, (block, channel), estimates);
                let sums = row_at_mut(across, choices.count, channel);
                let trends = rows(row_at(trends, choices.count * fixed, channel), fixed);
                for ((estimate, sum), trend) in estimates.iter().zip(sums).zip(trends) {
                    let trend = combine([NONE; AT_ONCE], places, trend);
                    let rest = zip_four(estimate, &trend, minus);
                    let rest = zip_four(inside, &rest, only);
                    for (row, rest) in rest.iter().enumerate() {
                        let sum = &mut sum[batch.colour((block, row))];
                        *sum = lanes::plus_product(*sum, *rest, *rest);
                    }
                    lanes::keep_together();
                }
            }
        }
        for (each, square) in across.iter_mut().zip(squares) {
            each.iter_mut().for_each(|sum| *sum = batch.joined(sum));
            // What is left of a signal that is its trend is rounding noise.
            let (left, square) = (total(each), batch.joined(square));
            for l in 0..LANES {
                let noise = square[l] * (f32::EPSILON * f32::EPSILON * 4096.0);
                let counts = left[l] > noise && freedom[l] > 0.0;
                for each in each.iter_mut() {
                    each[l] = if counts { each[l] } else { 0.0 };
                }
            }
        }
        for (channel, within) in rows_mut(within, choices.count).enumerate() {
            for (choice, each) in within.iter_mut().enumerate() {
                let (value, fit) = choices.value_and_fit(channel, choice);
                for (colour, each) in each.iter_mut().enumerate().filter(|&(colour, _)| taken.has(colour)) {
                    *each = match fit.checked_sub(1) {
                        Some(fit) => fits.within((value, colour), fit),
                        None => batch.whole(value, colour),
                    };
                }
            }
        }
        Self { across, within, freedom, pixels, has_several: batch.call.n > 1, choices }
    }

    /// The sums of a choice, across pixels and within them: for 0 as all pixels count them, else as a colour does. What
    /// its own pixels say of fits to the others is biased by them, and counts less.
    fn sums(&self, channel: usize, choice: usize, by: usize) -> [Eight; 2] {
        [&*self.across, &*self.within].map(|all| {
            let mut each = at(row_at(all, self.choices.count, channel), choice);
            if let Some(each) = by.checked_sub(1).and_then(|colour| each.get_mut(colour)) {
                *each = lanes::zip(each, &self.freedom, |sum, freedom| sum * if freedom < ENOUGH { 1.0 } else { OWN });
            }
            total(&each)
        })
    }

    /// Chooses for all pixels, and for those of each of so many colours, and keeps that from a time on.
    #[inline(always)]
    pub(super) fn choose(
        &self,
        colours: usize,
        time: usize,
        is_stratified: bool,
        present: &Eight,
        shares: &mut Shares<'_>,
    ) {
        let part = if is_stratified { WITHIN_STRATIFIED } else { WITHIN };
        for (by, channel) in (0..=colours).flat_map(|by| (0..self.choices.channels).map(move |channel| (by, channel))) {
            self.share(channel, by, part, present, shares.of_mut(time + by, channel));
        }
    }

    /// Trust by spreads, of the plain mean first: [`Judge::weigh`](trust::Judge::weigh) in each lane. As `part` counts
    /// what samples within pixels say for a fit.
    #[inline(always)]
    fn share(&self, channel: usize, by: usize, part: f32, present: &Eight, shares: &mut [Eight]) {
        let &Self { choices, pixels, has_several, .. } = self;
        let sharper = if by > 0 { SHARPER } else { 1.0 };
        let freedom = lanes::each(&self.freedom, |freedom| freedom * if freedom < ENOUGH { 1.0 } else { sharper });
        let Some((mean, rest)) = shares.split_first_mut() else { return };
        let [plain, noise] = &self.sums(channel, 0, by);
        let [least, least_noise] = [plain, noise].map(no_less);
        let [inverse, inverse_noise] =
            [least, least_noise].map(|least| lanes::each(&lanes::divisor(&least), |least| 1.0 / least));
        let [most, most_noise] = [least, least_noise].map(|least| no_more(&least));
        let [power, power_within] =
            [&freedom, &pixels].map(|count| lanes::each(count, |count| count * -trust::SHARPNESS as f32));
        let mut largest = NONE;
        for (choice, share) in rest.iter_mut().enumerate() {
            let [spread, within] = &self.sums(channel, 1 + choice, by);
            let over = |sum: &Eight, most: &Eight, inverse: &Eight| {
                let told = no_less(&lanes::zip(sum, most, Real::min));
                lanes::zip(&told, inverse, |told, inverse| Real::max(told * inverse, 1e-30))
            };
            let ratio = over(spread, &most, &inverse);
            *share = product(&lanes::log2(&ratio), &power);
            if has_several {
                let ratio = over(within, &most_noise, &inverse_noise);
                let part = if choice < choices.fits { part } else { WITHIN };
                let logarithm =
                    lanes::each(&lanes::log2(&ratio), |value| if value < 0.0 { part * value } else { value });
                *share = lanes::plus_product(*share, logarithm, power_within);
            }
            largest = lanes::zip(&largest, share, |largest, share| if share > largest { share } else { largest });
        }
        let prior = Real::ln(trust::PRIOR as f32 * choices.counted() as f32) * LOG2_E;
        *mean = lanes::zip(&largest, &freedom, |largest, freedom| {
            let caution = largest - freedom * freedom * (LOG2_E / trust::CAUTION as f32);
            if caution > 0.0 { prior + caution } else { prior }
        });
        largest = lanes::zip(&largest, mean, |largest, mean| if mean > largest { mean } else { largest });
        let mut total = NONE;
        for (choice, share) in [&mut *mean].into_iter().chain(rest.iter_mut()).enumerate() {
            *share = lanes::exp2(&minus(share, &largest));
            if choices.is_edge(choice) {
                // Where there is none, it is the plain mean.
                *share = only(if choice > choices.fits { &NONE } else { present }, share);
            }
            total = plus(&total, share);
        }
        // Without a spread, or noise within pixels, the mean is exact.
        let varies = lanes::zip(
            plain,
            noise,
            |plain, noise| if plain > 0.0 && (noise > 0.0 || !has_several) { 1.0 } else { 0.0 },
        );
        let scale = lanes::zip(&varies, &lanes::divisor(&total), |varies, total| varies / total);
        let exact = lanes::each(&varies, |varies| 1.0 - varies);
        *mean = plus(&exact, &product(mean, &scale));
        for share in rest {
            *share = product(share, &scale);
        }
    }

    /// The plain mean's spread.
    pub(super) fn plain(&self, channel: usize) -> Eight {
        let [plain, _] = self.sums(channel, 0, 0);
        plain
    }

    /// A mixture's spread relative to the plain mean's, by the samples within pixels where `inside`.
    pub(super) fn ratio(&self, channel: usize, shares: &[Eight], inside: bool) -> Eight {
        let sum = |choice: usize| {
            let [across, within] = self.sums(channel, choice, 0);
            if inside { within } else { across }
        };
        let plain = sum(0);
        let mixed = shares.iter().enumerate();
        let mixed = mixed.fold(NONE, |mixed, (choice, share)| lanes::plus_product(mixed, sum(choice), *share));
        let least = no_less(&plain);
        let mixed = no_less(&lanes::zip(&mixed, &no_more(&least), Real::min));
        // Behind a black box, or compilers divide a lane or two, and what else their vector holds.
        let mut ratio = black_box(lanes::zip(&mixed, &lanes::divisor(&least), |mixed, plain| mixed / plain));
        for l in 0..LANES {
            ratio[l] = if plain[l] > 0.0 { ratio[l] } else { 1.0 };
        }
        ratio
    }
}

/// Sums of squares, none below what is nothing beside the unit and yet has quotients that are numbers.
fn no_less(sums: &Eight) -> Eight {
    lanes::each(sums, |sum| Real::max(sum, 1e-24))
}

/// What is told of a sum of squares beside one of those; of what is no number, too.
fn no_more(sums: &Eight) -> Eight {
    lanes::each(sums, |sum| Real::min(sum, 1e7) * 1e30)
}
