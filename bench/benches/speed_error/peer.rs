//! Algorithm 1 as published, re-implemented: what the library is compared with in the same run.
//!
//! Monomials up to a total degree, the system (4.27) updated sample by sample (4.28), a general dense solver that sizes
//! and allocates its matrices when called, then the integral of the fit plus the mean of its residuals on the same
//! samples. The thesis solves by complete orthogonal decomposition (section 4.3.5), which is QR with column pivoting
//! wherever the system has full rank; Cholesky is what is usual. As in code that is written for readability, the basis
//! functions of a sample are a fresh vector whenever they are needed: two allocations for each sample.

use nalgebra::{DMatrix, DVector};
use noisefloor_tests::legendre;

/// How the system is solved.
#[derive(Clone, Copy)]
pub(crate) enum Solver {
    /// QR with column pivoting: for any matrix.
    Qr,
    /// For positive definite matrices.
    Cholesky,
}

/// The published estimator for one size.
pub(crate) struct Peer {
    exponents: Vec<Vec<usize>>,
    solver: Solver,
}

impl Peer {
    pub(crate) fn new(dims: usize, order: usize, solver: Solver) -> Self {
        Self { exponents: legendre::terms(dims, order), solver }
    }

    /// The monomials at `u`.
    fn basis(&self, u: &[f32]) -> DVector<f64> {
        let power = |x: f64, exponent: usize| (0..exponent).fold(1.0, |product, _| product * x);
        DVector::from_iterator(
            self.exponents.len(),
            self.exponents.iter().map(|powers| u.iter().zip(powers).map(|(&x, &k)| power(x.into(), k)).product()),
        )
    }

    /// The estimate; NaN if the system cannot be solved.
    pub(crate) fn estimate(&self, u: &[f32], f: &[f32]) -> f32 {
        let terms = self.exponents.len();
        let dims = u.len() / f.len();
        let mut matrix = DMatrix::<f64>::zeros(terms, terms);
        let mut rhs = DVector::<f64>::zeros(terms);
        for (u, &f) in u.chunks_exact(dims).zip(f) {
            let p = self.basis(u);
            matrix.ger(1.0, &p, &p, 1.0);
            rhs.axpy(f.into(), &p, 1.0);
        }
        let Some(theta) = solve(matrix, &rhs, self.solver) else { return f32::NAN };
        let integral =
            |exponents: &Vec<usize>| exponents.iter().map(|&power| 1.0 / (power + 1) as f64).product::<f64>();
        let fit: f64 = self.exponents.iter().zip(theta.iter()).map(|(powers, theta)| integral(powers) * theta).sum();
        let mut residuals = 0.0;
        for (u, &f) in u.chunks_exact(dims).zip(f) {
            let p = self.basis(u);
            residuals += f64::from(f) - p.dot(&theta);
        }
        (fit + residuals / f.len() as f64) as f32
    }
}

/// The solution, factors and all in fresh memory.
pub(crate) fn solve(matrix: DMatrix<f64>, rhs: &DVector<f64>, solver: Solver) -> Option<DVector<f64>> {
    match solver {
        Solver::Qr => matrix.col_piv_qr().solve(rhs),
        Solver::Cholesky => matrix.cholesky().map(|factor| factor.solve(rhs)),
    }
}
