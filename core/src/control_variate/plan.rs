//! How a configuration is carried out.

use super::config::{Config, Estimator, Ridge, Solver};
use crate::error::Error;

/// The most samples that [`Solver::Dual`] takes: its system is as large as they are.
const MAX_DUAL: usize = 4096;

/// Whether the estimate is the plain mean whatever the samples are.
///
/// What corrects some samples by fits to others undoes what is even about all of them, and errors on samples that a fit
/// has not seen do not show it.
pub(crate) fn is_plain(config: &Config, columns: usize) -> bool {
    let fits_all = matches!(config.estimator, Estimator::LeastSquares | Estimator::GradientDescent);
    columns == 0 || (config.stratified && !fits_all)
}

/// How a configuration is carried out.
#[derive(Clone, Copy)]
pub(crate) struct Plan {
    /// Functions, control functions included, the constant not.
    pub(crate) columns: usize,
    /// Whether fits go through the samples' n x n system.
    pub(crate) dual: bool,
}

impl Plan {
    #[inline(always)]
    pub(crate) fn new(config: &Config, functions: usize, n: usize) -> Result<Self, Error> {
        let columns = config.controls + functions;
        let dual = match config.solver {
            // Control functions are all but free of penalty, which the dual divides by.
            Solver::Auto => n <= columns && config.controls == 0,
            Solver::NormalEquations => false,
            Solver::Dual if config.controls > 0 => return Err(Error::Unsupported),
            Solver::Dual if n > MAX_DUAL => return Err(Error::Range),
            Solver::Dual => true,
            Solver::SquareRoot if config.estimator == Estimator::LeastSquares && config.ridge != Ridge::Auto => false,
            Solver::SquareRoot => return Err(Error::Unsupported),
        };
        Ok(Self { columns, dual })
    }
}
