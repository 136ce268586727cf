//! The estimates that a streaming estimate's sums hold.

use super::config::{Color, Config, Estimate, Estimator, Ridge, Solver};
use super::cross_fit;
use super::design::Units;
use super::incremental;
use super::moments::{Centred, Moments};
use super::per_channel::{PerChannel, add, get, set};
use super::result::{self, Outcome, Summary};
use super::ridge;
use super::state::State;
use super::{gradient_descent, square_root};
use crate::arena::Arena;
use crate::basis::Basis;
use crate::error::Error;
use crate::linalg::givens;
use crate::real::Real;
use crate::rows::rows;

impl<R: Real> State<R> {
    /// The estimate from all samples so far. More may be added afterwards.
    ///
    /// # Errors
    /// [`Error::NoSamples`] if there are none, [`Error::Memory`] if `workspace` is shorter than
    /// [`State::workspace_len`] says.
    pub fn estimate(&self, sums: &[R], workspace: &mut [R]) -> Result<Estimate, Error> {
        let state = self;
        if sums.len() < state.len() {
            return Err(Error::Memory);
        }
        if state.samples == 0 {
            return Err(Error::NoSamples);
        }
        let mut arena = Arena::new(workspace);
        let total = Totals::new(self, sums)?;
        let outcome = if state.columns == 0 {
            total.plain()
        } else {
            match state.config.estimator {
                Estimator::Incremental => incremental::outcome(&state.incremental, state.samples).relative_to(&total),
                Estimator::Robust | Estimator::KFold => self.cross_fit(sums, &total, &mut arena)?,
                Estimator::GradientDescent => {
                    let group = self.moments(sums, 0).ok_or(Error::Memory)?;
                    self.descend(&group, &total, &mut arena)?
                }
                _ if state.config.solver == Solver::SquareRoot => {
                    let group = self.moments(sums, 0).ok_or(Error::Memory)?;
                    let basis = self.basis()?;
                    let outcome = square_root::from_factor(
                        &group,
                        &state.config,
                        &basis,
                        state.terms(),
                        state.channels,
                        &mut arena,
                    )?;
                    let variance = outcome.variance.or(total.variance);
                    Outcome { variance, ..outcome.relative_to(&total) }
                }
                _ => {
                    let group = self.moments(sums, 0).ok_or(Error::Memory)?;
                    self.least_squares(&group, &total, &mut arena)?
                }
            }
        };
        let samples = state.samples;
        Ok(result::finish(
            Summary {
                samples: usize::try_from(samples).unwrap_or(usize::MAX),
                channels: state.channels,
                units: total.units,
                plain_variance: total.variance,
                colour: (state.config.color == Color::LuminanceRatio).then(|| {
                    let inverse = 1.0 / samples as f64;
                    let [red, green, blue, luminance] = state.colour.map(|sum| sum * inverse);
                    ([red, green, blue], luminance)
                }),
            },
            outcome,
        ))
    }

    #[inline(never)]
    fn basis(&self) -> Result<Basis, Error> {
        let mut basis = Basis::empty();
        basis.set(self.config.basis, self.shape)?;
        Ok(basis)
    }

