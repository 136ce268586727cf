//! Reading samples, as fits see them.

use super::batch::Batch;
use super::call::Call;
use super::products::*;
use crate::control_variate::Config;
use core::ops::Range;

/// Rows of `WIDTH` numbers for each lane, from row `which` on: in a column for each number those of `taken`.
fn put_rows<const WIDTH: usize, const ROWS: usize>(
    rows: &[f32],
    which: &[usize; LANES],
    taken: &Range<usize>,
    out: &mut [[Eight; ROWS]],
) {
    let (rows, _) = rows.as_chunks::<WIDTH>();
    let Some(out) = out.first_chunk_mut::<WIDTH>() else { return };
    for (lane, &first) in which.iter().enumerate() {
        let mut put = |row: usize, numbers: &[f32; WIDTH]| {
            for (out, number) in out.iter_mut().zip(numbers) {
                out[row % ROWS][lane % LANES] = *number;
            }
        };
        // One, or four, without a look for each whether it is there: 1.5 to 6 % fewer instructions of a fit.
        if taken.len() == 1 {
            rows.get(first).into_iter().for_each(|numbers| put(taken.start, numbers));
            continue;
        }
        let rows = from(rows, first);
        match rows.first_chunk::<AT_ONCE>() {
            Some(rows) if taken.len() == AT_ONCE => {
                rows.iter().enumerate().for_each(|(row, numbers)| put(row, numbers));
            }
            _ => taken.clone().zip(rows).for_each(|(row, numbers)| put(row, numbers)),
        }
    }
}

