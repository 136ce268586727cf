//! Least squares by Givens rotations, for samples so badly placed that normal equations lose their digits.

use super::config::{Config, Ridge};
use super::design::Design;
use super::moments::Moments;
use super::per_channel::{PerChannel, set};
use super::result::{self, Outcome};
use super::ridge_fit;
use crate::arena::Arena;
use crate::basis::Basis;
use crate::error::Error;
use crate::lanes::LANES;
use crate::linalg::{givens, packed_len, row, row_mut};
use crate::real::Real;

/// Strength of the penalty that makes the solution unique: its square root, which is what rows see, is the type's
/// rounding noise. For `f64` and for narrower types.
const FLOOR: [f64; 2] = [1e-24, 1e-12];

/// An entry below this fraction of its column, in units of the type's epsilon, is rounding noise.
const NOISE: f64 = 64.0;

/// Numbers that [`least_squares`] takes from its arena.
pub(crate) fn size(columns: usize, channels: usize) -> usize {
    packed_len(columns) + columns * (channels + 3)
}

/// Algorithm 1 on a centred design.
#[inline(never)]
pub(crate) fn least_squares<R: Real>(
    design: &Design<'_, R>,
    config: &Config,
    basis: &Basis,
    arena: &mut Arena<'_, R>,
) -> Result<Outcome<R>, Error> {
    let (columns, channels) = (design.columns, design.channels);
    let factor = arena.take(packed_len(columns))?;
    let rhs = arena.take(columns * channels)?;
    let x = arena.take(columns)?;
    let solution = arena.take(columns)?;
    let penalties = arena.take(columns)?;
    for value in factor.iter_mut().chain(rhs.iter_mut()).chain(penalties.iter_mut()) {
        *value = R::ZERO;
    }
    let mut residual = PerChannel::default();
    let mut unexplained = PerChannel::default();
    for (index, (panel, values)) in design.each_panel().enumerate() {
        for lane in 0..LANES.min(design.n.saturating_sub(index * LANES)) {
            let mut y = PerChannel::default();
            let at = |lanes: &[R; LANES]| lanes.get(lane).copied().unwrap_or(R::ZERO);
            for (x, column) in x.iter_mut().zip(panel) {
                *x = at(column);
            }
            for (y, values) in y.iter_mut().zip(values) {
                *y = at(values);
            }
            givens::add_row(factor, rhs, &mut unexplained, x, y.get_mut(..channels).unwrap_or(&mut []));
        }
    }
    basis.penalties(penalties.get_mut(config.controls..).unwrap_or(&mut []));
    let strength = strength::<R>(config.ridge)? * R::from_usize(design.n);
    let mut triangle = Triangle { factor, rhs, channels };
    // A column that hardly moves is noise as a whole: its size is that before centring.
    let n = R::from_usize(design.n);
    triangle.column_squares(solution);
    for (square, &mean) in solution.iter_mut().zip(design.column_means.iter()) {
        *square += n * mean * mean;
    }
    triangle.add_penalty(penalties, strength, solution, x);
    let mut correction = PerChannel::default();
    for channel in 0..channels {
        givens::solve(triangle.factor, triangle.rhs, channels, channel, solution);
        let value = solution.iter().zip(design.column_means.iter()).fold(R::ZERO, |sum, (&b, &m)| sum - b * m);
        set(&mut correction, channel, value);
        set(&mut residual, channel, design.residual_square(channel, solution));
    }
    ridge_fit::copy_padded(x, design.column_means);
    let eccentricity = n * givens::inverse_square(triangle.factor, x);
    let variance = result::residual_variance(residual, columns, n, eccentricity);
    Ok(Outcome { correction, variance: variance.or_else(|| result::plain_variance(design)) })
}

