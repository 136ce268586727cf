//! What fits to other pixels add to each pixel's mean.
//!
//! One factorisation A = L D L' serves every candidate, as each is a prefix of the columns and so of L.

use super::super::config::Ridge;
use super::super::ridge;
use super::batch::{AT_ONCE, Batch, COLOURS, Eight, MAX_FIXED, NONE, Total, next_four, only, products_len};
use super::terms::Terms;
use super::{Call, Layout};
use crate::arena::Arena;
use crate::error::Error;
use crate::lanes::{self, LANES};
use crate::linalg::ldlt;
use crate::matrix::{packed_len, row, row_at, row_at_mut, row_mut};
use crate::real::Real;
use crate::rows::{rows, rows_mut};

/// Ridge strength per sample if the caller gives none.
const STRENGTH: f64 = 0.003;
/// What a fit leaves of a sum of squares is at least this of it.
const ROUNDING: f32 = 1e-5;
/// The least that 1 less a sample's leverage is taken for.
const SINGULAR: f32 = 64.0 * f32::EPSILON;

/// Some of the colours, a bit each.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Colours(pub(super) u8);

impl Colours {
    pub(super) const ALL: Self = Self(0b1111);
    /// Either half of them.
    pub(super) const HALVES: [Self; 2] = [Self(0b1001), Self(0b0110)];

    /// Whether the pixel of a slot is of one of these.
    #[inline(always)]
    pub(super) fn has(self, slot: usize) -> bool {
        self.0 >> (slot % COLOURS) & 1 == 1
    }

    /// These without one.
    fn without(self, colour: usize) -> Self {
        Self(self.0 & !(1 << colour))
    }
}

/// Lanes of [`Fits::within`].
fn within_len(terms: &Terms, values: usize, n: usize) -> usize {
    if n > 1 { values * COLOURS * (1 + terms.ends.len()) } else { 0 }
}

/// Fits to the pixels of a batch.
pub(super) struct Fits<'a> {
    /// For each slot and value, each candidate's correction of its mean.
    corrections: &'a mut [Eight],
    /// How many candidates there are.
    pub(super) count: usize,
    values: usize,
    /// Of several samples in each pixel, what the fits leave of the samples' sums of squares about their pixel's mean:
    /// of each value and colour, which they have not seen.
    within: &'a mut [Eight],
    /// Whether pixels have several samples.
    pub(super) has_several: bool,
    /// A, then its factors; for each channel what the fit is to, then D^-1 L^-1 times it.
    system: Total<'a>,
    /// Sums of the pixels' means.
    between: Total<'a>,
    coefficients: &'a mut [Eight],
    /// 1 / D.
    pivots: &'a mut [Eight],
    /// L^-1 of the fixed columns of the unit matrix.
    units: &'a mut [Eight],
    /// L^-1 of four slots' columns, and the same without the fixed ones.
    solved: &'a mut [[Eight; AT_ONCE]],
    moved: &'a mut [[Eight; AT_ONCE]],
    /// For each value and four slots, what the columns so far leave of it, and what they explain.
    residuals: &'a mut [[Eight; AT_ONCE]],
    fitted: &'a mut [[Eight; AT_ONCE]],
    penalties: &'a mut [f32],
}

/// Numbers that fits take for so many slots.
pub(super) fn fits_len(layout: &Layout<'_>, terms: &Terms, slots: usize) -> Option<usize> {
    let (columns, values, n) = (terms.columns(), layout.values(), layout.n);
    let totals = products_len(columns, values) + products_len(columns, 2 * values);
    let once = totals + (MAX_FIXED + 2 + 2 * AT_ONCE) * columns + within_len(terms, values, n) + 2 * AT_ONCE * values;
    slots.checked_mul(terms.ends.len() * values)?.checked_add(once)?.checked_mul(LANES)?.checked_add(columns)
}

