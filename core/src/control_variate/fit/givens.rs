//! Least squares by Givens rotations, for samples so badly placed that normal equations lose their digits.

use super::super::config::{Config, Ridge};
use super::super::design::Design;
use super::super::per_channel::PerChannel;
use super::super::result::{self, Outcome};
use super::super::ridge;
use super::super::sums::Sums;
use crate::arena::Arena;
use crate::basis::Basis;
use crate::error::Error;
use crate::lanes::LANES;
use crate::linalg::givens;
use crate::matrix::{Panel, Triangle, at, copy, first_mut, from_mut, packed_len};
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
    let mut system = System::new(columns, channels, arena)?;
    let (x, solution, penalties) = (arena.take(columns)?, arena.take(columns)?, arena.zeros(columns)?);
    for (index, (panel, values)) in design.each_panel().enumerate() {
        for lane in 0..LANES.min(design.n.saturating_sub(index * LANES)) {
            let mut y = PerChannel::default();
            for (x, column) in x.iter_mut().zip(panel) {
                *x = at(column, lane);
            }
            for (y, values) in y.iter_mut().zip(values) {
                *y = at(values, lane);
            }
            system.add_row(x, &mut y);
        }
    }
    basis.penalties(from_mut(penalties, config.controls));
    let n = R::from_usize(design.n);
    // A column that hardly moves is noise as a whole: its size is that before centring.
    system.column_squares(solution);
    for (square, &mean) in solution.iter_mut().zip(design.column_means) {
        *square += n * mean * mean;
    }
    system.add_penalty(penalties, strength::<R>(config.ridge)? * n, solution, x);
    let (mut correction, mut residual) = (PerChannel::default(), PerChannel::default());
    for channel in 0..channels {
        system.solve(channel, solution);
        correction[channel] = solution.iter().zip(design.column_means).fold(R::ZERO, |sum, (&b, &m)| sum - b * m);
        residual[channel] = design.residual_square(channel, solution);
    }
    copy(x, design.column_means);
    let eccentricity = n * givens::inverse_square(&system.factor.view(), x);
    let variance = result::residual_variance(residual, columns, n, eccentricity);
    Ok(Outcome { correction, variance: variance.or_else(|| result::plain_variance(design)) })
}

/// Algorithm 1 from the triangular factor of the rows (1, functions); the estimate is in the sums' units.
pub(crate) fn from_factor<R: Real>(
    sums: &Sums<&[R]>,
    config: &Config,
    basis: &Basis,
    channels: usize,
    arena: &mut Arena<'_, R>,
) -> Result<Outcome<R>, Error> {
    let terms = sums.gram.order();
    let mut system = System::new(terms, channels, arena)?;
    let (x, solution, penalties) = (arena.take(terms)?, arena.take(terms)?, arena.zeros(terms)?);
    copy(system.factor.entries_mut(), sums.gram.entries());
    for (out, rhs) in system.rhs.rows_mut().zip(sums.rhs.rows()) {
        copy(out, rhs);
    }
    basis.penalties(from_mut(penalties, 1 + config.controls));
    let first = sums.gram.at(0, 0);
    let count = first * first;
    system.column_squares(solution);
    system.add_penalty(penalties, strength::<R>(config.ridge)? * count, solution, x);
    let (mut correction, mut residuals) = (PerChannel::default(), PerChannel::default());
    for channel in 0..channels {
        system.solve(channel, solution);
        // The functions' integrals are zero.
        correction[channel] = at(solution, 0);
        // What no fit explains, and what this one leaves of the rest because of its penalty.
        residuals[channel] = sums.square(channel);
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
    let eccentricity = (count * givens::inverse_square(&system.factor.view(), x) - R::ONE).max(R::ZERO);
    let variance = result::residual_variance(residuals, terms - 1, count, eccentricity);
    Ok(Outcome { correction, variance })
}

/// For a factor whose first column is the constant 1: the sum of a right-hand side and of its squares.
pub(crate) fn totals<R: Real>(sums: &Sums<&[R]>, channel: usize) -> (R, R) {
    let square = sums.rhs.column(channel).fold(sums.square(channel), |sum, &z| sum + z * z);
    (sums.gram.at(0, 0) * sums.total(channel), square)
}

fn strength<R: Real>(ridge: Ridge) -> Result<R, Error> {
    match ridge {
        Ridge::Default => Ok(R::from_f64(FLOOR[usize::from(R::NARROW)])),
        Ridge::Fixed(_) => Ok(R::from_f64(ridge::least_squares::<R>(ridge))),
        Ridge::Auto => Err(Error::Unsupported),
    }
}

/// x := `value` e_j
fn unit<R: Real>(x: &mut [R], j: usize, value: R) {
    for (k, x) in x.iter_mut().enumerate() {
        *x = if k == j { value } else { R::ZERO };
    }
}

/// A triangular system to be solved.
struct System<'a, R> {
    factor: Triangle<&'a mut [R]>,
    /// A row for each column.
    rhs: Panel<&'a mut [R]>,
    channels: usize,
}

impl<'a, R: Real> System<'a, R> {
    /// Of no rows.
    fn new(columns: usize, channels: usize, arena: &mut Arena<'a, R>) -> Result<Self, Error> {
        let factor = Triangle::new(arena.zeros(packed_len(columns))?, columns)?;
        Ok(Self { factor, rhs: Panel::new(arena.zeros(columns * channels)?, channels), channels })
    }

    /// `x` and `y` are used up.
    fn add_row(&mut self, x: &mut [R], y: &mut PerChannel<R>) {
        let mut unexplained = PerChannel::<R>::default();
        let y = first_mut(&mut **y, self.channels);
        givens::add_row(&mut self.factor, &mut self.rhs, &mut *unexplained, x, y);
    }

    /// The squared length of each column.
    fn column_squares(&self, out: &mut [R]) {
        for (out, column) in out.iter_mut().zip(self.factor.rows()) {
            *out = column.iter().fold(R::ZERO, |sum, &r| sum + r * r);
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
                if let Some(r) = self.factor.at_mut(k, j)
                    && *r * *r <= noise * noise * square
                {
                    *r = R::ZERO;
                }
            }
            if penalty > R::ZERO {
                unit(x, j, (strength * penalty).sqrt());
                self.add_row(x, &mut PerChannel::default());
            }
        }
    }

    /// The coefficients of a channel.
    fn solve(&self, channel: usize, solution: &mut [R]) {
        for (out, &z) in solution.iter_mut().zip(self.rhs.column(channel)) {
            *out = z;
        }
        givens::solve(&self.factor.view(), solution);
    }
}
