//! A = L D L' for symmetric positive semidefinite matrices: the direct solver of (4.27).

use super::{packed_len, row, row_mut};
use crate::lanes::{self, LANES, Lanes, dot};
use crate::real::Real;

/// A pivot below this fraction of its diagonal entry, in units of the type's epsilon, is rounding noise. Its column
/// then depends on earlier ones and gets coefficient zero.
const DEPENDENT: f64 = 64.0;

/// Replaces the packed lower triangle of A, of `n` rows, by L below the diagonal and 1 / D on it.
///
/// 1 / D is 0 for a column that depends on the columns before it: the solution then does not use it.
#[inline(always)]
pub(crate) fn factor<R: Real>(matrix: &mut [R], n: usize) {
    let tolerance = R::from_f64(DEPENDENT) * R::EPSILON;
    for j in 0..n {
        let Some((done, rest)) = matrix.split_at_mut_checked(packed_len(j)) else { return };
        let Some((diagonal, row_j)) = rest.get_mut(..=j).and_then(<[R]>::split_last_mut) else { return };
        // First v_k = d_k l_jk, which the later entries of the row need, then l_jk itself.
        for k in 0..j {
            let (before, from_k) = row_j.split_at_mut_checked(k).unwrap_or((&mut [], &mut []));
            if let Some(value) = from_k.first_mut() {
                *value -= dot(before, row(done, k).get(..k).unwrap_or(&[]));
            }
        }
        let whole = *diagonal;
        let mut pivot = whole;
        for (k, value) in row_j.iter_mut().enumerate() {
            let inverse = row(done, k).last().copied().unwrap_or(R::ZERO);
            let l = *value * inverse;
            pivot -= *value * l;
            *value = l;
        }
        *diagonal = if pivot > tolerance * whole { R::ONE / pivot } else { R::ZERO };
    }
}

/// x := L^-1 x.
#[inline(always)]
pub(crate) fn forward<R: Real>(factor: &[R], x: &mut [R]) {
    for j in 0..x.len() {
        let (before, from_j) = x.split_at_mut_checked(j).unwrap_or((&mut [], &mut []));
        if let Some(value) = from_j.first_mut() {
            *value -= dot(before, row(factor, j).get(..j).unwrap_or(&[]));
        }
    }
}

/// x := L'^-1 x.
#[inline(always)]
pub(crate) fn backward<R: Real>(factor: &[R], x: &mut [R]) {
    for j in (0..x.len()).rev() {
        let (before, from_j) = x.split_at_mut_checked(j).unwrap_or((&mut [], &mut []));
        let value = from_j.first().copied().unwrap_or(R::ZERO);
        for (x, &l) in before.iter_mut().zip(row(factor, j)) {
            *x -= l * value;
        }
    }
}

/// x := D^-1 x.
#[inline(always)]
pub(crate) fn scale_by_inverse_diagonal<R: Real>(factor: &[R], x: &mut [R]) {
    for (j, value) in x.iter_mut().enumerate() {
        *value *= inverse_pivot(factor, j);
    }
}

/// x := A^-1 x.
#[inline(always)]
pub(crate) fn solve<R: Real>(factor: &[R], x: &mut [R]) {
    forward(factor, x);
    scale_by_inverse_diagonal(factor, x);
    backward(factor, x);
}

/// 1 / d_j.
#[inline(always)]
pub(crate) fn inverse_pivot<R: Real>(factor: &[R], j: usize) -> R {
    row(factor, j).last().copied().unwrap_or(R::ZERO)
}

/// X := L^-1 X for eight right-hand sides side by side.
#[inline(always)]
pub(crate) fn forward_lanes<R: Real>(factor: &[R], x: &mut [Lanes<R>]) {
    for j in 0..x.len() {
        let (before, from_j) = x.split_at_mut_checked(j).unwrap_or((&mut [], &mut []));
        if let Some(value) = from_j.first_mut() {
            let mut sum = *value;
            for (x, &l) in before.iter().zip(row(factor, j)) {
                lanes::subtract_scaled(&mut sum, l, x);
            }
            *value = sum;
        }
    }
}

/// [`factor`] of eight matrices side by side.
#[inline(always)]
pub(crate) fn factor_each<R: Real>(matrices: &mut [Lanes<R>], n: usize) {
    let tolerance = R::from_f64(DEPENDENT) * R::EPSILON;
    for j in 0..n {
        let Some((done, rest)) = matrices.split_at_mut_checked(packed_len(j)) else { return };
        let Some((diagonal, row_j)) = rest.get_mut(..=j).and_then(<[Lanes<R>]>::split_last_mut) else { return };
        for k in 0..j {
            let (before, from_k) = row_j.split_at_mut_checked(k).unwrap_or((&mut [], &mut []));
            if let Some(value) = from_k.first_mut() {
                let mut sum = *value;
                for (a, b) in before.iter().zip(row(done, k)) {
                    sum = lanes::minus_product(sum, *a, *b);
                }
                *value = sum;
            }
        }
        let mut pivot = *diagonal;
        for (k, value) in row_j.iter_mut().enumerate() {
            let inverse = row(done, k).last().copied().unwrap_or([R::ZERO; LANES]);
            let l = lanes::zip(value, &inverse, |value, inverse| value * inverse);
            pivot = lanes::minus_product(pivot, *value, l);
            *value = l;
        }
        let inverse = lanes::divisor(&pivot).map(|pivot| R::ONE / pivot);
        for l in 0..LANES {
            diagonal[l] = if pivot[l] > tolerance * diagonal[l] { inverse[l] } else { R::ZERO };
        }
    }
}