impl<'a> Fits<'a> {
    pub(super) fn new(call: &Call<'_>, terms: &Terms, slots: usize, arena: &mut Arena<'a, f32>) -> Result<Self, Error> {
        let (columns, values) = (terms.columns(), call.values());
        let fits = Self {
            corrections: arena.take_lanes(slots * terms.ends.len() * values)?,
            count: terms.ends.len(),
            values,
            within: arena.take_lanes(within_len(terms, values, call.n))?,
            has_several: call.n > 1,
            system: Total::new(columns, values, arena)?,
            between: Total::new(columns, 2 * values, arena)?,
            coefficients: arena.take_lanes(columns)?,
            pivots: arena.take_lanes(columns)?,
            units: arena.take_lanes(terms.fixed() * columns)?,
            solved: arena.take_lanes(AT_ONCE * columns)?.as_chunks_mut().0,
            moved: arena.take_lanes(AT_ONCE * columns)?.as_chunks_mut().0,
            residuals: arena.take_lanes(AT_ONCE * values)?.as_chunks_mut().0,
            fitted: arena.take_lanes(AT_ONCE * values)?.as_chunks_mut().0,
            penalties: arena.take(columns)?,
        };
        terms.penalties(call.config, call.basis, |_| 1.0, fits.penalties);
        Ok(fits)
    }

    /// Corrects every pixel of the colours `taken`, of which it has seen no sample, by fits to the others of them.
    #[inline(always)]
    pub(super) fn correct(&mut self, call: &Call<'_>, terms: &Terms, batch: &Batch<'_>, taken: Colours) {
        let is_single = call.n == 1;
        for colour in 0..if is_single { 1 } else { COLOURS } {
            if !is_single && !taken.has(colour) {
                continue;
            }
            self.factor(call, terms, batch, if is_single { taken } else { taken.without(colour) });
            let targets = if is_single { taken } else { Colours(1 << colour) };
            if !is_single {
                self.judge(terms, batch, colour);
            }
            let mut slots = (0..batch.slots).filter(|&slot| targets.has(slot));
            while let Some(four) = next_four(&mut slots) {
                if is_single {
                    self.apply::<true>(terms, batch, &four);
                } else {
                    self.apply::<false>(terms, batch, &four);
                }
            }
        }
    }

    /// What a fit, or without one the mean, leaves of the samples of a colour about their pixels' means.
    #[inline(always)]
    pub(super) fn within(&self, value: usize, colour: usize, fit: usize) -> Eight {
        row_at(self.within, 1 + self.count, value * COLOURS + colour).get(fit).copied().unwrap_or(NONE)
    }

    /// The candidates' corrections of a value of a slot.
    #[inline(always)]
    pub(super) fn corrections(&self, slot: usize, value: usize) -> &[Eight] {
        row_at(self.corrections, self.count, slot * self.values + value)
    }

    /// The fit to all pixels of some colours.
    #[inline(always)]
    fn factor(&mut self, call: &Call<'_>, terms: &Terms, batch: &Batch<'_>, training: Colours) {
        let width = terms.columns();
        batch.sums.total(training, &batch.sums.samples, &mut self.system);
        if call.n > 1 {
            batch.sums.total(training, &batch.sums.pixels, &mut self.between);
            self.weigh_means(call, terms);
        }
        let system = &mut *self.system.gram;
        let strength = match call.config.ridge {
            Ridge::Fixed(_) => ridge::single::<f32>(call.config.ridge),
            Ridge::Default | Ridge::Auto => STRENGTH,
        } as f32;
        // One sample less where a pixel's own is left out afterwards.
        let (counted, own) = if call.n == 1 { (&*system, 1.0) } else { (&*self.between.gram, 0.0) };
        let count = counted.first().copied().unwrap_or(NONE);
        let controls = terms.fixed()..terms.fixed() + call.config.controls;
        for (j, penalty) in self.penalties.iter().enumerate() {
            let Some(diagonal) = row_mut(system, j).last_mut() else { continue };
            let divisor = if controls.contains(&j) { lanes::divisor(&count) } else { *diagonal };
            for l in 0..LANES {
                // What a control function is measured in is its maker's choice.
                let unit = if controls.contains(&j) { diagonal[l] / divisor[l] } else { 1.0 };
                diagonal[l] += strength * Real::max(count[l] - own, 0.0) * penalty * unit;
            }
            lanes::keep_together();
        }
        ldlt::factor_each(system, width);
        for (j, pivot) in self.pivots.iter_mut().enumerate() {
            *pivot = row(system, j).last().copied().unwrap_or(NONE);
        }
        for side in rows_mut(self.system.sides, width) {
            ldlt::forward_each::<f32, 1>(system, 0, ldlt::one_each_mut(side));
            for (side, pivot) in side.iter_mut().zip(self.pivots.iter()) {
                *side = lanes::zip(side, pivot, |side, pivot| side * pivot);
                lanes::keep_together();
            }
        }
        if call.n == 1 {
            for (k, unit) in rows_mut(self.units, width).enumerate() {
                unit.iter_mut().enumerate().for_each(|(j, out)| *out = if j == k { [1.0; LANES] } else { NONE });
                ldlt::forward_each::<f32, 1>(system, k, ldlt::one_each_mut(unit));
            }
        }
    }

