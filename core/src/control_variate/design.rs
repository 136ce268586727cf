//! A pixel's samples as a regression sees them: columns of functions, centred, and values, centred and scaled.

use super::Config;
use super::samples::{Reader, Subset};
use crate::arena::Arena;
use crate::basis::{Basis, MAX_DIMS};
use crate::error::Error;
use crate::lanes::{self, LANES, Lanes};
use crate::linalg::row_mut;
use crate::real::Real;
use crate::rows::{rows, rows_mut};

/// The size of a control function about its mean, in epsilons of its size about zero, that is rounding noise.
const NOISE: f64 = 64.0;

/// The design matrix and the values, eight samples to a panel. Unused lanes of the last panel are zero.
pub(crate) struct Design<'a, R> {
    /// Samples.
    pub(crate) n: usize,
    /// Functions, the constant not counted.
    pub(crate) columns: usize,
    /// Values of a sample.
    pub(crate) channels: usize,
    /// Panel after panel, each with one group of lanes for each column.
    pub(crate) panels: &'a mut [Lanes<R>],
    /// Panel after panel, each with one group of lanes for each channel.
    pub(crate) values: &'a mut [Lanes<R>],
    /// What was subtracted from each column: its sample mean.
    pub(crate) column_means: &'a mut [R],
    /// How stored values map to the caller's.
    pub(crate) units: [Units<R>; Config::MAX_CHANNELS],
}

/// value = offset + 2^exponent * stored
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Units<R> {
    pub(crate) offset: R,
    pub(crate) exponent: i32,
}

impl<R: Real> Units<R> {
    /// The caller's value for a stored one.
    pub(crate) fn value(&self, stored: R) -> f64 {
        libm::scalbn(self.offset.to_f64() + stored.to_f64(), self.exponent)
    }

    /// The caller's length for a stored one.
    pub(crate) fn length(&self, stored: R) -> f64 {
        libm::scalbn(stored.to_f64(), self.exponent)
    }

    /// The stored length for a caller's.
    pub(crate) fn stored_length(&self, value: f32) -> R {
        R::from_f64(libm::scalbn(f64::from(value), -self.exponent))
    }

    /// A length stored in other units, in these.
    #[inline(always)]
    pub(crate) fn converted(&self, length: R, other: &Self) -> R {
        if self.exponent == other.exponent { length } else { length.scale(other.exponent - self.exponent) }
    }

    /// A value stored in other units, in these.
    #[inline(always)]
    pub(crate) fn relative(&self, stored: R, other: &Self) -> R {
        self.converted(other.offset + stored, other) - self.offset
    }
}

impl<'a, R: Real> Design<'a, R> {
    /// Numbers that a design of `n` samples takes from its arena.
    pub(crate) fn size(n: usize, columns: usize, channels: usize) -> Option<usize> {
        let lanes = n.div_ceil(LANES).checked_mul(LANES)?;
        lanes.checked_mul(columns.checked_add(channels)?)?.checked_add(columns)
    }

    /// Evaluates the basis at the samples of a subset, which were checked before. With `centre`, columns and values
    /// have mean zero; without, columns are as they are, and values relative to the first sample.
    #[inline(always)]
    pub(crate) fn load(
        reader: &Reader<'_>,
        basis: &Basis,
        columns: usize,
        subset: Subset,
        centre: bool,
        arena: &mut Arena<'a, R>,
    ) -> Result<Self, Error> {
        let channels = reader.channels();
        let count = reader.count(subset).div_ceil(LANES);
        let panels = arena.take_lanes(count.checked_mul(columns).ok_or(Error::Memory)?)?;
        let values = arena.take_lanes(count.checked_mul(channels).ok_or(Error::Memory)?)?;
        let column_means = arena.take(columns)?;
        let units = units(reader, subset);
        let factors = units.map(|unit| R::ONE.scale(-unit.exponent));
        let mut x = [[R::ZERO; LANES]; MAX_DIMS];
        let mut h = [[R::ZERO; LANES]; Config::MAX_CONTROLS];
        let mut f = [[R::ZERO; LANES]; Config::MAX_CHANNELS];
        let mut column_panels = rows_mut(panels, columns);
        let mut value_panels = rows_mut(values, channels);
        let (mut next, mut n) = (0, 0);
        loop {
            // Lanes that are not filled hold an earlier panel's samples, in range; they are cleared below.
            let filled = reader.panel(subset, &mut next, &mut x, &mut h, &mut f);
            if filled == 0 {
                break;
            }
            n += filled;
            if let Some(panel) = column_panels.next() {
                reader.columns(basis, &x, &h, panel);
            }
            let values = value_panels.next().unwrap_or(&mut []).iter_mut();
            for (((out, f), &factor), unit) in values.zip(&f).zip(&factors).zip(&units) {
                *out = f.map(|f| f * factor - unit.offset);
            }
        }
        if n == 0 {
            return Err(Error::NoSamples);
        }
        let used = n.div_ceil(LANES);
        let panels = panels.get_mut(..used * columns).ok_or(Error::Memory)?;
        let values = values.get_mut(..used * channels).ok_or(Error::Memory)?;
        clear_unused(panels, columns, n);
        clear_unused(values, channels, n);
        let mut design = Self { n, columns, channels, panels, values, column_means, units };
        design.centre(centre);
        if centre {
            design.clear_constant(reader.control_integrals());
        }
        Ok(design)
    }

