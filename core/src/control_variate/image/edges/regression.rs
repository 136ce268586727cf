//! The fits: a logistic regression of whether a sample is lit, and least squares to the lit ones.

use super::super::batch::{Batch, MAX_FIXED};
use super::super::products::*;
use super::functions::*;
use super::interpolant::MOST;
use super::{Edges, MAX_COLUMNS};
use crate::control_variate::Config;
use core::f32::consts::{LN_2, LOG2_E};

/// The most steps of the regression, the longest, and the shortest after which there is another.
const STEPS: usize = 8;
const LONGEST: f32 = 4.0;
const SHORTEST: f32 = 0.02;
/// Penalties of the constant, of places and of functions, in q and in A, where places have unit variance.
const PENALTIES: [f32; 2 + FUNCTIONS] = [1e-4, 0.03, 0.05, 0.05, 0.2, 0.2, 0.2];
const PENALTIES_OF_A: [f32; 2 + SLOPES] = [2e-3, 0.3, 0.5, 0.5];
/// The least variance of whether a sample is lit.
const LEAST_VARIANCE: f32 = 1e-3;

impl Edges<'_> {
    /// The logistic regression, by Newton's steps, where `wanted`.
    #[inline(always)]
    pub(super) fn regress(&self, batch: &Batch<'_>, training: Colours, wanted: &Eight, weights: &mut [Eight]) {
        let (width, fixed) = (weights.len(), batch.terms.fixed());
        let sums = self.training[0].part(0);
        let [count, lit] = [sums.gram, sums.sides].map(|sums| at(sums, 0));
        let odds = lanes::zip(&lit, &count, |lit, count| (lit + 0.5) / (count - lit + 0.5));
        let share = odds.map(|odds| odds / (1.0 + odds));
        set(weights, 0, lanes::log2(&odds).map(|logarithm| logarithm * LN_2));
        let mut all = [NONE; packed_len(MAX_COLUMNS)];
        let matrix = first_mut(&mut all, packed_len(width));
        let mut sides = [NONE; MAX_COLUMNS];
        let sides = first_mut(&mut sides, width);
        let mut left = *wanted;
        for step in 0..STEPS {
            if step == 0 {
                // All are as likely to be lit, so that the sums are at hand.
                let variance = share.map(|share| Real::max(share * (1.0 - share), LEAST_VARIANCE));
                for (out, sum) in matrix.iter_mut().zip(sums.gram) {
                    *out = product(sum, &variance);
                }
                for (j, (out, side)) in sides.iter_mut().zip(sums.sides).enumerate() {
                    *out = lanes::minus_product(*side, at(row(sums.gram, j), 0), share);
                }
            } else {
                matrix.iter_mut().chain(sides.iter_mut()).for_each(|sum| *sum = NONE);
                for block in batch.blocks(training) {
                    self.add_slopes(batch, block, weights, matrix, sides);
                }
                matrix.iter_mut().chain(sides.iter_mut()).for_each(|sum| *sum = batch.joined(sum));
            }
            for (j, (side, weight)) in sides.iter_mut().zip(weights.iter()).enumerate() {
                *side = lanes::minus_product(*side, *weight, [penalise(matrix, &PENALTIES, fixed, j); LANES]);
            }
            ldlt::factor_each(matrix, width);
            ldlt::solve_each(matrix, sides);
            let mut longest = NONE;
            for side in sides.iter() {
                longest = lanes::zip(&longest, side, |longest, side| Real::max(Real::abs(side), longest));
            }
            let scale = longest.map(|longest| LONGEST / Real::max(longest, LONGEST));
            let scale = only(&left, &scale);
            for (weight, side) in weights.iter_mut().zip(sides.iter()) {
                *weight = lanes::plus_product(*weight, *side, scale);
            }
            left = lanes::zip(&left, &longest, |left, longest| if longest >= SHORTEST { left } else { 0.0 });
            if left == NONE {
                break;
            }
        }
    }

    /// Adds what a block's samples say of the next step.
    #[inline]
    fn add_slopes(
        &self,
        batch: &Batch<'_>,
        block: usize,
        weights: &[Eight],
        matrix: &mut [Eight],
        sides: &mut [Eight],
    ) {
        let fixed = batch.terms.fixed();
        let places = row_at(batch.places, fixed, block);
        let inside = at(batch.inside, block);
        let base = combine([NONE; AT_ONCE], places, weights);
        // A pixel's place is the same for all of its samples.
        let (mut total, mut totals) = ([NONE; AT_ONCE], [[NONE; AT_ONCE]; FUNCTIONS]);
        let mut rest = [NONE; AT_ONCE];
        for (x, y, lit, _) in self.samples(batch, block) {
            let functions = functions(x, y);
            let q = combine(base, &functions, from(weights, fixed));
            let (mut variance, mut apart) = (q, *lit);
            for row in 0..AT_ONCE {
                let share = logistic(&q[row]);
                for l in 0..LANES {
                    variance[row][l] = Real::max(share[l] * (1.0 - share[l]), LEAST_VARIANCE) * inside[row][l];
                    apart[row][l] = (lit[row][l] - share[l]) * inside[row][l];
                    total[row][l] += variance[row][l];
                    rest[row][l] += apart[row][l];
                }
                lanes::keep_together();
            }
            for (i, (function, total)) in functions.iter().zip(&mut totals).enumerate() {
                let weighted = times(function, &variance);
                for row in 0..AT_ONCE {
                    total[row] = plus(&total[row], &weighted[row]);
                }
                add_products(from_mut(row_mut(matrix, fixed + i), fixed), &weighted, &functions);
                if let Some(side) = sides.get_mut(fixed + i) {
                    *side = plus_four(*side, &apart, function);
                }
            }
        }
        for (j, (place, side)) in places.iter().zip(sides.iter_mut()).enumerate() {
            let weighted = times(place, &total);
            add_products(row_mut(matrix, j), &weighted, places);
            *side = plus_four(*side, &rest, place);
        }
        for (i, total) in totals.iter().enumerate() {
            add_products(first_mut(row_mut(matrix, fixed + i), fixed), total, places);
        }
    }

    /// Least squares to the lit samples of the training set.
    pub(super) fn fit_lit(&self, batch: &Batch<'_>, a: &mut [[Eight; MAX_FIXED + SLOPES]; Config::MAX_CHANNELS]) {
        let (fixed, width) = (batch.terms.fixed(), batch.terms.fixed() + SLOPES);
        let sums = self.training[1].part(0);
        let count = at(sums.gram, 0);
        let mut matrix = [NONE; packed_len(MAX_FIXED + SLOPES)];
        let matrix = first_mut(&mut matrix, packed_len(width));
        copy(matrix, sums.gram);
        for j in 0..width {
            penalise(matrix, &PENALTIES_OF_A, fixed, j);
        }
        ldlt::factor_each(matrix, width);
        let divisor = lanes::divisor(&count);
        for (channel, out) in a.iter_mut().enumerate().take(batch.call.config.channels) {
            let out = first_mut(out, width);
            copy(out, row_at(sums.sides, width, channel));
            // About their mean, which is not held back.
            let mean = lanes::zip(&at(out, 0), &divisor, |sum, count| sum / count);
            for (j, out) in out.iter_mut().enumerate() {
                *out = lanes::minus_product(*out, at(row(sums.gram, j), 0), mean);
            }
            ldlt::solve_each(matrix, out);
            if let Some(first) = out.first_mut() {
                *first = plus(first, &mean);
            }
        }
    }
}

/// 1 / (1 + e^-q)
#[inline]
fn logistic(q: &Eight) -> Eight {
    let mut out = *q;
    for value in &mut out {
        *value = Real::max(Real::min(*value, MOST), -MOST) * -LOG2_E;
    }
    out = lanes::exp2(&out);
    for value in &mut out {
        *value = 1.0 / (1.0 + *value);
    }
    out
}

/// Adds the penalty of a column to its square, and says it.
fn penalise(matrix: &mut [Eight], penalties: &[f32], fixed: usize, column: usize) -> f32 {
    let penalty = at(penalties, if column < fixed { column.min(1) } else { 2 + column - fixed });
    if let Some(square) = row_mut(matrix, column).last_mut() {
        *square = square.map(|square| square + penalty);
    }
    penalty
}
