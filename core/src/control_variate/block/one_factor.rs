//! Leaving each pixel's samples out of one factorisation.

use super::super::config::Config;
use super::super::design::Design;
use super::fit::{Problem, Setting};
use super::members::Members;
use super::panel::only_used;
use super::terms::MAX_AXES;
use crate::arena::Arena;
use crate::error::Error;
use crate::lanes::{self, LANES, Lanes};
use crate::linalg::{ldlt, packed_len, row, row_mut};
use crate::real::Real;
use crate::rows::{rows, rows_mut};

/// The least that 1 less a sample's leverage is taken for, in units of the type's epsilon.
const SINGULAR: f64 = 64.0;

impl Problem<'_> {
    /// Few samples in each pixel: one factorisation A = L D L', from which each pixel's n samples are left out in
    /// closed form. With X their rows, H = X A^-1 X' and e their residuals, the residuals under the fit to all others
    /// are r = (I - H)^-1 e, and its coefficients b - A^-1 X' r. Every candidate is a prefix of the columns and so of
    /// L: with Z = L^-1 X', H = Z'D^-1 Z and all else are partial sums over the rows of Z.
    #[inline(always)]
    pub(super) fn by_one_factor<R: Real>(
        &self,
        members: &Members<'_>,
        setting: &Setting<'_, R>,
        n: usize,
        estimates: &mut [Lanes<R>],
        arena: &mut Arena<'_, R>,
    ) -> Result<(), Error> {
        let mut arena = arena.scratch();
        let terms = setting.terms;
        let (width, fixed, channels) = (terms.columns(), terms.fixed(), self.config.channels);
        let count = members.len.div_ceil(LANES);
        let columns = arena.take_lanes(count * n * width)?;
        let values = arena.take_lanes(count * n * channels)?;
        let z = arena.take_lanes(n * width)?;
        let products = arena.take_lanes(packed_len(n))?;
        let system = arena.take_lanes(packed_len(n))?;
        let parts = arena.take_lanes(fixed * n)?;
        let fitted = arena.take_lanes(channels * n)?;
        let residuals = arena.take_lanes(n)?;
        let gram = arena.take(packed_len(width))?;
        let rhs = arena.take(width * channels)?;
        let penalties = arena.take(width)?;
        let units = arena.take(fixed * width)?;
        let loads = rows_mut(columns, n * width).zip(rows_mut(values, n * channels)).zip(setting.places());
        for (index, ((columns, values), places)) in loads.enumerate() {
            let panel = self.panel(members, index * LANES);
            for (sample, (columns, values)) in rows_mut(columns, width).zip(rows_mut(values, channels)).enumerate() {
                self.load(setting, &panel, sample, places, columns, values);
            }
        }
        let design = Design {
            n: members.len * n,
            columns: width,
            channels,
            panels: columns,
            values,
            column_means: &mut [],
            units: setting.units,
        };
        design.normal_equations(gram, rhs);
        self.add_ridge(terms, (members.len - 1) * n, gram, penalties);
        ldlt::factor(gram, width);
        for rhs in rows_mut(rhs, width) {
            ldlt::forward(gram, rhs);
            ldlt::scale_by_inverse_diagonal(gram, rhs);
        }
        // The fixed columns' part of a row, which corrects nothing, has L^-1 of the columns of the unit matrix: what it
        // adds to a sum over Z is its places times that sum over those.
        for (k, unit) in rows_mut(units, width).enumerate() {
            for (j, value) in unit.iter_mut().enumerate() {
                *value = if j == k { R::ONE } else { R::ZERO };
            }
            ldlt::forward(gram, unit);
        }
        let smallest = R::from_f64(SINGULAR) * R::EPSILON;
        let inverse_n = R::ONE / R::from_usize(n);
        let panels = rows(design.panels, n * width).zip(rows(design.values, n * channels)).zip(setting.places());
        let panels = panels.zip(rows_mut(estimates, setting.estimates(channels))).enumerate();
        for (index, (((columns, values), used), out)) in panels {
            let whole;
            let mut places = used;
            let panel = self.panel(members, index * LANES);
            if setting.leaves_out {
                whole = members.places(index * LANES);
                places = whole.get(..fixed).unwrap_or(&[]);
            }
            for (sample, (z, columns)) in rows_mut(z, width).zip(rows(columns, width)).enumerate() {
                for (z, column) in z.iter_mut().zip(columns) {
                    *z = *column;
                }
                if setting.leaves_out {
                    // Pixels that are in no fit were not in the columns.
                    let mut values = [[R::ZERO; LANES]; Config::MAX_CHANNELS];
                    self.load(setting, &panel, sample, places, z, values.get_mut(..channels).unwrap_or(&mut []));
                }
                ldlt::forward_lanes(gram, z);
            }
            for sum in products.iter_mut().chain(parts.iter_mut()).chain(fitted.iter_mut()) {
                *sum = [R::ZERO; LANES];
            }
            let mut trends = [[R::ZERO; 1 + MAX_AXES]; Config::MAX_CHANNELS];
            let mut means = [[R::ZERO; LANES]; Config::MAX_CHANNELS];
            for values in rows(values, channels) {
                for (mean, value) in means.iter_mut().zip(values) {
                    lanes::add_scaled(mean, inverse_n, value);
                }
            }
            let mut out = rows_mut(out, channels);
            for (out, mean) in out.next().unwrap_or(&mut []).iter_mut().zip(&means) {
                *out = *mean;
            }
            let mut begin = 0;
            for (&end, out) in terms.ends.iter().zip(out) {
                for j in begin..end {
                    let inverse = ldlt::inverse_pivot(gram, j);
                    for (s, row_s) in rows(z, width).enumerate() {
                        let at = row_s.get(j).copied().unwrap_or([R::ZERO; LANES]);
                        let scaled = at.map(|z| z * inverse);
                        for (sum, other) in row_mut(products, s).iter_mut().zip(rows(z, width)) {
                            lanes::add_product(sum, other.get(j).unwrap_or(&[R::ZERO; LANES]), &scaled);
                        }
                        for (parts, unit) in rows_mut(parts, n).zip(rows(units, width)) {
                            if let (Some(part), Some(&unit)) = (parts.get_mut(s), unit.get(j)) {
                                lanes::add_scaled(part, unit, &scaled);
                            }
                        }
                        for (fitted, rhs) in rows_mut(fitted, n).zip(rows(rhs, width)) {
                            if let (Some(fitted), Some(&b)) = (fitted.get_mut(s), rhs.get(j)) {
                                lanes::add_scaled(fitted, b, &at);
                            }
                        }
                    }
                    for (trend, rhs) in trends.iter_mut().zip(rows(rhs, width)) {
                        for (trend, unit) in trend.iter_mut().zip(rows(units, width)) {
                            *trend += rhs.get(j).copied().unwrap_or(R::ZERO) * unit.get(j).copied().unwrap_or(R::ZERO);
                        }
                    }
                }
                begin = end;
                for s in 0..n {
                    let pairs = row_mut(system, s).iter_mut().zip(row(products, s)).enumerate();
                    for (t, (out, product)) in pairs {
                        *out = product.map(|h| if s == t { (R::ONE - h).max(smallest) } else { -h });
                    }
                }
                ldlt::factor_each(system, n);
                for (channel, (out, mean)) in out.iter_mut().zip(&means).enumerate() {
                    let fitted = rows(fitted, n).nth(channel).unwrap_or(&[]);
                    // The mean of f - b'p without the fixed columns, then what leaving the pixel out changes.
                    let mut estimate = *mean;
                    for fitted in fitted {
                        lanes::subtract_scaled(&mut estimate, inverse_n, fitted);
                    }
                    for (&trend, place) in trends.get(channel).into_iter().flatten().zip(places) {
                        lanes::add_scaled(&mut estimate, trend, place);
                    }
                    let values = rows(values, channels).map(|values| values.get(channel));
                    for ((residual, value), fitted) in residuals.iter_mut().zip(values).zip(fitted) {
                        *residual =
                            lanes::zip(value.unwrap_or(&[R::ZERO; LANES]), fitted, |value, fitted| value - fitted);
                    }
                    ldlt::solve_each(system, residuals);
                    if setting.leaves_out {
                        for residual in residuals.iter_mut() {
                            *residual = only_used(residual, used);
                        }
                    }
                    for (t, residual) in residuals.iter().enumerate() {
                        let mut reach = [R::ZERO; LANES];
                        for s in 0..n {
                            let product = row(products, s.max(t)).get(s.min(t)).copied().unwrap_or([R::ZERO; LANES]);
                            lanes::add_scaled(&mut reach, inverse_n, &product);
                        }
                        for (parts, place) in rows(parts, n).zip(places) {
                            if let Some(part) = parts.get(t) {
                                reach = lanes::minus_product(reach, *part, *place);
                            }
                        }
                        lanes::add_product(&mut estimate, &reach, residual);
                    }
                    *out = estimate;
                }
            }
        }
        Ok(())
    }
}
