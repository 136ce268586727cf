//! From the corrections of groups to the pixels' estimates.

use super::super::config::{Config, Estimate};
use super::super::result::{mean_divisor, saturate};
use super::call::Call;
use super::groups::{Groups, Kind, Place};
use super::products::*;

/// Sums of a pixel that are not a channel's: the weight of the groups that it was in, of those with an error, and their
/// gain.
const COMMON: usize = 3;
/// The largest correction that the windows of a pixel may add up: their weights are at most 512.
const MOST: f32 = (1_u128 << 118) as f32;

/// The square of a likely correction of a pixel of `n` samples, two or more, is at most this many times the variance of
/// their mean: the square, or within 2 % of it, of what Student's t of n - 1 degrees of freedom is below as often as a
/// normal number is below two standard deviations.
fn most_likely(n: usize) -> f64 {
    match n {
        2 => 195.1,
        3 => 20.5,
        _ => 4.0 + 10.3 / (n as f64 - 2.5),
    }
}

/// Numbers that are summed for each pixel over the groups that it was in; of each channel the correction and what the
/// standard error comes from.
pub(super) const fn sums_len(channels: usize) -> usize {
    COMMON + 2 * channels
}

/// The sums of some rows of pixels: row y is row y modulo `rows`, and has eight pixels side by side.
pub(super) struct Band<'a> {
    sums: &'a mut [Eight],
    rows: usize,
}

/// A number for each of eight pixels, with which the last operations are done.
type Wide = Lanes<f64>;

fn wide(a: &Eight) -> Wide {
    let mut out = [0.0; LANES];
    for l in 0..LANES {
        out[l] = f64::from(a[l]);
    }
    out
}

/// [`saturate`] lane by lane, in vectors.
fn narrow(a: &Wide) -> Eight {
    let limited = lanes::zip(a, &[f64::from(f32::MAX); LANES], |value, most| Real::max(Real::min(value, most), -most));
    let mut out = NONE;
    for l in 0..LANES {
        out[l] = limited[l] as f32;
    }
    out
}

/// 1 / a lane by lane, where that is positive.
fn inverse(a: &Eight) -> Wide {
    lanes::zip(&[1.0; LANES], &lanes::divisor(&wide(a)), |one, a| one / a)
}

/// From 1 at the centre linearly to almost 0 at the ends.
fn hat(place: u32, over_extent: f32) -> f32 {
    1.0 - Real::abs((2 * place as i32 + 1) as f32 * over_extent - 1.0)
}

/// Eight numbers, each so many after the one before; 0 where there is none. Inlined: a call takes as long for a sample.
#[inline(always)]
fn every(step: usize, numbers: &[f32]) -> Eight {
    fn of<const STEP: usize>(numbers: &[f32]) -> Option<Eight> {
        Some(numbers.as_chunks::<STEP>().0.first_chunk::<LANES>()?.map(|row| row[0]))
    }
    // Without a look for each whether it is there.
    let all = match step {
        1 => of::<1>(numbers),
        2 => of::<2>(numbers),
        3 => of::<3>(numbers),
        4 => of::<4>(numbers),
        _ => None,
    };
    all.unwrap_or_else(|| core::array::from_fn(|lane| at(numbers, lane * step)))
}

/// Adds the first `count` lanes to the sums of the pixels that are at `spots`.
#[inline(always)]
fn scatter<const LEN: usize>(band: &mut [Eight], spots: [u32; LANES], sums: &[Eight], count: usize) {
    let Some(sums) = sums.first_chunk::<LEN>() else { return };
    let begins = spots.map(|spot| spot / LANES as u32 * LEN as u32);
    for lane in 0..count.min(LANES) {
        let out = band.get_mut(begins[lane] as usize..);
        let Some(out) = out.and_then(|out| out.first_chunk_mut::<LEN>()) else { return };
        let spot = spots[lane] as usize % LANES;
        for (out, sum) in out.iter_mut().zip(sums) {
            out[spot] += sum[lane];
        }
    }
}

impl<'a> Band<'a> {
    pub(super) fn new(call: &Call<'_>, rows: usize, arena: &mut Arena<'a, f32>) -> Self {
        let eights = call.eights().saturating_mul(rows).saturating_mul(call.windows.frames());
        let sums = arena.take_lanes(eights.saturating_mul(sums_len(call.config.channels)));
        empty(sums);
        Self { sums, rows }
    }
}

