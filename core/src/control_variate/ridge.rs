//! Ridge strengths and penalties.

use super::config::{Config, Estimator, Ridge};
use crate::basis::Basis;
use crate::matrix::halves_mut;
use crate::real::Real;

/// Strengths, per sample, of the fits of a mixture. More of them gain nothing that a test can see, and each costs time.
pub(crate) const MIXED: [f64; 2] = [2e-5, 0.02];
/// Strengths, per sample, that [`Ridge::Auto`] chooses from.
pub(crate) const CHOICES: [f64; 4] = [2e-5, 1e-3, 0.02, 0.2];
/// The most fits that are made of one design.
pub(crate) const MAX_FITS: usize = CHOICES.len();
/// The strength of [`Ridge::Default`] where there is one fit.
const DEFAULT: f64 = 0.01;
/// What keeps a least-squares system with too few samples solvable, for `f64` and for narrower types.
const FLOOR: [f64; 2] = [1e-10, 1e-6];
/// Relative penalty of a control function for strengths up to one, and above that its penalty: next to none, as its
/// maker vouches for it, and as it depends on the samples.
const CONTROL_PENALTY: f64 = 1e-7;

/// The smallest strength that a caller gets, for `f64` and for narrower types: with less, leverages lose their digits.
const SMALLEST: [f64; 2] = [1e-12, 1e-5];

/// How much stronger control functions are held where a fit is judged by what it says of samples left out: with less,
/// the leverage of a sample that alone moves one would be lost in rounding.
pub(crate) fn control_factor<R: Real>(config: &Config) -> R {
    let strength = strength::<R>(given(config), MIXED[0]);
    let least = if config.estimator == Estimator::LeastSquares { 0.0 } else { SMALLEST[usize::from(R::NARROW)] };
    R::from_f64((least / (strength.min(1.0) * CONTROL_PENALTY)).max(1.0))
}

/// The caller's strength, or without one `otherwise`.
pub(crate) fn strength<R: Real>(ridge: Ridge, otherwise: f64) -> f64 {
    match ridge {
        Ridge::Fixed(strength) => f64::from(strength).max(SMALLEST[usize::from(R::NARROW)]),
        Ridge::Default | Ridge::Auto => otherwise,
    }
}

/// The ridge that one integral's fits go by: the robust estimator's strengths are [`MIXED`], whatever is given.
fn given(config: &Config) -> Ridge {
    if config.estimator == Estimator::Robust { Ridge::Default } else { config.ridge }
}

/// The strength where there is one fit.
pub(crate) fn single<R: Real>(ridge: Ridge) -> f64 {
    strength::<R>(ridge, DEFAULT)
}

/// The strength of least squares: next to none.
pub(crate) fn least_squares<R: Real>(ridge: Ridge) -> f64 {
    strength::<R>(ridge, FLOOR[usize::from(R::NARROW)])
}

/// Relative penalties of control functions and basis, where `mean_square` is that of a control function's column.
pub(crate) fn penalties<R: Real>(config: &Config, basis: &Basis, mean_square: impl Fn(usize) -> R, out: &mut [R]) {
    let (controls, functions) = halves_mut(out, config.controls);
    let relative = CONTROL_PENALTY / strength::<R>(given(config), 1.0).max(1.0);
    for (j, penalty) in controls.iter_mut().enumerate() {
        *penalty = R::from_f64(relative) * mean_square(j);
    }
    basis.penalties(functions);
}
