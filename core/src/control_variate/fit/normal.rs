//! The normal equations (4.27) and L D L'.

use super::super::config::Config;
use super::super::design::Design;
use super::super::per_channel::PerChannel;
use super::super::result::{self, Outcome};
use super::super::sums::{Layout, Sums, not_below_zero, residual_square, spread};
use super::super::trust::Centre;
use super::descent::{About, Objective};
use super::{Fit, Penalty};
use crate::arena::Arena;
use crate::lanes::{self, LANES, Lanes};
use crate::linalg::ldlt::Ldlt;
use crate::matrix::{Panel, Triangle, copy, packed_len, row_at, rows, set, split_at};
use crate::real::{Real, rounding};

/// A ridge problem whose intercept is free and eliminated.
pub(crate) struct Normal<'a, R> {
    /// The number of samples.
    pub(crate) count: R,
    /// P'P
    pub(crate) gram: Triangle<&'a mut [R]>,
    /// P'f, a row for each channel.
    pub(crate) rhs: Panel<&'a mut [R]>,
    /// What was subtracted from each column.
    pub(crate) means: &'a [R],
}

/// Numbers that [`Normal::fit`] takes from its arena.
pub(crate) fn fit_len(columns: usize, channels: usize) -> usize {
    packed_len(columns) + columns * (1 + channels) + columns * LANES
}

impl<'a, R: Real> Normal<'a, R> {
    /// Of the samples of a design.
    // Without, estimates of one pixel take 9 to 14 % more instructions.
    #[inline(always)]
    pub(crate) fn of(design: &Design<'a, R>, arena: &mut Arena<'a, R>) -> Self {
        let mut gram = arena.triangle(design.columns);
        let mut rhs = Panel::new(arena.take(design.columns * design.channels), design.columns);
        design.normal_equations(&mut gram, &mut rhs);
        Self { count: R::from_usize(design.n), gram, rhs, means: design.column_means }
    }

    /// P'P + L, factored.
    #[inline]
    fn factor<'f>(&self, penalty: Penalty<'_, R>, arena: &mut Arena<'f, R>) -> Ldlt<&'f mut [R]> {
        let mut matrix = arena.triangle(self.gram.order());
        copy(matrix.entries_mut(), self.gram.entries());
        let strength = penalty.strength * self.count;
        matrix.add_to_diagonal(penalty.relative.iter().map(|&relative| strength * relative));
        Ldlt::new(matrix)
    }

    #[inline(always)]
    pub(crate) fn fit(
        &self,
        design: &Design<'_, R>,
        penalty: Penalty<'_, R>,
        leave_one_out: bool,
        coefficients: Option<&mut [R]>,
        mut arena: Arena<'_, R>,
    ) -> Fit<R> {
        let columns = self.gram.order();
        let factor = self.factor(penalty, &mut arena);
        let means = arena.take(columns);
        let mut solution = Panel::new(arena.take(columns * design.channels), columns);
        let z = arena.take_lanes(columns);
        // Everything below lives in the coordinates z = L^-1 p, where A^-1 is diagonal.
        copy(means, self.means);
        factor.forward(means);
        let mut fit = Fit::default();
        for (channel, (solution, rhs)) in solution.rows_mut().zip(self.rhs.rows()).enumerate() {
            copy(solution, rhs);
            factor.forward(solution);
            for (j, (value, &mean)) in solution.iter_mut().zip(means.iter()).enumerate() {
                *value *= factor.inverse_pivot(j);
                fit.in_sample[channel] -= *value * mean;
            }
        }
        if leave_one_out {
            residuals(design, &factor, means, &solution, z, &mut fit);
        }
        if let Some(coefficients) = coefficients {
            for (out, solution) in Panel::new(coefficients, columns).rows_mut().zip(solution.rows()) {
                copy(out, solution);
                factor.backward(out);
            }
        }
        fit
    }

