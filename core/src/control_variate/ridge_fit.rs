//! One ridge fit to a design, with its leave-one-out residuals in closed form.
//!
//! With the intercept free, columns centred (P), values centred (f), A = P'P + L and b = A^-1 P'f, the residual of
//! sample i under the fit to all others is
//!
//! r_i = (f_i - b'p_i) / (1 - h_i),   h_i = 1/n + p_i' A^-1 p_i,
//!
//! and the estimate that corrects each sample by the fit to the others is the mean of
//!
//! y_i = f_i - b'q_i + (q_i' A^-1 p_i) r_i
//!
//! where q_i = p_i + m is the column before centring, whose integral is zero. For a fixed L that mean is exactly
//! unbiased although every sample serves both the fit and the estimate.
//!
//! The estimate of the fit to all, mean f - b'm, has the weight 1/n - m'A^-1 p_i on sample i. The sum of (1 - n m'A^-1
//! p_i)^2 r_i^2 is therefore n^2 times its variance whatever the noise depends on (White 1980; HC3 of MacKinnon and
//! White 1985).

use super::Config;
use super::design::Design;
use super::per_channel::{PerChannel, get, set};
use crate::arena::Arena;
use crate::error::Error;
use crate::lanes::{self, LANES, Lanes};
use crate::linalg::{ldlt, packed_len, row, row_mut};
use crate::real::Real;
use crate::rows::{rows, rows_mut};

/// What one ridge fit says, in the design's units.
#[derive(Clone, Copy, Default)]
pub(crate) struct RidgeFit<R> {
    /// The sum of squared leave-one-out residuals.
    pub(crate) press: PerChannel<R>,
    /// The sum of squares of those residuals times n times the weight of their sample in the estimate.
    pub(crate) influence: PerChannel<R>,
    /// The mean of y_i minus the mean of f_i: what leaving one out adds to the plain mean.
    pub(crate) leave_one_out: PerChannel<R>,
    /// -b'm: what the fit to all samples adds to the plain mean (Alg. 1).
    pub(crate) in_sample: PerChannel<R>,
    /// n sum_i (m'A^-1 p_i)^2: how far the columns' means are from their integrals, as the fit measures distance.
    pub(crate) eccentricity: R,
    /// The effective number of coefficients, tr(P A^-1 P').
    pub(crate) freedom: R,
}

/// Which fit.
#[derive(Clone, Copy)]
pub(crate) struct Choice<'a, R> {
    /// Ridge strength per sample.
    pub(crate) strength: R,
    /// Relative penalty of each column.
    pub(crate) penalties: &'a [R],
    /// Whether the leave-one-out figures are wanted.
    pub(crate) leave_one_out: bool,
}

/// The smallest 1 - h that a division is trusted with, in units of the type's epsilon.
const SMALLEST_GAP: f64 = 64.0;

/// Numbers that [`primal`] takes from its arena.
pub(crate) fn primal_size(columns: usize, channels: usize) -> usize {
    packed_len(columns) + columns * (1 + channels) + columns * LANES
}

