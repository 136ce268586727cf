//! Fixed-size sums over samples, from which every fit of the streaming estimators is made.
//!
//! For rows p = (1, functions) and values f the sums are P'P (packed), P'f (a row for each column) and f'f.

use super::per_channel::{PerChannel, get, set};
use super::trust::Centre;
use crate::arena::Arena;
use crate::error::Error;
use crate::linalg::{ldlt, packed_len, row, row_mut};
use crate::real::Real;
use crate::rows::{rows, rows_mut};

/// A column whose sum of squares about its mean is below this fraction of that about zero, in units of the type's
/// epsilon, is constant.
const NOISE: f64 = 64.0;

/// How many numbers the sums of `terms` terms (constant included) and `channels` values take.
pub(crate) const fn len(terms: usize, channels: usize) -> usize {
    packed_len(terms) + terms * channels + channels
}

/// The parts of one group of sums.
pub(crate) struct Moments<'a, R> {
    pub(crate) gram: &'a [R],
    pub(crate) rhs: &'a [R],
    pub(crate) square: &'a [R],
}

/// The same, to be changed.
pub(crate) struct MomentsMut<'a, R> {
    pub(crate) gram: &'a mut [R],
    pub(crate) rhs: &'a mut [R],
    pub(crate) square: &'a mut [R],
}

impl<'a, R: Real> Moments<'a, R> {
    pub(crate) fn new(sums: &'a [R], terms: usize, channels: usize) -> Option<Self> {
        let (gram, rest) = sums.split_at_checked(packed_len(terms))?;
        let (rhs, square) = rest.split_at_checked(terms * channels)?;
        Some(Self { gram, rhs, square })
    }

    /// The number of samples.
    pub(crate) fn count(&self) -> R {
        self.gram.first().copied().unwrap_or(R::ZERO)
    }

    /// The sum of the values of a channel.
    pub(crate) fn total(&self, channel: usize) -> R {
        self.rhs.get(channel).copied().unwrap_or(R::ZERO)
    }

    /// The sum of the values' squares.
    pub(crate) fn square(&self, channel: usize) -> R {
        self.square.get(channel).copied().unwrap_or(R::ZERO)
    }

    /// The sum of column j.
    pub(crate) fn column_total(&self, j: usize) -> R {
        row(self.gram, j + 1).first().copied().unwrap_or(R::ZERO)
    }

    /// The sum of the squares of column j.
    pub(crate) fn column_square(&self, j: usize) -> R {
        row(self.gram, j + 1).last().copied().unwrap_or(R::ZERO)
    }

    /// The mean of the squares of column j.
    pub(crate) fn mean_square(&self, j: usize) -> R {
        self.column_square(j) / self.count()
    }

    /// The sum of f - b'p over the samples.
    pub(crate) fn residual_total(&self, channel: usize, b: &[R]) -> R {
        let mut total = self.total(channel);
        for (j, &b) in b.iter().enumerate() {
            total -= b * self.column_total(j);
        }
        total
    }

    /// The sum of (f - a - b'p)^2 over the samples.
    pub(crate) fn residual_square(&self, channel: usize, channels: usize, a: R, b: &[R]) -> R {
        // theta'G theta - 2 theta'r + s, with theta = (a, b), row by row of the lower triangle.
        let theta = |j: usize| if j == 0 { a } else { b.get(j - 1).copied().unwrap_or(R::ZERO) };
        let mut total = self.square(channel);
        for j in 0..=b.len() {
            let mut product = R::ZERO;
            let row = row(self.gram, j);
            for (k, &value) in row.iter().enumerate() {
                let twice = if k == j { value } else { value + value };
                product += theta(k) * twice;
            }
            let rhs = self.rhs.get(j * channels + channel).copied().unwrap_or(R::ZERO);
            total += theta(j) * (product - rhs - rhs);
        }
        not_below_zero(total)
    }
}

impl<'a, R: Real> MomentsMut<'a, R> {
    pub(crate) fn new(sums: &'a mut [R], terms: usize, channels: usize) -> Option<Self> {
        let (gram, rest) = sums.split_at_mut_checked(packed_len(terms))?;
        let (rhs, square) = rest.split_at_mut_checked(terms * channels)?;
        Some(Self { gram, rhs, square })
    }

    /// Adds a sample: its row, 1 first, and its values.
    #[inline(always)]
    pub(crate) fn add(&mut self, p: &[R], f: &[R]) {
        for (j, &value) in p.iter().enumerate() {
            for (out, &other) in row_mut(self.gram, j).iter_mut().zip(p) {
                *out += value * other;
            }
        }
        for (out, &value) in rows_mut(self.rhs, f.len()).zip(p) {
            for (out, &f) in out.iter_mut().zip(f) {
                *out += value * f;
            }
        }
        for (out, &f) in self.square.iter_mut().zip(f) {
            *out += f * f;
        }
    }

