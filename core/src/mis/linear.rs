//! Symmetric systems of at most 16 unknowns, two ways.

use super::limits::MAX_TECHNIQUES;

pub(crate) type Vector = [f64; MAX_TECHNIQUES];
pub(crate) type Matrix = [Vector; MAX_TECHNIQUES];

/// Something that solves M x = b for any number of right-hand sides; only the first `n` unknowns are used.
pub(crate) enum Factor {
    /// Of x = 0, whatever b is.
    Zero,
    Cholesky {
        lower: Matrix,
        n: usize,
    },
    Spectral {
        vectors: Matrix,
        inverse: Vector,
        n: usize,
    },
}

/// Eigenvalues below this part of the largest are taken for rounding errors of 0.
const RANK_TOLERANCE: f64 = 1e-12;

impl Factor {
    /// M = L L', for a positive definite M of which the lower triangle is read.
    pub(crate) fn cholesky(mut lower: Matrix, n: usize) -> Factor {
        let n = n.min(MAX_TECHNIQUES);
        for j in 0..n {
            let pivot = lower[j].iter().take(j).fold(lower[j][j], |sum, &x| sum - x * x);
            // Never met with the ridge this crate adds; it only keeps nonsense finite.
            let root = libm::sqrt(pivot.max(f64::MIN_POSITIVE));
            lower[j][j] = root;
            for i in j + 1..n {
                let sum = dot(&lower[i], &lower[j], j);
                lower[i][j] = (lower[i][j] - sum) / root;
            }
        }
        Factor::Cholesky { lower, n }
    }

    /// M = V D V' by Jacobi rotations, for any symmetric M given in full. It then solves in the least-squares sense of
    /// least norm: the pseudo-inverse.
    pub(crate) fn spectral(mut m: Matrix, n: usize) -> Factor {
        let n = n.min(MAX_TECHNIQUES);
        let mut vectors = Matrix::default();
        for (i, row) in vectors.iter_mut().enumerate() {
            row[i] = 1.0;
        }
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
        let mut values = Vector::default();
        for (i, (value, row)) in values.iter_mut().zip(&m).enumerate() {
            *value = row[i];
        }
        let largest = values.iter().take(n).fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let mut inverse = Vector::default();
        for (inverse, value) in
            inverse.iter_mut().zip(values).filter(|(_, value)| value.abs() > RANK_TOLERANCE * largest)
        {
            *inverse = 1.0 / value;
        }
        Factor::Spectral { vectors, inverse, n }
    }

    pub(crate) fn solve(&self, b: &Vector) -> Vector {
        let mut x = Vector::default();
        match self {
            Factor::Zero => {}
            Factor::Cholesky { lower, n } => {
                let n = (*n).min(MAX_TECHNIQUES);
                // L y = b, then L' x = y with one row of L at a time.
                for i in 0..n {
                    x[i] = (b[i] - dot(&lower[i], &x, i)) / lower[i][i];
                }
                for i in (0..n).rev().map(|i| i % MAX_TECHNIQUES) {
                    let solved = x[i] / lower[i][i];
                    x.iter_mut().zip(&lower[i]).take(i).for_each(|(x, l)| *x -= l * solved);
                    x[i] = solved;
                }
            }
            Factor::Spectral { vectors, inverse, n } => {
                for (row, inverse) in vectors.iter().zip(inverse).take(*n) {
                    let along = dot(row, b, *n) * inverse;
                    x.iter_mut().zip(row).take(*n).for_each(|(x, v)| *x += along * v);
                }
            }
        }
        x
    }

    /// N^1/2 M^-1 N^1/2 b / divisor, for `scale`, the diagonal of N^1/2: with M from [`scaled`], A^-1 b.
    pub(crate) fn solve_scaled(&self, scale: &Vector, b: &[f64], divisor: f64) -> Vector {
        let mut right = Vector::default();
        right.iter_mut().zip(b.iter().zip(scale)).for_each(|(out, (b, scale))| *out = scale * (b / divisor));
        let mut x = self.solve(&right);
        x.iter_mut().zip(scale).for_each(|(x, scale)| *x *= scale);
        x
    }
}

/// N^1/2 (A / divisor) N^1/2, for the lower triangle of A by rows and `scale`, the diagonal of N^1/2.
///
/// With N the counts, and A per round, its largest eigenvalue tends to 1, with the counts' square roots as its vector,
/// whatever the techniques and counts are: the scale on which a ridge or a rank means the same everywhere.
pub(crate) fn scaled(cells: &[f64], divisor: f64, scale: &Vector, n: usize) -> Matrix {
    let mut matrix = Matrix::default();
    let mut cells = cells.iter();
    for j in 0..n.min(MAX_TECHNIQUES) {
        for (k, &cell) in (0..=j).zip(&mut cells) {
            let value = scale[j] * scale[k] * (cell / divisor);
            matrix[j][k] = value;
            matrix[k][j] = value;
        }
    }
    matrix
}

/// v' M v, for v the direction of `scale`: the part of the trace of [`scaled`]'s matrix, about 1, that belongs to what
/// all densities have in common. The counts' weighted sum of the densities over S is 1 at every sample.
pub(crate) fn along(matrix: &Matrix, scale: &Vector, n: usize) -> f64 {
    let sum: f64 = matrix.iter().zip(scale).take(n).map(|(row, entry)| entry * dot(row, scale, n)).sum();
    sum / dot(scale, scale, n)
}

/// The dot product of the first `n` entries.
fn dot(a: &Vector, b: &Vector, n: usize) -> f64 {
    a.iter().zip(b).take(n).map(|(a, b)| a * b).sum()
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
    m[p][q] = 0.0;
    m[q][p] = 0.0;
    for k in (0..n).map(|k| k % MAX_TECHNIQUES).filter(|&k| k != p && k != q) {
        let (along_p, along_q) = (m[k][p], m[k][q]);
        m[k][p] = cos * along_p - sin * along_q;
        m[k][q] = sin * along_p + cos * along_q;
        m[p][k] = m[k][p];
        m[q][k] = m[k][q];
    }
    let (row_p, row_q) = (vectors[p], vectors[q]);
    for (out, (along_p, along_q)) in vectors[p].iter_mut().zip(row_p.iter().zip(&row_q)) {
        *out = cos * along_p - sin * along_q;
    }
    for (out, (along_p, along_q)) in vectors[q].iter_mut().zip(row_p.iter().zip(&row_q)) {
        *out = sin * along_p + cos * along_q;
    }
    true
}
