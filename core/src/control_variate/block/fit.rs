//! Fits to all pixels of a group but one, for each pixel.

use super::super::config::{Config, Estimator, Ridge};
use super::super::design::{Design, Units};
use super::super::per_channel::get;
use super::super::ridge;
use super::super::samples::Reader;
use super::choice::{Spreads, Weights, last_only};
use super::members::Members;
use super::terms::{MAX_AXES, Terms};
use crate::arena::Arena;
use crate::basis::{Basis, MAX_DIMS, Shape};
use crate::error::Error;
use crate::lanes::{self, LANES, Lanes};
use crate::linalg::{ldlt, packed_len, row, row_mut};
use crate::real::Real;
use crate::rows::{rows, rows_mut};

/// Ridge strength per sample if the caller gives none.
const STRENGTH: f64 = 0.003;
/// The least that 1 less a sample's leverage is taken for, in units of the type's epsilon.
const SINGULAR: f64 = 64.0;

/// Whether pixels of `n` samples are few enough to leave their samples out of one factor of `columns` columns.
fn has_few(n: usize, columns: usize) -> bool {
    n == 1 || 4 * n <= columns
}

/// Numbers that a fit with so many columns takes.
fn size_of_fit(config: &Config, terms: &Terms, columns: usize, pixels: usize, n: usize) -> Option<usize> {
    let (channels, fixed) = (config.channels, terms.fixed());
    let sums = packed_len(columns) + columns * channels;
    let (each, scratch) = if has_few(n, columns) {
        let each = n.checked_mul(columns + channels)?;
        (each, n * (columns + fixed + channels + 1) + 2 * packed_len(n))
    } else {
        (sums, columns + sums)
    };
    let each = each.checked_add(fixed + (terms.ends.len() + 1) * channels)?;
    let lanes = pixels.div_ceil(LANES).checked_mul(each)?.checked_add(scratch)?.checked_mul(LANES)?;
    lanes.checked_add(sums + columns + fixed * columns)
}

/// Everything that the fits of a call have in common.
pub(super) struct Problem<'a> {
    pub(super) config: &'a Config,
    pub(super) shape: Shape,
    pub(super) basis: &'a Basis,
    pub(super) reader: Reader<'a>,
    /// Samples of a pixel.
    pub(super) n: usize,
    /// What the values of a pixel are divided by before the fit, a row for each pixel; empty: 1.
    pub(super) factors: &'a [f32],
}

/// Eight pixels.
struct Panel {
    pixels: [usize; LANES],
    /// How many of them there are.
    used: usize,
}

/// What the fits of a group have in common.
struct Setting<'s, R> {
    terms: &'s Terms,
    units: [Units<R>; Config::MAX_CHANNELS],
    /// Panel after panel the lanes of [`Members::places`].
    places: &'s [Lanes<R>],
}

impl<R> Setting<'_, R> {
    /// Panels of pixels with their places.
    #[inline(always)]
    fn places(&self) -> impl Iterator<Item = &[Lanes<R>]> {
        rows(self.places, self.terms.fixed())
    }

    /// Groups of lanes in a panel's estimates.
    #[inline(always)]
    fn estimates(&self, channels: usize) -> usize {
        (self.terms.ends.len() + 1) * channels
    }
}

/// What a group's fits say.
pub(super) struct Group<'a, R> {
    pub(super) units: [Units<R>; Config::MAX_CHANNELS],
    /// Panel after panel: the plain means of all channels, then each fit's estimates.
    estimates: &'a [Lanes<R>],
    fits: usize,
    channels: usize,
    pub(super) spreads: Spreads<R>,
}

