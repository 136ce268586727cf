//! Sums of samples by slices.

use super::products::*;

/// Sums of one part's samples by slices. Each lane has its own, one after the other's, so that what a sample adds to
/// those of its slice is together.
pub(super) struct Sliced<'a> {
    /// For each slice and lane: for each eight columns their products with the first of these and all numbers after it.
    all: &'a mut [Eight],
    /// A sample's numbers: its columns, then its values.
    sample: &'a mut [Eight],
    columns: usize,
    values: usize,
}

/// How many eights so many numbers fill.
pub(super) const fn panels(count: usize) -> usize {
    count.div_ceil(LANES)
}

impl<'a> Sliced<'a> {
    /// Products of one slice and lane.
    fn each(columns: usize, values: usize) -> usize {
        let eights = panels(columns);
        eights * (columns + values + LANES) - LANES * packed_len(eights)
    }

    pub(super) fn new(slices: usize, columns: usize, values: usize, arena: &mut Arena<'a, f32>) -> Self {
        let all = arena.take_lanes(slices * LANES * Self::each(columns, values));
        let sample = arena.take_lanes(if slices == 0 { 0 } else { panels(columns + values) });
        all.iter_mut().chain(sample.iter_mut()).for_each(|sum| *sum = NONE);
        Self { all, sample, columns, values }
    }

    /// Adds four rows of samples, each to the sums of its lanes' slices, but where the first column, a constant, is 0.
    #[inline(always)]
    pub(super) fn add(&mut self, picked: &Four, columns: &[Four], values: &[Four]) {
        let each = Self::each(self.columns, self.values);
        for (row, picked) in picked.iter().enumerate() {
            for lane in 0..LANES {
                if at(columns, 0)[row % AT_ONCE][lane] == 0.0 {
                    continue;
                }
                let (line, own) = halves_mut(self.sample.as_flattened_mut(), self.columns);
                line.iter_mut().zip(columns).for_each(|(out, column)| *out = column[row % AT_ONCE][lane]);
                own.iter_mut().zip(values).for_each(|(out, value)| *out = value[row % AT_ONCE][lane]);
                let mut sums = row_at_mut(self.all, each, picked[lane] as usize * LANES + lane);
                let mut numbers = first(self.sample.as_flattened(), self.columns + self.values);
                for eight in self.sample.iter().take(panels(self.columns)) {
                    let (products, rest) = halves_mut(sums, numbers.len());
                    for (sum, number) in products.iter_mut().zip(numbers) {
                        *sum = lanes::plus_product(*sum, *eight, [*number; LANES]);
                        lanes::keep_together();
                    }
                    (sums, numbers) = (rest, from(numbers, LANES));
                }
            }
        }
    }

    /// Sets the slices' sums of a part, and forgets them here.
    #[inline(always)]
    pub(super) fn put(&mut self, part: usize, out: &mut Sums<'_>) {
        let (columns, each) = (self.columns, Self::each(self.columns, self.values));
        for (index, mut sums) in rows_mut(self.all, each).enumerate() {
            let (slice, lane) = (index / LANES, index % LANES);
            let Part { gram, sides, .. } = out.part_mut(part + slice);
            for begin in (0..columns).step_by(LANES) {
                let (products, rest) = halves_mut(sums, columns + self.values - begin);
                sums = rest;
                for (product, number) in products.iter_mut().zip(begin..) {
                    let entries = match number.checked_sub(columns) {
                        None => row_mut(gram, number),
                        Some(value) => row_at_mut(sides, columns, value),
                    };
                    for (out, sum) in from_mut(entries, begin).iter_mut().zip(&*product) {
                        out[lane] = *sum;
                    }
                    *product = NONE;
                }
            }
        }
    }
}
