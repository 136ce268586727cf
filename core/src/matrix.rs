//! Views of matrices, over memory that somebody else owns and measured.
//!
//! What lies outside reads as zero or as an empty row, so no index of a formula over views can be out of bounds.
//!
//! `S` is `&[T]` or `&mut [T]`.

use crate::real::Real;
pub(crate) use crate::rows::{
    at, first, first_mut, from, from_mut, halves, halves_mut, part, part_mut, row_at, row_at_mut, rows, rows_mut, set,
};
use core::ops::{Deref, DerefMut};

/// The count of numbers in a packed triangle of `order` rows.
pub(crate) const fn packed_len(order: usize) -> usize {
    order * (order + 1) / 2
}

/// Row `j` of a packed triangle, diagonal included.
pub(crate) fn row<T>(triangle: &[T], j: usize) -> &[T] {
    part(triangle, packed_len(j), j + 1)
}

pub(crate) fn row_mut<T>(triangle: &mut [T], j: usize) -> &mut [T] {
    part_mut(triangle, packed_len(j), j + 1)
}

/// Entry (j, j) of a packed triangle.
pub(crate) fn diagonal<T: Copy + Default>(triangle: &[T], j: usize) -> T {
    at(triangle, packed_len(j) + j)
}

/// Entry `j` of a vector, and the entries before it: what a substitution works on.
pub(crate) fn split_at<T>(vector: &mut [T], j: usize) -> Option<(&mut [T], &mut T)> {
    vector.get_mut(..=j)?.split_last_mut().map(|(last, before)| (before, last))
}

/// Copies as many entries as both have.
pub(crate) fn copy<T: Copy>(into: &mut [T], from: &[T]) {
    for (into, &from) in into.iter_mut().zip(from) {
        *into = from;
    }
}

/// A symmetric or lower triangular matrix: row j holds the j + 1 entries up to the diagonal, and follows row j - 1.
#[derive(Clone, Copy)]
pub(crate) struct Triangle<S> {
    entries: S,
    order: usize,
}

/// The rows before row j, row j left of the diagonal, and the entry there.
type Split<'a, T> = (Triangle<&'a [T]>, &'a mut [T], &'a mut T);

impl<T: 'static, S: Deref<Target = [T]>> Triangle<S> {
    pub(crate) fn new(entries: S, order: usize) -> Self {
        Self { entries, order }
    }

    pub(crate) fn order(&self) -> usize {
        self.order
    }

    /// All entries, row after row.
    pub(crate) fn entries(&self) -> &[T] {
        &self.entries
    }

    /// Row `j`, diagonal included.
    pub(crate) fn row(&self, j: usize) -> &[T] {
        row(&self.entries, j)
    }

    /// Row `j` left of the diagonal.
    pub(crate) fn left(&self, j: usize) -> &[T] {
        part(&self.entries, packed_len(j), j)
    }

    /// The rows from the first on.
    pub(crate) fn rows(&self) -> impl Iterator<Item = &[T]> {
        let mut rest: &[T] = &self.entries;
        (1..=self.order).map_while(move |len| {
            let (row, after) = rest.split_at_checked(len)?;
            rest = after;
            Some(row)
        })
    }
}

impl<T: Copy + Default + 'static, S: Deref<Target = [T]>> Triangle<S> {
    /// Entry (j, k), k <= j.
    pub(crate) fn at(&self, j: usize, k: usize) -> T {
        at(self.row(j), k)
    }

    /// Entry (j, j).
    pub(crate) fn diagonal(&self, j: usize) -> T {
        diagonal(&self.entries, j)
    }
}

impl<R: Real, S: Deref<Target = [R]>> Triangle<S> {
    /// Sum_k a_jk x_k over the row up to the diagonal, what is left of it counted twice: times x_j and summed over the
    /// rows it makes x'A x.
    pub(crate) fn half_product(&self, j: usize, x: &[R]) -> R {
        let mut sum = R::ZERO;
        for (k, (&a, &x)) in self.row(j).iter().zip(x).enumerate() {
            sum += (if k == j { a } else { a + a }) * x;
        }
        sum
    }

    /// x'A x
    pub(crate) fn quadratic(&self, x: &[R]) -> R {
        let mut sum = R::ZERO;
        for (j, &x_j) in x.iter().enumerate() {
            for (k, (&a, &x_k)) in self.row(j).iter().zip(x).enumerate() {
                let product = x_j * a * x_k;
                sum += if k == j { product } else { product + product };
            }
        }
        sum
    }
}

impl<T: 'static, S: DerefMut<Target = [T]>> Triangle<S> {
    pub(crate) fn entries_mut(&mut self) -> &mut [T] {
        &mut self.entries
    }

    pub(crate) fn row_mut(&mut self, j: usize) -> &mut [T] {
        row_mut(&mut self.entries, j)
    }

    pub(crate) fn at_mut(&mut self, j: usize, k: usize) -> Option<&mut T> {
        self.row_mut(j).get_mut(k)
    }

    pub(crate) fn diagonal_mut(&mut self, j: usize) -> Option<&mut T> {
        self.entries.get_mut(packed_len(j) + j)
    }

    /// What the factorisation of row `j` works on.
    pub(crate) fn split(&mut self, j: usize) -> Option<Split<'_, T>> {
        let (before, rest) = self.entries.split_at_mut_checked(packed_len(j))?;
        let (left, diagonal) = split_at(rest, j)?;
        Some((Triangle { entries: before, order: j }, left, diagonal))
    }
}

/// Rows of equal length, one after the other.
#[derive(Clone, Copy)]
pub(crate) struct Panel<S> {
    entries: S,
    width: usize,
}

impl<T: 'static, S: Deref<Target = [T]>> Panel<S> {
    /// The whole rows of `width` entries.
    pub(crate) fn new(entries: S, width: usize) -> Self {
        Self { entries, width }
    }

    /// Row `i`.
    pub(crate) fn row(&self, i: usize) -> &[T] {
        row_at(&self.entries, self.width, i)
    }

    pub(crate) fn rows(&self) -> impl Iterator<Item = &[T]> {
        rows(&self.entries, self.width)
    }

    /// The entries at place `j` of every row.
    pub(crate) fn column(&self, j: usize) -> impl Iterator<Item = &T> {
        self.rows().filter_map(move |row| row.get(j))
    }
}

impl<T: Copy + Default + 'static, S: Deref<Target = [T]>> Panel<S> {
    /// Entry (i, j).
    pub(crate) fn at(&self, i: usize, j: usize) -> T {
        at(&self.entries, i * self.width + j)
    }
}

impl<T: 'static, S: DerefMut<Target = [T]>> Panel<S> {
    pub(crate) fn row_mut(&mut self, i: usize) -> &mut [T] {
        row_at_mut(&mut self.entries, self.width, i)
    }

    pub(crate) fn rows_mut(&mut self) -> impl Iterator<Item = &mut [T]> {
        rows_mut(&mut self.entries, self.width)
    }

    pub(crate) fn column_mut(&mut self, j: usize) -> impl Iterator<Item = &mut T> {
        self.rows_mut().filter_map(move |row| row.get_mut(j))
    }
}
