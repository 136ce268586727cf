//! Least squares by Givens rotations, for samples so badly placed that normal equations lose their digits.

use super::super::config::Config;
use super::super::per_channel::PerChannel;
use super::super::result::{self, Outcome};
use super::super::ridge;
use super::super::sums::{Layout, Sums, not_below_zero};
use crate::arena::Arena;
use crate::basis::Basis;
use crate::linalg::givens;
use crate::matrix::{at, copy, first_mut, from_mut};
use crate::real::{Real, rounding};

/// Strength of the penalty that makes the solution unique: its square root, which is what rows see, is the type's
/// rounding noise. For `f64` and for narrower types.
const FLOOR: [f64; 2] = [1e-24, 1e-12];

/// Numbers that [`least_squares`] takes from its arena.
pub(crate) fn size(layout: Layout) -> usize {
    layout.len() + 3 * layout.terms()
}

/// Algorithm 1 from the triangular factor of the rows (1, functions); the estimate is in the sums' units.
#[inline(never)]
pub(crate) fn least_squares<R: Real>(
    sums: &Sums<&[R]>,
    config: &Config,
    basis: &Basis,
    arena: &mut Arena<'_, R>,
) -> Outcome<R> {
    let (layout, terms) = (sums.layout(), sums.gram.order());
    let mut system = layout.group_mut(arena.zeros(layout.len()), 0);
    let (x, solution, penalties) = (arena.take(terms), arena.take(terms), arena.zeros(terms));
    copy(system.gram.entries_mut(), sums.gram.entries());
    for (out, rhs) in system.rhs.rows_mut().zip(sums.rhs.rows()) {
        copy(out, rhs);
    }
    basis.penalties(from_mut(penalties, 1 + config.controls));
    let count = sums.count();
    // The squared length of each column, until there is a solution.
    for (square, column) in solution.iter_mut().zip(system.gram.rows()) {
        *square = column.iter().fold(R::ZERO, |sum, &r| sum + r * r);
    }
    let strength = R::from_f64(ridge::strength::<R>(config.ridge, FLOOR[usize::from(R::NARROW)]));
    add_penalty(&mut system, penalties, strength * count, solution, x);
    let (mut correction, mut residuals) = (PerChannel::default(), PerChannel::default());
    for channel in 0..layout.channels {
        for (out, &z) in solution.iter_mut().zip(system.rhs.column(channel)) {
            *out = z;
        }
        givens::solve(&system.gram, solution);
        // The functions' integrals are zero.
        correction[channel] = at(solution, 0);
        // What no fit explains, and what this one leaves of the rest because of its penalty.
        residuals[channel] = at(sums.square, channel);
        for j in 0..terms {
            let mut left = sums.rhs.at(j, channel);
            for (k, &value) in solution.iter().enumerate().skip(j) {
                left -= value * sums.gram.at(k, j);
            }
            residuals[channel] += left * left;
        }
    }
    // The constant is the first column, and has a share of 1 in its own variance.
    unit(x, 0, R::ONE);
    let eccentricity = not_below_zero(count * givens::inverse_square(&system.gram, x) - R::ONE);
    let variance = result::residual_variance(residuals, layout.columns, count, eccentricity);
    Outcome { correction, variance: Some(variance) }
}

/// x := `value` e_j
fn unit<R: Real>(x: &mut [R], j: usize, value: R) {
    x.fill(R::ZERO);
    if let Some(x_j) = x.get_mut(j) {
        *x_j = value;
    }
}

/// Adds a row sqrt(strength penalty_j) e_j for each column with a penalty; `x` is scratch.
///
/// Where columns depend on each other, a row of the factor is rounding noise with a right-hand side that is not: the
/// quotient would be anything. What is noise in a column of the squared length given is therefore zero.
fn add_penalty<R: Real>(system: &mut Sums<&mut [R]>, penalties: &[R], strength: R, squares: &[R], x: &mut [R]) {
    let noise = rounding::<R>();
    let channels = system.channels();
    for (j, &penalty) in penalties.iter().enumerate() {
        for (k, &square) in squares.iter().enumerate().skip(j) {
            if let Some(r) = system.gram.at_mut(k, j)
                && *r * *r <= noise * noise * square
            {
                *r = R::ZERO;
            }
        }
        if penalty > R::ZERO {
            unit(x, j, (strength * penalty).sqrt());
            system.add(x, first_mut(&mut *PerChannel::default(), channels));
        }
    }
}
