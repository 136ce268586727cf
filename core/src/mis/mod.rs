//! Multiple importance sampling: several densities for one integral (section 2.2.2).
//!
//! With n_j samples x_ij of technique j, whose density is p_j, and weights w_j(x) that sum to one over the techniques
//! and vanish where p_j does, the estimator
//!
//! `F = sum_j sum_i w_j(x_ij) f(x_ij) / (n_j p_j(x_ij))`  (2.10)
//!
//! is unbiased wherever at least one density covers f. [`balance`], [`power`], [`cutoff`] and [`maximum`] are the
//! weights of Veach and Guibas (1995); [`OptimalMis`] finds those of least variance, (2.15), from the samples.

mod heuristics;
pub(crate) mod linear;
pub(crate) mod optimal;
mod solver;
mod weight;

pub use heuristics::{DEFAULT_BETA, balance, cutoff, maximum, power};
pub use linear::MAX_TECHNIQUES;
pub use optimal::{OptimalMis, len};
pub use solver::{DEFAULT_RIDGE, RIDGE_RANGE, Solver};
pub use weight::optimal_contribution;
