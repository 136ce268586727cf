//! Parts of slices, and rows of matrices that are stored row after row. What lies outside reads as zero, or as an empty
//! part, so that no index can be out of bounds: the sizes are checked where memory comes in.

use core::iter;

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
