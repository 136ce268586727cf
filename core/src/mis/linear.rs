//! The symmetric systems of optimal MIS.

use super::solver::Solver;
use crate::linalg::ldlt::Ldlt;
use crate::matrix::{Triangle, copy, first, first_mut, packed_len};
use core::array::from_fn;
use core::iter;

/// The most techniques that one call combines.
pub const MAX_TECHNIQUES: usize = 16;

pub(crate) type Vector = [f64; MAX_TECHNIQUES];
/// A packed triangle.
pub(crate) type Cells = [f64; packed_len(MAX_TECHNIQUES)];
type Matrix = [Vector; MAX_TECHNIQUES];

/// Eigenvalues below this part of the largest are taken for rounding errors of 0.
const RANK_TOLERANCE: f64 = 1e-12;
/// The least ridge, as a part of the trace: densities are `f32`, and what they differ by is divided by its size. Where
/// they are less than about a part in 10,000 apart their rounding would be most of it.
const LEAST_RIDGE: f64 = 1e-8;
/// Samples that have decayed to fewer count as so many, which leaves a ridge that is large, and finite.
const LEAST_SAMPLES: f64 = 1e-8;

/// A system A x = b for any number of right-hand sides, solved as M = N^1/2 A N^1/2 / `divisor`.
///
/// With N the counts, `scale` the diagonal of N^1/2, and A / `divisor` per round, M's largest eigenvalue tends to 1,
/// with `scale` as its vector, whatever the techniques and counts are: the scale on which a ridge or a rank means the
/// same everywhere.
pub(crate) struct System {
    factor: Factor,
    scale: Vector,
    n: usize,
    divisor: f64,
}

#[allow(clippy::large_enum_variant, reason = "there is no allocator for a box")]
enum Factor {
    /// x is 0.
    Zero,
    /// M = L D L', factored.
    Definite(Cells),
    /// M = V D V', the rows of V', and 1 / D.
    Spectral(Matrix, Vector),
}

impl System {
    /// For the packed triangle A of `n` rows, which was estimated from so many `samples`.
    pub(crate) fn new(solver: Solver, a: &[f64], divisor: f64, scale: Vector, n: usize, samples: f64) -> Self {
        let mut cells = [0.0; packed_len(MAX_TECHNIQUES)];
        copy(&mut cells, a);
        each_product(&mut cells, first(&scale, n), |cell, product| *cell = product * (*cell / divisor));
        let mut m = Triangle::new(&mut cells[..], n);
        let factor = match solver {
            Solver::Plain => spectral(&m),
            Solver::Ridge(ridge) => {
                let trace = (0..n).map(|j| m.diagonal(j)).sum::<f64>();
                // Of it, about 1 belongs to what all densities have in common: the counts' weighted sum of the
                // densities over S is 1 at every sample.
                let scale = first(&scale, n);
                let common = m.quadratic(scale) / scale.iter().map(|entry| entry * entry).sum::<f64>();
                let penalty = f64::from(ridge) * (trace - common) / samples.max(LEAST_SAMPLES);
                m.add_to_diagonal(iter::repeat(penalty.max(LEAST_RIDGE * trace)));
                Ldlt::new(m);
                Factor::Definite(cells)
            }
            _ => Factor::Zero,
        };
        Self { factor, scale, n, divisor }
    }

    /// x = N^1/2 M^-1 N^1/2 b / divisor.
    pub(crate) fn solve(&self, b: &[f64]) -> Vector {
        let mut x = Vector::default();
        x.iter_mut().zip(b.iter().zip(&self.scale)).for_each(|(x, (b, scale))| *x = scale * (b / self.divisor));
        match &self.factor {
            Factor::Zero => return Vector::default(),
            Factor::Definite(cells) => {
                Ldlt(Triangle::new(&cells[..], self.n)).solve(first_mut(&mut x, self.n));
            }
            Factor::Spectral(vectors, inverse) => {
                let b = core::mem::take(&mut x);
                for (row, inverse) in vectors.iter().zip(inverse).take(self.n) {
                    let along = inverse * row.iter().zip(&b).take(self.n).map(|(v, b)| v * b).sum::<f64>();
                    x.iter_mut().zip(row).take(self.n).for_each(|(x, v)| *x += along * v);
                }
            }
        }
        x.iter_mut().zip(&self.scale).for_each(|(x, scale)| *x *= scale);
        x
    }
}