    /// Subtracts the means, or with `centre` false sets them to zero.
    #[inline(always)]
    fn centre(&mut self, centre: bool) {
        for mean in self.column_means.iter_mut() {
            *mean = R::ZERO;
        }
        if !centre {
            return;
        }
        let inverse = R::ONE / R::from_usize(self.n);
        for (j, mean) in self.column_means.iter_mut().enumerate() {
            let mut total = [R::ZERO; LANES];
            for panel in rows(self.panels, self.columns) {
                if let Some(column) = panel.get(j) {
                    total = lanes::zip(&total, column, |a, b| a + b);
                }
            }
            *mean = lanes::sum(&total) * inverse;
        }
        for panel in rows_mut(self.panels, self.columns) {
            for (column, &mean) in panel.iter_mut().zip(self.column_means.iter()) {
                *column = column.map(|value| value - mean);
            }
        }
        for (channel, unit) in self.units.iter_mut().enumerate().take(self.channels) {
            let mut total = [R::ZERO; LANES];
            for panel in rows(self.values, self.channels) {
                if let Some(values) = panel.get(channel) {
                    total = lanes::zip(&total, values, |a, b| a + b);
                }
            }
            let mean = lanes::sum(&total) * inverse;
            for panel in rows_mut(self.values, self.channels) {
                if let Some(values) = panel.get_mut(channel) {
                    *values = values.map(|value| value - mean);
                }
            }
            unit.offset += mean;
        }
        // Centring moved the unused lanes too.
        clear_unused(self.panels, self.columns, self.n);
        clear_unused(self.values, self.channels, self.n);
    }

    /// Zeroes control functions that hardly move about their means: what is left is rounding noise, and says nothing
    /// about the values.
    fn clear_constant(&mut self, integrals: &[f32]) {
        for (j, &integral) in integrals.iter().enumerate().take(self.columns) {
            let mean = self.column_means.get(j).copied().unwrap_or(R::ZERO).abs();
            let noise = R::from_f64(NOISE) * R::EPSILON * (mean + R::from_f32(integral).abs());
            if (self.column_square(j) / R::from_usize(self.n)).sqrt() <= noise {
                for column in rows_mut(self.panels, self.columns).filter_map(|panel| panel.get_mut(j)) {
                    *column = [R::ZERO; LANES];
                }
            }
        }
    }

    /// The panels one by one: columns and values of eight samples.
    #[inline(always)]
    pub(crate) fn each_panel(&self) -> impl Iterator<Item = (&[Lanes<R>], &[Lanes<R>])> {
        rows(self.panels, self.columns).zip(rows(self.values, self.channels))
    }

    /// The sum of squares of a column.
    pub(crate) fn column_square(&self, column: usize) -> R {
        square(self.panels, self.columns, column)
    }

    /// The sum of squares of a channel.
    pub(crate) fn sum_of_squares(&self, channel: usize) -> R {
        square(self.values, self.channels, channel)
    }

    /// The sum of squared residuals of coefficients.
    pub(crate) fn residual_square(&self, channel: usize, b: &[R]) -> R {
        let mut total = [R::ZERO; LANES];
        for (panel, values) in self.each_panel() {
            let mut residual = values.get(channel).copied().unwrap_or([R::ZERO; LANES]);
            for (column, &b) in panel.iter().zip(b) {
                lanes::subtract_scaled(&mut residual, b, column);
            }
            lanes::add_product(&mut total, &residual, &residual);
        }
        lanes::sum(&total)
    }

