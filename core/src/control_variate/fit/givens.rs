//! Least squares by Givens rotations, for samples so badly placed that normal equations lose their digits.

use super::super::config::Config;
use super::super::per_channel::PerChannel;
use super::super::result::{self, Outcome};
use super::super::ridge;
use super::super::sums::{Layout, Sums, not_below_zero};
use crate::arena::Arena;
use crate::basis::Basis;
use crate::linalg::givens;
use crate::matrix::{at, copy, from_mut, set};
use crate::real::{Real, rounding};
use core::mem::take;

/// Strength of the penalty that makes the solution unique: its square root, which is what rows see, is the type's
/// rounding noise. For `f64` and for narrower types.
const FLOOR: [f64; 2] = [1e-24, 1e-12];

/// Numbers that [`least_squares`] takes from its arena.
pub(crate) fn size(layout: Layout) -> usize {
    let wide = widened(layout);
    wide.len() + 3 * layout.terms() + wide.channels
}

/// Beside the values a unit matrix: what becomes of it says how much each row of the factor counts in the estimate.
fn widened(layout: Layout) -> Layout {
    Layout { channels: layout.channels + layout.terms(), ..layout }
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
    let wide = widened(layout);
    let mut system = wide.group_mut(arena.zeros(wide.len()), 0);
    let (x, solution, penalties) = (arena.take(terms), arena.take(terms), arena.zeros(terms));
    let y = arena.take(wide.channels);
    copy(system.gram.entries_mut(), sums.gram.entries());
    for (j, (out, rhs)) in system.rhs.rows_mut().zip(sums.rhs.rows()).enumerate() {
        copy(out, rhs);
        unit(from_mut(out, layout.channels), j, R::ONE);
    }
    basis.penalties(from_mut(penalties, 1 + config.controls));
    let count = sums.count();
    // The squared length of each column, until there is a solution.
    for (square, column) in solution.iter_mut().zip(system.gram.rows()) {
        *square = column.iter().fold(R::ZERO, |sum, &r| sum + r * r);
    }
    remove_noise(&mut system, solution, x, y);
    let strength = R::from_f64(ridge::strength::<R>(config.ridge, FLOOR[usize::from(R::NARROW)])) * count;
    for (j, &penalty) in penalties.iter().enumerate().filter(|(_, penalty)| **penalty > R::ZERO) {
        unit(x, j, (strength * penalty).sqrt());
        y.fill(R::ZERO);
        system.add(x, y);
    }
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
    // The estimate is the sum of x_j z_j over the rows, their values z a sum of those before there was a penalty.
    unit(x, 0, R::ONE);
    givens::solve_transposed(&system.gram, x);
    // The constant is the first column, and has a share of 1 in its own variance.
    let mut square = R::ZERO;
    for j in layout.channels..wide.channels {
        let weight = x.iter().zip(system.rhs.column(j)).fold(R::ZERO, |sum, (&x, &z)| sum + x * z);
        square += weight * weight;
    }
    let eccentricity = not_below_zero(count * square - R::ONE);
    let variance = result::residual_variance(residuals, layout.columns, count, eccentricity);
    Outcome { correction, variance: Some(variance) }
}

/// x := `value` e_j
fn unit<R: Real>(x: &mut [R], j: usize, value: R) {
    x.fill(R::ZERO);
    set(x, j, value);
}

/// Takes out each row of the factor whose pivot is noise in its column, of the squared length given: where columns
/// depend on each other, its quotient would be anything. What it says of later columns is left to the rows below; `x`
/// and `y` are scratch.
fn remove_noise<R: Real>(system: &mut Sums<&mut [R]>, squares: &[R], x: &mut [R], y: &mut [R]) {
    // The rounding of n rotations adds up as a random walk does.
    let noise = rounding::<R>() * (system.count().sqrt() * R::from_f64(0.125)).max(R::ONE);
    let is_noise = |r: R, square: R| r * r <= noise * noise * square;
    for (j, &square) in squares.iter().enumerate() {
        if !is_noise(system.gram.diagonal(j), square) {
            continue;
        }
        for (k, (x, &square)) in x.iter_mut().zip(squares).enumerate() {
            *x = system.gram.at_mut(k, j).map(take).filter(|&r| !is_noise(r, square)).unwrap_or_default();
        }
        for (y, z) in y.iter_mut().zip(system.rhs.row_mut(j)) {
            *y = take(z);
        }
        system.add(x, y);
    }
}