/// Adds `part` x x' to a packed triangle.
pub(crate) fn add_products(cells: &mut [f64], x: &[f64], part: f64) {
    each_product(cells, x, |cell, product| *cell += part * product);
}

/// Calls `change` with each entry of a packed triangle and that of x x'.
fn each_product(cells: &mut [f64], x: &[f64], change: impl Fn(&mut f64, f64)) {
    for (line, row) in Triangle::new(cells, x.len()).rows_mut().zip(x) {
        for (cell, column) in line.iter_mut().zip(x) {
            change(cell, row * column);
        }
    }
}

/// By Jacobi rotations. It solves in the least-squares sense of least norm: the pseudo-inverse.
fn spectral(triangle: &Triangle<&mut [f64]>) -> Factor {
    let n = triangle.order().min(MAX_TECHNIQUES);
    let mut m: Matrix = from_fn(|j| from_fn(|k| triangle.at(j.max(k), j.min(k))));
    let mut vectors: Matrix = from_fn(|j| from_fn(|k| if j == k { 1.0 } else { 0.0 }));
    // Convergence is quadratic: 16 unknowns need about 8 sweeps.
    for _ in 0..30 {
        let mut rotated = false;
        for p in 0..n {
            for q in p + 1..n {
                rotated |= rotate(&mut m, &mut vectors, p, q, n);
            }
        }
        if !rotated {
            break;
        }
    }
    let values: Vector = from_fn(|i| m[i][i]);
    let largest = values.iter().take(n).fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let mut inverse = Vector::default();
    for (inverse, value) in inverse.iter_mut().zip(values).filter(|(_, value)| value.abs() > RANK_TOLERANCE * largest) {
        *inverse = 1.0 / value;
    }
    Factor::Spectral(vectors, inverse)
}

/// One Jacobi rotation that makes `m[p][q]` zero; the rows of `vectors` turn with it. False if it already was
/// negligible.
fn rotate(m: &mut Matrix, vectors: &mut Matrix, p: usize, q: usize, n: usize) -> bool {
    let (p, q) = (p % MAX_TECHNIQUES, q % MAX_TECHNIQUES);
    let off = m[p][q];
    let size = libm::sqrt((m[p][p] * m[q][q]).abs());
    // Relative to the diagonal, so that small eigenvalues keep their digits; the floor ends it where one of them is 0.
    let floor = f64::EPSILON * f64::EPSILON * (m[p][p].abs() + m[q][q].abs());
    if off.abs() <= 0.5 * f64::EPSILON * size || off.abs() <= floor {
        return false;
    }
    let theta = (m[q][q] - m[p][p]) / (2.0 * off);
    let root = theta.abs() + libm::sqrt(1.0 + theta * theta);
    let t = if theta < 0.0 { -1.0 / root } else { 1.0 / root };
    let cos = 1.0 / libm::sqrt(1.0 + t * t);
    let sin = t * cos;
    m[p][p] -= t * off;
    m[q][q] += t * off;
    (m[p][q], m[q][p]) = (0.0, 0.0);
    let turned = |along_p: f64, along_q: f64| (cos * along_p - sin * along_q, sin * along_p + cos * along_q);
    for k in (0..n).map(|k| k % MAX_TECHNIQUES).filter(|&k| k != p && k != q) {
        (m[k][p], m[k][q]) = turned(m[k][p], m[k][q]);
        (m[p][k], m[q][k]) = (m[k][p], m[k][q]);
    }
    if let Ok([row_p, row_q]) = vectors.get_disjoint_mut([p, q]) {
        row_p.iter_mut().zip(row_q).for_each(|(p, q)| (*p, *q) = turned(*p, *q));
    }
    true
}
