//! A pixel's samples as a regression sees them: columns of functions, centred, and values, centred and scaled.

use super::config::Config;
use super::folds::Subset;
use super::per_channel::PerChannel;
use super::samples::Reader;
use crate::arena::Arena;
use crate::basis::{Basis, MAX_DIMS};
use crate::lanes::{self, LANES, Lanes};
use crate::matrix::{Panel, Triangle, first_mut, from, from_mut, rows_mut};
use crate::real::{Real, rounding};
use core::ops::Deref;

/// The design matrix and the values, eight samples to a panel. Unused lanes of the last panel are zero.
pub(crate) struct Design<'a, R> {
    /// Samples.
    pub(crate) n: usize,
    /// Functions, the constant not counted.
    pub(crate) columns: usize,
    /// Values of a sample.
    pub(crate) channels: usize,
    /// Panel after panel, each with one group of lanes for each column.
    pub(crate) panels: Panel<&'a [Lanes<R>]>,
    /// Panel after panel, each with one group of lanes for each channel.
    pub(crate) values: Panel<&'a [Lanes<R>]>,
    /// What was subtracted from each column: its sample mean.
    pub(crate) column_means: &'a [R],
    /// How stored values map to the caller's.
    pub(crate) units: Units<R>,
}

/// value = 2^exponent (offset + stored)
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Units<R> {
    pub(crate) offsets: PerChannel<R>,
    pub(crate) exponents: PerChannel<i32>,
}

impl<R: Real> Units<R> {
    /// 2^-exponent
    pub(crate) fn scales(&self) -> PerChannel<R> {
        self.exponents.map(|exponent| R::ONE.scale(-exponent))
    }

    /// The caller's value for a channel's stored one.
    pub(crate) fn value(&self, channel: usize, stored: R) -> f64 {
        libm::scalbn(self.offsets[channel].to_f64() + stored.to_f64(), self.exponents[channel])
    }

    /// The caller's length for a stored one.
    pub(crate) fn length(&self, channel: usize, stored: R) -> f64 {
        libm::scalbn(stored.to_f64(), self.exponents[channel])
    }

    /// The stored length for a caller's.
    pub(crate) fn stored_length(&self, channel: usize, value: f32) -> R {
        R::from_f64(libm::scalbn(f64::from(value), -self.exponents[channel]))
    }

    /// A length stored in other units, in these.
    pub(crate) fn converted(&self, channel: usize, length: R, other: &Self) -> R {
        let by = other.exponents[channel] - self.exponents[channel];
        if by == 0 { length } else { length.scale(by) }
    }

    /// A value stored in other units, in these.
    pub(crate) fn relative(&self, channel: usize, stored: R, other: &Self) -> R {
        self.converted(channel, other.offsets[channel] + stored, other) - self.offsets[channel]
    }
}

/// Numbers that a design of `n` samples takes from its arena.
pub(crate) fn size(n: usize, columns: usize, channels: usize) -> Option<usize> {
    let lanes = n.div_ceil(LANES).checked_mul(LANES)?;
    lanes.checked_mul(columns.checked_add(channels)?)?.checked_add(columns)
}

impl<'a, R: Real> Design<'a, R> {
    /// Evaluates the basis at the samples of a subset, which were checked before. With `centre`, columns and values
    /// have mean zero; without, columns are as they are, and values relative to the first sample. None without samples.
    // See `Reader`; without it on what follows, estimates of one pixel take 9 to 19 % more instructions.
    #[inline(always)]
    pub(crate) fn load(
        reader: &Reader<'_>,
        basis: &Basis,
        columns: usize,
        subset: Subset,
        centre: bool,
        arena: &mut Arena<'a, R>,
    ) -> Option<Self> {
        let channels = reader.channels();
        let count = subset.len(reader.len()).div_ceil(LANES);
        let (all_columns, all_values) = (arena.take_lanes(count * columns), arena.take_lanes(count * channels));
        let column_means = arena.zeros(columns);
        let mut units = units(reader, subset);
        let scales = units.scales();
        let mut x = [[R::ZERO; LANES]; MAX_DIMS];
        let mut h = [[R::ZERO; LANES]; Config::MAX_CONTROLS];
        let mut f = [[R::ZERO; LANES]; Config::MAX_CHANNELS];
        let (mut next, mut n) = (0, 0);
        let mut column_panels = rows_mut(all_columns, columns);
        for values in rows_mut(all_values, channels) {
            // Lanes that are not filled hold an earlier panel's samples, in range; they are cleared below.
            let filled = reader.panel(subset, &mut next, &mut x, &mut h, &mut f);
            if filled == 0 {
                break;
            }
            n += filled;
            if let Some(panel) = column_panels.next() {
                reader.columns(basis, &x, &h, panel);
            }
            for (((out, f), &scale), &offset) in values.iter_mut().zip(&f).zip(&scales.0).zip(&units.offsets.0) {
                *out = f.map(|f| f * scale - offset);
            }
        }
        drop(column_panels);
        if n == 0 {
            return None;
        }
        let used = n.div_ceil(LANES);
        let (all_columns, all_values) =
            (first_mut(all_columns, used * columns), first_mut(all_values, used * channels));
        let (mut panels, mut values) = (Panel::new(&mut *all_columns, columns), Panel::new(&mut *all_values, channels));
        clear_unused(&mut panels, n);
        clear_unused(&mut values, n);
        if centre {
            self::centre(&mut panels, n, column_means);
            clear_constant(&mut panels, n, column_means, reader.samples.control_integrals);
            // Of a narrow type twice: about an outlier, the first sample may be one, the first mean is rounded to it.
            for _ in 0..1 + usize::from(R::NARROW) {
                let mut means = PerChannel::default();
                self::centre(&mut values, n, first_mut(&mut means.0, channels));
                units.offsets += means;
            }
        }
        let (panels, values) = (Panel::new(&*all_columns, columns), Panel::new(&*all_values, channels));
        Some(Self { n, columns, channels, panels, values, column_means, units })
    }

