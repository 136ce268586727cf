//! The fit by gradient descent (Alg. 2, 4.29).
//!
//! With orthonormal functions the loss is nearly round, so few steps do. Columns of degree k are scaled by 2^(1-k), so
//! that the early steps go where functions vary most. A fit that stopped early is a shrunk one: at low sample counts
//! this is safer than least squares, with no matrix at all.

use super::super::config::{Config, Estimate, Optimizer};
use super::super::design::{self, Design, square};
use super::super::folds::Subset;
use super::super::per_channel::PerChannel;
use super::super::plan::Plan;
use super::super::result::{self, Outcome, Summary};
use super::super::samples::{Reader, Samples};
use crate::arena::Arena;
use crate::basis::Basis;
use crate::error::{Error, ensure};
use crate::lanes::{self, LANES};
use crate::matrix::{at, copy, from_mut, rows_mut};
use crate::real::Real;

/// Steps, if the caller names none: half as many as samples, within these bounds. Stopping early shrinks the fit as a
/// ridge does, which few samples need.
const ITERATIONS: (usize, usize) = (8, 128);
/// Adam's step length in standard deviations of the values, if the caller names none.
const ADAM_RATE: f64 = 0.05;
/// Heavy-ball momentum, if the caller names none.
const MOMENTUM: f64 = 0.5;
/// Adam's decay of the first and second moment.
const ADAM_DECAY: [f64; 2] = [0.9, 0.999];
/// Rounds of power iteration for the largest curvature, which bounds the step.
const POWER_ROUNDS: usize = 12;

/// Numbers that a descent takes from its arena, its solution included.
pub(crate) fn size(columns: usize, channels: usize) -> usize {
    columns * (channels + 5)
}

/// Curvatures and gradients below this, in units of the functions' and the values' variance, are taken for rounding
/// noise of samples that all but coincide, for `f64` and for narrower types: a step of one over the curvature would go
/// anywhere.
const FLOOR: [f64; 2] = [1e-6, 1e-2];

/// A least-squares problem whose intercept was eliminated.
pub(crate) trait Objective<R> {
    fn about(&self) -> About<'_, R>;
    /// Half the negative gradient of the mean squared residual, P'(f - P b) / n; without a channel, P'P b / n.
    fn gradient(&self, channel: Option<usize>, b: &[R], out: &mut [R]);
    /// The sum of squared residuals, |f - P b|^2.
    fn residual_square(&self, channel: usize, b: &[R]) -> R;
    /// The sum of squares of a function.
    fn column_square(&self, column: usize) -> R;
}

/// What an objective was made of.
pub(crate) struct About<'a, R> {
    /// The number of samples.
    pub(crate) count: usize,
    /// The functions' means.
    pub(crate) means: &'a [R],
    /// The values' sums of squares.
    pub(crate) squares: PerChannel<R>,
}