    /// Writes the packed matrix of column products (4.28), and for each channel the products with its values.
    ///
    /// Two columns times two at a time: their sums stay in registers.
    #[inline(always)]
    pub(crate) fn normal_equations(&self, gram: &mut [R], rhs: &mut [R]) {
        for j in (0..self.columns).step_by(2) {
            for k in (0..=j).step_by(2) {
                let sums = self.products(|panel, _| two(panel, j), k);
                for (step, sums) in sums.iter().enumerate() {
                    let row = row_mut(gram, j + step).get_mut(k..).unwrap_or(&mut []);
                    for (out, sum) in row.iter_mut().zip(sums) {
                        *out = lanes::sum(sum);
                    }
                }
            }
        }
        for channel in (0..self.channels).step_by(2) {
            for k in (0..self.columns).step_by(2) {
                let sums = self.products(|_, values| two(values, channel), k);
                for (row, sums) in rows_mut(rhs, self.columns).skip(channel).zip(&sums) {
                    for (out, sum) in row.get_mut(k..).unwrap_or(&mut []).iter_mut().zip(sums) {
                        *out = lanes::sum(sum);
                    }
                }
            }
        }
    }

    /// Sums, over the panels, of two quantities times columns k and k + 1.
    #[inline(always)]
    fn products(&self, quantities: impl Fn(&[Lanes<R>], &[Lanes<R>]) -> [Lanes<R>; 2], k: usize) -> [[Lanes<R>; 2]; 2] {
        let [mut a, mut b, mut c, mut d] = [[R::ZERO; LANES]; 4];
        for (panel, values) in self.each_panel() {
            let ([p, q], [x, y]) = (quantities(panel, values), two(panel, k));
            a = lanes::plus_product(a, p, x);
            b = lanes::plus_product(b, p, y);
            c = lanes::plus_product(c, q, x);
            d = lanes::plus_product(d, q, y);
        }
        [[a, b], [c, d]]
    }
}

/// The sum of squares of group `index` of every panel, of `width` groups each.
#[inline(always)]
fn square<R: Real>(panels: &[Lanes<R>], width: usize, index: usize) -> R {
    let mut total = [R::ZERO; LANES];
    for values in rows(panels, width).filter_map(|panel| panel.get(index)) {
        lanes::add_product(&mut total, values, values);
    }
    lanes::sum(&total)
}

/// Groups `first` and the next; zero where there is none.
#[inline(always)]
fn two<R: Real>(groups: &[Lanes<R>], first: usize) -> [Lanes<R>; 2] {
    match groups.get(first..).unwrap_or(&[]) {
        [a, b, ..] => [*a, *b],
        [a] => [*a, [R::ZERO; LANES]],
        [] => [[R::ZERO; LANES]; 2],
    }
}

/// Zeroes the lanes after sample `n`, where each panel has `width` groups.
#[inline(always)]
fn clear_unused<R: Real>(panels: &mut [Lanes<R>], width: usize, n: usize) {
    let used = n % LANES;
    if used == 0 {
        return;
    }
    for group in panels.rchunks_exact_mut(width.max(1)).next().unwrap_or(&mut []) {
        for value in group.iter_mut().skip(used) {
            *value = R::ZERO;
        }
    }
}

/// Where the stored values' zero and unit lie: at the first sample, so that constants are exact, and, for a type whose
/// range squares could leave, at a power of two near the largest value.
#[inline(always)]
pub(crate) fn units<R: Real>(reader: &Reader<'_>, subset: Subset) -> [Units<R>; Config::MAX_CHANNELS] {
    let mut units = [Units::default(); Config::MAX_CHANNELS];
    if R::NARROW {
        let mut largest = [R::ZERO; Config::MAX_CHANNELS];
        reader.each(subset, |sample| {
            for (largest, value) in largest.iter_mut().zip(reader.values::<R>(sample)) {
                *largest = largest.max(value.abs());
            }
        });
        for (unit, largest) in units.iter_mut().zip(largest) {
            unit.exponent = if largest > R::ZERO { largest.exponent().clamp(-126, 126) } else { 0 };
        }
    }
    if let Some(sample) = reader.first(subset) {
        for (unit, value) in units.iter_mut().zip(reader.values::<R>(&sample)) {
            unit.offset = value * R::ONE.scale(-unit.exponent);
        }
    }
    units
}
