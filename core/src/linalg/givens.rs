//! A triangular factor R of the rows seen so far, updated by Givens rotations.
//!
//! R'R is the normal matrix, but it is never formed: a system of condition number c loses log10(c) digits here and
//! twice as many through the normal equations. Row j of R is kept as the *column* j of a packed lower triangle, that
//! is, R' is the packed matrix: entry (j, k) of R with k >= j stands in row k at place j.

use super::{packed_len, row};
use crate::real::Real;
use crate::rows::rows;

/// Rotates one row into the factor: `x` has one number for each of the `n` columns, `y` one for each right-hand side.
/// `rhs` has `n` rows of `y.len()` numbers; `residual` gathers what no coefficient can explain. `x` and `y` are used
/// up.
#[inline(always)]
pub(crate) fn add_row<R: Real>(factor: &mut [R], rhs: &mut [R], residual: &mut [R], x: &mut [R], y: &mut [R]) {
    let n = x.len();
    let width = y.len();
    for j in 0..n {
        let Some((&mut head, tail)) = x.get_mut(j..).and_then(<[R]>::split_first_mut) else { return };
        if head == R::ZERO {
            continue;
        }
        let Some(diagonal) = factor.get_mut(packed_len(j) + j) else { return };
        let (c, s, length) = rotation(*diagonal, head);
        *diagonal = length;
        for (k, value) in (j + 1..n).zip(tail) {
            if let Some(r) = factor.get_mut(packed_len(k) + j) {
                (*r, *value) = (c * *r + s * *value, c * *value - s * *r);
            }
        }
        let rhs_j = rhs.get_mut(j * width..(j + 1) * width).unwrap_or(&mut []);
        for (z, value) in rhs_j.iter_mut().zip(y.iter_mut()) {
            (*z, *value) = (c * *z + s * *value, c * *value - s * *z);
        }
    }
    for (total, &value) in residual.iter_mut().zip(y.iter()) {
        *total += value * value;
    }
}

/// Solves R x = z for column `channel` of the right-hand sides; a column with no pivot gets coefficient zero.
#[inline(always)]
pub(crate) fn solve<R: Real>(factor: &[R], rhs: &[R], width: usize, channel: usize, x: &mut [R]) {
    let n = x.len();
    for (j, value) in x.iter_mut().enumerate() {
        *value = rhs.get(j * width + channel).copied().unwrap_or(R::ZERO);
    }
    for j in (0..n).rev() {
        let (before, from_j) = x.split_at_mut_checked(j).unwrap_or((&mut [], &mut []));
        let Some(value) = from_j.first_mut() else { return };
        let column = row(factor, j);
        let pivot = column.last().copied().unwrap_or(R::ZERO);
        *value = if pivot == R::ZERO { R::ZERO } else { *value / pivot };
        for (x, &r) in before.iter_mut().zip(column) {
            *x -= r * *value;
        }
    }
}

/// The squared length of R'^-1 x, which is x'A^-1 x for A = R'R; `x` is used up. A column with no pivot adds nothing.
pub(crate) fn inverse_square<R: Real>(factor: &[R], x: &mut [R]) -> R {
    let mut total = R::ZERO;
    for j in 0..x.len() {
        let (before, from_j) = x.split_at_mut_checked(j).unwrap_or((&mut [], &mut []));
        let Some(value) = from_j.first_mut() else { return total };
        let column = row(factor, j);
        for (x, &r) in before.iter().zip(column) {
            *value -= r * *x;
        }
        let pivot = column.last().copied().unwrap_or(R::ZERO);
        *value = if pivot == R::ZERO { R::ZERO } else { *value / pivot };
        total += *value * *value;
    }
    total
}

/// For a factor whose first column is the constant 1: the sum of a right-hand side and of its squares.
pub(crate) fn first_column<R: Real>(factor: &[R], rhs: &[R], residual: &[R], width: usize, channel: usize) -> (R, R) {
    let root = factor.first().copied().unwrap_or(R::ZERO);
    let mut square = residual.get(channel).copied().unwrap_or(R::ZERO);
    for z in rows(rhs, width).filter_map(|row| row.get(channel)) {
        square += *z * *z;
    }
    (root * rhs.get(channel).copied().unwrap_or(R::ZERO), square)
}

/// (c, s, r) with c a + s b = r and c b - s a = 0, without overflow.
#[inline(always)]
fn rotation<R: Real>(a: R, b: R) -> (R, R, R) {
    let size = a.abs().max(b.abs());
    let (a, b) = (a / size, b / size);
    let length = (a * a + b * b).sqrt();
    (a / length, b / length, length * size)
}