    fn moments<'a>(&self, sums: &'a [R], fold: usize) -> Option<Moments<'a, R>> {
        let group = self.group();
        Moments::new(sums.get(fold * group..(fold + 1) * group)?, self.terms(), self.channels)
    }

    fn penalties<'a>(&self, group: &Moments<'_, R>, arena: &mut Arena<'a, R>) -> Result<&'a [R], Error> {
        let penalties = arena.take(self.columns)?;
        ridge::penalties(&self.config, &self.basis()?, |j| group.mean_square(j), penalties);
        Ok(penalties)
    }

    fn cross_fit(&self, sums: &[R], total: &Totals<R>, arena: &mut Arena<'_, R>) -> Result<Outcome<R>, Error> {
        let (config, basis) = (&self.config, self.basis()?);
        let groups = cross_fit::Groups { sums, folds: self.groups(), columns: self.columns, channels: self.channels };
        let k_fold = config.estimator == Estimator::KFold;
        // One fold to fit to and one to judge by, and for K-fold one to correct.
        let needed = if k_fold && !matches!(config.ridge, Ridge::Fixed(_)) { groups.folds.min(3) } else { 2 };
        let Some(variance) = total.variance.as_ref().filter(|_| groups.has(needed)) else { return Ok(total.plain()) };
        if k_fold {
            cross_fit::nested(&groups, config, &basis, &total.mean, arena)
        } else {
            cross_fit::pooled(&groups, config, &basis, (&total.mean, variance), arena)
        }
    }

    fn least_squares(
        &self,
        group: &Moments<'_, R>,
        total: &Totals<R>,
        arena: &mut Arena<'_, R>,
    ) -> Result<Outcome<R>, Error> {
        let (columns, channels) = (self.columns, self.channels);
        let penalties = self.penalties(group, arena)?;
        let coefficients = arena.take(columns * channels)?;
        let Some(centred) = Centred::new(group, columns, channels, arena)? else { return Ok(total.plain()) };
        let strength = R::from_f64(ridge::least_squares::<R>(self.config.ridge));
        let centre = centred.solve(penalties, strength, coefficients, true, arena)?;
        let eccentricity = centre.map_or(R::ZERO, |centre| centre.eccentricity);
        let (correction, residual) = in_sample(&centred, coefficients);
        let variance = result::residual_variance(residual, columns, centred.count, eccentricity);
        Ok(Outcome { correction, variance: variance.or(total.variance) })
    }

    fn descend(
        &self,
        group: &Moments<'_, R>,
        total: &Totals<R>,
        arena: &mut Arena<'_, R>,
    ) -> Result<Outcome<R>, Error> {
        let (columns, channels) = (self.columns, self.channels);
        let Some(centred) = Centred::new(group, columns, channels, arena)? else { return Ok(total.plain()) };
        let coefficients = arena.take(columns * channels)?;
        for value in coefficients.iter_mut() {
            *value = R::ZERO;
        }
        gradient_descent::descend(&centred, &self.config, &self.basis()?, coefficients, total.variance, arena)
    }
}

/// What a fit to all samples adds to the mean, and its sums of squared residuals: its intercept is the estimate.
fn in_sample<R: Real>(centred: &Centred<'_, R>, coefficients: &[R]) -> (PerChannel<R>, PerChannel<R>) {
    let (mut correction, mut residual) = (PerChannel::default(), PerChannel::default());
    for (channel, b) in rows(coefficients, centred.columns).enumerate() {
        set(&mut correction, channel, centred.intercept(channel, b) - get(&centred.value_means, channel));
        set(&mut residual, channel, centred.residual_square(channel, b));
    }
    (correction, residual)
}

/// What the sums say about the plain mean.
pub(crate) struct Totals<R> {
    /// The accumulator's units, moved so that zero is the plain mean.
    pub(crate) units: [Units<R>; Config::MAX_CHANNELS],
    /// The plain mean in the accumulator's units.
    pub(crate) mean: PerChannel<R>,
    /// The plain mean's variance.
    pub(crate) variance: Option<PerChannel<R>>,
}

impl<R: Real> Totals<R> {
    fn new(state: &State<R>, sums: &[R]) -> Result<Self, Error> {
        let mut totals = PerChannel::default();
        let mut squares = PerChannel::default();
        for fold in 0..state.groups() {
            let group = state.moments(sums, fold).ok_or(Error::Memory)?;
            for channel in 0..state.channels {
                let (total, square) = if state.config.solver == Solver::SquareRoot {
                    givens::first_column(group.gram, group.rhs, group.square, state.channels, channel)
                } else {
                    (group.total(channel), group.square(channel))
                };
                add(&mut totals, channel, total);
                add(&mut squares, channel, square);
            }
        }
        let n = R::from_f64(state.samples as f64);
        let mut result = Self { units: state.units, mean: PerChannel::default(), variance: None };
        let mut variance = PerChannel::default();
        for (channel, unit) in result.units.iter_mut().enumerate().take(state.channels) {
            let total = get(&totals, channel);
            let mean = total / n;
            unit.offset += mean;
            set(&mut result.mean, channel, mean);
            let square = Real::max(get::<R>(&squares, channel) - total * mean, R::ZERO);
            set(&mut variance, channel, square / result::mean_divisor(n));
        }
        result.variance = (state.samples > 1).then_some(variance);
        Ok(result)
    }

    fn plain(&self) -> Outcome<R> {
        Outcome { correction: PerChannel::default(), variance: self.variance }
    }
}

impl<R: Real> Outcome<R> {
    /// Turns an estimate in the accumulator's units into a correction of the plain mean.
    fn relative_to(mut self, total: &Totals<R>) -> Self {
        for (correction, &mean) in self.correction.iter_mut().zip(&total.mean) {
            *correction -= mean;
        }
        self
    }
}