    /// Adds another group's sums, of values that are `shift` + `factors` times as they were summed.
    pub(crate) fn merge(
        &mut self,
        other: &Moments<'_, R>,
        factors: &PerChannel<R>,
        shift: &PerChannel<R>,
        channels: usize,
    ) {
        let count = other.count();
        for (channel, ((square, &factor), &shift)) in self.square.iter_mut().zip(factors).zip(shift).enumerate() {
            let total = factor * other.total(channel);
            *square += factor * factor * other.square(channel) + shift * (total + total + shift * count);
        }
        let (ours, theirs) = (rows_mut(self.rhs, channels), rows(other.rhs, channels));
        for (j, (ours, theirs)) in ours.zip(theirs).enumerate() {
            let column = row(other.gram, j).first().copied().unwrap_or(R::ZERO);
            for (((out, &value), &factor), &shift) in ours.iter_mut().zip(theirs).zip(factors).zip(shift) {
                *out += factor * value + shift * column;
            }
        }
        add_sums(self.gram, other.gram);
    }

    /// Makes the sums those of `factors` times f.
    pub(crate) fn rescale(&mut self, factors: &PerChannel<R>, channels: usize) {
        for out in rows_mut(self.rhs, channels) {
            for (out, &factor) in out.iter_mut().zip(factors) {
                *out *= factor;
            }
        }
        for (out, &factor) in self.square.iter_mut().zip(factors) {
            *out *= factor * factor;
        }
    }
}

/// A ridge problem in centred form: the intercept is free and eliminated.
pub(crate) struct Centred<'a, R> {
    /// Functions, the constant not counted.
    pub(crate) columns: usize,
    pub(crate) count: R,
    gram: &'a mut [R],
    rhs: &'a mut [R],
    /// The columns' means.
    pub(crate) means: &'a mut [R],
    /// The values' means.
    pub(crate) value_means: PerChannel<R>,
    /// The sums of squares about the means.
    pub(crate) squares: PerChannel<R>,
}

/// How many numbers a [`Centred`] takes.
pub(crate) fn centred_len(columns: usize, channels: usize) -> usize {
    packed_len(columns) + columns * channels + columns
}

/// How many numbers [`Centred::solve`] takes.
pub(crate) fn solve_len(columns: usize) -> usize {
    2 * packed_len(columns) + 2 * columns
}

impl<'a, R: Real> Centred<'a, R> {
    /// Centres a group of sums; None if it holds no sample.
    #[inline(always)]
    pub(crate) fn new(
        sums: &Moments<'_, R>,
        columns: usize,
        channels: usize,
        arena: &mut Arena<'a, R>,
    ) -> Result<Option<Self>, Error> {
        let gram = arena.take(packed_len(columns))?;
        let rhs = arena.take(columns * channels)?;
        let means = arena.take(columns)?;
        let count = sums.count();
        if count <= R::ZERO {
            return Ok(None);
        }
        let inverse = R::ONE / count;
        for (j, mean) in means.iter_mut().enumerate() {
            *mean = sums.column_total(j) * inverse;
        }
        for j in 0..columns {
            let total = sums.column_total(j);
            let source = row(sums.gram, j + 1).get(1..).unwrap_or(&[]);
            for ((out, &value), &mean) in row_mut(gram, j).iter_mut().zip(source).zip(means.iter()) {
                *out = value - total * mean;
            }
        }
        let mut value_means = PerChannel::default();
        let mut squares = PerChannel::default();
        for channel in 0..channels {
            let mean = sums.total(channel) * inverse;
            set(&mut value_means, channel, mean);
            let square = sums.square(channel) - sums.total(channel) * mean;
            set(&mut squares, channel, square.max(R::ZERO));
            for (j, out) in rows_mut(rhs, columns).nth(channel).into_iter().flatten().enumerate() {
                let value = sums.rhs.get((j + 1) * channels + channel).copied().unwrap_or(R::ZERO);
                *out = value - sums.column_total(j) * mean;
            }
        }
        for j in 0..columns {
            let left = row(gram, j).last().copied().unwrap_or(R::ZERO);
            if left > R::from_f64(NOISE) * R::EPSILON * sums.column_square(j) {
                continue;
            }
            // What is left of a column that hardly moves is rounding noise, and says nothing about the values.
            for value in row_mut(gram, j) {
                *value = R::ZERO;
            }
            for k in j + 1..columns {
                if let Some(value) = row_mut(gram, k).get_mut(j) {
                    *value = R::ZERO;
                }
            }
            for value in rows_mut(rhs, columns).filter_map(|row| row.get_mut(j)) {
                *value = R::ZERO;
            }
        }
        Ok(Some(Self { columns, count, gram, rhs, means, value_means, squares }))
    }

