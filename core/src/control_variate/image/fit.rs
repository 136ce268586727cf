//! What fits to other pixels add to each pixel's mean.
//!
//! One factorisation A = L D L' serves every candidate, as each is a prefix of the columns and so of L; `slices`
//! are apart.

use super::super::config::Config;
use super::batch::{Batch, MAX_FIXED};
use super::products::*;
use super::seen::{SUMS, Seen};
use super::slices::Apart;
use super::terms::{MAX_FITS, Terms, scale};

/// What a fit leaves of a sum of squares is at least this of it.
const ROUNDING: f32 = 1e-5;
/// The least weight of pixels' means but 0.
const FAINT: f32 = 1e-24;

pub(super) struct Fits<'a> {
    /// For each block and value, each candidate's correction of its mean.
    pub(super) corrections: &'a mut [Four],
    pub(super) count: usize,
    values: usize,
    /// Of several samples in each pixel, what the fits leave of the samples' sums of squares about their pixel's mean:
    /// of each value and colour, which they have not seen.
    within: &'a mut [Eight],
    /// A, then its factors; for each value what the fit is to, then D^-1 L^-1 times it.
    system: Sums<'a>,
    /// Sums of the pixels' means.
    between: Sums<'a>,
    /// Of each value and candidate; where pixels have one sample those of the fixed columns alone.
    coefficients: &'a mut [Eight],
    /// D^-1 L^-1 of the fixed columns of the unit matrix.
    units: &'a mut [Eight],
    /// L^-1 of a block's columns.
    solved: &'a mut [Four],
    pub(super) penalties: &'a mut [f32],
    /// Where slices are apart, what takes the place of most of these.
    pub(super) apart: Option<Apart<'a>>,
}

impl<'a> Fits<'a> {
    pub(super) fn new(batch: &Batch<'_>, arena: &mut Arena<'a, f32>) -> Self {
        let (call, terms) = (batch.call, &batch.terms);
        let (columns, values, count) = (terms.of_deviations(), batch.values, terms.candidates());
        let fits = Self {
            corrections: arena.take_fours(batch.len.saturating_mul(count * values)),
            count,
            values,
            within: arena.take_lanes(if call.n > 1 { values * COLOURS * count } else { 0 }),
            system: Sums::new(1, columns, values, arena),
            between: Sums::new(1, terms.of_means(), values, arena),
            coefficients: arena.take_lanes(values * count * if call.n > 1 { columns } else { terms.fixed() }),
            units: arena.take_lanes(terms.fixed() * columns),
            solved: arena.take_fours(columns),
            penalties: arena.take(terms.columns()),
            apart: (terms.slices > 0).then(|| Apart::new(terms, values, call.n, arena)),
        };
        terms.penalties(call.basis, fits.penalties);
        fits
    }

    /// Corrects pixels of one sample of the colours `taken`, which the fit to all of them has seen.
    #[inline(always)]
    pub(super) fn leave_own(&mut self, batch: &Batch<'_>, taken: Colours) {
        let Part { gram: factors, sides: of_values, .. } = self.system.part(0);
        let seen = Seen { factors, of_values, of_units: self.units, trends: self.coefficients };
        let none = ([NONE; AT_ONCE], [[NONE; AT_ONCE]; SUMS]);
        for block in batch.blocks(taken) {
            batch.put_pixels(block, false, self.solved, &mut []);
            seen.correct(batch, block, 0..batch.terms.ends.len(), self.solved, none, self.corrections);
        }
    }