/// Algorithm 1 from the triangular factor of the rows (1, functions); the estimate is in the sums' units.
pub(crate) fn from_factor<R: Real>(
    sums: &Moments<'_, R>,
    config: &Config,
    basis: &Basis,
    terms: usize,
    channels: usize,
    arena: &mut Arena<'_, R>,
) -> Result<Outcome<R>, Error> {
    let factor = arena.take(packed_len(terms))?;
    let rhs = arena.take(terms * channels)?;
    let x = arena.take(terms)?;
    let solution = arena.take(terms)?;
    let penalties = arena.take(terms)?;
    ridge_fit::copy_padded(factor, sums.gram);
    ridge_fit::copy_padded(rhs, sums.rhs);
    for value in penalties.iter_mut() {
        *value = R::ZERO;
    }
    basis.penalties(penalties.get_mut(1 + config.controls..).unwrap_or(&mut []));
    let first = sums.gram.first().copied().unwrap_or(R::ZERO);
    let count = first * first;
    let mut triangle = Triangle { factor, rhs, channels };
    triangle.column_squares(solution);
    triangle.add_penalty(penalties, strength::<R>(config.ridge)? * count, solution, x);
    let mut correction = PerChannel::default();
    let mut residuals = PerChannel::default();
    for channel in 0..channels {
        givens::solve(triangle.factor, triangle.rhs, channels, channel, solution);
        // The functions' integrals are zero.
        set(&mut correction, channel, solution.first().copied().unwrap_or(R::ZERO));
        // What no fit explains, and what this one leaves of the rest because of its penalty.
        let mut residual = sums.square(channel);
        for j in 0..terms {
            let mut left = sums.rhs.get(j * channels + channel).copied().unwrap_or(R::ZERO);
            for (k, &value) in solution.iter().enumerate().skip(j) {
                left -= value * row(sums.gram, k).get(j).copied().unwrap_or(R::ZERO);
            }
            residual += left * left;
        }
        set(&mut residuals, channel, residual);
    }
    // The constant is the first column, and has a share of 1 in its own variance.
    for (k, x) in x.iter_mut().enumerate() {
        *x = if k == 0 { R::ONE } else { R::ZERO };
    }
    let eccentricity = (count * givens::inverse_square(triangle.factor, x) - R::ONE).max(R::ZERO);
    let variance = result::residual_variance(residuals, terms.saturating_sub(1), count, eccentricity);
    Ok(Outcome { correction, variance })
}

fn strength<R: Real>(ridge: Ridge) -> Result<R, Error> {
    match ridge {
        Ridge::Default => Ok(R::from_f64(FLOOR[usize::from(R::NARROW)])),
        Ridge::Fixed(_) => Ok(R::from_f64(super::ridge::least_squares::<R>(ridge))),
        Ridge::Auto => Err(Error::Unsupported),
    }
}

/// A triangular system to be solved.
struct Triangle<'a, R> {
    factor: &'a mut [R],
    rhs: &'a mut [R],
    channels: usize,
}

impl<R: Real> Triangle<'_, R> {
    /// The squared length of each column.
    fn column_squares(&self, out: &mut [R]) {
        for (k, out) in out.iter_mut().enumerate() {
            *out = row(self.factor, k).iter().fold(R::ZERO, |sum, &r| sum + r * r);
        }
    }

    /// Adds a row sqrt(strength penalty_j) e_j for each column with a penalty; `x` is scratch.
    ///
    /// Where columns depend on each other, a row of the factor is rounding noise with a right-hand side that is not:
    /// the quotient would be anything. What is noise in a column of the squared length given is therefore zero.
    fn add_penalty(&mut self, penalties: &[R], strength: R, squares: &[R], x: &mut [R]) {
        let noise = R::from_f64(NOISE) * R::EPSILON;
        for (j, &penalty) in penalties.iter().enumerate() {
            for (k, &square) in squares.iter().enumerate().skip(j) {
                if let Some(r) = row_mut(self.factor, k).get_mut(j)
                    && *r * *r <= noise * noise * square
                {
                    *r = R::ZERO;
                }
            }
            if penalty <= R::ZERO {
                continue;
            }
            for (k, x) in x.iter_mut().enumerate() {
                *x = if k == j { (strength * penalty).sqrt() } else { R::ZERO };
            }
            let mut y = PerChannel::default();
            let mut spent = PerChannel::default();
            givens::add_row(self.factor, self.rhs, &mut spent, x, y.get_mut(..self.channels).unwrap_or(&mut []));
        }
    }
}
