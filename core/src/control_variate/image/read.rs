//! Reading samples, as fits see them.

use super::batch::Batch;
use super::call::Call;
use super::products::*;
use crate::control_variate::Config;
use core::ops::Range;

/// A column of some rows of `WIDTH` numbers, for each lane from where its rows start.
fn put_column<const WIDTH: usize>(rows: &[f32], starts: &[usize; LANES], column: usize, out: &mut [Eight]) {
    for (lane, start) in starts.iter().enumerate() {
        let (rows, _) = from(rows, *start).as_chunks::<WIDTH>();
        let put = |(out, row): (&mut Eight, &[f32; WIDTH])| out[lane % LANES] = row[column % WIDTH];
        match (rows.first_chunk::<AT_ONCE>(), out.as_chunks_mut::<AT_ONCE>().0) {
            // Four, without a look for each whether it is there: 1.5 to 6 % fewer instructions of a fit.
            (Some(rows), [out]) => out.iter_mut().zip(rows).for_each(put),
            _ => out.iter_mut().zip(rows).for_each(put),
        }
    }
}

/// One of some rows of `WIDTH` numbers for each lane, a column for each number.
fn put_row<const WIDTH: usize>(rows: &[f32], which: &[usize; LANES], out: &mut [Eight]) {
    let (rows, _) = rows.as_chunks::<WIDTH>();
    for (lane, &row) in which.iter().enumerate() {
        for (out, value) in out.iter_mut().zip(rows.get(row).into_iter().flatten()) {
            out[lane % LANES] = *value;
        }
    }
}

impl Call<'_> {
    /// The pixels' lowest and highest values of each channel, as fits see them.
    pub(super) fn ranges(&self, pixels: &[usize; LANES]) -> [[Eight; 2]; Config::MAX_CHANNELS] {
        if self.n > 1 {
            let mut ranges = [[NONE; 2]; Config::MAX_CHANNELS];
            for (channel, range) in ranges.iter_mut().enumerate().take(self.config.channels) {
                *range = self.range(pixels, channel);
            }
            return ranges;
        }
        let mut values = [NONE; Config::MAX_CHANNELS];
        let (f, first) = (self.reader.samples.f, pixels.map(|pixel| pixel * self.held));
        match self.config.channels {
            1 => put_row::<1>(f, &first, &mut values),
            2 => put_row::<2>(f, &first, &mut values),
            3 => put_row::<3>(f, &first, &mut values),
            _ => put_row::<4>(f, &first, &mut values),
        }
        for (channel, values) in values.iter_mut().enumerate().take(self.config.channels) {
            self.divide_by_factors(pixels, channel, values);
        }
        values.map(|values| [values; 2])
    }

    /// The same of a channel.
    fn range(&self, pixels: &[usize; LANES], channel: usize) -> [Eight; 2] {
        let (mut low, mut high) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
        for begin in (0..self.n).step_by(AT_ONCE) {
            let mut four = [NONE; AT_ONCE];
            let values = first_mut(&mut four, AT_ONCE.min(self.n - begin));
            self.put_rows(self.reader.samples.f, pixels, (self.held, begin), channel, values);
            for value in values {
                low = lanes::zip(value, &low, Real::min);
                high = lanes::zip(value, &high, Real::max);
            }
            lanes::keep_together();
        }
        [low, high]
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

    /// As many of a pixel's so many rows of numbers as `out` holds, from one on, for eight pixels.
    fn put_rows(
        &self,
        rows: &[f32],
        pixels: &[usize; LANES],
        (each, first): (usize, usize),
        channel: usize,
        out: &mut [Eight],
    ) {
        let channels = self.config.channels;
        if let [out] = out {
            *out = self.gather(rows, pixels, (each, first), channel);
            return;
        }
        let starts = pixels.map(|pixel| (pixel * each + first) * channels);
        match channels {
            1 => put_column::<1>(rows, &starts, channel, out),
            2 => put_column::<2>(rows, &starts, channel, out),
            3 => put_column::<3>(rows, &starts, channel, out),
            _ => put_column::<4>(rows, &starts, channel, out),
        }
        out.iter_mut().for_each(|values| self.divide_by_factors(pixels, channel, values));
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
        for (channel, values) in inputs.iter_mut().enumerate() {
            let out = part_mut(values, row, samples.len());
            match batch.ranges.get(index(channel)) {
                // The survey has read it.
                Some([only, _]) if self.n == 1 => out.fill(*only),
                _ => self.put_rows(self.reader.samples.f, pixels, (self.held, samples.start), channel, out),
            }
        }
        for (channel, (out, values)) in rest.iter_mut().zip(inputs).enumerate() {
            let out = part_mut(out, row, samples.len());
            let [coefficient, integral] = [&*batch.coefficients, &*batch.integrals].map(|all| at(all, index(channel)));
            self.put_rows(self.image.known, pixels, (self.held, samples.start), channel, out);
            for (out, value) in out.iter_mut().zip(from(values, row)) {
                *out = lanes::minus_product(*value, coefficient, minus(out, &integral));
            }
        }
    }
}
