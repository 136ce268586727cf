//! Parts of slices, rows of matrices that are stored row after row, and views of matrices: all over memory that
//! somebody else owns.
//!
//! What lies outside reads as zero, or as an empty part, so that no index can be out of bounds: the sizes are checked
//! where memory comes in. `S` is `&[T]` or `&mut [T]`.

use crate::real::Real;
use core::iter;
use core::ops::{Deref, DerefMut};

/// The whole rows of `width` entries, none of no width, for which `chunks_exact` and its length panic.
pub(crate) fn rows<T>(mut rest: &[T], width: usize) -> impl Iterator<Item = &[T]> + Clone {
    iter::from_fn(move || {
        let (row, after) = rest.split_at_checked(width).filter(|_| width > 0)?;
        rest = after;
        Some(row)
    })
}

pub(crate) fn rows_mut<T>(mut rest: &mut [T], width: usize) -> impl Iterator<Item = &mut [T]> {
    iter::from_fn(move || {
        let (row, after) = core::mem::take(&mut rest).split_at_mut_checked(width).filter(|_| width > 0)?;
        rest = after;
        Some(row)
    })
}

/// Row `index` of `width` entries.
pub(crate) fn row_at<T>(matrix: &[T], width: usize, index: usize) -> &[T] {
    part(matrix, index * width, width)
}

pub(crate) fn row_at_mut<T>(matrix: &mut [T], width: usize, index: usize) -> &mut [T] {
    part_mut(matrix, index * width, width)
}

/// One entry of a vector.
pub(crate) fn at<T: Copy + Default>(vector: &[T], j: usize) -> T {
    vector.get(j).copied().unwrap_or_default()
}

/// Writes one entry of a vector, if it is there.
pub(crate) fn set<T>(vector: &mut [T], j: usize, value: T) {
    if let Some(out) = vector.get_mut(j) {
        *out = value;
    }
}

/// `len` entries of a vector from entry `start` on.
pub(crate) fn part<T>(vector: &[T], start: usize, len: usize) -> &[T] {
    vector.get(start..start + len).unwrap_or_default()
}

pub(crate) fn part_mut<T>(vector: &mut [T], start: usize, len: usize) -> &mut [T] {
    vector.get_mut(start..start + len).unwrap_or_default()
}

/// The entries of a vector from entry `start` on.
pub(crate) fn from<T>(vector: &[T], start: usize) -> &[T] {
    vector.get(start..).unwrap_or_default()
}

pub(crate) fn from_mut<T>(vector: &mut [T], start: usize) -> &mut [T] {
    vector.get_mut(start..).unwrap_or_default()
}

/// The first `len` entries of a vector.
pub(crate) fn first<T>(vector: &[T], len: usize) -> &[T] {
    vector.get(..len).unwrap_or_default()
}

pub(crate) fn first_mut<T>(vector: &mut [T], len: usize) -> &mut [T] {
    vector.get_mut(..len).unwrap_or_default()
}

/// The first `len` entries of a vector, and the others.
pub(crate) fn halves<T>(vector: &[T], len: usize) -> (&[T], &[T]) {
    vector.split_at_checked(len).unwrap_or_default()
}

pub(crate) fn halves_mut<T>(vector: &mut [T], len: usize) -> (&mut [T], &mut [T]) {
    vector.split_at_mut_checked(len).unwrap_or_default()
}

/// The first N entries of a vector that has as many.
pub(crate) fn chunk<T: Copy + Default, const N: usize>(vector: &[T]) -> [T; N] {
    vector.first_chunk().copied().unwrap_or([T::default(); N])
}

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

/// Whether as many entries as both have are equal. Of `==` compilers may make a call of bcmp, which a freestanding
/// target need not have.
pub(crate) fn is_same<T: Copy + PartialEq>(a: &[T], b: &[T]) -> bool {
    a.iter().zip(b).fold(true, |is_same, (a, b)| is_same & (a == b))
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
        (0..self.order).map_while(move |j| {
            let (row, after) = rest.split_at_checked(j + 1)?;
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

    /// The rows from the first on.
    pub(crate) fn rows_mut(&mut self) -> impl Iterator<Item = &mut [T]> {
        let mut rest: &mut [T] = &mut self.entries;
        (1..=self.order).map_while(move |len| {
            let (row, after) = core::mem::take(&mut rest).split_at_mut_checked(len)?;
            rest = after;
            Some(row)
        })
    }

    pub(crate) fn at_mut(&mut self, j: usize, k: usize) -> Option<&mut T> {
        self.row_mut(j).get_mut(k)
    }

    pub(crate) fn diagonal_mut(&mut self, j: usize) -> Option<&mut T> {
        self.entries.get_mut(packed_len(j) + j)
    }

    /// Adds to the diagonal, from its first entry on.
    pub(crate) fn add_to_diagonal(&mut self, terms: impl Iterator<Item = T>)
    where
        T: Real,
    {
        for (j, term) in (0..self.order).zip(terms) {
            if let Some(diagonal) = self.diagonal_mut(j) {
                *diagonal += term;
            }
        }
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