/// The fit through the normal equations. `coefficients`, if wanted, gets a row for each channel.
#[inline(always)]
pub(crate) fn primal<R: Real>(
    design: &Design<'_, R>,
    gram: &[R],
    rhs: &[R],
    choice: Choice<'_, R>,
    coefficients: Option<&mut [R]>,
    mut arena: Arena<'_, R>,
) -> Result<RidgeFit<R>, Error> {
    let columns = design.columns;
    let n = R::from_usize(design.n);
    let factor = arena.take(packed_len(columns))?;
    let means = arena.take(columns)?;
    let solution = arena.take(columns * design.channels)?;
    let z = arena.take_lanes(columns)?;
    for (factor, &gram) in factor.iter_mut().zip(gram) {
        *factor = gram;
    }
    let strength = choice.strength * n;
    ldlt::add_diagonal(factor, columns, |j| strength * choice.penalties.get(j).copied().unwrap_or(R::ONE));
    ldlt::factor(factor, columns);

    // Everything below lives in the coordinates z = L^-1 p, where A^-1 is diagonal.
    for (out, &mean) in means.iter_mut().zip(design.column_means.iter()) {
        *out = mean;
    }
    ldlt::forward(factor, means);
    let mut fit = RidgeFit::default();
    for (channel, solution) in rows_mut(solution, columns).enumerate() {
        let rhs = rhs.get(channel * columns..).unwrap_or(&[]);
        for (out, &rhs) in solution.iter_mut().zip(rhs) {
            *out = rhs;
        }
        ldlt::forward(factor, solution);
        let mut in_sample = R::ZERO;
        for (j, (value, &mean)) in solution.iter_mut().zip(means.iter()).enumerate() {
            *value *= ldlt::inverse_pivot(factor, j);
            in_sample -= *value * mean;
        }
        set(&mut fit.in_sample, channel, in_sample);
    }
    if choice.leave_one_out {
        residuals(design, factor, means, solution, z, &mut fit);
    }
    if let Some(coefficients) = coefficients {
        for solution in rows_mut(solution, columns) {
            ldlt::backward(factor, solution);
        }
        copy_padded(coefficients, solution);
    }
    Ok(fit)
}

/// The leave-one-out figures, eight samples at a time.
#[inline(always)]
fn residuals<R: Real>(
    design: &Design<'_, R>,
    factor: &[R],
    means: &[R],
    solution: &[R],
    z: &mut [Lanes<R>],
    fit: &mut RidgeFit<R>,
) {
    let columns = means.len();
    let n = R::from_usize(design.n);
    let inverse_n = R::ONE / n;
    let smallest_gap = R::from_f64(SMALLEST_GAP) * R::EPSILON;
    let zero = [R::ZERO; LANES];
    let [mut press, mut influences, mut corrections] = [[zero; Config::MAX_CHANNELS]; 3];
    let (mut freedom, mut eccentricity) = (zero, zero);
    for (panel, values) in design.each_panel() {
        for (z, column) in z.iter_mut().zip(panel) {
            *z = *column;
        }
        ldlt::forward_lanes(factor, z);
        // leverage = p'A^-1 p, shift = m'A^-1 p
        let (mut leverage, mut shift) = (zero, zero);
        for (j, (z, &mean)) in z.iter().zip(means).enumerate() {
            let pivot = ldlt::inverse_pivot(factor, j);
            let scaled_mean = mean * pivot;
            let z = *z;
            for l in 0..LANES {
                leverage[l] += z[l] * z[l] * pivot;
                shift[l] += z[l] * scaled_mean;
            }
        }
        freedom = lanes::zip(&freedom, &leverage, |a, b| a + b);
        lanes::add_product(&mut eccentricity, &shift, &shift);
        let (mut gap, mut weight) = (zero, zero);
        for l in 0..LANES {
            gap[l] = R::ONE / (R::ONE - inverse_n - leverage[l]).max(smallest_gap);
            weight[l] = R::ONE - n * shift[l];
        }
        let sums = press.iter_mut().zip(&mut influences).zip(&mut corrections);
        for ((values, solution), ((press, influences), corrections)) in
            values.iter().zip(rows(solution, columns)).zip(sums)
        {
            let mut residual = *values;
            for (z, &weight) in z.iter().zip(solution) {
                lanes::subtract_scaled(&mut residual, weight, z);
            }
            let (mut press_sum, mut influence_sum, mut correction_sum) = (*press, *influences, *corrections);
            for l in 0..LANES {
                let residual = residual[l] * gap[l];
                let influence = residual * weight[l];
                press_sum[l] += residual * residual;
                influence_sum[l] += influence * influence;
                correction_sum[l] += (leverage[l] + shift[l]) * residual;
            }
            (*press, *influences, *corrections) = (press_sum, influence_sum, correction_sum);
        }
    }
    fit.freedom = lanes::sum(&freedom);
    fit.eccentricity = lanes::sum(&eccentricity) * n;
    let sums = press.iter().zip(&influences).zip(&corrections).enumerate();
    for (channel, ((press, influences), corrections)) in sums.take(design.channels) {
        set(&mut fit.press, channel, lanes::sum(press));
        set(&mut fit.influence, channel, lanes::sum(influences));
        let correction = lanes::sum(corrections) * inverse_n;
        let in_sample = get(&fit.in_sample, channel);
        set(&mut fit.leave_one_out, channel, in_sample + correction);
    }
}