    /// Writes the coefficients of the fit with a ridge of `strength` per sample, a row for each channel, and returns
    /// where its samples lie, if that is wanted and there are two.
    #[inline(always)]
    pub(crate) fn solve(
        &self,
        penalties: &[R],
        strength: R,
        coefficients: &mut [R],
        with_centre: bool,
        arena: &mut Arena<'_, R>,
    ) -> Result<Option<Centre<R>>, Error> {
        let factor = arena.take(packed_len(self.columns))?;
        for (out, &value) in factor.iter_mut().zip(self.gram.iter()) {
            *out = value;
        }
        let strength = strength * self.count;
        ldlt::add_diagonal(factor, self.columns, |j| strength * penalties.get(j).copied().unwrap_or(R::ONE));
        ldlt::factor(factor, self.columns);
        for (out, rhs) in rows_mut(coefficients, self.columns).zip(rows(self.rhs, self.columns)) {
            for (out, &value) in out.iter_mut().zip(rhs) {
                *out = value;
            }
            ldlt::solve(factor, out);
        }
        if !with_centre || self.count <= R::ONE {
            return Ok(None);
        }
        let inverse = arena.take(packed_len(self.columns))?;
        let diagonal = arena.take(self.columns)?;
        let means = arena.take(self.columns)?;
        ldlt::inverse_diagonal(factor, self.columns, inverse, diagonal);
        // tr(A^-1 G) = columns - strength tr(A^-1 D).
        let mut freedom = R::from_usize(self.columns);
        for (&value, &penalty) in diagonal.iter().zip(penalties) {
            freedom -= strength * value * penalty;
        }
        super::ridge_fit::copy_padded(means, self.means);
        ldlt::solve(factor, means);
        // sum_i (m'A^-1 p_i)^2 = x'G x for x = A^-1 m.
        let mut eccentricity = R::ZERO;
        for (j, &x) in means.iter().enumerate() {
            for (k, (&gram, &other)) in row(self.gram, j).iter().zip(means.iter()).enumerate() {
                let both = x * gram * other;
                eccentricity += if k == j { both } else { both + both };
            }
        }
        Ok(Some(Centre::new(eccentricity * self.count, freedom, self.count)))
    }

    /// The sum of squares of a column about its mean.
    pub(crate) fn column_square(&self, column: usize) -> R {
        row(self.gram, column).last().copied().unwrap_or(R::ZERO)
    }

    /// The intercept that goes with coefficients.
    pub(crate) fn intercept(&self, channel: usize, b: &[R]) -> R {
        let mean = get(&self.value_means, channel);
        b.iter().zip(self.means.iter()).fold(mean, |sum, (&b, &m)| sum - b * m)
    }

    /// The sum of squared residuals of coefficients, f'f - 2 b'c + b'G b.
    pub(crate) fn residual_square(&self, channel: usize, b: &[R]) -> R {
        let mut total = get(&self.squares, channel);
        let rhs = self.rhs.get(channel * self.columns..).unwrap_or(&[]);
        for (j, (&value, &rhs)) in b.iter().zip(rhs).enumerate() {
            let mut product = R::ZERO;
            for (k, (&gram, &other)) in row(self.gram, j).iter().zip(b).enumerate() {
                product += if k == j { gram * other } else { (gram + gram) * other };
            }
            total += value * (product - rhs - rhs);
        }
        not_below_zero(total)
    }

    /// Half the negative gradient of the mean squared residual, (c - G b) / n; without a channel, G b / n.
    pub(crate) fn half_gradient(&self, channel: Option<usize>, b: &[R], gradient: &mut [R]) {
        let sign = if channel.is_some() { -R::ONE } else { R::ONE };
        let rhs = channel.and_then(|channel| self.rhs.get(channel * self.columns..)).unwrap_or(&[]);
        super::ridge_fit::copy_padded(gradient, rhs);
        for (j, &value) in b.iter().enumerate() {
            let row = row(self.gram, j);
            let mut product = row.last().copied().unwrap_or(R::ZERO) * value;
            for ((&gram, &other), out) in row.iter().zip(b).zip(gradient.iter_mut()).take(j) {
                product += gram * other;
                *out += sign * gram * value;
            }
            if let Some(out) = gradient.get_mut(j) {
                *out += sign * product;
            }
        }
        let inverse = R::ONE / self.count;
        for out in gradient.iter_mut() {
            *out *= inverse;
        }
    }
}

/// Adds one group of sums to another.
pub(crate) fn add_sums<R: Real>(into: &mut [R], other: &[R]) {
    for (into, &other) in into.iter_mut().zip(other) {
        *into += other;
    }
}

/// What rounding took below zero is zero; what is no number stays so, and is not taken for a perfect fit.
fn not_below_zero<R: Real>(square: R) -> R {
    if square < R::ZERO && square.is_finite() { R::ZERO } else { square }
}
