//! The small dense linear algebra of the regressions.
//!
//! Symmetric and triangular matrices are packed: row j of the lower triangle holds j + 1 numbers and starts at
//! j (j + 1) / 2. A row that is not there reads as empty, so no index can be out of bounds.

pub(crate) mod givens;
pub(crate) mod ldlt;

/// The count of numbers in a packed triangle of `n` rows.
#[inline(always)]
pub(crate) const fn packed_len(n: usize) -> usize {
    n * (n + 1) / 2
}

/// Row `j` of a packed lower triangle, diagonal included.
#[inline(always)]
pub(crate) fn row<R>(matrix: &[R], j: usize) -> &[R] {
    let start = packed_len(j);
    matrix.get(start..start + j + 1).unwrap_or(&[])
}

/// Row `j` of a packed lower triangle, diagonal included.
#[inline(always)]
pub(crate) fn row_mut<R>(matrix: &mut [R], j: usize) -> &mut [R] {
    let start = packed_len(j);
    matrix.get_mut(start..start + j + 1).unwrap_or(&mut [])
}
