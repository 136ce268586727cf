//! The samples' n x n system, for fewer samples than functions.

use super::super::design::Design;
use super::{Fit, Penalty};
use crate::arena::Arena;
use crate::lanes::{self, LANES};
use crate::linalg::ldlt::Ldlt;
use crate::matrix::{Panel, Triangle, copy, from_mut, packed_len};
use crate::real::{Real, rounding};
use core::iter;

/// The matrix K = P D^-1 P' over all columns, for relative penalties D, and g = P D^-1 m.
pub(crate) struct Dual<'a, R> {
    kernel: Triangle<&'a mut [R]>,
    shift: &'a mut [R],
}

/// Numbers that a dual system of `n` samples, not many, and its fits take from their arena.
pub(crate) fn len(n: usize, channels: usize) -> usize {
    let padded = n.next_multiple_of(LANES);
    packed_len(padded) + padded + 2 * packed_len(n) + n * (2 + channels)
}

impl<'a, R: Real> Dual<'a, R> {
    pub(crate) fn new(design: &Design<'_, R>, penalties: &[R], arena: &mut Arena<'a, R>) -> Self {
        let padded = design.n.next_multiple_of(LANES);
        let mut kernel = arena.triangle(padded);
        let shift = arena.zeros(padded);
        for (a, ((left, _), shift)) in design.each_panel().zip(shift.chunks_exact_mut(LANES)).enumerate() {
            for (b, (right, _)) in design.each_panel().enumerate().take(a + 1) {
                let mut tile = [[R::ZERO; LANES]; LANES];
                for ((left, right), &penalty) in left.iter().zip(right).zip(penalties) {
                    let weight = R::ONE / penalty;
                    for (row, &value) in tile.iter_mut().zip(left) {
                        *row = lanes::plus_product(*row, [weight * value; LANES], *right);
                    }
                }
                for (i, tile_row) in tile.iter().enumerate() {
                    copy(from_mut(kernel.row_mut(a * LANES + i), b * LANES), tile_row);
                }
            }
            for ((column, &mean), &penalty) in left.iter().zip(design.column_means).zip(penalties) {
                let weight = R::ONE / penalty * mean;
                for (shift, &value) in shift.iter_mut().zip(column) {
                    *shift += weight * value;
                }
            }
        }
        Self { kernel, shift }
    }

    /// The fit with ridge strength s over all columns. With B = K + s n I,
    ///
    /// b = D^-1 P' B^-1 f,   h_i - 1/n = 1 - s n (B^-1)_ii,   m'A^-1 p_i = (B^-1 g)_i.
    pub(crate) fn fit(
        &self,
        design: &Design<'_, R>,
        penalty: Penalty<'_, R>,
        leave_one_out: bool,
        coefficients: Option<&mut [R]>,
        mut arena: Arena<'_, R>,
    ) -> Fit<R> {
        let n = design.n;
        let count = R::from_usize(n);
        let inverse_n = R::ONE / count;
        let strength = penalty.strength * count;
        let mut matrix = arena.triangle(n);
        let inverse = arena.triangle(n);
        let (diagonal, shift) = (arena.zeros(n), arena.take(n));
        let mut alpha = Panel::new(arena.take(n * design.channels), n);
        copy(matrix.entries_mut(), self.kernel.entries());
        // K annihilates 1, so B^-1 holds 11'/(s n) beside which all else is small for a small strength s. With
        // c 11'/n added to B, c = tr K / n, that part is 11'/((s + c) n), and f and g, orthogonal to 1, see no change.
        let trace = (0..n).fold(R::ZERO, |sum, i| sum + self.kernel.diagonal(i));
        let lift = trace * inverse_n;
        for value in matrix.entries_mut() {
            *value += lift * inverse_n;
        }
        matrix.add_to_diagonal(iter::repeat(strength));
        let left = strength / (strength + lift);
        let factor = Ldlt::new(matrix);
        copy(shift, self.shift);
        factor.solve(shift);
        if leave_one_out {
            factor.inverse_diagonal(inverse, diagonal);
        }
        let eccentricity = shift.iter().fold(R::ZERO, |sum, &value| sum + value * value) * count;
        let traced = diagonal.iter().fold(R::ZERO, |sum, &value| sum + (R::ONE - strength * value));
        let mut fit = Fit { eccentricity, freedom: traced - (R::ONE - left), ..Fit::default() };
        for (channel, alpha) in alpha.rows_mut().enumerate() {
            for (out, &value) in alpha.iter_mut().zip(design.values.column(channel).flatten()) {
                *out = value;
            }
            factor.solve(alpha);
            let (mut in_sample, mut correction) = (R::ZERO, R::ZERO);
            let (mut press, mut influences) = (R::ZERO, R::ZERO);
            let samples = alpha.iter().zip(self.shift.iter()).zip(shift.iter()).zip(diagonal.iter());
            for (((&alpha, &g), &shift), &diagonal) in samples {
                in_sample -= g * alpha;
                let complement = strength * diagonal;
                let gap = (complement - left * inverse_n).max(rounding());
                let residual = strength * alpha / gap;
                let influence = residual * (R::ONE - count * shift);
                press += residual * residual;
                influences += influence * influence;
                let leverage = R::ONE - complement - (R::ONE - left) * inverse_n;
                correction += (leverage + shift) * residual;
            }
            fit.press[channel] = press;
            fit.influence[channel] = influences;
            fit.in_sample[channel] = in_sample;
            fit.leave_one_out[channel] = in_sample + correction * inverse_n;
        }
        if let Some(coefficients) = coefficients {
            for (out, alpha) in Panel::new(coefficients, design.columns).rows_mut().zip(alpha.rows()) {
                for (j, (out, &relative)) in out.iter_mut().zip(penalty.relative).enumerate() {
                    let mut total = R::ZERO;
                    for (column, alpha) in design.panels.column(j).zip(alpha.chunks(LANES)) {
                        total += column.iter().zip(alpha).map(|(&p, &a)| p * a).fold(R::ZERO, |a, b| a + b);
                    }
                    *out = total / relative;
                }
            }
        }
        fit
    }
}
