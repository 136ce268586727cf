//! From the corrections of groups to the pixels' estimates.

use super::super::config::Estimate;
use super::super::result::{mean_divisor, saturate, standard_error};
use super::call::Call;
use super::groups::{Groups, Place};
use super::pixels::Rectangle;
use crate::arena::Arena;
use crate::error::Error;
use crate::matrix::{self, from, from_mut, row_at_mut};
use crate::processor::Processor;
use crate::real::Real;
use crate::rows::rows;
use core::hint::black_box;

/// Sums of a pixel that are not a channel's: the weight of the groups that it was in, of those with an error, and their
/// gain.
const COMMON: usize = 3;
/// The largest correction that the windows of a pixel may add up, 2^120.
const MOST: f32 = (1_u128 << 120) as f32;

/// The square of a likely correction is at most this many times the variance of the mean.
const UNLIKELY: f64 = 4.0;

/// Numbers that are summed for each pixel over the groups that it was in; of each channel the correction and what the
/// standard error comes from.
pub(super) fn sums_len(channels: usize) -> usize {
    COMMON + 2 * channels
}

/// The sums of some rows of pixels: row y is row y modulo `rows`.
struct Band<'a> {
    sums: &'a mut [f32],
    rows: usize,
}

impl Call<'_> {
    /// All of it: windows some rows at a time, and pixels as soon as no later window has them.
    pub(super) fn run<P: Processor>(
        &self,
        arena: &mut Arena<'_, f32>,
        out: &mut dyn FnMut(usize, Estimate),
    ) -> Result<(), Error> {
        let (Rectangle { width, .. }, wanted) = (self.windows.given, self.windows.wanted);
        let frames = self.windows.frames();
        let [across, down] = self.windows.counts();
        let [rows, touched] = self.band();
        let sums = arena.take(width * touched * frames * sums_len(self.config.channels))?;
        sums.iter_mut().for_each(|sum| *sum = 0.0);
        let mut band = Band { sums, rows: touched };
        let mut groups = self.groups(arena)?;
        let has_fits = self.image.has_known() || self.has_edges() || !self.terms(self.windows.pixels()).ends.is_empty();
        let mut done = self.windows.top(0);
        for row in (0..down).step_by(rows.max(1)) {
            let last = (row + rows).min(down);
            for first in (row * across..last * across).step_by(self.windows_at_once().max(1)) {
                if !has_fits {
                    break;
                }
                let end = (first + self.windows_at_once()).min(last * across);
                self.divide(first, end, &mut groups);
                self.find_edges(&mut groups);
                self.fit::<P>(&mut groups, arena)?;
                self.add(first, &groups, &mut band);
            }
            let end = if last < down { self.windows.top(last) } else { wanted.y + wanted.height };
            for frame in 0..frames {
                for y in done..end {
                    self.write(frame, y, &mut band, out);
                }
            }
            done = end;
        }
        Ok(())
    }

    /// Adds the groups' corrections to the sums of their pixels, in the order of the windows.
    #[inline]
    fn add(&self, first: usize, groups: &Groups<'_>, band: &mut Band<'_>) {
        let channels = self.config.channels;
        let given = self.windows.given;
        let has_factors = !self.image.factors.is_empty();
        // How near a pixel is to its window's centre: 1 there, falling linearly along x and y to almost 0.
        let inverse = self.windows.extent.map(|extent| (1.0 / extent.max(1) as f64) as f32);
        let hat = |at: usize, inverse: f32| 1.0 - Real::abs((2 * at as i32 + 1) as f32 * inverse - 1.0);
        for group in groups.in_order(self) {
            let Some(([gain, has_error], errors)) = groups.told(self, &group).split_first_chunk() else { continue };
            let window = self.window(first + group.window);
            let top = window.y % band.rows.max(1);
            let left = window.x - given.x;
            let members = groups.members(&group);
            let corrections = from(groups.corrections, group.start * channels);
            for (index, corrections) in rows(corrections, channels).enumerate().take(group.len) {
                let place = Place::read(matrix::at(members, index));
                let [x, y, frame] = place.split();
                let (mut at, mut near) = (index, 1.0);
                if self.windows.is_ordered {
                    let row = if top + y < band.rows { top + y } else { top + y - band.rows };
                    at = (frame * band.rows + row) * given.width + left + x;
                    near = hat(x, inverse[0]) * hat(y, inverse[1]);
                } else if !self.is_joined() {
                    at = x;
                }
                let sums = from_mut(band.sums, at * sums_len(channels));
                let Some((common, each)) = sums.split_first_chunk_mut::<COMMON>() else { continue };
                common[0] += near;
                common[1] += near * has_error;
                common[2] += near * gain;
                let values = corrections.iter().zip(errors).enumerate();
                for (each, (channel, (&correction, &error))) in each.as_chunks_mut::<2>().0.iter_mut().zip(values) {
                    let mut both = [correction, error];
                    if has_factors {
                        let factor = self.factor(self.pixel(window, place, index), channel);
                        let factors = [factor, if self.error_is_the_groups() { factor } else { 1.0 }];
                        let most = f64::from(f32::MAX);
                        both.iter_mut().zip(factors).for_each(|(value, factor)| {
                            *value = (f64::from(*value) * factor).clamp(-most, most) as f32;
                        });
                    }
                    // What cannot be added up is no number, and found at the end.
                    let [correction, error] = both.map(|value| if Real::abs(value) < MOST { value } else { f32::NAN });
                    each[0] += near * correction;
                    each[1] += near * error;
                }
            }
        }
    }

    /// Writes a row of pixels, and empties its sums.
    #[inline]
    fn write(&self, frame: usize, y: usize, band: &mut Band<'_>, out: &mut dyn FnMut(usize, Estimate)) {
        let (given, wanted) = (self.windows.given, self.windows.wanted);
        let row = frame * band.rows + y % band.rows.max(1);
        let sums = row_at_mut(band.sums, given.width * sums_len(self.config.channels), row);
        for (column, sums) in rows(sums, sums_len(self.config.channels)).enumerate() {
            let x = (given.x + column).wrapping_sub(wanted.x);
            if y >= wanted.y && x < wanted.width {
                let estimate = self.estimate(self.windows.number(wanted.x + x, y, frame), sums);
                out((frame * wanted.height + y - wanted.y) * wanted.width + x, estimate);
            }
        }
        sums.iter_mut().for_each(|sum| *sum = 0.0);
    }

    #[inline]
    fn estimate(&self, pixel: usize, sums: &[f32]) -> Estimate {
        let samples = self.n.min(u32::MAX as usize) as u32;
        let mut estimate = Estimate { mean: [0.0; 4], std_error: [0.0; 4], samples, gain: 1.0 };
        let Some(([weight, error_weight, gain], each)) = sums.split_first_chunk() else { return estimate };
        // Without a weight all sums are zero.
        let inverse = 1.0 / black_box(f64::from(weight.or_one()));
        let error_inverse = 1.0 / black_box(f64::from(error_weight.or_one()));
        if *weight > 0.0 {
            estimate.gain = (f64::from(*gain) * inverse) as f32;
        }
        let outputs = estimate.mean.iter_mut().zip(&mut estimate.std_error);
        for (channel, ((mean, error), sums)) in outputs.zip(rows(each, 2)).enumerate() {
            let &[correction, spread] = sums else { continue };
            let (correction, spread) = (f64::from(correction) * inverse, f64::from(spread) * error_inverse);
            let first = f64::from(self.reader.input(pixel * self.n, channel));
            let (mut plain, mut variance) = (first, f64::INFINITY);
            if self.n > 1 {
                let (mut total, mut square) = (0.0, 0.0);
                for sample in pixel * self.n + 1..(pixel + 1) * self.n {
                    let value = f64::from(self.reader.input(sample, channel)) - first;
                    total += value;
                    square += value * value;
                }
                let n = self.n as f64;
                plain += total / n;
                variance = (square - total * total / n).max(0.0) / mean_divisor(n);
            }
            // In no group there is no correction; nor is one that left the type's range.
            *mean = saturate(if correction.is_finite() { plain + correction } else { plain });
            let has_error = *error_weight > 0.0;
            let told = if has_error && self.error_is_the_groups() {
                spread
            } else if self.n > 1 {
                let ratio = if has_error { spread * spread } else { 1.0 };
                // A correction that the pixel's own samples make unlikely is an error.
                let moved = if correction.is_finite() { correction * correction } else { 0.0 };
                libm::sqrt(ratio * variance + (moved - UNLIKELY * variance).max(0.0))
            } else {
                f64::INFINITY
            };
            *error = standard_error(told);
        }
        estimate
    }
}
