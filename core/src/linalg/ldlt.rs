//! A = L D L' for symmetric positive semidefinite matrices: the direct solver of (4.27).

use crate::lanes::{self, LANES, Lanes, dot};
use crate::matrix::{Triangle, split_at};
use crate::real::{Real, rounding};
use core::ops::{Deref, DerefMut};

/// A factored matrix: L below the diagonal, and on it 1 / D.
///
/// 1 / d_j is 0 for a column that depends on the columns before it, so that its pivot is rounding noise: the solution
/// then does not use it.
pub(crate) struct Ldlt<S>(pub(crate) Triangle<S>);

impl<R: Real, S: DerefMut<Target = [R]>> Ldlt<S> {
    /// Factors a matrix in place.
    #[inline]
    pub(crate) fn new(mut matrix: Triangle<S>) -> Self {
        for j in 0..matrix.order() {
            let Some((l, row, diagonal)) = matrix.split(j) else { break };
            // First v_k = d_k l_jk, which the later entries of the row need, then l_jk itself.
            for k in 0..j {
                let Some((before, v_k)) = split_at(row, k) else { break };
                *v_k -= dot(before, l.left(k));
            }
            let mut pivot = *diagonal;
            for (k, value) in row.iter_mut().enumerate() {
                let l_jk = *value * l.diagonal(k);
                pivot -= *value * l_jk;
                *value = l_jk;
                lanes::keep_together();
            }
            *diagonal = if pivot > rounding::<R>() * *diagonal { R::ONE / pivot } else { R::ZERO };
        }
        Self(matrix)
    }
}

impl<R: Real, S: Deref<Target = [R]>> Ldlt<S> {
    /// 1 / d_j.
    pub(crate) fn inverse_pivot(&self, j: usize) -> R {
        self.0.diagonal(j)
    }

    /// x := L^-1 x.
    #[inline]
    pub(crate) fn forward(&self, x: &mut [R]) {
        for j in 0..x.len() {
            let Some((before, x_j)) = split_at(x, j) else { return };
            *x_j -= dot(before, self.0.left(j));
        }
    }

    /// X := L^-1 X for eight right-hand sides side by side.
    #[inline(always)]
    pub(crate) fn forward_lanes(&self, x: &mut [Lanes<R>]) {
        for j in 0..x.len() {
            let Some((before, x_j)) = split_at(x, j) else { return };
            let mut sum = *x_j;
            for (x, &l) in before.iter().zip(self.0.left(j)) {
                sum = lanes::minus_product(sum, [l; LANES], *x);
            }
            *x_j = sum;
        }
    }

    /// x := L'^-1 x.
    pub(crate) fn backward(&self, x: &mut [R]) {
        for j in (0..x.len()).rev() {
            let Some((before, &mut x_j)) = split_at(x, j) else { return };
            for (x, &l) in before.iter_mut().zip(self.0.left(j)) {
                *x -= l * x_j;
            }
        }
    }

    /// x := A^-1 x.
    pub(crate) fn solve(&self, x: &mut [R]) {
        self.forward(x);
        for (j, x_j) in x.iter_mut().enumerate() {
            *x_j *= self.inverse_pivot(j);
        }
        self.backward(x);
    }

    /// Writes the diagonal of A^-1 to `diagonal`; `inverse` is scratch for L^-1.
    pub(crate) fn inverse_diagonal(&self, mut inverse: Triangle<&mut [R]>, diagonal: &mut [R]) {
        diagonal.fill(R::ZERO);
        for j in 0..self.0.order() {
            // Row j of L^-1 is e_j - sum_k l_jk (row k of L^-1).
            let Some((done, row, one)) = inverse.split(j) else { return };
            row.fill(R::ZERO);
            *one = R::ONE;
            for (k, &l) in self.0.left(j).iter().enumerate() {
                for (value, &other) in row.iter_mut().zip(done.row(k)) {
                    *value -= l * other;
                }
            }
            let weight = self.inverse_pivot(j);
            for (total, &value) in diagonal.iter_mut().zip(inverse.row(j)) {
                *total += weight * value * value;
            }
        }
    }
}

/// [`Ldlt::new`] of eight matrices side by side, packed triangles of `n` rows.
// Without, and without it on `forward_each`, image fits take 2 % more instructions.
#[inline(always)]
pub(crate) fn factor_each<R: Real>(matrices: &mut [Lanes<R>], n: usize) {
    let mut matrices = Triangle::new(matrices, n);
    for j in 0..n {
        let Some((l, row, diagonal)) = matrices.split(j) else { return };
        for (k, l_k) in l.rows().enumerate() {
            let (Some((before, v_k)), Some(l_k)) = (split_at(row, k), l_k.get(..k)) else { return };
            [*v_k] = lanes::minus_products([*v_k], before.as_chunks().0, l_k);
        }
        let mut pivot = *diagonal;
        for (k, value) in row.iter_mut().enumerate() {
            let l_jk = lanes::zip(value, &l.diagonal(k), |value, inverse| value * inverse);
            pivot = lanes::minus_product(pivot, *value, l_jk);
            *value = l_jk;
        }
        let inverse = lanes::divisor(&pivot).map(|pivot| R::ONE / pivot);
        for lane in 0..LANES {
            diagonal[lane] = if pivot[lane] > rounding::<R>() * diagonal[lane] { inverse[lane] } else { R::ZERO };
        }
    }
}

/// X := L^-1 X for eight systems side by side, of `N` right-hand sides each; rows before `first` are zero and stay so.
#[inline(always)]
pub(crate) fn forward_each<R: Real, const N: usize>(factors: &[Lanes<R>], first: usize, x: &mut [[Lanes<R>; N]]) {
    let factors = Triangle::new(factors, x.len());
    for (j, row) in factors.rows().enumerate().skip(first) {
        let (Some((before, x_j)), Some(row)) = (split_at(x, j), row.get(first..j)) else { return };
        let Some(before) = before.get(first..) else { return };
        *x_j = lanes::minus_products(*x_j, before, row);
    }
}

/// The same for one right-hand side of each.
#[inline(always)]
pub(crate) fn forward_one<R: Real>(factors: &[Lanes<R>], first: usize, x: &mut [Lanes<R>]) {
    forward_each::<R, 1>(factors, first, x.as_chunks_mut().0);
}

/// X := A^-1 X for eight systems side by side.
pub(crate) fn solve_each<R: Real>(factors: &[Lanes<R>], x: &mut [Lanes<R>]) {
    forward_one(factors, 0, x);
    divide_each(factors, x);
    backward_each(factors, x);
}

/// X := D^-1 X for eight systems side by side.
#[inline(always)]
pub(crate) fn divide_each<R: Real>(factors: &[Lanes<R>], x: &mut [Lanes<R>]) {
    let pivots = Triangle::new(factors, x.len());
    for (j, x_j) in x.iter_mut().enumerate() {
        *x_j = lanes::zip(x_j, &pivots.diagonal(j), |x_j, inverse| x_j * inverse);
        lanes::keep_together();
    }
}

/// X := L'^-1 X for eight systems side by side.
pub(crate) fn backward_each<R: Real>(factors: &[Lanes<R>], x: &mut [Lanes<R>]) {
    let factors = Triangle::new(factors, x.len());
    for j in (0..x.len()).rev() {
        let Some((before, &mut x_j)) = split_at(x, j) else { return };
        for (x, l) in before.iter_mut().zip(factors.left(j)) {
            *x = lanes::minus_product(*x, *l, x_j);
        }
    }
}