    /// The panels one by one: columns and values of eight samples.
    #[inline]
    pub(crate) fn each_panel(&self) -> impl Iterator<Item = (&[Lanes<R>], &[Lanes<R>])> {
        self.panels.rows().zip(self.values.rows())
    }

    /// The values' sums of squares.
    pub(crate) fn squares(&self) -> PerChannel<R> {
        PerChannel::of(self.channels, |channel| square(&self.values, channel))
    }

    /// Writes the packed matrix of column products (4.28), and for each channel the products with its values.
    ///
    /// Two columns times two at a time: their sums stay in registers.
    #[inline(always)]
    pub(crate) fn normal_equations(&self, gram: &mut Triangle<&mut [R]>, rhs: &mut Panel<&mut [R]>) {
        for j in (0..self.columns).step_by(2) {
            for k in (0..=j).step_by(2) {
                let sums = self.products(|panel, _| two(panel, j), k);
                for (step, sums) in sums.iter().enumerate().take(self.columns - j) {
                    put(gram.row_mut(j + step), k, sums);
                }
            }
        }
        for channel in (0..self.channels).step_by(2) {
            for k in (0..self.columns).step_by(2) {
                let sums = self.products(|_, values| two(values, channel), k);
                for (row, sums) in rhs.rows_mut().skip(channel).zip(&sums) {
                    put(row, k, sums);
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

/// Writes sums over lanes to places `first` and the next of a row.
fn put<R: Real>(row: &mut [R], first: usize, sums: &[Lanes<R>; 2]) {
    for (out, sum) in row.iter_mut().skip(first).zip(sums) {
        *out = lanes::sum(sum);
    }
}

/// The sum of squares of group `index` of every panel.
pub(crate) fn square<R: Real>(panels: &Panel<impl Deref<Target = [Lanes<R>]>>, index: usize) -> R {
    let mut total = [R::ZERO; LANES];
    for values in panels.column(index) {
        total = lanes::plus_product(total, *values, *values);
    }
    lanes::sum(&total)
}

/// Subtracts each column's mean, and writes it to `means`.
fn centre<R: Real>(panels: &mut Panel<&mut [Lanes<R>]>, n: usize, means: &mut [R]) {
    let inverse = R::ONE / R::from_usize(n);
    for (j, mean) in means.iter_mut().enumerate() {
        let total = panels.column(j).fold([R::ZERO; LANES], |total, column| lanes::zip(&total, column, |a, b| a + b));
        *mean = lanes::sum(&total) * inverse;
    }
    for panel in panels.rows_mut() {
        for (column, &mean) in panel.iter_mut().zip(means.iter()) {
            *column = column.map(|value| value - mean);
        }
    }
    // That moved the unused lanes too.
    clear_unused(panels, n);
}

/// Zeroes control functions that hardly move about their means: what is left is rounding noise, and says nothing about
/// the values.
fn clear_constant<R: Real>(panels: &mut Panel<&mut [Lanes<R>]>, n: usize, means: &[R], integrals: &[f32]) {
    for (j, (&mean, &integral)) in means.iter().zip(integrals).enumerate() {
        let noise = rounding::<R>() * (mean.abs() + R::from(integral).abs());
        if (square(panels, j) / R::from_usize(n)).sqrt() <= noise {
            panels.column_mut(j).for_each(|column| *column = [R::ZERO; LANES]);
        }
    }
}

/// Groups `first` and the next; zero where there is none.
fn two<R: Real>(groups: &[Lanes<R>], first: usize) -> [Lanes<R>; 2] {
    match from(groups, first) {
        [a, b, ..] => [*a, *b],
        [a] => [*a, [R::ZERO; LANES]],
        [] => [[R::ZERO; LANES]; 2],
    }
}

/// Zeroes the lanes after sample `n`, of which the last panel holds some.
fn clear_unused<R: Real>(panels: &mut Panel<&mut [Lanes<R>]>, n: usize) {
    let used = n % LANES;
    if used == 0 {
        return;
    }
    for group in panels.row_mut(n / LANES) {
        from_mut(group, used).fill(R::ZERO);
    }
}

/// Where the stored values' zero and unit lie: at the first sample, so that constants are exact, and, for a type whose
/// range squares could leave, at a power of two near the largest value.
fn units<R: Real>(reader: &Reader<'_>, subset: Subset) -> Units<R> {
    let mut units = Units::default();
    if R::NARROW {
        let mut largest = PerChannel::<R>::default();
        reader.each(subset, |sample| {
            largest = largest.zip(reader.values::<R>(sample), |largest, value| largest.max(value.abs()));
        });
        let exponent = |largest: R| if largest > R::ZERO { largest.exponent().clamp(-126, 126) } else { 0 };
        units.exponents = largest.map(exponent);
    }
    if let Some(sample) = reader.first(subset) {
        units.offsets = reader.values(&sample) * units.scales();
    }
    units
}
