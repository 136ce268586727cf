//! What each estimator is: the one place that decides what is done for a configuration.
//!
//! | [`Method`] | samples in arrays | a stream | unbiased | its error is told by |
//! |---|---|---|---|---|
//! | `Plain` | `batch` | `accumulator` | yes | the values' spread |
//! | `Robust` | `fitter` | `cross_fit::pooled` | nearly | residuals left out |
//! | `LeaveOneOut` | `fitter` | - | yes | residuals left out |
//! | `KFold` | `batch::k_fold` | `cross_fit::nested` | yes | residuals held out |
//! | `LeastSquares` | `fitter` | `accumulator` | O(1/n) | residuals |
//! | `SquareRoot` | as a stream | `fit::givens` | O(1/n) | residuals |
//! | `Descent` | `fit::descent` | `fit::descent` | no | residuals and the gradient |
//! | `Incremental` | as a stream | `incremental` | yes | the corrected values' spread |

use super::config::{Config, Estimator, Ridge, Solver};
use crate::error::{Error, ensure};
use crate::lanes::LANES;
use crate::real::Real;

/// The most samples whose sum, in a narrow type, one more surely shows in.
pub(crate) const NARROW_CAPACITY: usize = 1 << 22;
/// The most samples that [`Solver::Dual`] takes: its system is as large as they are.
const MAX_DUAL: usize = 4096;

/// How samples become an estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Method {
    /// The mean, whatever the samples are.
    Plain,
    /// The mean and two fits, weighed by their errors on samples that they have not seen.
    Robust,
    /// Each sample is corrected by the fit to the others.
    LeaveOneOut,
    /// Each fold is corrected by fits to the others.
    KFold,
    /// The fit's constant term, by normal equations or their dual.
    LeastSquares,
    /// The same, by Givens rotations.
    SquareRoot,
    /// The same, of a fit by gradient descent.
    Descent,
    /// Each sample is corrected by fits to those before it.
    Incremental,
}

impl Method {
    /// Whether samples in arrays go into sums one by one, as those of a stream do.
    pub(crate) fn streams(self) -> bool {
        matches!(self, Self::Incremental | Self::SquareRoot)
    }

    /// Of a fit of so many functions.
    pub(crate) fn of(config: &Config, columns: usize) -> Self {
        // What corrects some samples by fits to others undoes what is even about all of them, and errors on samples
        // that a fit has not seen do not show it.
        let fits_all = matches!(config.estimator, Estimator::LeastSquares | Estimator::GradientDescent);
        if columns == 0 || (config.stratified && !fits_all) {
            return Self::Plain;
        }
        match config.estimator {
            Estimator::Robust => Self::Robust,
            Estimator::LeaveOneOut => Self::LeaveOneOut,
            Estimator::KFold => Self::KFold,
            Estimator::LeastSquares if config.solver == Solver::SquareRoot => Self::SquareRoot,
            Estimator::LeastSquares => Self::LeastSquares,
            Estimator::GradientDescent => Self::Descent,
            Estimator::Incremental => Self::Incremental,
        }
    }
}

/// # Errors
/// [`Error::Unsupported`] for what a stream's sums cannot tell: leave-one-out errors need the samples.
pub(crate) fn check_stream(config: &Config) -> Result<(), Error> {
    let needs_samples = config.solver == Solver::Dual
        || config.estimator == Estimator::LeaveOneOut
        || config.estimator == Estimator::LeastSquares && config.ridge == Ridge::Auto;
    ensure(!needs_samples, Error::Unsupported)
}

/// The most samples whose fits go through their n x n system.
pub(crate) fn most_dual(config: &Config, columns: usize) -> usize {
    match config.solver {
        // Control functions are all but free of penalty, which the dual divides by.
        Solver::Auto if config.controls == 0 => columns,
        Solver::Dual => MAX_DUAL,
        _ => 0,
    }
}

/// How samples in arrays become an estimate.
#[derive(Clone, Copy)]
pub(crate) struct Plan {
    pub(crate) method: Method,
    /// Functions that are fitted, control functions included, the constant not.
    pub(crate) columns: usize,
    /// Whether fits go through the samples' n x n system.
    pub(crate) dual: bool,
}

impl Plan {
    /// # Errors
    /// [`Error::Range`] for more samples than the solver takes, or sums, eight side by side but where they stream, or
    /// counts of 32 bits hold.
    pub(crate) fn new<R: Real>(config: &Config, functions: usize, n: usize) -> Result<Self, Error> {
        let columns = config.controls + functions;
        let method = Method::of(config, columns);
        let solves = !matches!(method, Method::Plain | Method::Descent);
        ensure(config.solver != Solver::Dual || n <= MAX_DUAL || !solves, Error::Range)?;
        let most = if method.streams() { NARROW_CAPACITY } else { LANES * NARROW_CAPACITY };
        ensure(u32::try_from(n).is_ok() && (!R::NARROW || n <= most), Error::Range)?;
        let dual = n <= most_dual(config, columns);
        Ok(Self { method, columns: if method == Method::Plain { 0 } else { columns }, dual })
    }
}