/// The samples' n x n matrix K = P D^-1 P' over all columns, for relative penalties D, and g = P D^-1 m.
pub(crate) struct Dual<'a, R> {
    kernel: &'a mut [R],
    shift: &'a mut [R],
}

/// Numbers that the dual fits of `n` samples take from their arena.
pub(crate) fn dual_size(n: usize, channels: usize) -> Option<usize> {
    let padded = n.checked_next_multiple_of(LANES)?;
    let triangle = padded.checked_mul(padded + 1)? / 2;
    triangle.checked_mul(3)?.checked_add(padded * (3 + channels))
}

impl<'a, R: Real> Dual<'a, R> {
    #[inline(always)]
    pub(crate) fn new(design: &Design<'_, R>, penalties: &[R], arena: &mut Arena<'a, R>) -> Result<Self, Error> {
        let padded = design.n.next_multiple_of(LANES);
        let kernel = arena.take(packed_len(padded))?;
        let shift = arena.take(padded)?;
        for value in shift.iter_mut() {
            *value = R::ZERO;
        }
        let weight = |j: usize| R::ONE / penalties.get(j).copied().unwrap_or(R::ONE);
        for (a, (left, _)) in design.each_panel().enumerate() {
            for (b, (right, _)) in design.each_panel().enumerate().take(a + 1) {
                let mut tile = [[R::ZERO; LANES]; LANES];
                for (j, (left, right)) in left.iter().zip(right).enumerate() {
                    let weight = weight(j);
                    for (row, &value) in tile.iter_mut().zip(left) {
                        lanes::add_scaled(row, weight * value, right);
                    }
                }
                for (i, tile_row) in tile.iter().enumerate() {
                    let row = row_mut(kernel, a * LANES + i);
                    for (out, &value) in row.iter_mut().skip(b * LANES).zip(tile_row) {
                        *out = value;
                    }
                }
            }
            let shift = shift.get_mut(a * LANES..(a + 1) * LANES).unwrap_or(&mut []);
            for (j, (column, &mean)) in left.iter().zip(design.column_means.iter()).enumerate() {
                let weight = weight(j) * mean;
                for (shift, &value) in shift.iter_mut().zip(column) {
                    *shift += weight * value;
                }
            }
        }
        Ok(Self { kernel, shift })
    }