    /// Several samples in each pixel: weighs what tells pixels apart by how far it is the samples' noise.
    ///
    /// With s the variance of samples within pixels and t that of the pixels' integrals about their linear trend, a
    /// texture's say, a pixel's mean of n samples says s / (s + n t) of what as many samples about it say: least
    /// squares for a random effect. Where samples are all alike, nothing is left to fit.
    #[inline(always)]
    fn weigh_means(&mut self, call: &Call<'_>, terms: &Terms) {
        let (width, fixed, values) = (terms.columns(), terms.fixed(), self.values);
        let n = call.n as f32;
        let pixels = self.between.gram.first().copied().unwrap_or(NONE).map(|count| count / n);
        let mut trend = [NONE; packed_len(MAX_FIXED)];
        trend.iter_mut().zip(self.between.gram.iter()).take(packed_len(fixed)).for_each(|(out, sum)| *out = *sum);
        ldlt::factor_each(&mut trend, fixed);
        let mut weight = [1.0; LANES];
        for value in 0..values {
            let get = |squares: &[Eight], index: usize| squares.get(index).copied().unwrap_or(NONE);
            let inside = get(self.system.squares, value);
            let (means, whole) = (get(self.between.squares, value), get(self.between.squares, values + value));
            let mut explained = [NONE; MAX_FIXED];
            let sides = row_at(self.between.sides, width, values + value);
            explained.iter_mut().zip(sides).take(fixed).for_each(|(out, side)| *out = *side);
            let explained = explained.get_mut(..fixed).unwrap_or(&mut []);
            ldlt::forward_each::<f32, 1>(&trend, 0, ldlt::one_each_mut(explained));
            let mut apart = whole;
            for (j, value) in explained.iter().enumerate() {
                let pivot = row(&trend, j).last().copied().unwrap_or(NONE);
                apart = lanes::minus_product(apart, lanes::zip(value, &pivot, |value, pivot| value * pivot), *value);
            }
            let samples = lanes::divisor(&pixels.map(|count| count * (n - 1.0)));
            let freedom = pixels.map(|count| Real::max(count - fixed as f32, 0.0));
            let per_freedom = lanes::zip(&apart, &lanes::divisor(&freedom), |apart, freedom| apart / freedom);
            let (mut within, mut largest) = (NONE, NONE);
            for l in 0..LANES {
                within[l] = Real::max(inside[l] - means[l], 0.0) / samples[l];
                largest[l] = if freedom[l] > 0.0 { Real::max(per_freedom[l], within[l]) } else { within[l] };
            }
            let divisor = lanes::divisor(&largest);
            for l in 0..LANES {
                let share = within[l] / divisor[l];
                // Where nothing varies, all of it.
                weight[l] = if largest[l] > 0.0 { Real::min(share, weight[l]) } else { weight[l] };
            }
        }
        let (system, between) = (&mut *self.system.gram, &*self.between.gram);
        for j in 0..width {
            for (k, (out, means)) in row_mut(system, j).iter_mut().zip(row(between, j)).enumerate() {
                for l in 0..LANES {
                    // The fixed columns do not change within a pixel.
                    let within = if k < fixed { 0.0 } else { out[l] - means[l] };
                    out[l] = within + weight[l] * means[l];
                }
                lanes::keep_together();
            }
        }
        for (value, sides) in rows_mut(self.system.sides, width).enumerate() {
            let means = row_at(self.between.sides, width, value);
            let whole = row_at(self.between.sides, width, values + value);
            for (j, (out, (means, whole))) in sides.iter_mut().zip(means.iter().zip(whole)).enumerate() {
                for l in 0..LANES {
                    let within = if j < fixed { 0.0 } else { out[l] - means[l] };
                    out[l] = within + weight[l] * whole[l];
                }
                lanes::keep_together();
            }
        }
    }