impl<R: Real> Group<'_, R> {
    /// What the mixture adds to the plain mean of member `index`: zero if that is not finite.
    #[inline(always)]
    pub(super) fn correction(&self, index: usize, weights: &Weights<R>, channel: usize) -> R {
        let start = index / LANES * (self.fits + 1) * self.channels + channel;
        let at = |fit: usize| {
            let lanes = self.estimates.get(start + fit * self.channels);
            lanes.and_then(|lanes| lanes.get(index % LANES)).copied().unwrap_or(R::ZERO)
        };
        let plain = at(0);
        let mut sum = R::ZERO;
        for (fit, weight) in weights.iter().enumerate().take(self.fits + 1).skip(1) {
            sum += get(weight, channel) * (at(fit) - plain);
        }
        if sum.is_finite() { sum } else { R::ZERO }
    }
}

impl<'a> Problem<'a> {
    /// Which columns a fit to these pixels has.
    #[inline(always)]
    pub(super) fn terms(&self, members: &Members<'_>) -> Terms {
        let single = self.config.estimator == Estimator::LeaveOneOut || matches!(self.config.ridge, Ridge::Fixed(_));
        Terms::new(self.config, &self.shape, members.axes(), members.len.saturating_mul(self.n), single)
    }

    /// Numbers that [`Problem::fit`] takes for at most so many pixels.
    pub(super) fn size(config: &Config, shape: &Shape, axes: usize, pixels: usize, n: usize) -> Option<usize> {
        let terms = Terms::new(config, shape, axes, pixels.checked_mul(n)?, false);
        // Fewer pixels may have fewer columns, and then go the other way.
        let sizes = terms.fewer_columns(shape).map(|columns| size_of_fit(config, &terms, columns, pixels, n));
        sizes.into_iter().try_fold(0, |largest, size| Some(size?.max(largest)))
    }