/// X := L^-1 X for eight systems side by side, of `N` right-hand sides each; rows before `first` are zero and stay so.
#[inline(always)]
pub(crate) fn forward_each<R: Real, const N: usize>(factors: &[Lanes<R>], first: usize, x: &mut [[Lanes<R>; N]]) {
    let mut rest = factors.get(packed_len(first)..).unwrap_or(&[]);
    for j in first..x.len() {
        let Some((row, after)) = rest.split_at_checked(j + 1) else { return };
        rest = after;
        let (before, from_j) = x.split_at_mut_checked(j).unwrap_or((&mut [], &mut []));
        if let Some(value) = from_j.first_mut() {
            let mut sums = *value;
            let (before, row) = (before.get(first..).unwrap_or(&[]), row.get(first..).unwrap_or(&[]));
            for (x, l) in before.iter().zip(row) {
                for n in 0..N {
                    sums[n] = lanes::minus_product(sums[n], x[n], *l);
                }
            }
            *value = sums;
        }
    }
}

/// X := D^-1 X for eight systems side by side.
#[inline(always)]
pub(crate) fn scale_each<R: Real>(factors: &[Lanes<R>], x: &mut [Lanes<R>]) {
    for (j, value) in x.iter_mut().enumerate() {
        let inverse = row(factors, j).last().copied().unwrap_or([R::ZERO; LANES]);
        *value = lanes::zip(value, &inverse, |value, inverse| value * inverse);
    }
}

/// Right-hand sides, one for each system.
#[inline(always)]
pub(crate) fn one_each_mut<R>(x: &mut [Lanes<R>]) -> &mut [[Lanes<R>; 1]] {
    x.as_chunks_mut().0
}

/// X := A^-1 X for eight systems side by side.
#[inline(always)]
pub(crate) fn solve_each<R: Real>(factors: &[Lanes<R>], x: &mut [Lanes<R>]) {
    forward_each::<R, 1>(factors, 0, one_each_mut(x));
    scale_each(factors, x);
    backward_each(factors, x);
}

/// X := L'^-1 X for eight systems side by side.
#[inline(always)]
pub(crate) fn backward_each<R: Real>(factors: &[Lanes<R>], x: &mut [Lanes<R>]) {
    for j in (0..x.len()).rev() {
        let (before, from_j) = x.split_at_mut_checked(j).unwrap_or((&mut [], &mut []));
        let value = from_j.first().copied().unwrap_or([R::ZERO; LANES]);
        for (x, l) in before.iter_mut().zip(row(factors, j)) {
            *x = lanes::minus_product(*x, *l, value);
        }
    }
}

/// Writes the diagonal of A^-1 to `diagonal`, using `inverse` (a packed triangle) for L^-1.
#[inline(always)]
pub(crate) fn inverse_diagonal<R: Real>(factor: &[R], n: usize, inverse: &mut [R], diagonal: &mut [R]) {
    for value in diagonal.iter_mut() {
        *value = R::ZERO;
    }
    for j in 0..n {
        // Row j of L^-1 is e_j - sum_k l_jk (row k of L^-1).
        let Some((done, rest)) = inverse.split_at_mut_checked(packed_len(j)) else { return };
        let row_j = rest.get_mut(..=j).unwrap_or(&mut []);
        for value in row_j.iter_mut() {
            *value = R::ZERO;
        }
        if let Some(value) = row_j.last_mut() {
            *value = R::ONE;
        }
        for (k, &l) in row(factor, j).get(..j).unwrap_or(&[]).iter().enumerate() {
            for (value, &other) in row_j.iter_mut().zip(row(done, k)) {
                *value -= l * other;
            }
        }
        let weight = inverse_pivot(factor, j);
        for (total, &value) in diagonal.iter_mut().zip(row_j.iter()) {
            *total += weight * value * value;
        }
    }
}

/// Adds `amount(j)` to diagonal entry j.
#[inline(always)]
pub(crate) fn add_diagonal<R: Real>(matrix: &mut [R], n: usize, amount: impl Fn(usize) -> R) {
    for j in 0..n {
        if let Some(value) = row_mut(matrix, j).last_mut() {
            *value += amount(j);
        }
    }
}