/// As [`estimate`](crate::control_variate::estimate) by gradient descent, starting from `coefficients`, a row of
/// `terms - 1` numbers for each channel that is regressed, in the values' unit, and leaving the solution there: a
/// previous frame's solution is a good start for the next (section 4.2.6).
///
/// # Errors
/// As for [`estimate`](crate::control_variate::estimate) by this estimator, whose workspace it needs;
/// [`Error::Length`] for another number of coefficients, [`Error::NotFinite`] for a start that is not finite. The
/// coefficients are written only on success.
///
/// ```
/// use noisefloor::control_variate::{Config, Estimator, Samples, gradient_descent};
///
/// let config = Config { estimator: Estimator::GradientDescent, iterations: 200, ..Config::new(1, 1, 1) };
/// let samples = Samples::new(&[0.1, 0.3, 0.9], &[1.1, 1.3, 1.9]);
/// let mut slope = [0.0];
/// gradient_descent(&config, samples, &mut slope, &mut [0.0_f64; 64])?; // the next frame starts from `slope`
/// assert!((slope[0] - (1.0_f32 / 12.0).sqrt()).abs() < 0.01);
/// # Ok::<(), noisefloor::Error>(())
/// ```
#[inline(never)]
pub fn estimate_from<R: Real>(
    config: &Config,
    samples: Samples<'_>,
    coefficients: &mut [f32],
    workspace: &mut [R],
) -> Result<Estimate, Error> {
    let mut basis = Basis::empty();
    basis.set(config.basis, config.checked_shape()?);
    let reader = Reader::new(config, samples)?;
    Plan::new::<R>(config, basis.columns(), reader.len())?;
    let columns = config.controls + basis.columns();
    ensure(coefficients.len() == columns * reader.channels(), Error::Length)?;
    ensure(coefficients.iter().all(|value| value.is_finite()), Error::NotFinite)?;
    reader.check()?;
    let loaded = design::size(reader.len(), columns, reader.channels());
    let needed = loaded.and_then(|loaded| loaded.checked_add(size(columns, reader.channels())));
    let mut arena = Arena::new(workspace, needed)?;
    let design = Design::load(&reader, &basis, columns, Subset::ALL, true, &mut arena).ok_or(Error::NoSamples)?;
    let solutions = arena.take(coefficients.len());
    let (units, channel) = (design.units, |index: usize| index / columns.max(1));
    for (index, (out, &value)) in solutions.iter_mut().zip(&*coefficients).enumerate() {
        *out = units.stored_length(channel(index), value);
    }
    let summary = Summary::of(&design, &reader);
    let outcome = descend(&design, config, &basis, solutions, summary.variance, &mut arena);
    for (index, (out, &value)) in coefficients.iter_mut().zip(&*solutions).enumerate() {
        *out = result::saturate(units.length(channel(index), value));
    }
    Ok(summary.finish(outcome))
}

/// Improves the coefficients, a row for each channel, step by step, and says what they make of the plain mean and of
/// its variance. A descent that ends farther from the values than the plain mean is makes that of them; its
/// coefficients are zero then, unless they came nearer than the start.
#[inline(never)]
pub(crate) fn descend<R: Real>(
    objective: &impl Objective<R>,
    config: &Config,
    basis: &Basis,
    coefficients: &mut [R],
    plain: Option<PerChannel<R>>,
    arena: &mut Arena<'_, R>,
) -> Outcome<R> {
    let about = objective.about();
    let columns = about.means.len();
    let (gradient, first, second) = (arena.take(columns), arena.take(columns), arena.take(columns));
    let (scales, units) = (arena.take(columns), arena.take(columns));
    let n = R::from_usize(about.count);
    // One for the basis, and one over a control function's size, whose unit is its maker's; zero for one that does not
    // move.
    units.fill(R::ONE);
    for (column, unit) in units.iter_mut().enumerate().take(config.controls) {
        let square = objective.column_square(column);
        *unit = if square > R::ZERO { R::ONE / (square / n).sqrt().or_one() } else { R::ZERO };
    }
    copy(scales, units);
    basis.scales(from_mut(scales, config.controls));
    let curvature = match config.optimizer {
        Optimizer::Adam => R::ONE,
        Optimizer::Momentum | Optimizer::Plain => largest_curvature(objective, scales, first, gradient, second),
    };
    let variance_factor = variance_factor(&about, units);
    let mut outcome = Outcome { correction: PerChannel::default(), variance: plain };
    let steps = match config.iterations {
        0 => (about.count / 2).clamp(ITERATIONS.0, ITERATIONS.1),
        steps => steps,
    };
    for (channel, solution) in rows_mut(coefficients, columns).enumerate() {
        let square = about.squares[channel];
        // Of a start at zero there is nothing to compute.
        let is_cold = solution.iter().all(|&b| b == R::ZERO);
        let start = if is_cold { square } else { objective.residual_square(channel, solution) };
        let descent = Descent::new(config, (square / n).sqrt(), curvature);
        first.fill(R::ZERO);
        second.fill(R::ZERO);
        let mut bias = [R::ONE; 2];
        for _ in 0..steps {
            objective.gradient(Some(channel), solution, gradient);
            descent.step(solution, gradient, (scales, units), first, second, &mut bias);
        }
        let residual = objective.residual_square(channel, solution);
        let is_fit = residual <= square;
        if !is_fit {
            // What came nearer than its start is a start for the next.
            let is_nearer = residual < start;
            if !is_nearer {
                solution.fill(R::ZERO);
            }
            continue;
        }
        objective.gradient(Some(channel), solution, gradient);
        let (mut correction, mut rest) = (R::ZERO, R::ZERO);
        for (((&b, &g), &mean), &unit) in solution.iter().zip(gradient.iter()).zip(about.means).zip(units.iter()) {
            correction -= b * mean;
            // The curvature of orthonormal functions is one: the gradient is what the coefficients lack.
            rest += (g * unit) * (unit * mean);
        }
        outcome.correction[channel] = correction;
        if let Some(variance) = &mut outcome.variance {
            let own = variance_factor.map_or(variance[channel], |factor| residual * factor);
            // The square of what a descent to its end would still change.
            variance[channel] = own + rest * rest;
        }
    }
    outcome
}

