//! Fixed-size sums over samples, from which every fit of the streaming estimators is made.
//!
//! For rows p = (1, functions) and values f the sums are P'P (packed), P'f (a row for each term) and f'f: the
//! [`Form::Products`]. Of badly placed samples they lose digits that [`Form::Factor`] keeps: in the same places stand
//! R' for P = Q R, Q'f, and what of f'f is left.

use super::config::Config;
use super::per_channel::PerChannel;
use crate::basis::MAX_TERMS;
use crate::error::Error;
use crate::linalg::givens;
use crate::matrix::{Panel, Triangle, packed_len};
use crate::real::Real;
use crate::rows::{at, first_mut, row_at, row_at_mut};
use core::ops::{Deref, DerefMut};

/// What is kept of the samples' rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Form {
    /// Their products.
    Products,
    /// Their triangular factor.
    Factor,
}

/// How groups of sums lie in memory, one after the other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layout {
    pub(crate) form: Form,
    /// Functions, the constant not counted.
    pub(crate) columns: usize,
    pub(crate) channels: usize,
}

/// One group of sums; `S` is `&[R]` or `&mut [R]`.
pub(crate) struct Sums<S> {
    pub(crate) form: Form,
    pub(crate) gram: Triangle<S>,
    pub(crate) rhs: Panel<S>,
    pub(crate) square: S,
}

impl Layout {
    /// The constant and the functions.
    pub(crate) fn terms(&self) -> usize {
        self.columns + 1
    }

    /// How many numbers a group takes.
    pub(crate) fn len(&self) -> usize {
        packed_len(self.terms()) + self.terms() * self.channels + self.channels
    }

    /// Group `index`.
    ///
    /// # Errors
    /// [`Error::Memory`] if there are too few numbers.
    pub(crate) fn group<'a, R>(&self, sums: &'a [R], index: usize) -> Result<Sums<&'a [R]>, Error> {
        let (gram, rest) =
            row_at(sums, self.len(), index).split_at_checked(packed_len(self.terms())).ok_or(Error::Memory)?;
        let (rhs, square) = rest.split_at_checked(self.terms() * self.channels).ok_or(Error::Memory)?;
        let (gram, rhs) = (Triangle::new(gram, self.terms())?, Panel::new(rhs, self.channels));
        Ok(Sums { form: self.form, gram, rhs, square })
    }

    /// Group `index`, to be changed.
    ///
    /// # Errors
    /// As for [`Layout::group`].
    #[inline]
    pub(crate) fn group_mut<'a, R>(&self, sums: &'a mut [R], index: usize) -> Result<Sums<&'a mut [R]>, Error> {
        let group = row_at_mut(sums, self.len(), index);
        let (gram, rest) = group.split_at_mut_checked(packed_len(self.terms())).ok_or(Error::Memory)?;
        let (rhs, square) = rest.split_at_mut_checked(self.terms() * self.channels).ok_or(Error::Memory)?;
        let (gram, rhs) = (Triangle::new(gram, self.terms())?, Panel::new(rhs, self.channels));
        Ok(Sums { form: self.form, gram, rhs, square })
    }
}

impl<R: Real, S: Deref<Target = [R]>> Sums<S> {
    pub(crate) fn layout(&self) -> Layout {
        Layout { form: self.form, columns: self.gram.order().saturating_sub(1), channels: self.channels() }
    }

    /// Values of a sample.
    pub(crate) fn channels(&self) -> usize {
        self.square.len()
    }

    pub(crate) fn count(&self) -> R {
        // Of a factor the constant's column is the first.
        let first = self.gram.at(0, 0);
        if self.form == Form::Factor { first * first } else { first }
    }

    /// The sum of the values of a channel.
    pub(crate) fn total(&self, channel: usize) -> R {
        let first = self.rhs.at(0, channel);
        if self.form == Form::Factor { self.gram.at(0, 0) * first } else { first }
    }

    pub(crate) fn square(&self, channel: usize) -> R {
        let last = at(&self.square, channel);
        if self.form == Form::Products {
            return last;
        }
        self.rhs.column(channel).fold(last, |sum, &z| sum + z * z)
    }

    pub(crate) fn column_total(&self, j: usize) -> R {
        self.gram.at(j + 1, 0)
    }

    /// What a row of the right-hand sides holds of a constant: the column's sum, of a factor its entry in that row.
    fn first_column(&self, j: usize) -> R {
        if self.form == Form::Factor && j > 0 { R::ZERO } else { self.gram.at(j, 0) }
    }

    pub(crate) fn column_square(&self, j: usize) -> R {
        self.gram.diagonal(j + 1)
    }

    pub(crate) fn mean_square(&self, j: usize) -> R {
        self.column_square(j) / self.count()
    }

    /// The sum of f - b'p over the samples.
    pub(crate) fn residual_total(&self, channel: usize, b: &[R]) -> R {
        b.iter().enumerate().fold(self.total(channel), |total, (j, &b)| total - b * self.column_total(j))
    }