impl Call<'_> {
    /// Groups of eight in a row of pixels.
    fn eights(&self) -> usize {
        self.windows.needed.width.div_ceil(LANES)
    }

    /// Adds the groups' corrections to the sums of their pixels, in the order of the windows.
    #[inline(always)]
    pub(super) fn add(&self, groups: &Groups<'_>, band: &mut Band<'_>) {
        let channels = self.config.channels;
        let [rows, width] = [band.rows, self.eights() * LANES].map(|extent| extent as u32);
        let [across, down, _] = self.windows.extent.map(|extent| (1.0 / extent.max(1) as f64) as f32);
        let all = self.fits_without_edges();
        let numbered = (0..groups.count).map(|index| groups.numbered(index));
        for group in numbered.filter(|group| all || group.kind == Kind::Edges) {
            let Some(([gain, has_error], errors)) = groups.found(&group).0.split_first_chunk() else { continue };
            let window = self.window(group.window);
            let (left, top) = (window[0] - self.windows.needed.x, window[1] % band.rows.max(1));
            let members = groups.members(&group);
            let corrections = from(groups.corrections, group.start * channels);
            for begin in (0..group.len).step_by(LANES) {
                let mut places = [Place::read(0.0); LANES];
                for (place, &member) in places.iter_mut().zip(from(members, begin)) {
                    *place = Place::read(member);
                }
                // Where the pixels have their sums, and how near each is to its window's centre.
                let mut spots = core::array::from_fn(|lane| (begin + lane) as u32);
                let mut near = [1.0; LANES];
                let [x, y, frame] = Place::split_each(&places);
                if self.windows.is_ordered {
                    for l in 0..LANES {
                        let row = top as u32 + y[l];
                        let row = frame[l] * rows + if row < rows { row } else { row - rows };
                        spots[l] = row * width + left as u32 + x[l];
                        near[l] = hat(x[l], across) * hat(y[l], down);
                    }
                } else if !self.is_joined() {
                    spots = x;
                }
                let mut sums = [NONE; sums_len(Config::MAX_CHANNELS)];
                sums[0] = near;
                sums[1] = product(&near, &[*has_error; LANES]);
                sums[2] = product(&near, &[*gain; LANES]);
                let (_, each) = halves_mut(&mut sums, COMMON);
                for (each, (channel, &error)) in each.as_chunks_mut().0.iter_mut().zip(errors.iter().enumerate()) {
                    let mut both = [every(1, from(corrections, channel * group.len + begin)), [error; LANES]];
                    if !self.image.factors.is_empty() {
                        self.times_factors(window, &places, begin, channel, &mut both);
                    }
                    // What cannot be added up is infinite, and found at the end.
                    *each = both.map(|values| {
                        lanes::zip(&near, &values, |near, value| {
                            near * if Real::abs(value) < MOST { value } else { f32::INFINITY }
                        })
                    });
                }
                let (sums, count) = (&sums, group.len - begin);
                match channels {
                    1 => scatter::<{ sums_len(1) }>(band.sums, spots, sums, count),
                    2 => scatter::<{ sums_len(2) }>(band.sums, spots, sums, count),
                    3 => scatter::<{ sums_len(3) }>(band.sums, spots, sums, count),
                    _ => scatter::<{ sums_len(4) }>(band.sums, spots, sums, count),
                }
            }
        }
    }

    /// Corrections and errors of pixels whose values were divided by factors.
    fn times_factors(
        &self,
        window: [usize; 2],
        places: &[Place; LANES],
        begin: usize,
        channel: usize,
        [corrections, errors]: &mut [Eight; 2],
    ) {
        let times = |value: f32, factor: f64| saturate(f64::from(value) * factor);
        for (lane, &place) in places.iter().enumerate() {
            let factor = self.factor(self.pixel(window, place, begin + lane), channel);
            corrections[lane % LANES] = times(corrections[lane % LANES], factor);
            errors[lane % LANES] = times(errors[lane % LANES], if self.error_is_the_groups() { factor } else { 1.0 });
        }
    }

    /// Writes a row of pixels, and empties its sums.
    #[inline(always)]
    pub(super) fn write(&self, (frame, y): (usize, usize), band: &mut Band<'_>, out: &mut dyn FnMut(usize, Estimate)) {
        let (needed, wanted) = (self.windows.needed, self.windows.wanted);
        let (len, samples) = (sums_len(self.config.channels), self.n.min(u32::MAX as usize) as u32);
        let row = frame * band.rows + y % band.rows.max(1);
        let sums = row_at_mut(band.sums, self.eights() * len, row);
        for (eight, sums) in rows_mut(sums, len).enumerate() {
            let column = needed.x + eight * LANES;
            if y >= wanted.y && column < wanted.x + wanted.width && wanted.x < column + LANES {
                let begin = (frame * wanted.height + y - wanted.y) * wanted.width;
                let mut estimates = [Estimate { mean: [0.0; 4], std_error: [0.0; 4], samples, gain: 1.0 }; LANES];
                let there = LANES.min(needed.x + needed.width - column);
                self.estimate((self.windows.number(column, y, frame), there), sums, &mut estimates);
                for (lane, &estimate) in estimates.iter().enumerate() {
                    let x = (column + lane).wrapping_sub(wanted.x);
                    if x < wanted.width {
                        out(begin + x, estimate);
                    }
                }
            }
            empty(sums);
        }
    }

    /// Of eight pixels from one on, as many of which are there.
    #[inline(always)]
    fn estimate(&self, pixels: (usize, usize), sums: &[Eight], out: &mut [Estimate; LANES]) {
        let Some(([weight, error_weight, gain], each)) = sums.split_first_chunk() else { return };
        let (by_groups, likely) = (self.error_is_the_groups(), most_likely(self.n));
        // Without a weight all sums are zero.
        let [over, error_over] = [weight, error_weight].map(inverse);
        let gain = narrow(&lanes::zip(&wide(gain), &over, |gain, over| gain * over));
        let mut gain = lanes::zip(&gain, weight, |gain, weight| if weight > 0.0 { gain } else { 1.0 });
        for (channel, [correction, spread]) in each.as_chunks().0.iter().enumerate() {
            let correction = lanes::zip(&wide(correction), &over, |correction, over| correction * over);
            let spread = lanes::zip(&wide(spread), &error_over, |spread, over| spread * over);
            let first = self.given(pixels, 0, channel);
            let (mut plain, mut variance) = (first, [f64::INFINITY; LANES]);
            if self.n > 1 {
                let [mut total, mut square] = [[0.0; LANES]; 2];
                for sample in 1..self.n {
                    let value = lanes::zip(&self.given(pixels, sample, channel), &first, |value, first| value - first);
                    total = lanes::zip(&total, &value, |total, value| total + value);
                    square = lanes::plus_product(square, value, value);
                    lanes::keep_together();
                }
                let n = self.n as f64;
                for l in 0..LANES {
                    plain[l] += total[l] / n;
                    variance[l] = (square[l] - total[l] * total[l] / n).max(0.0) / mean_divisor(n);
                }
            }
            // A correction that left the type's range is none.
            let (mut mean, mut told) = (plain, [f64::INFINITY; LANES]);
            if self.n > 1 {
                for l in 0..LANES {
                    let is_corrected = correction[l].is_finite();
                    let has_ratio = is_corrected & (error_weight[l] > 0.0) & !by_groups;
                    let ratio = if has_ratio { spread[l] * spread[l] } else { 1.0 };
                    // A correction that the pixel's own samples make unlikely is an error.
                    let moved = if is_corrected { correction[l] * correction[l] } else { 0.0 };
                    told[l] = ratio * variance[l] + (moved - likely * variance[l]).max(0.0);
                }
                told = told.map(libm::sqrt);
            }
            for l in 0..LANES {
                let is_corrected = correction[l].is_finite();
                let has_error = is_corrected & (error_weight[l] > 0.0);
                mean[l] = if is_corrected { plain[l] + correction[l] } else { plain[l] };
                gain[l] = if is_corrected { gain[l] } else { 1.0 };
                told[l] = if by_groups & has_error { spread[l] } else { told[l] };
            }
            let (mean, mut error) = (narrow(&mean), narrow(&told));
            // As `standard_error` has it.
            for l in 0..LANES {
                error[l] = if told[l] < f64::INFINITY { error[l] } else { f32::INFINITY };
            }
            for l in 0..LANES {
                let Estimate { mean: means, std_error: errors, .. } = &mut out[l];
                (means[channel % means.len()], errors[channel % errors.len()]) = (mean[l], error[l]);
            }
        }
        for l in 0..LANES {
            out[l].gain = gain[l];
        }
    }

    /// A channel of a sample of each pixel, as it was given; 0 of those that are not there.
    fn given(&self, (pixel, there): (usize, usize), sample: usize, channel: usize) -> Wide {
        let (channels, step) = (self.config.channels, self.held * self.config.channels);
        let numbers = from(self.reader.samples.f, (pixel * self.held + sample) * channels + channel);
        let all = if there == LANES { numbers } else { first(numbers, (there.max(1) - 1) * step + 1) };
        wide(&every(step, all))
    }
}