    /// What the fit leaves of the samples of a colour that it has not seen, about their pixels' means.
    #[inline(always)]
    fn judge(&mut self, terms: &Terms, batch: &Batch<'_>, colour: usize) {
        let (width, fixed) = (terms.columns(), terms.fixed());
        let samples = batch.sums.samples.part(colour);
        let pixels = batch.sums.pixels.part(colour);
        for value in 0..samples.squares.len() {
            let within = row_at_mut(self.within, 1 + self.count, value * COLOURS + colour);
            let difference = |a: &[Eight], b: &[Eight], index: usize| {
                let [a, b] = [a, b].map(|all| all.get(index).copied().unwrap_or(NONE));
                lanes::zip(&a, &b, |a, b| a - b)
            };
            let whole = difference(samples.squares, pixels.squares, value).map(|whole| Real::max(whole, 0.0));
            if let Some(out) = within.first_mut() {
                *out = whole;
            }
            let [sides, means] = [samples.sides, pixels.sides].map(|sides| row_at(sides, width, value));
            for (&end, out) in terms.ends.iter().zip(within.iter_mut().skip(1)) {
                let coefficients = self.coefficients.get_mut(..end).unwrap_or(&mut []);
                let solved = row_at(self.system.sides, width, value);
                coefficients.iter_mut().zip(solved).for_each(|(out, side)| *out = *side);
                ldlt::backward_each(self.system.gram, coefficients);
                let mut left = whole;
                for (j, b) in coefficients.iter().enumerate().skip(fixed) {
                    // b_j (G_jj b_j + 2 sum_k G_jk b_k - 2 r_j).
                    let mut sum = difference(sides, means, j).map(|side| -2.0 * side);
                    let products = row(samples.grams, j).iter().zip(row(pixels.grams, j));
                    for (k, ((samples, means), other)) in products.zip(coefficients.iter()).enumerate().skip(fixed) {
                        let twice = if k < j { 2.0 } else { 1.0 };
                        for l in 0..LANES {
                            sum[l] += (samples[l] - means[l]) * (twice * other[l]);
                        }
                        lanes::keep_together();
                    }
                    left = lanes::plus_product(left, sum, *b);
                }
                // A difference of sums has no more digits than they.
                *out = lanes::zip(&left, &whole, |left, whole| Real::max(left, whole * ROUNDING));
            }
        }
    }

