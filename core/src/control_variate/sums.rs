//! Fixed-size sums over samples, from which every fit of the streaming estimators is made.
//!
//! For rows p = (1, functions) and values f the sums are P'P (packed), P'f (a row for each term) and f'f: the
//! [`Form::Products`]. Of badly placed samples they lose digits that [`Form::Factor`] keeps: in the same places stand
//! R' for P = Q R, Q'f, and what of f'f is left.

use super::per_channel::PerChannel;
use crate::basis::MAX_TERMS;
use crate::linalg::givens;
use crate::matrix::{
    Panel, Triangle, at, copy, first, first_mut, from_mut, halves, halves_mut, packed_len, row_at, row_at_mut,
};
use crate::real::Real;
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

    /// How many coefficients a fit has, a row for each channel.
    pub(crate) fn coefficients(&self) -> usize {
        self.columns * self.channels
    }

    /// How many numbers a group takes.
    pub(crate) fn len(&self) -> usize {
        packed_len(self.terms()) + self.terms() * self.channels + self.channels
    }

    /// Group `index`.
    pub(crate) fn group<'a, R: Real>(&self, sums: &'a [R], index: usize) -> Sums<&'a [R]> {
        self.parts(row_at(sums, self.len(), index), halves)
    }

    /// Group `index`, to be changed.
    pub(crate) fn group_mut<'a, R: Real>(&self, sums: &'a mut [R], index: usize) -> Sums<&'a mut [R]> {
        self.parts(row_at_mut(sums, self.len(), index), halves_mut)
    }

    fn parts<R: Real, S: Deref<Target = [R]>>(&self, group: S, halves: impl Fn(S, usize) -> (S, S)) -> Sums<S> {
        let (gram, rest) = halves(group, packed_len(self.terms()));
        let (rhs, square) = halves(rest, self.terms() * self.channels);
        let (gram, rhs) = (Triangle::new(gram, self.terms()), Panel::new(rhs, self.channels));
        Sums { form: self.form, gram, rhs, square }
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

    /// The sums of the values.
    pub(crate) fn totals(&self) -> PerChannel<R> {
        let of_first = if self.form == Form::Factor { self.gram.at(0, 0) } else { R::ONE };
        PerChannel::of(self.channels(), |channel| of_first * self.rhs.at(0, channel))
    }

    /// The sums of their squares.
    pub(crate) fn squares(&self) -> PerChannel<R> {
        PerChannel::of(self.channels(), |channel| {
            let last = at(&self.square, channel);
            if self.form == Form::Products {
                return last;
            }
            self.rhs.column(channel).fold(last, |sum, &z| sum + z * z)
        })
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

    /// The sums of f - b'p over the samples, for coefficients b, a row for each channel.
    pub(crate) fn residual_totals(&self, b: &[R]) -> PerChannel<R> {
        let (totals, columns) = (self.totals(), self.layout().columns);
        PerChannel::of(self.channels(), |channel| {
            let b = row_at(b, columns, channel).iter().enumerate();
            b.fold(totals[channel], |total, (j, &b)| total - b * self.column_total(j))
        })
    }

    /// The intercepts that go with those coefficients; zero without a sample.
    pub(crate) fn intercepts(&self, b: &[R]) -> PerChannel<R> {
        let inverse = if self.count() > R::ZERO { R::ONE / self.count() } else { R::ZERO };
        self.residual_totals(b) * inverse
    }

    /// The sums of (f - a - b'p)^2 over the samples, with theta = (a, b); of a alone without any b.
    pub(crate) fn residual_squares(&self, a: PerChannel<R>, b: &[R]) -> PerChannel<R> {
        let (squares, columns) = (self.squares(), self.layout().columns);
        PerChannel::of(self.channels(), |channel| {
            let b = row_at(b, columns, channel);
            let mut theta = [a[channel]; MAX_TERMS];
            copy(from_mut(&mut theta, 1), b);
            residual_square(squares[channel], &self.gram, self.rhs.column(channel), first(&theta, 1 + b.len()))
        })
    }
}

impl<R: Real, S: DerefMut<Target = [R]>> Sums<S> {
    /// Adds a sample: its row, 1 first, and its values. Both are used up.
    pub(crate) fn add(&mut self, p: &mut [R], f: &mut [R]) {
        if self.form == Form::Factor {
            return givens::add_row(&mut self.gram, &mut self.rhs, &mut self.square, p, f);
        }
        for (row, &value) in self.gram.rows_mut().zip(&*p) {
            for (out, &other) in row.iter_mut().zip(&*p) {
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
        add(&mut self.square, &change.squares(other.squares(), other.totals(), other.count()).0);
        for (j, (ours, theirs)) in self.rhs.rows_mut().zip(other.rhs.rows()).enumerate() {
            add(ours, &change.totals(PerChannel::from_row(theirs), other.gram.at(j, 0)).0);
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
            let mut y = change.totals(PerChannel::from_row(z), other.first_column(j));
            self.add(x, first_mut(&mut y.0, other.channels()));
        }
        add(&mut self.square, &change.squares(PerChannel::from_row(other.square), PerChannel::default(), R::ZERO).0);
    }

    /// Makes the sums those of changed values.
    pub(crate) fn change(&mut self, change: &Change<R>) {
        // What is left of a factor's squares does not depend on where zero is.
        let is_products = self.form == Form::Products;
        let (totals, n) = if is_products { (self.totals(), self.count()) } else { (PerChannel::default(), R::ZERO) };
        let squares = change.squares(PerChannel::from_row(&self.square), totals, n);
        copy(&mut self.square, &squares.0);
        for j in 0..self.gram.order() {
            let column = self.first_column(j);
            let row = self.rhs.row_mut(j);
            copy(row, &change.totals(PerChannel::from_row(row), column).0);
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
        Self { factors: PerChannel::all(R::ONE), shift: PerChannel::default() }
    }

    /// Sums of `n` values.
    pub(crate) fn totals(&self, totals: PerChannel<R>, n: R) -> PerChannel<R> {
        self.factors * totals + self.shift * n
    }

    /// The sums of their squares.
    pub(crate) fn squares(&self, squares: PerChannel<R>, totals: PerChannel<R>, n: R) -> PerChannel<R> {
        let totals = self.factors * totals;
        self.factors * self.factors * squares + self.shift * (totals + totals + self.shift * n)
    }
}

/// Adds one group of sums to another.
pub(crate) fn add<R: Real>(into: &mut [R], other: &[R]) {
    for (into, &other) in into.iter_mut().zip(other) {
        *into += other;
    }
}

/// The sum of (f - b'p)^2, from that of f^2 and the products of p with p and f: f'f - 2 b'c + b'G b.
pub(crate) fn residual_square<'a, R: Real>(
    square: R,
    gram: &Triangle<impl Deref<Target = [R]>>,
    rhs: impl Iterator<Item = &'a R>,
    b: &[R],
) -> R {
    let mut total = square;
    for (j, (&value, &rhs)) in b.iter().zip(rhs).enumerate() {
        total += value * (gram.half_product(j, b) - rhs - rhs);
    }
    not_below_zero(total)
}

/// The sums of squares about the means, from those about zero.
pub(crate) fn spread<R: Real>(squares: PerChannel<R>, totals: PerChannel<R>, means: PerChannel<R>) -> PerChannel<R> {
    (squares - totals * means).map(not_below_zero)
}

/// What rounding took below zero is zero; what is no number stays so, and is not taken for a perfect fit.
pub(crate) fn not_below_zero<R: Real>(square: R) -> R {
    if square < R::ZERO && square.is_finite() { R::ZERO } else { square }
}
