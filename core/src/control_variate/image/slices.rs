//! Fits where the last coordinate picks one of many slices.
//!
//! A slice's own columns are zero at the samples of others. The matrix is then an arrow: a block for each slice, and a
//! border of the columns that slices share. Each block is made of its own samples' sums alone, takes its share of the
//! border with it, and what is left of that is a system of the shared columns.
//!
//! Indicators are not centred here. The constant, which has no penalty, and the trends, which have next to none, take
//! the difference. Of several samples in each pixel, less the pixel's mean, columns would be of several slices at once.
//! So they stay as they are, and values alone are less a part of the pixel's mean: all of it where pixels' means say
//! nothing ([`Fits::weigh`](super::fit::Fits)). For independent samples coefficients are then too small by a
//! factor that is known.

use super::batch::{Batch, MAX_FIXED};
use super::products::*;
use super::seen::{SUMS, Seen};
use super::several::Several;
use super::terms::{Terms, scale};
use core::ops::Range;

/// Fits of candidates that have as many own columns of each slice.
pub(super) struct Apart<'a> {
    /// Columns that slices share, constant and axes among them.
    width: usize,
    /// Own columns of a slice.
    own: usize,
    totals: Sums<'a>,
    /// For each slice rows of L, as wide as its own columns: of these, with 1 / D on the diagonal, of the shared ones,
    /// of values, and of units of the fixed columns.
    blocks: &'a mut [Eight],
    /// What all blocks leave of the shared columns, then its factors.
    border: &'a mut [Eight],
    /// Rows of L of values and units, as wide as the shared columns.
    sides: &'a mut [Eight],
    /// What each lane has of its slice.
    gathered: &'a mut [Eight],
    /// L^-1 of a row's columns; coefficients while these are made.
    solved: &'a mut [Eight],
    /// A block's shared columns.
    columns: &'a mut [Four],
    /// Of one sample in each pixel, for each value and candidate the coefficients of the fixed columns, with what all
    /// slices' own have in common.
    trends: &'a mut [Eight],
    /// Of several, for each value, candidate and slice, what shared columns are multiplied by at a sample of the slice.
    /// The fixed ones are without what all slices have in common.
    coefficients: &'a mut [Eight],
    /// Of several samples in each pixel.
    pub(super) several: Option<Several<'a>>,
}

/// Puts a row together, each lane of another's.
fn gather(out: &mut [Eight], of: &[&[Eight]; LANES]) {
    for lane in 0..LANES {
        for (out, entry) in out.iter_mut().zip(of[lane]) {
            out[lane] = entry[lane];
        }
    }
}

/// Entry (i, k) of a symmetric matrix.
fn symmetric(triangle: &[Eight], i: usize, k: usize) -> Eight {
    at(triangle, packed_len(i.max(k)) + i.min(k))
}

impl<'a> Apart<'a> {
    /// Rows of a slice's block.
    fn order(terms: &Terms, values: usize) -> usize {
        terms.all_own() + terms.columns() + values + terms.fixed()
    }

    pub(super) fn new(terms: &Terms, values: usize, n: usize, arena: &mut Arena<'a, f32>) -> Self {
        let (slices, width, order) = (terms.slices, terms.columns(), Self::order(terms, values));
        let fits = values * terms.ends.len();
        let [trends, coefficients] = if n > 1 { [0, fits * slices * width] } else { [fits * terms.fixed(), 0] };
        Self {
            width,
            own: 0,
            totals: Sums::new(slices, width, terms.of_slices(values, n), arena),
            blocks: arena.take_lanes(slices * order * terms.all_own()),
            border: arena.take_lanes(packed_len(width)),
            sides: arena.take_lanes((values + terms.fixed()) * width),
            gathered: arena.take_lanes(order * terms.all_own()),
            solved: arena.take_lanes(terms.all_own() + width),
            columns: arena.take_fours(width),
            trends: arena.take_lanes(trends),
            coefficients: arena.take_lanes(coefficients),
            several: (n > 1).then(|| Several::new(terms, values, arena)),
        }
    }

    /// Makes the fits to the colours `training`. Pixels of one sample are corrected by those to the other pixels.
    #[inline(always)]
    pub(super) fn fit(
        &mut self,
        batch: &Batch<'_>,
        penalties: &[f32],
        training: Colours,
        weight_of_means: &Eight,
        corrections: &mut [Four],
    ) {
        let terms = &batch.terms;
        self.totals.set_total(&batch.sliced, training);
        if batch.call.n > 1 {
            self.subtract_means(batch, weight_of_means);
        }
        let mut begin = 0;
        for fit in 0..terms.ends.len() {
            // The last of those with as many own columns has all the shared ones that these have.
            if terms.own.get(fit) == terms.own.get(fit + 1) {
                continue;
            }
            (self.own, self.width) = (at(&terms.own, fit), at(&terms.ends, fit));
            let fits = begin..fit + 1;
            self.factor(batch, penalties, training, fits.clone());
            if batch.call.n == 1 {
                for block in batch.blocks(training) {
                    self.leave_own(batch, block, fits.clone(), corrections);
                }
            } else {
                for (value, fit) in (0..batch.values).flat_map(|value| fits.clone().map(move |fit| (value, fit))) {
                    self.solve(batch, value, fit);
                }
            }
            begin = fit + 1;
        }
        if let Some(several) = &mut self.several {
            several.set(terms, batch.values, self.coefficients);
        }
    }

