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
use super::products::{AT_ONCE, Colours, Eight, Four, NONE, Part, Sums, minus, only, plus, product};
use super::several::Several;
use super::terms::{SINGULAR, Terms, scale};
use crate::arena::Arena;
use crate::lanes::{self, LANES};
use crate::linalg::ldlt;
use crate::matrix::{
    at, copy, diagonal, first_mut, from, halves_mut, packed_len, row, row_at, row_at_mut, row_mut, split_at,
};
use crate::real::Real;
use crate::rows::{first, halves, rows, rows_mut};
use core::ops::Range;

/// Fits of candidates that have as many own columns of each slice.
pub(super) struct Apart<'a> {
    /// Columns that slices share, constant and axes among them.
    width: usize,
    /// Own columns of a slice.
    own: usize,
    /// The sums of each slice.
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
    /// For each value and candidate those of the fixed columns.
    trends: &'a mut [Eight],
    /// For each value, candidate and slice, what shared columns are multiplied by at a sample of the slice. The fixed
    /// ones are without what all slices have in common.
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

    /// Lanes of workspace.
    pub(super) fn len(terms: &Terms, values: usize, n: usize) -> usize {
        let (slices, width, order) = (terms.slices, terms.columns(), Self::order(terms, values));
        if slices == 0 {
            return 0;
        }
        let each = Sums::len(width, terms.of_slices(values, n)) + order * terms.all_own();
        let coefficients = values * terms.ends.len() * (terms.fixed() + slices * width);
        let border = packed_len(width) + (values + terms.fixed()) * width;
        let several = if n > 1 { Several::len(terms, values) } else { 0 };
        slices * each + border + order * (1 + terms.all_own()) + width + AT_ONCE * width + coefficients + several
    }

    pub(super) fn new(terms: &Terms, values: usize, n: usize, arena: &mut Arena<'a, f32>) -> Self {
        let (slices, width, order) = (terms.slices, terms.columns(), Self::order(terms, values));
        let fits = terms.ends.len();
        Self {
            width,
            own: 0,
            totals: Sums::new(slices, width, terms.of_slices(values, n), arena),
            blocks: arena.take_lanes(slices * order * terms.all_own()),
            border: arena.take_lanes(packed_len(width)),
            sides: arena.take_lanes((values + terms.fixed()) * width),
            gathered: arena.take_lanes(order * terms.all_own() + width),
            solved: arena.take_lanes(order),
            columns: arena.take_fours(width),
            trends: arena.take_lanes(values * fits * terms.fixed()),
            coefficients: arena.take_lanes(values * fits * slices * width),
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
            self.factor(batch, penalties);
            for fit in begin..=fit {
                for value in 0..batch.values {
                    self.solve(batch, value, fit);
                }
            }
            for block in batch.blocks(training).filter(|_| batch.call.n == 1) {
                self.leave_own(batch, block, begin..fit + 1, corrections);
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

    #[inline(always)]
    fn factor(&mut self, batch: &Batch<'_>, penalties: &[f32]) {
        let (terms, values, slices) = (&batch.terms, batch.values, batch.terms.slices);
        let (own, width, fixed, len) = (self.own, self.width, terms.fixed(), self.block_len(batch));
        let linear = batch.call.shape.linear() as f32;
        let counts = (0..slices).map(|slice| at(self.totals.part(slice).gram, 0));
        let count = counts.fold(NONE, |sum, count| plus(&sum, &count));
        // Where a pixel's own sample is left out afterwards, of which there is one less.
        let (left_out, units) = if batch.call.n == 1 { (1.0, fixed) } else { (0.0, 0) };
        let scale = scale(batch.call.config, &count.map(|count| count - left_out));
        for (j, penalty) in penalties.iter().enumerate().take(width) {
            let out = row_mut(self.border, j);
            out.iter_mut().for_each(|out| *out = NONE);
            if let Some(out) = out.last_mut() {
                *out = scale.map(|scale| scale * penalty);
            }
        }
        for (i, side) in rows_mut(self.sides, width).take(values + units).enumerate() {
            side.iter_mut().for_each(|out| *out = NONE);
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
                ldlt::forward_each::<f32, 1>(triangle, 0, ldlt::one_each_mut(solved));
                for (k, (l, z)) in row_at_mut(lines, own, i).iter_mut().zip(&*solved).enumerate() {
                    *l = product(z, &diagonal(triangle, k));
                }
                // What the block leaves.
                for (out, sum) in out.iter_mut().zip(sums) {
                    *out = plus(out, sum);
                    lanes::keep_together();
                }
                for (out, line) in out.iter_mut().zip(rows(lines, own)) {
                    *out = lanes::minus_products(*out, solved, line);
                }
            }
        }
        ldlt::factor_each(self.border, width);
        for side in rows_mut(self.sides, width).take(values + units) {
            ldlt::forward_each::<f32, 1>(self.border, 0, ldlt::one_each_mut(side));
            for (j, side) in side.iter_mut().enumerate() {
                *side = product(side, &at(self.border, packed_len(j) + j));
            }
        }
    }

    /// A candidate's coefficients for a value.
    #[inline(always)]
    fn solve(&mut self, batch: &Batch<'_>, value: usize, fit: usize) {
        let (terms, slices) = (&batch.terms, batch.terms.slices);
        let (own, fixed, len) = (self.own, terms.fixed(), self.block_len(batch));
        let (end, which) = (at(&terms.ends, fit), value * terms.ends.len() + fit);
        let Some((shared, solved)) = self.solved.split_at_mut_checked(end) else { return };
        copy(shared, row_at(self.sides, self.width, value));
        ldlt::backward_each(self.border, shared);
        let trend = row_at_mut(self.trends, fixed, which);
        trend.iter_mut().for_each(|sum| *sum = NONE);
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
            first_mut(out, fixed).iter_mut().for_each(|out| *out = NONE);
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
        trend.iter_mut().zip(&*shared).for_each(|(trend, shared)| *trend = plus(trend, shared));
    }

    /// Corrects a block by the fit to the other pixels; see `Fits::leave_block`.
    #[inline(always)]
    fn leave_own(&mut self, batch: &Batch<'_>, block: usize, fits: Range<usize>, corrections: &mut [Four]) {
        let (terms, values, count) = (&batch.terms, batch.values, batch.terms.ends.len());
        let (own, width, fixed, len) = (self.own, self.width, terms.fixed(), self.block_len(batch));
        let places = row_at(batch.places, fixed, block);
        batch.put_columns(block, self.columns);
        let (Some(slices), Some(inside)) = (batch.slices.get(block), batch.inside.get(block)) else { return };
        for (line, slices) in slices.iter().enumerate() {
            let slices = slices.map(|slice| slice as usize);
            gather(self.gathered, &slices.map(|slice| row_at(self.blocks, len, slice)));
            let (mut leverage, mut shares) = (NONE, [NONE; MAX_FIXED]);
            for j in 0..own + width {
                let (source, start) = match j.checked_sub(own) {
                    None => (terms.source(j).0, packed_len(j)),
                    Some(shared) => (shared, packed_len(own) + shared * own),
                };
                let Some((before, out)) = split_at(self.solved, j) else { return };
                let (of_slice, of_border) = halves(before, own.min(j));
                let own_row = first(from(self.gathered, start), of_slice.len());
                let z = lanes::minus_products(at(self.columns, source)[line], of_slice, own_row);
                *out = lanes::minus_products(
                    z,
                    of_border,
                    first(row(self.border, j.saturating_sub(own)), of_border.len()),
                );
                if j < own {
                    let scaled = product(out, &at(self.gathered, start + j));
                    leverage = lanes::plus_product(leverage, scaled, *out);
                    for (unit, share) in shares.iter_mut().enumerate().take(fixed) {
                        let unit = packed_len(own) + (width + values + unit) * own + j;
                        *share = lanes::plus_product(*share, at(self.gathered, unit), *out);
                    }
                }
            }
            let of_border = self.solved.get(own..own + width).unwrap_or_default();
            let mut begin = 0;
            for fit in fits.clone() {
                let end = at(&terms.ends, fit);
                for (b, z) in of_border.iter().enumerate().take(end).skip(begin) {
                    let scaled = product(z, &at(self.border, packed_len(b) + b));
                    leverage = lanes::plus_product(leverage, scaled, *z);
                    for (unit, share) in shares.iter_mut().enumerate().take(fixed) {
                        let entry = at(row_at(self.sides, width, values + unit), b);
                        *share = lanes::plus_product(*share, entry, *z);
                    }
                }
                begin = end;
                let mut reach = leverage;
                for (place, share) in places.iter().zip(&shares) {
                    reach = lanes::minus_product(reach, place[line], *share);
                }
                for value in 0..values {
                    let which = value * count + fit;
                    let all = from(self.coefficients, which * terms.slices * terms.columns());
                    let of = slices.map(|slice| row_at(all, terms.columns(), slice));
                    let coefficients = first_mut(self.gathered, end);
                    gather(coefficients, &of);
                    let mut fitted = NONE;
                    for (column, coefficient) in self.columns.iter().zip(&*coefficients) {
                        fitted = lanes::plus_product(fitted, column[line], *coefficient);
                        lanes::keep_together();
                    }
                    let mut trend = NONE;
                    for (place, coefficient) in places.iter().zip(row_at(self.trends, fixed, which)) {
                        trend = lanes::plus_product(trend, place[line], *coefficient);
                    }
                    let mean = at(row_at(batch.means, values, block), value)[line];
                    let mut residual = NONE;
                    for l in 0..LANES {
                        residual[l] = mean[l] - fitted[l] - trend[l];
                    }
                    // A pixel that no fit is made to is corrected by the fit to all.
                    let residual = if batch.leaves_out { only(&inside[line], &residual) } else { residual };
                    let corrections = row_at_mut(corrections, count, block * values + value);
                    let Some(out) = corrections.get_mut(fit) else { return };
                    for l in 0..LANES {
                        let left = Real::max(1.0 - leverage[l], SINGULAR);
                        out[line][l] = reach[l] * (residual[l] / left) - fitted[l];
                    }
                    lanes::keep_together();
                }
            }
        }
    }
}