    /// Writes the coefficients of a fit, a row for each channel, and returns the factored matrix.
    pub(crate) fn solve<'f>(
        &self,
        penalty: Penalty<'_, R>,
        coefficients: &mut [R],
        arena: &mut Arena<'f, R>,
    ) -> Ldlt<&'f mut [R]> {
        let factor = self.factor(penalty, arena);
        for (out, rhs) in Panel::new(coefficients, self.gram.order()).rows_mut().zip(self.rhs.rows()) {
            copy(out, rhs);
            factor.solve(out);
        }
        factor
    }

    /// n sum_i (m'A^-1 p_i)^2 = n x'P'P x for x = A^-1 m.
    pub(crate) fn eccentricity(&self, factor: &Ldlt<&mut [R]>, arena: &mut Arena<'_, R>) -> R {
        let x = arena.take(self.gram.order());
        copy(x, self.means);
        factor.solve(x);
        not_below_zero(self.gram.quadratic(x)) * self.count
    }

    /// Where the samples of a fit lie.
    pub(crate) fn centre(
        &self,
        factor: &Ldlt<&mut [R]>,
        penalty: Penalty<'_, R>,
        mut arena: Arena<'_, R>,
    ) -> Centre<R> {
        let columns = self.gram.order();
        let (inverse, diagonal) = (arena.triangle(columns), arena.take(columns));
        factor.inverse_diagonal(inverse, diagonal);
        // tr(A^-1 P'P) = columns - tr(A^-1 L).
        let strength = penalty.strength * self.count;
        let mut freedom = R::from_usize(columns);
        for (&value, &relative) in diagonal.iter().zip(penalty.relative) {
            freedom -= strength * value * relative;
        }
        let eccentricity = self.eccentricity(factor, &mut arena);
        Centre::new(eccentricity, freedom, self.count)
    }
}