    /// Takes a part of the pixels' means from the values that fits are made to.
    #[inline(always)]
    fn subtract_means(&mut self, batch: &Batch<'_>, weight: &Eight) {
        let part = weight.map(|weight| 1.0 - Real::sqrt(weight));
        // Stratified samples hardly depend on their pixel's mean.
        let own = if batch.call.config.stratified { 0.0 } else { 1.0 / batch.call.n as f32 };
        let factor = part.map(|part| 1.0 / (1.0 - part * own));
        for slice in 0..batch.terms.slices {
            let (values, means) = halves_mut(self.totals.part_mut(slice).sides, batch.values * batch.terms.columns());
            for (value, mean) in values.iter_mut().zip(&*means) {
                *value = product(&lanes::minus_product(*value, part, *mean), &factor);
                lanes::keep_together();
            }
        }
    }

    /// Lanes of a slice's block.
    fn block_len(&self, batch: &Batch<'_>) -> usize {
        packed_len(self.own) + (self.width + batch.values + batch.terms.fixed()) * self.own
    }

    /// Factors the system; of one sample in each pixel with the trends of the candidates `fits`.
    #[inline(always)]
    fn factor(&mut self, batch: &Batch<'_>, penalties: &[f32], training: Colours, fits: Range<usize>) {
        let (terms, values, slices) = (&batch.terms, batch.values, batch.terms.slices);
        let (own, width, fixed, len) = (self.own, self.width, terms.fixed(), self.block_len(batch));
        let linear = batch.call.shape.linear() as f32;
        // Where a pixel's own sample is left out afterwards, of which there is one less.
        let (count, left_out, units) = if batch.call.n == 1 {
            (batch.present(training), 1.0, fixed)
        } else {
            let counts = (0..slices).map(|slice| at(self.totals.part(slice).gram, 0));
            (counts.fold(NONE, |sum, count| plus(&sum, &count)), 0.0, 0)
        };
        let ends = part(&terms.ends, fits.start, fits.len());
        empty(self.trends);
        let scale = scale(batch.call.config, &count.map(|count| count - left_out));
        for (j, penalty) in penalties.iter().enumerate().take(width) {
            let out = row_mut(self.border, j);
            empty(out);
            if let Some(out) = out.last_mut() {
                *out = scale.map(|scale| scale * penalty);
            }
        }
        for (i, side) in rows_mut(self.sides, width).take(values + units).enumerate() {
            empty(side);
            if let Some(out) = i.checked_sub(values).and_then(|unit| side.get_mut(unit)) {
                *out = [1.0; LANES];
            }
        }
        for slice in 0..slices {
            let Part { gram, sides, .. } = self.totals.part(slice);
            let (triangle, lines) = halves_mut(row_at_mut(self.blocks, len, slice), packed_len(own));
            for i in 0..own {
                let (source, factor) = terms.source(i);
                let line = row_mut(triangle, i);
                for (k, out) in line.iter_mut().enumerate() {
                    *out = symmetric(gram, source, terms.source(k).0);
                }
                if let Some(out) = line.last_mut() {
                    let penalty = terms.own_penalty(i, penalties, linear) / factor;
                    *out = lanes::plus_product(*out, scale, [penalty; LANES]);
                }
            }
            ldlt::factor_each(triangle, own);
            let solved = first_mut(self.solved, own);
            for i in 0..width + values + units {
                let (sums, out) = match i.checked_sub(width) {
                    None => (row(gram, i), row_mut(self.border, i)),
                    Some(side) => (row_at(sides, terms.columns(), side), row_at_mut(self.sides, width, side)),
                };
                for (k, out) in solved.iter_mut().enumerate() {
                    let other = terms.source(k).0;
                    *out = if i < width {
                        symmetric(gram, i, other)
                    } else if i < width + values {
                        at(sums, other)
                    } else {
                        [if other == i - width - values { 1.0 / slices as f32 } else { 0.0 }; LANES]
                    };
                }
                ldlt::forward_one(triangle, 0, solved);
                for (k, (l, z)) in row_at_mut(lines, own, i).iter_mut().zip(&*solved).enumerate() {
                    *l = product(z, &diagonal(triangle, k));
                }
                if let Some(unit) = i.checked_sub(width + values) {
                    for (value, trends) in rows_mut(self.trends, ends.len() * fixed).enumerate().take(values) {
                        let line = row_at(lines, own, width + value).iter().zip(&*solved);
                        let sum = line.fold(NONE, |sum, (l, z)| lanes::plus_product(sum, *l, *z));
                        // All candidates have the same own columns: the first's has their sum.
                        if let Some(trend) = trends.get_mut(unit) {
                            *trend = plus(trend, &sum);
                        }
                    }
                }
                // What the block leaves.
                for (out, sum) in out.iter_mut().zip(sums) {
                    *out = plus(out, sum);
                    lanes::keep_together();
                }
                for (out, line) in out.iter_mut().zip(rows(lines, own)) {
                    [*out] = lanes::minus_products([*out], solved.as_chunks().0, line);
                }
            }
        }
        ldlt::factor_each(self.border, width);
        let (of_values, of_units) = halves_mut(self.sides, values * width);
        for side in rows_mut(of_values, width) {
            ldlt::forward_one(self.border, 0, side);
            ldlt::divide_each(self.border, side);
        }
        for (k, unit) in rows_mut(of_units, width).take(units).enumerate() {
            ldlt::forward_one(self.border, 0, unit);
            for (side, trends) in rows(of_values, width).zip(rows_mut(self.trends, ends.len() * fixed)) {
                let own_sum = at(trends, k);
                sums_to(ends, unit, side, |fit, sum| {
                    set(row_at_mut(trends, fixed, fit), k, plus(&own_sum, &sum));
                });
            }
            ldlt::divide_each(self.border, unit);
        }
    }

