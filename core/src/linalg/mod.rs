//! The small dense linear algebra of the regressions, over the packed triangles of [`matrix`](crate::matrix).

pub(crate) mod givens;
pub(crate) mod ldlt;

pub(crate) use crate::matrix::packed_len;

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