/// What a sum of squared residuals of a descent is multiplied by to be a variance; None if no residual is left over to
/// tell.
///
/// As for least squares ([`result::residual_variance`]), with functions that the samples see as orthonormal, and of the
/// degrees of freedom one power less. What uncertain coefficients add is taken as 2 k times what k columns of a
/// finished fit would: a descent that stops early is wrong in all of them in the same way. It overstates the error of
/// one that nearly finished, up to 1.8 times on the test integrands, and several times where functions are tens.
fn variance_factor<R: Real>(about: &About<'_, R>, units: &[R]) -> Option<R> {
    let freedom = about.count.checked_sub(about.means.len() + 1).filter(|&freedom| freedom > 0)?;
    let (n, freedom) = (R::from_usize(about.count), R::from_usize(freedom));
    let means = about.means.iter().zip(units).map(|(&mean, &unit)| mean * unit);
    let square = means.fold(R::ZERO, |sum, mean| sum + mean * mean);
    let uncertain = R::ONE + R::from_usize(2 * about.means.len()) * square;
    let all = n - R::ONE;
    Some(uncertain * all * all / (n * freedom * freedom * freedom))
}

/// The step rule and its constants.
struct Descent<R> {
    optimizer: Optimizer,
    rate: R,
    momentum: R,
    /// Keeps Adam's quotient small where the gradient is noise, and finite where it is zero.
    smallest: R,
}

impl<R: Real> Descent<R> {
    fn new(config: &Config, deviation: R, curvature: R) -> Self {
        let is_adam = config.optimizer == Optimizer::Adam;
        let rate = match config.learning_rate {
            0.0 => R::from_f64(if is_adam { ADAM_RATE } else { 1.0 }),
            rate => R::from(rate),
        };
        let rate = if is_adam { rate * deviation } else { rate / curvature };
        let momentum = match config.optimizer {
            Optimizer::Plain => R::ZERO,
            _ if config.momentum > 0.0 => R::from(config.momentum),
            Optimizer::Momentum => R::from_f64(MOMENTUM),
            Optimizer::Adam => R::from_f64(ADAM_DECAY[0]),
        };
        Self { optimizer: config.optimizer, rate, momentum, smallest: floor::<R>() * deviation }
    }