    /// Of several samples in each pixel, a candidate's coefficients for a value.
    #[inline(always)]
    fn solve(&mut self, batch: &Batch<'_>, value: usize, fit: usize) {
        let (terms, slices) = (&batch.terms, batch.terms.slices);
        let (own, fixed, len) = (self.own, terms.fixed(), self.block_len(batch));
        let (end, which) = (at(&terms.ends, fit), value * terms.ends.len() + fit);
        let Some((shared, solved)) = self.solved.split_at_mut_checked(end) else { return };
        copy(shared, row_at(self.sides, self.width, value));
        ldlt::backward_each(self.border, shared);
        let mut trend = [NONE; MAX_FIXED];
        let trend = first_mut(&mut trend, fixed);
        let each = slices * terms.columns();
        let coefficients = row_at_mut(self.coefficients, each, which);
        for slice in 0..slices {
            let (triangle, lines) = halves(row_at(self.blocks, len, slice), packed_len(own));
            let solved = first_mut(solved, own);
            copy(solved, row_at(lines, own, self.width + value));
            for (shared, line) in shared.iter().zip(rows(lines, own)) {
                for (out, l) in solved.iter_mut().zip(line) {
                    *out = lanes::minus_product(*out, *l, *shared);
                }
            }
            ldlt::backward_each(triangle, solved);
            let out = row_at_mut(coefficients, terms.columns(), slice);
            copy(out, shared);
            empty(first_mut(out, fixed));
            for (j, value) in solved.iter().enumerate() {
                if let Some(out) = out.get_mut(terms.source(j).0) {
                    *out = plus(out, value);
                }
            }
            for (sum, own) in trend.iter_mut().zip(&*out) {
                *sum = plus(sum, own);
            }
        }
        let inverse = [1.0 / slices as f32; LANES];
        trend.iter_mut().for_each(|sum| *sum = lanes::plus_product(NONE, *sum, inverse));
        for slice in 0..slices {
            for (out, mean) in row_at_mut(coefficients, terms.columns(), slice).iter_mut().zip(&*trend) {
                *out = minus(out, mean);
            }
        }
    }

    /// Corrects a block by the fits to the other pixels: see [`Seen::correct`], whose sums begin with the own columns.
    #[inline(always)]
    fn leave_own(&mut self, batch: &Batch<'_>, block: usize, fits: Range<usize>, corrections: &mut [Four]) {
        let (terms, values) = (&batch.terms, batch.values);
        let (own, width, fixed, len) = (self.own, self.width, terms.fixed(), self.block_len(batch));
        batch.put_pixels(block, false, self.columns, &mut []);
        let (mut leverage, mut sums) = ([NONE; AT_ONCE], [[NONE; AT_ONCE]; SUMS]);
        for (line, slices) in at(batch.slices, block).iter().enumerate() {
            gather(self.gathered, &slices.map(|slice| row_at(self.blocks, len, slice as usize)));
            let (triangle, lines) = halves(self.gathered, packed_len(own));
            let (of_columns, of_sums) = halves(lines, width * own);
            let solved = first_mut(self.solved, own);
            for j in 0..own {
                let Some((before, z)) = split_at(solved, j) else { return };
                let l = part(triangle, packed_len(j), j);
                [*z] = lanes::minus_products([at(self.columns, terms.source(j).0)[line]], before.as_chunks().0, l);
                let scaled = product(z, &diagonal(triangle, j));
                leverage[line] = lanes::plus_product(leverage[line], scaled, *z);
                for (sum, row) in sums.iter_mut().take(values + fixed).zip(rows(of_sums, own)) {
                    sum[line] = lanes::plus_product(sum[line], at(row, j), *z);
                }
            }
            for (column, row) in self.columns.iter_mut().zip(rows(of_columns, own)) {
                [column[line]] = lanes::minus_products([column[line]], solved.as_chunks().0, row);
            }
        }
        let (of_values, of_units) = halves(self.sides, values * width);
        let seen = Seen { factors: self.border, of_values, of_units, trends: self.trends };
        seen.correct(batch, block, fits, first_mut(self.columns, width), (leverage, sums), corrections);
    }
}