    /// Corrects pixels of several samples of a colour, which the fit has not seen.
    #[inline(always)]
    pub(super) fn correct_colour(&mut self, batch: &Batch<'_>, colour: usize) {
        let terms = &batch.terms;
        let (width, fixed) = (terms.columns(), terms.fixed());
        // What the fit leaves of the samples about their pixels' means.
        let Part { gram, sides, squares } = batch.within.part(colour);
        for (value, (whole, sides)) in squares.iter().zip(rows(sides, width)).enumerate() {
            for fit in 0..terms.ends.len() {
                let mut left = *whole;
                let coefficients = self.coefficients(terms, value, fit);
                for (j, b) in coefficients.iter().enumerate().skip(fixed) {
                    let (Some((square, row)), Some(side)) = (row(gram, j).split_last(), sides.get(j)) else { break };
                    // b_j (G_jj b_j + 2 (sum_k G_jk b_k - r_j)).
                    let mut sum = side.map(|side| -side);
                    for (product, other) in from(row, fixed).iter().zip(from(coefficients, fixed)) {
                        sum = lanes::plus_product(sum, *product, *other);
                        lanes::keep_together();
                    }
                    let sum = lanes::plus_product(sum.map(|sum| sum + sum), *square, *b);
                    left = lanes::plus_product(left, sum, *b);
                }
                self.set_within(batch, (value, colour), fit, &left);
            }
        }
        // The fixed columns follow the signal, and correct nothing.
        for (block, value) in
            batch.blocks(Colours(1 << colour)).flat_map(|block| (0..batch.values).map(move |value| (block, value)))
        {
            let functions = row_at(batch.functions, terms.functions, block);
            let places = row_at(batch.places, fixed, block);
            for fit in 0..terms.ends.len() {
                let own = from(self.coefficients(terms, value, fit), fixed);
                let mut fitted = combine([NONE; AT_ONCE], functions, own);
                for (axis, own) in places.iter().skip(1).zip(rows(from(own, terms.functions), terms.moving)) {
                    let slope = combine([NONE; AT_ONCE], functions, own);
                    for row in 0..AT_ONCE {
                        fitted[row] = lanes::plus_product(fitted[row], axis[row], slope[row]);
                    }
                }
                let correction = fitted.map(|fitted| fitted.map(|fitted| -fitted));
                set(self.corrections_mut(block, value), fit, correction);
            }
        }
    }

    /// The fits to slices apart of some colours' samples, with the corrections of pixels of one sample.
    #[inline(always)]
    pub(super) fn fit_slices(&mut self, batch: &Batch<'_>, training: Colours) {
        let weight = if batch.call.n > 1 { self.weigh(batch, training) } else { [1.0; LANES] };
        let Some(apart) = &mut self.apart else { return };
        apart.fit(batch, self.penalties, training, &weight, self.corrections);
    }

    /// As [`correct_colour`](Self::correct_colour), by fits to slices apart.
    #[inline(always)]
    pub(super) fn correct_slices(&mut self, batch: &Batch<'_>, colour: usize) {
        let Some(several) = self.apart.as_mut().and_then(|apart| apart.several.as_mut()) else { return };
        let mut left = [NONE; 2 * Config::MAX_CHANNELS * MAX_FITS];
        for block in batch.blocks(Colours(1 << colour)) {
            several.correct(batch, block, self.corrections, &mut left);
        }
        let fits = batch.terms.ends.len();
        for (value, left) in rows(&left, fits).enumerate().take(batch.values) {
            for (fit, left) in left.iter().enumerate() {
                self.set_within(batch, (value, colour), fit, &batch.joined(left));
            }
        }
    }

    /// What a fit leaves of the samples of a colour about their pixels' means.
    pub(super) fn within(&self, (value, colour): (usize, usize), fit: usize) -> Eight {
        at(row_at(self.within, self.count, value * COLOURS + colour), fit)
    }

    /// The candidates' corrections of a value of a block.
    pub(super) fn corrections(&self, block: usize, value: usize) -> &[Four] {
        row_at(self.corrections, self.count, block * self.values + value)
    }

    pub(super) fn corrections_mut(&mut self, block: usize, value: usize) -> &mut [Four] {
        row_at_mut(self.corrections, self.count, block * self.values + value)
    }

    /// Sets what a fit leaves of the samples of a colour. A difference of sums has no more digits than they.
    pub(super) fn set_within(&mut self, batch: &Batch<'_>, (value, colour): (usize, usize), fit: usize, left: &Eight) {
        let whole = batch.whole(value, colour);
        let left = lanes::zip(left, &whole, |left, whole| Real::max(left, whole * ROUNDING));
        set(row_at_mut(self.within, self.count, value * COLOURS + colour), fit, left);
    }

