//! Fixed-size sums over samples, from which every fit of the streaming estimators is made.
//!
//! For rows p = (1, functions) and values f the sums are P'P (packed), P'f (a row for each term) and f'f.

use super::per_channel::PerChannel;
use crate::error::Error;
use crate::matrix::{Panel, Triangle, at, packed_len};
use crate::real::Real;
use core::ops::{Deref, DerefMut};

/// How many numbers the sums of `terms` terms (constant included) and `channels` values take.
pub(crate) const fn len(terms: usize, channels: usize) -> usize {
    packed_len(terms) + terms * channels + channels
}

/// One group of sums; `S` is `&[R]` or `&mut [R]`.
pub(crate) struct Sums<S> {
    pub(crate) gram: Triangle<S>,
    pub(crate) rhs: Panel<S>,
    pub(crate) square: S,
}

impl<'a, R: Real> Sums<&'a [R]> {
    /// # Errors
    /// [`Error::Memory`] for less than [`len`] numbers.
    pub(crate) fn new(numbers: &'a [R], terms: usize, channels: usize) -> Result<Self, Error> {
        let (gram, rest) = numbers.split_at_checked(packed_len(terms)).ok_or(Error::Memory)?;
        let (rhs, square) = rest.split_at_checked(terms * channels).ok_or(Error::Memory)?;
        Ok(Self { gram: Triangle::new(gram, terms)?, rhs: Panel::new(rhs, channels), square })
    }
}

impl<'a, R: Real> Sums<&'a mut [R]> {
    /// # Errors
    /// [`Error::Memory`] for less than [`len`] numbers.
    #[inline]
    pub(crate) fn new_mut(numbers: &'a mut [R], terms: usize, channels: usize) -> Result<Self, Error> {
        let (gram, rest) = numbers.split_at_mut_checked(packed_len(terms)).ok_or(Error::Memory)?;
        let (rhs, square) = rest.split_at_mut_checked(terms * channels).ok_or(Error::Memory)?;
        Ok(Self { gram: Triangle::new(gram, terms)?, rhs: Panel::new(rhs, channels), square })
    }
}

impl<R: Real, S: Deref<Target = [R]>> Sums<S> {
    /// The number of samples.
    pub(crate) fn count(&self) -> R {
        self.gram.at(0, 0)
    }

    /// The sum of the values of a channel.
    pub(crate) fn total(&self, channel: usize) -> R {
        self.rhs.at(0, channel)
    }

    /// The sum of the values' squares.
    pub(crate) fn square(&self, channel: usize) -> R {
        at(&self.square, channel)
    }

    /// The sum of column j.
    pub(crate) fn column_total(&self, j: usize) -> R {
        self.gram.at(j + 1, 0)
    }

    /// The sum of the squares of column j.
    pub(crate) fn column_square(&self, j: usize) -> R {
        self.gram.diagonal(j + 1)
    }

    /// The mean of the squares of column j.
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
    /// Adds a sample: its row, 1 first, and its values.
    #[inline(always)]
    pub(crate) fn add(&mut self, p: &[R], f: &[R]) {
        for (j, &value) in p.iter().enumerate() {
            for (out, &other) in self.gram.row_mut(j).iter_mut().zip(p) {
                *out += value * other;
            }
        }
        for (out, &value) in self.rhs.rows_mut().zip(p) {
            for (out, &f) in out.iter_mut().zip(f) {
                *out += value * f;
            }
        }
        for (out, &f) in self.square.iter_mut().zip(f) {
            *out += f * f;
        }
    }

    /// Adds another group's sums, of values that are `shift` + `factors` times as they were summed.
    pub(crate) fn merge(&mut self, other: &Sums<&[R]>, factors: &PerChannel<R>, shift: &PerChannel<R>) {
        for (channel, square) in self.square.iter_mut().enumerate() {
            let (factor, shift) = (factors[channel], shift[channel]);
            let total = factor * other.total(channel);
            *square += factor * factor * other.square(channel) + shift * (total + total + shift * other.count());
        }
        for (j, (ours, theirs)) in self.rhs.rows_mut().zip(other.rhs.rows()).enumerate() {
            let column = other.gram.at(j, 0);
            for (channel, (out, &value)) in ours.iter_mut().zip(theirs).enumerate() {
                *out += factors[channel] * value + shift[channel] * column;
            }
        }
        add(self.gram.entries_mut(), other.gram.entries());
    }

    /// Makes the sums those of `shift` + f.
    pub(crate) fn shift(&mut self, shift: &PerChannel<R>) {
        let (gram, rhs) = (self.gram.view(), &mut self.rhs);
        for (channel, square) in self.square.iter_mut().enumerate() {
            let (shift, total) = (shift[channel], rhs.at(0, channel));
            *square += shift * (total + total + shift * gram.at(0, 0));
        }
        for (j, out) in rhs.rows_mut().enumerate() {
            let column = gram.at(j, 0);
            for (out, &shift) in out.iter_mut().zip(shift.iter()) {
                *out += shift * column;
            }
        }
    }

    /// Makes the sums those of `factors` times f.
    pub(crate) fn rescale(&mut self, factors: &PerChannel<R>) {
        for out in self.rhs.rows_mut() {
            for (out, &factor) in out.iter_mut().zip(factors.iter()) {
                *out *= factor;
            }
        }
        for (out, &factor) in self.square.iter_mut().zip(factors.iter()) {
            *out *= factor * factor;
        }
    }
}

/// Adds one group of sums to another.
pub(crate) fn add<R: Real>(into: &mut [R], other: &[R]) {
    for (into, &other) in into.iter_mut().zip(other) {
        *into += other;
    }
}

/// What rounding took below zero is zero; what is no number stays so, and is not taken for a perfect fit.
pub(crate) fn not_below_zero<R: Real>(square: R) -> R {
    if square < R::ZERO && square.is_finite() { R::ZERO } else { square }
}