    /// The sum of (f - a - b'p)^2 over the samples: theta'G theta - 2 theta'r + s with theta = (a, b).
    pub(crate) fn residual_square(&self, channel: usize, a: R, b: &[R]) -> R {
        let theta = |j: usize| if j == 0 { a } else { at(b, j - 1) };
        let mut total = self.square(channel);
        for (j, row) in self.gram.rows().enumerate().take(b.len() + 1) {
            let mut product = R::ZERO;
            for (k, &value) in row.iter().enumerate() {
                product += theta(k) * if k == j { value } else { value + value };
            }
            let rhs = self.rhs.at(j, channel);
            total += theta(j) * (product - rhs - rhs);
        }
        not_below_zero(total)
    }
}

impl<R: Real, S: DerefMut<Target = [R]>> Sums<S> {
    /// Adds a sample: its row, 1 first, and its values. Both are used up.
    #[inline]
    pub(crate) fn add(&mut self, p: &mut [R], f: &mut [R]) {
        if self.form == Form::Factor {
            return givens::add_row(&mut self.gram, &mut self.rhs, &mut self.square, p, f);
        }
        for (j, &value) in p.iter().enumerate() {
            for (out, &other) in self.gram.row_mut(j).iter_mut().zip(&*p) {
                *out += value * other;
            }
        }
        for (out, &value) in self.rhs.rows_mut().zip(&*p) {
            for (out, &f) in out.iter_mut().zip(&*f) {
                *out += value * f;
            }
        }
        for (out, &f) in self.square.iter_mut().zip(&*f) {
            *out += f * f;
        }
    }

    /// Adds another group's sums, of values that were changed since.
    pub(crate) fn merge(&mut self, other: &Sums<&[R]>, change: &Change<R>) {
        if self.form == Form::Factor {
            return self.merge_factor(other, change);
        }
        for (channel, square) in self.square.iter_mut().enumerate() {
            *square += change.square(channel, other.square(channel), other.total(channel), other.count());
        }
        for (j, (ours, theirs)) in self.rhs.rows_mut().zip(other.rhs.rows()).enumerate() {
            for (channel, (out, &value)) in ours.iter_mut().zip(theirs).enumerate() {
                *out += change.total(channel, value, other.gram.at(j, 0));
            }
        }
        add(self.gram.entries_mut(), other.gram.entries());
    }

    /// Rotates the rows of another factor into this one.
    fn merge_factor(&mut self, other: &Sums<&[R]>, change: &Change<R>) {
        let mut x = [R::ZERO; MAX_TERMS];
        let x = first_mut(&mut x, other.gram.order());
        for (j, z) in other.rhs.rows().enumerate() {
            for (k, x) in x.iter_mut().enumerate() {
                *x = if k < j { R::ZERO } else { other.gram.at(k, j) };
            }
            let first = other.first_column(j);
            let mut y = PerChannel::default();
            for (channel, &z) in z.iter().enumerate() {
                y[channel] = change.total(channel, z, first);
            }
            self.add(x, first_mut(&mut *y, other.channels()));
        }
        for (channel, (square, &other)) in self.square.iter_mut().zip(other.square).enumerate() {
            *square += change.square(channel, other, R::ZERO, R::ZERO);
        }
    }

    /// Makes the sums those of changed values.
    pub(crate) fn change(&mut self, change: &Change<R>) {
        for channel in 0..self.channels() {
            // What is left of a factor's squares does not depend on where zero is.
            let is_products = self.form == Form::Products;
            let (total, n) = if is_products { (self.total(channel), self.count()) } else { (R::ZERO, R::ZERO) };
            if let Some(square) = self.square.get_mut(channel) {
                *square = change.square(channel, *square, total, n);
            }
        }
        for j in 0..self.gram.order() {
            let column = self.first_column(j);
            for (channel, out) in self.rhs.row_mut(j).iter_mut().enumerate() {
                *out = change.total(channel, *out, column);
            }
        }
    }
}

/// What becomes of values: `factors` f + `shift`.
#[derive(Clone, Copy)]
pub(crate) struct Change<R> {
    pub(crate) factors: PerChannel<R>,
    pub(crate) shift: PerChannel<R>,
}

impl<R: Real> Change<R> {
    /// None.
    pub(crate) fn none() -> Self {
        Self { factors: PerChannel([R::ONE; Config::MAX_CHANNELS]), shift: PerChannel::default() }
    }

    /// A sum of `n` values.
    pub(crate) fn total(&self, channel: usize, total: R, n: R) -> R {
        self.factors[channel] * total + self.shift[channel] * n
    }

    /// The sum of their squares.
    pub(crate) fn square(&self, channel: usize, square: R, total: R, n: R) -> R {
        let (factor, shift) = (self.factors[channel], self.shift[channel]);
        let total = factor * total;
        factor * factor * square + shift * (total + total + shift * n)
    }
}

/// Adds one group of sums to another.
pub(crate) fn add<R: Real>(into: &mut [R], other: &[R]) {
    for (into, &other) in into.iter_mut().zip(other) {
        *into += other;
    }
}

/// The sum of squares about the mean, from those about zero.
pub(crate) fn spread<R: Real>(square: R, total: R, mean: R) -> R {
    not_below_zero(square - total * mean)
}

/// What rounding took below zero is zero; what is no number stays so, and is not taken for a perfect fit.
pub(crate) fn not_below_zero<R: Real>(square: R) -> R {
    if square < R::ZERO && square.is_finite() { R::ZERO } else { square }
}