impl Call<'_> {
    /// The pixels' lowest and highest values of each channel, as fits see them.
    pub(super) fn ranges(&self, pixels: &[usize; LANES]) -> [[Eight; 2]; Config::MAX_CHANNELS] {
        let f = self.reader.samples.f;
        if self.n == 1 {
            let mut values = [[NONE]; Config::MAX_CHANNELS];
            self.put_rows(f, pixels, (self.held, 0), &(0..1), &mut values);
            return values.map(|[only]| [only; 2]);
        }
        let mut ranges = [[[f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]]; Config::MAX_CHANNELS];
        for begin in (0..self.n).step_by(AT_ONCE) {
            let mut values = [[NONE; AT_ONCE]; Config::MAX_CHANNELS];
            let taken = 0..AT_ONCE.min(self.n - begin);
            self.put_rows(f, pixels, (self.held, begin), &taken, &mut values);
            for ([low, high], values) in ranges.iter_mut().zip(&values).take(self.config.channels) {
                for value in first(values, taken.len()) {
                    *low = lanes::zip(value, low, Real::min);
                    *high = lanes::zip(value, high, Real::max);
                }
                lanes::keep_together();
            }
        }
        ranges
    }

    /// A channel of one of a pixel's so many rows of numbers, for eight pixels, divided by the pixels' factors.
    pub(super) fn gather(
        &self,
        rows: &[f32],
        pixels: &[usize; LANES],
        (each, row): (usize, usize),
        channel: usize,
    ) -> Eight {
        let channels = self.config.channels;
        let mut values = pixels.map(|pixel| at(rows, (pixel * each + row) * channels + channel));
        self.divide_by_factors(pixels, channel, &mut values);
        values
    }

    fn divide_by_factors(&self, pixels: &[usize; LANES], channel: usize, values: &mut Eight) {
        if !self.image.factors.is_empty() {
            for (value, pixel) in values.iter_mut().zip(pixels) {
                *value = saturate(f64::from(*value) / self.factor(*pixel, channel));
            }
        }
    }

    /// Some of a pixel's so many rows of numbers, from one on, for eight pixels: of each channel in its rows `taken`.
    fn put_rows<const ROWS: usize>(
        &self,
        rows: &[f32],
        pixels: &[usize; LANES],
        (each, first): (usize, usize),
        taken: &Range<usize>,
        out: &mut [[Eight; ROWS]],
    ) {
        let which = pixels.map(|pixel| pixel * each + first);
        match self.config.channels {
            1 => put_rows::<1, ROWS>(rows, &which, taken, out),
            2 => put_rows::<2, ROWS>(rows, &which, taken, out),
            3 => put_rows::<3, ROWS>(rows, &which, taken, out),
            _ => put_rows::<4, ROWS>(rows, &which, taken, out),
        }
        if self.image.factors.is_empty() {
            return;
        }
        for (channel, values) in out.iter_mut().enumerate().take(self.config.channels) {
            for values in part_mut(values, taken.start, taken.len()) {
                self.divide_by_factors(pixels, channel, values);
            }
        }
    }

    /// What a pixel's values are divided by. Black says nothing about what it multiplies: 1.
    pub(super) fn factor(&self, pixel: usize, channel: usize) -> f64 {
        let factor = self.image.factors.get(pixel * self.config.channels + channel).copied().unwrap_or(1.0);
        if factor > 0.0 { f64::from(factor) } else { 1.0 }
    }

    /// Reads some samples of the pixels of some slots of a block, four in all: functions at them, and their values in
    /// units. Of one sample in each pixel zero where there is no pixel.
    #[inline(always)]
    pub(super) fn read(
        &self,
        batch: &Batch<'_>,
        (block, slots): (usize, Range<usize>),
        samples: Range<usize>,
        rows: &mut Rows<'_>,
    ) {
        let Rows { x, columns, values } = rows;
        for (run, slot) in slots.enumerate() {
            let pixels = batch.pixels((block, slot));
            let first = pixels.map(|pixel| pixel * self.held + samples.start);
            self.reader.put_positions(&first, samples.len(), run * LANES, x);
            self.put_values(batch, (block, slot), &pixels, &samples, run, values);
        }
        batch.put_in_units(values);
        let wide = columns.as_flattened_mut().as_flattened_mut().as_chunks_mut::<AT_ONCE_LANES>().0;
        self.basis.evaluate(x, wide);
        if self.n == 1 {
            batch.empty_missing(block, columns.iter_mut().chain(values.iter_mut()));
        }
    }

    /// The slices of samples that were read.
    #[inline]
    pub(super) fn slices(&self, rows: &Rows<'_>) -> Four {
        let mut out = [NONE; AT_ONCE];
        for (out, slices) in out.iter_mut().zip(self.basis.slices_at(&rows.x).as_chunks::<LANES>().0) {
            *out = slices.map(|slice| slice as f32);
        }
        out
    }

    /// Values of samples of each pixel, as they were given but for factors and what is known of them: in each column
    /// from `row` on.
    pub(super) fn put_values(
        &self,
        batch: &Batch<'_>,
        (block, slot): (usize, usize),
        pixels: &[usize; LANES],
        samples: &Range<usize>,
        row: usize,
        values: &mut [Four],
    ) {
        let (inputs, rest) = halves_mut(values, self.config.channels);
        let index = |channel| batch.entry(channel, (block, slot));
        let (rows, taken) = ((self.held, samples.start), row..row + samples.len());
        if self.n == 1 {
            // The survey has read it.
            for (channel, out) in inputs.iter_mut().enumerate() {
                let [only, _] = at(batch.ranges, index(channel));
                part_mut(out, row, 1).fill(only);
            }
        } else {
            self.put_rows(self.reader.samples.f, pixels, rows, &taken, inputs);
        }
        if !rest.is_empty() {
            self.put_rows(self.image.known, pixels, rows, &taken, rest);
        }
        for (channel, (out, values)) in rest.iter_mut().zip(inputs).enumerate() {
            let [coefficient, integral] = [&*batch.coefficients, &*batch.integrals].map(|all| at(all, index(channel)));
            for (out, value) in part_mut(out, row, samples.len()).iter_mut().zip(from(values, row)) {
                *out = lanes::minus_product(*value, coefficient, minus(out, &integral));
            }
        }
    }
}