    /// Fits to all members but one, for each of them, of which there are at least two.
    #[inline(always)]
    pub(super) fn fit<'b, R: Real>(
        &self,
        members: &Members<'_>,
        terms: &Terms,
        arena: &mut Arena<'b, R>,
    ) -> Result<Group<'b, R>, Error> {
        let channels = self.config.channels;
        let (fixed, fits) = (terms.fixed(), terms.ends.len());
        let panels = members.len.div_ceil(LANES);
        let places = arena.take_lanes(panels * fixed)?;
        for (panel, out) in rows_mut(places, fixed).enumerate() {
            for (out, place) in out.iter_mut().zip(members.places(panel * LANES)) {
                *out = place;
            }
        }
        let setting = Setting { terms, units: self.units(members), places };
        let estimates = arena.take_lanes(panels * setting.estimates(channels))?;
        if self.n == 1 {
            // A copy of its own: loops over one sample vanish.
            self.by_one_factor(members, &setting, 1, estimates, arena)?;
        } else if has_few(self.n, terms.columns()) {
            self.by_one_factor(members, &setting, self.n, estimates, arena)?;
        } else {
            self.by_factor_each(members, &setting, estimates, arena)?;
        }
        let Setting { units, .. } = setting;
        let spreads = Spreads::new(members.len, places, fixed, estimates, fits, channels);
        Ok(Group { units, estimates, fits, channels, spreads })
    }

    /// How far the mean and the fits are trusted, by a group that has at least two members.
    #[inline(always)]
    pub(super) fn weights<R: Real>(&self, group: &Group<'_, R>) -> Weights<R> {
        match (self.config.estimator, self.config.ridge) {
            (Estimator::LeaveOneOut, _) | (_, Ridge::Fixed(_)) => last_only(group.fits),
            _ => group.spreads.weights(self.config.channels),
        }
    }

    /// What a pixel's values are divided by. Black says nothing about what it multiplies: 1.
    #[inline(always)]
    pub(super) fn factor(&self, pixel: usize, channel: usize) -> f64 {
        let factor = self.factors.get(pixel * self.config.channels + channel).copied().unwrap_or(1.0);
        if factor > 0.0 { f64::from(factor) } else { 1.0 }
    }

    /// As for one pixel's samples: the zero at the first value and, for a narrow type, the unit near the largest.
    #[inline(always)]
    fn units<R: Real>(&self, members: &Members<'_>) -> [Units<R>; Config::MAX_CHANNELS] {
        let mut units = [Units::default(); Config::MAX_CHANNELS];
        if R::NARROW {
            let mut largest = [0.0f64; Config::MAX_CHANNELS];
            for index in 0..members.len * self.n {
                let pixel = members.pixel(index.checked_div(self.n).unwrap_or(0));
                let sample = self.reader.get(pixel * self.n + index.checked_rem(self.n).unwrap_or(0));
                for (channel, largest) in largest.iter_mut().enumerate().take(self.config.channels) {
                    let value = get(&self.reader.values::<f64>(&sample), channel) / self.factor(pixel, channel);
                    *largest = largest.max(Real::abs(value));
                }
            }
            for (unit, largest) in units.iter_mut().zip(largest) {
                unit.exponent = Real::exponent(largest).clamp(-126, 126);
            }
        }
        let pixel = members.pixel(0);
        let first = self.reader.values::<f64>(&self.reader.get(pixel * self.n));
        for (channel, (unit, value)) in units.iter_mut().zip(first).enumerate().take(self.config.channels) {
            unit.offset = R::from_f64(libm::scalbn(value / self.factor(pixel, channel), -unit.exponent));
        }
        units
    }

    #[inline(always)]
    fn panel(&self, members: &Members<'_>, start: usize) -> Panel {
        let used = LANES.min(members.len.saturating_sub(start));
        let mut pixels = [0; LANES];
        for (lane, pixel) in pixels.iter_mut().enumerate().take(used) {
            *pixel = members.pixel(start + lane);
        }
        Panel { pixels, used }
    }

    /// Writes sample `sample` of a panel's pixels: their columns, and their values in `units`. Zero in unused lanes.
    #[inline(always)]
    fn load<R: Real>(
        &self,
        setting: &Setting<'_, R>,
        panel: &Panel,
        sample: usize,
        places: &[Lanes<R>],
        columns: &mut [Lanes<R>],
        values: &mut [Lanes<R>],
    ) {
        let mut x = [[R::ZERO; LANES]; MAX_DIMS];
        let mut h = [[R::ZERO; LANES]; Config::MAX_CONTROLS];
        self.gather(setting, panel, sample, (&mut x, &mut h), values);
        self.expand(setting, panel, places, &x, &h, columns);
    }

    /// Reads sample `sample` of a panel's pixels. Zero in unused lanes.
    #[inline(always)]
    fn gather<R: Real>(
        &self,
        setting: &Setting<'_, R>,
        panel: &Panel,
        sample: usize,
        (x, h): (&mut [Lanes<R>; MAX_DIMS], &mut [Lanes<R>; Config::MAX_CONTROLS]),
        values: &mut [Lanes<R>],
    ) {
        let [first, .., last] = panel.pixels;
        // Neighbours in a row, as most are.
        if panel.used == LANES && last == first + LANES - 1 && self.factors.is_empty() && self.reader.is_simple() {
            let mut f = [[R::ZERO; LANES]; Config::MAX_CHANNELS];
            self.reader.rows(first * self.n + sample, self.n, x, &mut f);
            for ((out, f), unit) in values.iter_mut().zip(&f).zip(&setting.units) {
                *out = f.map(|f| (if R::NARROW { f.scale(-unit.exponent) } else { f }) - unit.offset);
            }
            return;
        }
        for value in values.iter_mut() {
            *value = [R::ZERO; LANES];
        }
        for (lane, &pixel) in panel.pixels.iter().enumerate().take(panel.used) {
            let sample = self.reader.get(pixel * self.n + sample);
            sample.put(lane, x, h);
            let f = self.reader.values::<f64>(&sample);
            for (channel, ((out, value), unit)) in values.iter_mut().zip(f).zip(&setting.units).enumerate() {
                let mut value = value;
                if !self.factors.is_empty() {
                    value /= self.factor(pixel, channel);
                }
                if R::NARROW {
                    value = libm::scalbn(value, -unit.exponent);
                }
                if let Some(out) = out.get_mut(lane) {
                    *out = R::from_f64(value) - unit.offset;
                }
            }
        }
    }

    /// A panel's columns at positions `x` with control functions `h`. Zero in unused lanes.
    #[inline(always)]
    fn expand<R: Real>(
        &self,
        setting: &Setting<'_, R>,
        panel: &Panel,
        places: &[Lanes<R>],
        x: &[Lanes<R>; MAX_DIMS],
        h: &[Lanes<R>; Config::MAX_CONTROLS],
        columns: &mut [Lanes<R>],
    ) {
        let terms = setting.terms;
        let (fixed, rest) = columns.split_at_mut_checked(terms.fixed()).unwrap_or((&mut [], &mut []));
        for (out, place) in fixed.iter_mut().zip(places) {
            *out = *place;
        }
        let (functions, products) = rest.split_at_mut_checked(terms.functions).unwrap_or((&mut [], &mut []));
        self.reader.columns(self.basis, x, h, functions);
        if panel.used < LANES {
            for column in functions.iter_mut() {
                for value in column.iter_mut().skip(panel.used) {
                    *value = R::ZERO;
                }
            }
        }
        let (first, count) = terms.moving;
        let moving = functions.get(first..first + count).unwrap_or(&[]);
        for (products, axis) in rows_mut(products, count).zip(places.iter().skip(1)) {
            for (out, function) in products.iter_mut().zip(moving) {
                *out = lanes::zip(function, axis, |a, b| a * b);
            }
        }
    }

    /// Adds what ridge a fit to `samples` samples has to the diagonal of the sums of products.
    #[inline(always)]
    fn add_ridge<R: Real>(&self, terms: &Terms, samples: usize, gram: &mut [R], penalties: &mut [R]) {
        let count = gram.first().copied().unwrap_or(R::ONE);
        let mean_square = |j: usize| row(gram, j).last().copied().unwrap_or(R::ZERO) / count;
        terms.penalties(self.config, self.basis, mean_square, penalties);
        let strength = match self.config.ridge {
            Ridge::Fixed(_) => ridge::single::<R>(self.config.ridge),
            Ridge::Default | Ridge::Auto => STRENGTH,
        };
        let strength = R::from_f64(strength) * R::from_usize(samples);
        ldlt::add_diagonal(gram, terms.columns(), |j| strength * penalties.get(j).copied().unwrap_or(R::ONE));
    }

    /// Few samples in each pixel: one factorisation A = L D L', from which each pixel's n samples are left out in closed
    /// form. With X their rows, H = X A^-1 X' and e their residuals, the residuals under the fit to all others are
    /// r = (I - H)^-1 e, and its coefficients b - A^-1 X' r. Every candidate is a prefix of the columns and so of L: with
    /// Z = L^-1 X', H = Z'D^-1 Z and all else are partial sums over the rows of Z.
    #[inline(always)]
    fn by_one_factor<R: Real>(
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
        for (((columns, values), places), out) in panels.zip(rows_mut(estimates, setting.estimates(channels))) {
            for (z, columns) in rows_mut(z, width).zip(rows(columns, width)) {
                for (z, column) in z.iter_mut().zip(columns) {
                    *z = *column;
                }
                ldlt::forward_lanes(gram, 0, z);
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
                        lanes::add_scaled(&mut estimate, -inverse_n, fitted);
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

    /// Many samples in each pixel: A less the pixel's own products, factored for eight pixels at a time, which takes less
    /// time than updating one factor by rank n.
    #[inline(always)]
    fn by_factor_each<R: Real>(
        &self,
        members: &Members<'_>,
        setting: &Setting<'_, R>,
        estimates: &mut [Lanes<R>],
        arena: &mut Arena<'_, R>,
    ) -> Result<(), Error> {
        let mut arena = arena.scratch();
        let terms = setting.terms;
        let (width, channels) = (terms.columns(), self.config.channels);
        let (squares, all) = (packed_len(width), packed_len(width) + width * channels);
        let count = members.len.div_ceil(LANES);
        let own = arena.take_lanes(count * all)?;
        let system = arena.take_lanes(all)?;
        let scratch = arena.take_lanes(width)?;
        let total = arena.take(all)?;
        let penalties = arena.take(width)?;
        for value in total.iter_mut() {
            *value = R::ZERO;
        }
        for (index, (own, places)) in rows_mut(own, all).zip(setting.places()).enumerate() {
            for value in own.iter_mut() {
                *value = [R::ZERO; LANES];
            }
            let (gram, rhs) = own.split_at_mut_checked(squares).unwrap_or((&mut [], &mut []));
            let panel = self.panel(members, index * LANES);
            let columns = &mut *scratch;
            let mut values = [[R::ZERO; LANES]; Config::MAX_CHANNELS];
            for sample in 0..self.n {
                self.load(setting, &panel, sample, places, columns, values.get_mut(..channels).unwrap_or(&mut []));
                for (j, column) in columns.iter().enumerate() {
                    for (out, other) in row_mut(gram, j).iter_mut().zip(columns.iter()) {
                        lanes::add_product(out, column, other);
                    }
                }
                for (rhs, value) in rows_mut(rhs, width).zip(&values) {
                    for (out, column) in rhs.iter_mut().zip(columns.iter()) {
                        lanes::add_product(out, value, column);
                    }
                }
            }
            for (total, own) in total.iter_mut().zip(own.iter()) {
                *total += lanes::sum(own);
            }
        }
        let training = (members.len - 1) * self.n;
        self.add_ridge(terms, training, total.get_mut(..squares).unwrap_or(&mut []), penalties);
        let inverse = R::ONE / R::from_usize(self.n);
        let fixed = terms.fixed();
        for (own, out) in rows(own, all).zip(rows_mut(estimates, setting.estimates(channels))) {
            for ((out, &total), own) in system.iter_mut().zip(total.iter()).zip(own) {
                *out = own.map(|own| total - own);
            }
            let (gram, rhs) = system.split_at_mut_checked(squares).unwrap_or((&mut [], &mut []));
            let (own_gram, own_rhs) = own.split_at_checked(squares).unwrap_or((&[], &[]));
            ldlt::factor_each(gram, width);
            // The means of the pixel's columns, which its fit is corrected by.
            let y = &mut *scratch;
            for (j, y) in y.iter_mut().enumerate() {
                let sum = row(own_gram, j).first().copied().unwrap_or([R::ZERO; LANES]);
                *y = if j < fixed { [R::ZERO; LANES] } else { sum.map(|sum| sum * inverse) };
            }
            ldlt::forward_each(gram, fixed, y);
            for (j, y) in y.iter_mut().enumerate() {
                let pivot = row(gram, j).last().copied().unwrap_or([R::ZERO; LANES]);
                *y = lanes::zip(y, &pivot, |y, pivot| y * pivot);
            }
            let mut corrected = [[R::ZERO; LANES]; Config::MAX_CHANNELS];
            for (rhs, (own, corrected)) in rows_mut(rhs, width).zip(rows(own_rhs, width).zip(&mut corrected)) {
                ldlt::forward_each(gram, 0, rhs);
                let sum = own.first().copied().unwrap_or([R::ZERO; LANES]);
                *corrected = sum.map(|sum| sum * inverse);
            }
            let mut out = rows_mut(out, channels);
            for (out, mean) in out.next().unwrap_or(&mut []).iter_mut().zip(&corrected) {
                *out = *mean;
            }
            let mut begin = 0;
            for (&end, out) in terms.ends.iter().zip(out) {
                for (corrected, rhs) in corrected.iter_mut().zip(rows(rhs, width)) {
                    for (rhs, y) in rhs.iter().zip(y.iter()).take(end).skip(begin) {
                        *corrected = lanes::minus_product(*corrected, *rhs, *y);
                    }
                }
                begin = end;
                for (out, corrected) in out.iter_mut().zip(&corrected) {
                    *out = *corrected;
                }
            }
        }
        Ok(())
    }
}
