//! A triangular factor R of the rows seen so far, updated by Givens rotations.
//!
//! R'R is the normal matrix, but it is never formed: a system of condition number c loses log10(c) digits here and
//! twice as many through the normal equations. The packed triangle holds R': entry (j, k) of R, k >= j, stands in row k
//! at place j.

use crate::matrix::{Panel, Triangle, split_at};
use crate::real::Real;
use core::hint::black_box;
use core::ops::{Deref, DerefMut};

/// Rotates one row into the factor: `x` has one number for each column, `y` one for each right-hand side, of which
/// `rhs` has a row for each column. `residual` gathers what no coefficient can explain. `x` and `y` are used up.
pub(crate) fn add_row<R: Real, S: DerefMut<Target = [R]>>(
    factor: &mut Triangle<S>,
    rhs: &mut Panel<S>,
    residual: &mut [R],
    x: &mut [R],
    y: &mut [R],
) {
    for j in 0..x.len() {
        let Some((&mut head, tail)) = x.get_mut(j..).and_then(<[R]>::split_first_mut) else { return };
        if head == R::ZERO {
            continue;
        }
        let Some(diagonal) = factor.diagonal_mut(j) else { return };
        let (c, s, length) = rotation(*diagonal, head);
        *diagonal = length;
        for (k, value) in tail.iter_mut().enumerate() {
            let Some(r) = factor.at_mut(j + 1 + k, j) else { return };
            (*r, *value) = (c * *r + s * *value, c * *value - s * *r);
        }
        for (z, value) in rhs.row_mut(j).iter_mut().zip(y.iter_mut()) {
            (*z, *value) = (c * *z + s * *value, c * *value - s * *z);
        }
    }
    for (total, &value) in residual.iter_mut().zip(y.iter()) {
        *total += value * value;
    }
}

/// x := R^-1 x; a column with no pivot gets coefficient zero.
pub(crate) fn solve<R: Real>(factor: &Triangle<impl Deref<Target = [R]>>, x: &mut [R]) {
    for j in (0..x.len()).rev() {
        let Some((before, x_j)) = split_at(x, j) else { return };
        *x_j = quotient(*x_j, factor.diagonal(j));
        for (x, &r) in before.iter_mut().zip(factor.left(j)) {
            *x -= r * *x_j;
        }
    }
}

/// x := R'^-1 x, with zero for a column that has no pivot.
pub(crate) fn solve_transposed<R: Real>(factor: &Triangle<impl Deref<Target = [R]>>, x: &mut [R]) {
    for j in 0..x.len() {
        let Some((before, x_j)) = split_at(x, j) else { return };
        for (x, &r) in before.iter().zip(factor.left(j)) {
            *x_j -= r * *x;
        }
        *x_j = quotient(*x_j, factor.diagonal(j));
    }
}

fn quotient<R: Real>(value: R, pivot: R) -> R {
    if pivot == R::ZERO { R::ZERO } else { value / pivot }
}

/// (c, s, r) with c a + s b = r and c b - s a = 0, without overflow.
fn rotation<R: Real>(a: R, b: R) -> (R, R, R) {
    // Each quotient behind a black box, or both are divided in four lanes, two of them 0 / 0: FE_INVALID.
    let over = |value: R, divisor: R| black_box(value / divisor);
    let size = a.abs().max(b.abs());
    let (a, b) = (over(a, size), over(b, size));
    let length = (a * a + b * b).sqrt();
    (over(a, length), over(b, length), length * size)
}