    /// One step along the negative gradient, of lengths `scales` for gradients in `units`; `bias` holds the powers of
    /// Adam's decays so far.
    fn step(
        &self,
        solution: &mut [R],
        gradient: &[R],
        (scales, units): (&[R], &[R]),
        first: &mut [R],
        second: &mut [R],
        bias: &mut [R; 2],
    ) {
        if self.optimizer != Optimizer::Adam {
            for (((b, &g), velocity), &scale) in solution.iter_mut().zip(gradient).zip(first).zip(scales) {
                *velocity = self.momentum * *velocity + self.rate * scale * g;
                *b += scale * *velocity;
            }
            return;
        }
        let decay = R::from_f64(ADAM_DECAY[1]);
        bias[0] *= self.momentum;
        bias[1] *= decay;
        let unbias = [R::ONE / (R::ONE - bias[0]), R::ONE / (R::ONE - bias[1])];
        let columns = solution.iter_mut().zip(gradient).zip(first).zip(second).zip(scales).zip(units);
        for (((((b, &g), m), v), &scale), &unit) in columns {
            let g = g * unit;
            *m = self.momentum * *m + (R::ONE - self.momentum) * g;
            *v = decay * *v + (R::ONE - decay) * g * g;
            let length = (*v * unbias[1]).sqrt() + self.smallest;
            if length > R::ZERO {
                *b += scale * self.rate * *m * unbias[0] / length;
            }
        }
    }
}

impl<R: Real> Objective<R> for Design<'_, R> {
    fn about(&self) -> About<'_, R> {
        About { count: self.n, means: self.column_means, squares: self.squares() }
    }

    fn gradient(&self, channel: Option<usize>, b: &[R], out: &mut [R]) {
        let inverse = R::ONE / R::from_usize(self.n);
        out.fill(R::ZERO);
        for (panel, values) in self.each_panel() {
            let mut residual = [R::ZERO; LANES];
            for (column, &b) in panel.iter().zip(b) {
                residual = lanes::plus_product(residual, [b; LANES], *column);
            }
            if let Some(values) = channel.and_then(|channel| values.get(channel)) {
                residual = lanes::zip(values, &residual, |f, g| f - g);
            }
            for (out, column) in out.iter_mut().zip(panel) {
                *out += lanes::sum(&lanes::zip(column, &residual, |p, r| p * r)) * inverse;
            }
        }
    }

    fn residual_square(&self, channel: usize, b: &[R]) -> R {
        let mut total = [R::ZERO; LANES];
        for (panel, values) in self.each_panel() {
            let mut residual = at(values, channel);
            for (column, &b) in panel.iter().zip(b) {
                residual = lanes::minus_product(residual, [b; LANES], *column);
            }
            total = lanes::plus_product(total, residual, residual);
        }
        lanes::sum(&total)
    }

    fn column_square(&self, column: usize) -> R {
        square(&self.panels, column)
    }
}

fn floor<R: Real>() -> R {
    R::from_f64(FLOOR[usize::from(R::NARROW)])
}

/// Nearly the largest eigenvalue of S P'P S / n for the column scales S, by power iteration; momentum forgives a third.
fn largest_curvature<R: Real>(
    objective: &impl Objective<R>,
    scales: &[R],
    vector: &mut [R],
    image: &mut [R],
    scaled: &mut [R],
) -> R {
    // Uneven, as the columns of slices add up to zero: a vector of ones would miss them.
    let mut phase = R::ZERO;
    for value in vector.iter_mut() {
        phase += R::from_f64(0.618_033_988_75);
        if phase > R::ONE {
            phase -= R::ONE;
        }
        *value = R::from_f64(0.5) + phase;
    }
    let length = |vector: &[R]| vector.iter().fold(R::ZERO, |sum, &x| sum + x * x).sqrt();
    let mut largest = R::ZERO;
    for _ in 0..POWER_ROUNDS {
        for ((out, &value), &scale) in scaled.iter_mut().zip(vector.iter()).zip(scales) {
            *out = scale * value;
        }
        objective.gradient(None, scaled, image);
        for (value, &scale) in image.iter_mut().zip(scales) {
            *value *= scale;
        }
        let (before, after) = (length(vector), length(image));
        let usable = after > R::ZERO && before > R::ZERO;
        if !usable {
            break;
        }
        largest = after / before;
        for (out, &value) in vector.iter_mut().zip(image.iter()) {
            *out = value / after;
        }
    }
    largest.max(floor())
}