    /// The fit to all pixels of some colours.
    #[inline(always)]
    pub(super) fn factor(&mut self, batch: &Batch<'_>, training: Colours) {
        let (call, terms) = (batch.call, &batch.terms);
        let width = terms.columns();
        let (count, own) = if call.n == 1 {
            self.system.set_total(&batch.between, training);
            // One sample less where a pixel's own is left out afterwards.
            (batch.present(training), 1.0)
        } else {
            let weight = self.weigh(batch, training);
            self.system.add_weighted(&self.between, &weight);
            (at(self.between.part(0).gram, 0), 0.0)
        };
        let scale = scale(call.config, &count.map(|count| count - own));
        let Part { gram, sides, .. } = self.system.part_mut(0);
        for (j, penalty) in self.penalties.iter().enumerate() {
            let Some(diagonal) = row_mut(gram, j).last_mut() else { continue };
            *diagonal = lanes::plus_product(*diagonal, scale, [*penalty; LANES]);
            lanes::keep_together();
        }
        ldlt::factor_each(gram, width);
        for side in rows_mut(sides, width) {
            ldlt::forward_one(gram, 0, side);
            ldlt::divide_each(gram, side);
        }
        if call.n > 1 {
            for (side, coefficients) in rows(sides, width).zip(rows_mut(self.coefficients, self.count * width)) {
                for (coefficients, &end) in rows_mut(coefficients, width).zip(&terms.ends) {
                    let coefficients = first_mut(coefficients, end);
                    copy(coefficients, side);
                    ldlt::backward_each(gram, coefficients);
                }
            }
            return;
        }
        // Coefficient k of a candidate is e_k' L'^-1 D^-1 L^-1 r over its columns.
        for (k, unit) in rows_mut(self.units, width).enumerate() {
            unit.iter_mut().enumerate().for_each(|(j, out)| *out = if j == k { [1.0; LANES] } else { NONE });
            ldlt::forward_one(gram, k, unit);
            for (side, trends) in rows(sides, width).zip(rows_mut(self.coefficients, self.count * terms.fixed())) {
                sums_to(&terms.ends, unit, side, |fit, sum| set(row_at_mut(trends, terms.fixed(), fit), k, sum));
            }
            ldlt::divide_each(gram, unit);
        }
    }

    /// A candidate's coefficients for a value.
    fn coefficients(&self, terms: &Terms, value: usize, fit: usize) -> &[Eight] {
        first(row_at(self.coefficients, terms.columns(), value * self.count + fit), at(&terms.ends, fit))
    }

    /// Sums several samples in each pixel, and weighs what tells pixels apart by how far it is the samples' noise.
    ///
    /// With s the variance of samples within pixels and t that of the pixels' integrals about their linear trend, a
    /// texture's say, a pixel's mean of n samples says s / (s + n t) of what as many samples about it say: least
    /// squares for a random effect. Where samples are all alike, nothing is left to fit.
    #[inline(always)]
    fn weigh(&mut self, batch: &Batch<'_>, training: Colours) -> Eight {
        let (n, fixed, width) = (batch.call.n as f32, batch.terms.fixed(), batch.terms.of_means());
        self.system.set_total(&batch.within, training);
        self.between.set_total(&batch.between, training);
        let between = self.between.part(0);
        let pixels = at(between.gram, 0).map(|count| count / n);
        let mut trend = [NONE; packed_len(MAX_FIXED)];
        copy(first_mut(&mut trend, packed_len(fixed)), between.gram);
        ldlt::factor_each(&mut trend, fixed);
        let mut weight = [1.0; LANES];
        let squares = self.system.part(0).squares.iter().zip(between.squares);
        for ((inside, whole), sides) in squares.zip(rows(between.sides, width)) {
            let mut explained = [NONE; MAX_FIXED];
            let explained = first_mut(&mut explained, fixed);
            copy(explained, sides);
            ldlt::forward_one(&trend, 0, explained);
            let mut apart = *whole;
            for (j, value) in explained.iter().enumerate() {
                let scaled = product(value, &diagonal(&trend, j));
                apart = lanes::minus_product(apart, scaled, *value);
            }
            let samples = lanes::divisor(&pixels.map(|count| count * (n - 1.0)));
            let freedom = pixels.map(|count| Real::max(count - fixed as f32, 0.0));
            let per_freedom = lanes::zip(&apart, &lanes::divisor(&freedom), |apart, freedom| apart / freedom);
            let (mut within, mut largest) = (NONE, NONE);
            for l in 0..LANES {
                within[l] = inside[l] / samples[l];
                largest[l] = if freedom[l] > 0.0 { Real::max(per_freedom[l], within[l]) } else { within[l] };
            }
            let divisor = lanes::divisor(&largest);
            for l in 0..LANES {
                let share = within[l] / divisor[l];
                // Where nothing varies, all of it.
                weight[l] = if largest[l] > 0.0 { Real::min(share, weight[l]) } else { weight[l] };
            }
        }
        // As good as nothing, of which there is no inverse.
        lanes::each(&weight, |weight| if weight < FAINT { 0.0 } else { weight })
    }
}
