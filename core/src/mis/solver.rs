//! What becomes of the sums of optimal MIS.

use crate::error::Error;

/// The ridge of [`Solver::default`], in samples: less loses to the balance heuristic where a few samples must tell
/// apart densities that bring little, more gives away gain where they bring much.
pub const DEFAULT_RIDGE: f32 = 2.0;

/// The ridges that [`Solver::Ridge`] accepts.
pub const RIDGE_RANGE: core::ops::RangeInclusive<f32> = 1e-8..=1e8;

/// How [`OptimalMis::solve`](super::OptimalMis::solve) turns its sums into an estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solver {
    /// alpha = (A + L)^-1 b, with L = ridge (tr(N A) - 1) / n N^-1, N the diagonal matrix of the counts and n the
    /// number of samples. tr(N A) - 1 is how much the densities differ, so that the ridge counts for as much whether
    /// they differ much or little: for as many samples more, which know nothing of f. A larger ridge shrinks the
    /// estimate towards the balance heuristic's, more samples towards the plain solve's. L is at least 1e-8 tr(N A)
    /// N^-1. Consistent, not unbiased: alpha comes from the samples it is applied to.
    Ridge(f32),
    /// alpha = A^-1 b, the pseudo-inverse (of N^1/2 A N^1/2) where A is singular: the limit of a vanishing ridge. The
    /// estimate is sum_k alpha_k, the direct estimator of Kondapaneni et al. Consistent, not unbiased, and heavy-tailed
    /// where A is nearly singular: similar techniques, or few samples.
    Plain,
    /// Each batch with the alpha of the batches before it, as
    /// [`OptimalMis::next_batch`](super::OptimalMis::next_batch) left it. Unbiased.
    Progressive,
    /// The balance heuristic, alpha = 0. Unbiased.
    Balance,
}

impl Default for Solver {
    /// [`Solver::Ridge`] with [`DEFAULT_RIDGE`].
    fn default() -> Solver {
        Solver::Ridge(DEFAULT_RIDGE)
    }
}

impl Solver {
    /// Checks the ridge.
    ///
    /// # Errors
    /// [`Error::NotFinite`] for a ridge that is NaN or infinite, [`Error::Range`] outside [`RIDGE_RANGE`].
    pub fn check(self) -> Result<(), Error> {
        match self {
            Solver::Ridge(ridge) if !ridge.is_finite() => Err(Error::NotFinite),
            Solver::Ridge(ridge) if !RIDGE_RANGE.contains(&ridge) => Err(Error::Range),
            _ => Ok(()),
        }
    }
}