    /// The fit with ridge strength `choice.strength` over all columns. With B = K + strength n I,
    ///
    /// b = D^-1 P' B^-1 f,   h_i - 1/n = 1 - strength n (B^-1)_ii,   m'A^-1 p_i = (B^-1 g)_i.
    #[inline(always)]
    pub(crate) fn fit(
        &self,
        design: &Design<'_, R>,
        choice: Choice<'_, R>,
        coefficients: Option<&mut [R]>,
        mut arena: Arena<'_, R>,
    ) -> Result<RidgeFit<R>, Error> {
        let n = design.n;
        let count = R::from_usize(n);
        let inverse_n = R::ONE / count;
        let strength = choice.strength * count;
        let factor = arena.take(packed_len(n))?;
        let inverse = arena.take(packed_len(n))?;
        let diagonal = arena.take(n)?;
        let shift = arena.take(n)?;
        let alpha = arena.take(n * design.channels)?;
        for (out, &value) in factor.iter_mut().zip(self.kernel.iter()) {
            *out = value;
        }
        // K annihilates 1, so B^-1 holds 11'/(s n) beside which all else is small for a small strength s. With
        // c 11'/n added to B, c = tr K / n, that part is 11'/((s + c) n), and f and g, orthogonal to 1, see no change.
        let trace = (0..n).fold(R::ZERO, |sum, i| sum + diagonal_entry(self.kernel, i));
        let lift = trace * inverse_n;
        for value in factor.iter_mut() {
            *value += lift * inverse_n;
        }
        let left = strength / (strength + lift);
        ldlt::add_diagonal(factor, n, |_| strength);
        ldlt::factor(factor, n);
        for (out, &value) in shift.iter_mut().zip(self.shift.iter()) {
            *out = value;
        }
        ldlt::solve(factor, shift);
        if choice.leave_one_out {
            ldlt::inverse_diagonal(factor, n, inverse, diagonal);
        }
        let smallest_gap = R::from_f64(SMALLEST_GAP) * R::EPSILON;
        let mut fit = RidgeFit::default();
        for &value in shift.iter() {
            fit.eccentricity += value * value;
        }
        fit.eccentricity *= count;
        for &value in diagonal.iter() {
            fit.freedom += R::ONE - strength * value;
        }
        fit.freedom -= R::ONE - left;
        for (channel, alpha) in rows_mut(alpha, n).enumerate() {
            let value = |i: usize| {
                let panel = design.values.get(i / LANES * design.channels + channel);
                panel.and_then(|lanes| lanes.get(i % LANES)).copied().unwrap_or(R::ZERO)
            };
            for (i, out) in alpha.iter_mut().enumerate() {
                *out = value(i);
            }
            ldlt::solve(factor, alpha);
            let (mut in_sample, mut correction) = (R::ZERO, R::ZERO);
            let (mut press, mut influences) = (R::ZERO, R::ZERO);
            for (i, &alpha) in alpha.iter().enumerate() {
                in_sample -= self.shift.get(i).copied().unwrap_or(R::ZERO) * alpha;
                let complement = strength * diagonal.get(i).copied().unwrap_or(R::ZERO);
                let gap = (complement - left * inverse_n).max(smallest_gap);
                let residual = strength * alpha / gap;
                let shift = shift.get(i).copied().unwrap_or(R::ZERO);
                let influence = residual * (R::ONE - count * shift);
                press += residual * residual;
                influences += influence * influence;
                let leverage = R::ONE - complement - (R::ONE - left) * inverse_n;
                correction += (leverage + shift) * residual;
            }
            set(&mut fit.press, channel, press);
            set(&mut fit.influence, channel, influences);
            set(&mut fit.in_sample, channel, in_sample);
            set(&mut fit.leave_one_out, channel, in_sample + correction * inverse_n);
        }
        if let Some(coefficients) = coefficients {
            for (out, alpha) in rows_mut(coefficients, design.columns).zip(rows(alpha, n)) {
                for (j, out) in out.iter_mut().enumerate() {
                    let mut total = R::ZERO;
                    for ((panel, _), alpha) in design.each_panel().zip(alpha.chunks(LANES)) {
                        let column = panel.get(j).map_or(&[] as &[R], |column| column);
                        total += column.iter().zip(alpha).map(|(&p, &a)| p * a).fold(R::ZERO, |a, b| a + b);
                    }
                    *out = total / choice.penalties.get(j).copied().unwrap_or(R::ONE);
                }
            }
        }
        Ok(fit)
    }
}

/// Copies, and fills what is left with zeros.
#[inline(always)]
pub(crate) fn copy_padded<R: Real>(out: &mut [R], values: &[R]) {
    let mut values = values.iter();
    for out in out {
        *out = values.next().copied().unwrap_or(R::ZERO);
    }
}

/// The diagonal entry j of a packed matrix.
#[inline(always)]
pub(crate) fn diagonal_entry<R: Real>(matrix: &[R], j: usize) -> R {
    row(matrix, j).last().copied().unwrap_or(R::ZERO)
}