/// The leave-one-out figures, eight samples at a time.
#[inline(always)]
fn residuals<R: Real>(
    design: &Design<'_, R>,
    factor: &Ldlt<&mut [R]>,
    means: &[R],
    solution: &Panel<&mut [R]>,
    z: &mut [Lanes<R>],
    fit: &mut Fit<R>,
) {
    let n = R::from_usize(design.n);
    let inverse_n = R::ONE / n;
    let zero = [R::ZERO; LANES];
    let [mut press, mut influences, mut corrections] = [[zero; Config::MAX_CHANNELS]; 3];
    let (mut freedom, mut eccentricity) = (zero, zero);
    for (panel, values) in design.each_panel() {
        copy(z, panel);
        factor.forward_lanes(z);
        // leverage = p'A^-1 p, shift = m'A^-1 p
        let (mut leverage, mut shift) = (zero, zero);
        for (j, (z, &mean)) in z.iter().zip(means).enumerate() {
            let pivot = factor.inverse_pivot(j);
            let scaled_mean = mean * pivot;
            let z = *z;
            for l in 0..LANES {
                leverage[l] += z[l] * z[l] * pivot;
                shift[l] += z[l] * scaled_mean;
            }
        }
        freedom = lanes::zip(&freedom, &leverage, |a, b| a + b);
        eccentricity = lanes::plus_product(eccentricity, shift, shift);
        let (mut gap, mut weight) = (zero, zero);
        for l in 0..LANES {
            gap[l] = R::ONE / (R::ONE - inverse_n - leverage[l]).max(rounding());
            weight[l] = R::ONE - n * shift[l];
        }
        let sums = press.iter_mut().zip(&mut influences).zip(&mut corrections);
        for ((values, solution), ((press, influences), corrections)) in values.iter().zip(solution.rows()).zip(sums) {
            let mut residual = *values;
            for (z, &weight) in z.iter().zip(solution) {
                residual = lanes::minus_product(residual, [weight; LANES], *z);
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
        fit.press[channel] = lanes::sum(press);
        fit.influence[channel] = lanes::sum(influences);
        fit.leave_one_out[channel] = fit.in_sample[channel] + lanes::sum(corrections) * inverse_n;
    }
}

/// The normal equations of sums, and what they say about the values.
pub(crate) struct Centred<'a, R> {
    pub(crate) normal: Normal<'a, R>,
    /// The values' means.
    pub(crate) value_means: PerChannel<R>,
    /// The sums of squares about the means.
    pub(crate) squares: PerChannel<R>,
}

/// How many numbers a [`Centred`] and a fit to it take, its penalties and coefficients included.
pub(crate) fn len(Layout { columns, channels, .. }: Layout) -> usize {
    3 * packed_len(columns) + columns * (4 + 2 * channels)
}

/// Algorithm 1 from sums: what a fit to all samples adds to the mean.
pub(crate) fn least_squares<R: Real>(
    sums: &Sums<&[R]>,
    penalty: Penalty<'_, R>,
    arena: &mut Arena<'_, R>,
) -> Outcome<R> {
    let Layout { columns, channels, .. } = sums.layout();
    let coefficients = arena.take(columns * channels);
    let centred = Centred::new(sums, arena);
    let factor = centred.normal.solve(penalty, coefficients, arena);
    let eccentricity = centred.normal.eccentricity(&factor, arena);
    // Its residuals have mean zero: its intercept is the estimate.
    let correction = centred.intercepts(coefficients) - centred.value_means;
    let b = |channel| row_at(coefficients, columns, channel);
    let residual = PerChannel::of(channels, |channel| centred.residual_square(channel, b(channel)));
    let variance = result::residual_variance(residual, columns, centred.normal.count, eccentricity);
    Outcome { correction, variance: Some(variance) }
}

impl<'a, R: Real> Centred<'a, R> {
    /// Centres a group of sums that holds samples.
    pub(crate) fn new(sums: &Sums<&[R]>, arena: &mut Arena<'a, R>) -> Self {
        let Layout { columns, channels, .. } = sums.layout();
        let mut gram = arena.triangle(columns);
        let mut rhs = Panel::new(arena.take(columns * channels), columns);
        let means = arena.take(columns);
        let count = sums.count();
        let inverse = R::ONE / count;
        for j in 0..columns {
            let total = sums.column_total(j);
            set(means, j, total * inverse);
            let products = sums.gram.row(j + 1).iter().skip(1);
            for ((out, &value), &mean) in gram.row_mut(j).iter_mut().zip(products).zip(means.iter()) {
                *out = value - total * mean;
            }
        }
        let value_means = sums.totals() * inverse;
        let squares = spread(sums.squares(), sums.totals(), value_means);
        for (channel, (row, &mean)) in rhs.rows_mut().zip(&value_means.0).enumerate() {
            for (j, out) in row.iter_mut().enumerate() {
                *out = sums.rhs.at(j + 1, channel) - sums.column_total(j) * mean;
            }
        }
        for j in 0..columns {
            if gram.diagonal(j) > rounding::<R>() * sums.column_square(j) {
                continue;
            }
            // What is left of a column that hardly moves is rounding noise, and says nothing about the values.
            gram.row_mut(j).fill(R::ZERO);
            for k in j + 1..columns {
                set(gram.row_mut(k), j, R::ZERO);
            }
            for value in rhs.column_mut(j) {
                *value = R::ZERO;
            }
        }
        Self { normal: Normal { count, gram, rhs, means }, value_means, squares }
    }

    /// The intercepts that go with coefficients, a row for each channel.
    pub(crate) fn intercepts(&self, coefficients: &[R]) -> PerChannel<R> {
        let mut intercepts = self.value_means;
        for (intercept, b) in intercepts.0.iter_mut().zip(rows(coefficients, self.normal.means.len())) {
            *intercept = b.iter().zip(self.normal.means).fold(*intercept, |sum, (&b, &m)| sum - b * m);
        }
        intercepts
    }
}

impl<R: Real> Objective<R> for Centred<'_, R> {
    fn about(&self) -> About<'_, R> {
        let Normal { count, means, .. } = self.normal;
        About { count: count.to_f64() as usize, means, squares: self.squares }
    }

    /// (c - G b) / n; without a channel, G b / n.
    fn gradient(&self, channel: Option<usize>, b: &[R], gradient: &mut [R]) {
        let Normal { count, gram, rhs, .. } = &self.normal;
        let sign = if channel.is_some() { -R::ONE } else { R::ONE };
        gradient.fill(R::ZERO);
        if let Some(channel) = channel {
            copy(gradient, rhs.row(channel));
        }
        for (j, &value) in b.iter().enumerate() {
            let Some((before, own)) = split_at(gradient, j) else { break };
            let mut product = gram.diagonal(j) * value;
            for ((&gram, &other), out) in gram.left(j).iter().zip(b).zip(before) {
                product += gram * other;
                *out += sign * gram * value;
            }
            *own += sign * product;
        }
        let inverse = R::ONE / *count;
        for out in gradient.iter_mut() {
            *out *= inverse;
        }
    }

    fn residual_square(&self, channel: usize, b: &[R]) -> R {
        residual_square(self.squares[channel], &self.normal.gram, self.normal.rhs.row(channel).iter(), b)
    }

    fn column_square(&self, column: usize) -> R {
        self.normal.gram.diagonal(column)
    }
}
