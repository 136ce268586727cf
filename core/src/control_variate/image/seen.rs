//! Fits that have seen the pixels' one sample, which is left out in closed form.

use super::super::config::Config;
use super::batch::{Batch, MAX_FIXED};
use super::products::*;
use core::ops::Range;

/// Sums of [`Seen::correct`] of each value and fixed column.
pub(super) const SUMS: usize = 2 * Config::MAX_CHANNELS + MAX_FIXED;

/// A system to pixels of one sample each, L D L', for fits that are prefixes of its columns.
pub(super) struct Seen<'f> {
    /// L, with D^-1 on the diagonal.
    pub(super) factors: &'f [Eight],
    /// D^-1 L^-1 of each value's right-hand side, and of the fixed columns of the unit matrix.
    pub(super) of_values: &'f [Eight],
    pub(super) of_units: &'f [Eight],
    /// For each value and fit the coefficients of the fixed columns.
    pub(super) trends: &'f [Eight],
}

impl Seen<'_> {
    /// Corrects a block by `fits` that have seen the pixels' one sample, which is left out in closed form. With x its
    /// `columns`, h = x'A^-1 x and e its residual, the fit to the others has coefficients b - A^-1 x e / (1 - h). With
    /// z = L^-1 x, h = z'D^-1 z and x'b = z'D^-1 L^-1 r, where A b = r: sums over each fit's columns. The leverage h,
    /// x'b of each value and A^-1 x of the fixed columns begin with what is given.
    #[inline(always)]
    pub(super) fn correct(
        &self,
        batch: &Batch<'_>,
        block: usize,
        fits: Range<usize>,
        columns: &mut [Four],
        (mut leverage, mut sums): (Four, [Four; SUMS]),
        corrections: &mut [Four],
    ) {
        let (terms, values, width) = (&batch.terms, batch.values, columns.len());
        let places = row_at(batch.places, terms.fixed(), block);
        let inside = at(batch.inside, block);
        ldlt::forward_each(self.factors, 0, columns);
        let factors = Triangle::new(self.factors, width);
        let (mut pivots, mut begin) = (factors.rows().filter_map(|row| row.last()), 0);
        for (index, fit) in fits.clone().enumerate() {
            let end = at(&terms.ends, fit);
            let Some(solved) = columns.get(begin..end) else { return };
            for (z, pivot) in solved.iter().zip(&mut pivots) {
                for row in 0..AT_ONCE {
                    leverage[row] = lanes::plus_product(leverage[row], product(&z[row], pivot), z[row]);
                }
                lanes::keep_together();
            }
            let sides = rows(self.of_values, width).chain(rows(self.of_units, width));
            for (sum, side) in sums.iter_mut().take(values + places.len()).zip(sides) {
                let Some(side) = side.get(begin..end) else { return };
                *sum = combine(*sum, solved, side);
            }
            begin = end;
            let (of_values, shares) = halves(&sums, values);
            let mut reach = leverage;
            for (place, share) in places.iter().zip(shares) {
                for row in 0..AT_ONCE {
                    reach[row] = lanes::minus_product(reach[row], place[row], share[row]);
                }
            }
            for (value, fitted) in of_values.iter().enumerate() {
                let trend = row_at(self.trends, places.len(), value * fits.len() + index);
                let trend = combine([NONE; AT_ONCE], places, trend);
                let mean = at(row_at(batch.means, values, block), value);
                let corrections = row_at_mut(corrections, terms.ends.len(), block * values + value);
                let Some(out) = corrections.get_mut(fit) else { return };
                for row in 0..AT_ONCE {
                    let residual = minus(&mean[row], &fitted[row]);
                    // A pixel that no fit is made to is corrected by the fit to all.
                    let residual = if batch.leaves_out { only(&inside[row], &residual) } else { residual };
                    for l in 0..LANES {
                        let left = Real::max(1.0 - leverage[row][l], rounding());
                        out[row][l] = trend[row][l] - fitted[row][l] + reach[row][l] * (residual[l] / left);
                    }
                    lanes::keep_together();
                }
            }
        }
    }
}