    /// Corrects four slots. With `OWN` the fit has seen their one sample, which is left out in closed form: with x its
    /// columns, h = x'A^-1 x and e its residual, the fit to the others has coefficients b - A^-1 x e / (1 - h).
    #[inline(always)]
    fn apply<const OWN: bool>(&mut self, terms: &Terms, batch: &Batch<'_>, slots: &[Option<usize>; AT_ONCE]) {
        let (width, fixed) = (terms.columns(), terms.fixed());
        let values = self.values;
        for (s, slot) in slots.iter().enumerate() {
            let columns = slot.map_or(&[][..], |slot| row_at(batch.columns, width, slot));
            for (j, solved) in self.solved.iter_mut().enumerate() {
                solved[s] = columns.get(j).copied().unwrap_or(NONE);
                lanes::keep_together();
            }
        }
        ldlt::forward_each(self.system.gram, if OWN { 0 } else { fixed }, self.solved);
        let moved = if OWN {
            // The fixed columns follow the signal, and correct nothing.
            for (moved, solved) in self.moved.iter_mut().zip(self.solved.iter()) {
                *moved = *solved;
                lanes::keep_together();
            }
            for (k, unit) in rows(self.units, width).enumerate() {
                let place = slots.map(|slot| {
                    slot.and_then(|slot| row_at(batch.places, fixed, slot).get(k)).copied().unwrap_or(NONE)
                });
                for (moved, unit) in self.moved.iter_mut().zip(unit) {
                    for s in 0..AT_ONCE {
                        moved[s] = lanes::minus_product(moved[s], place[s], *unit);
                    }
                    lanes::keep_together();
                }
            }
            &*self.moved
        } else {
            &*self.solved
        };
        let inside = slots.map(|slot| slot.and_then(|slot| batch.inside.get(slot)).copied().unwrap_or(NONE));
        for (s, slot) in slots.iter().enumerate() {
            let means = slot.map_or(&[][..], |slot| row_at(batch.means, values, slot));
            for (at, residual) in self.residuals.iter_mut().enumerate() {
                residual[s] = means.get(at).copied().unwrap_or(NONE);
            }
        }
        self.fitted.iter_mut().for_each(|fitted| *fitted = [NONE; AT_ONCE]);
        let (mut leverage, mut reach) = ([NONE; AT_ONCE], [NONE; AT_ONCE]);
        let mut begin = if OWN { 0 } else { fixed };
        for (fit, &end) in terms.ends.iter().enumerate() {
            let range = begin..end;
            let (solved, moved) = (self.solved.get(range.clone()), moved.get(range.clone()));
            let (Some(solved), Some(moved), Some(pivots)) = (solved, moved, self.pivots.get(range.clone())) else {
                return;
            };
            begin = end;
            if OWN {
                for ((z, moved), pivot) in solved.iter().zip(moved).zip(pivots) {
                    for s in 0..AT_ONCE {
                        let scaled = lanes::zip(&z[s], pivot, |z, pivot| z * pivot);
                        leverage[s] = lanes::plus_product(leverage[s], scaled, z[s]);
                        reach[s] = lanes::plus_product(reach[s], scaled, moved[s]);
                    }
                    lanes::keep_together();
                }
            }
            for (value, (residual, fitted)) in self.residuals.iter_mut().zip(self.fitted.iter_mut()).enumerate() {
                let sides = row_at(self.system.sides, width, value).get(range.clone()).unwrap_or(&[]);
                for ((z, moved), side) in solved.iter().zip(moved).zip(sides) {
                    for s in 0..AT_ONCE {
                        if OWN {
                            residual[s] = lanes::minus_product(residual[s], *side, z[s]);
                        }
                        fitted[s] = lanes::plus_product(fitted[s], *side, moved[s]);
                    }
                    lanes::keep_together();
                }
                for (s, slot) in slots.iter().enumerate() {
                    let Some(slot) = slot else { continue };
                    let at = (slot * values + value) * self.count + fit;
                    let Some(out) = self.corrections.get_mut(at) else { continue };
                    // A pixel that no fit is made to is corrected by the fit to all.
                    let own = if batch.leaves_out { only(&inside[s], &residual[s]) } else { residual[s] };
                    for l in 0..LANES {
                        let left = Real::max(1.0 - leverage[s][l], SINGULAR);
                        out[l] = if OWN { reach[s][l] * (own[l] / left) - fitted[s][l] } else { -fitted[s][l] };
                    }
                    lanes::keep_together();
                }
            }
        }
    }
}
