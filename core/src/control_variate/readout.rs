//! The estimates that a streaming estimate's sums hold.

use super::accumulator::Accumulator;
use super::config::{Color, Config, Estimate, Ridge};
use super::cross_fit;
use super::design::Units;
use super::fit::descent::Objective;
use super::fit::normal::Centred;
use super::fit::{Penalty, descent, givens};
use super::incremental;
use super::per_channel::PerChannel;
use super::plan::Method;
use super::result::{self, Outcome, Summary};
use super::ridge;
use super::sums::Sums;
use crate::arena::Arena;
use crate::basis::Basis;
use crate::error::Error;
use crate::matrix::row_at;
use crate::real::Real;
use crate::rows::rows;

impl<R: Real> Accumulator<R> {
    /// The estimate from all samples so far. More may be added afterwards.
    ///
    /// # Errors
    /// [`Error::NoSamples`] if there are none, [`Error::Memory`] if `workspace` is shorter than
    /// [`Accumulator::workspace_len`] says.
    pub fn estimate(&self, sums: &[R], workspace: &mut [R]) -> Result<Estimate, Error> {
        let total = self.totals(sums)?;
        let mut arena = Arena::new(workspace);
        let outcome = match self.method {
            Method::Robust | Method::KFold => self.cross_fit(sums, &total, &mut arena)?,
            Method::Incremental => return Ok(self.incremental_of(total)),
            Method::Descent => self.descend(&self.sums(sums, 0)?, &total, &mut arena)?,
            Method::SquareRoot => {
                let sums = self.sums(sums, 0)?;
                let outcome = givens::from_factor(&sums, &self.config, &self.basis()?, self.channels, &mut arena)?;
                Outcome { variance: outcome.variance.or(total.variance), ..outcome.relative_to(&total) }
            }
            Method::LeastSquares => self.least_squares(&self.sums(sums, 0)?, &total, &mut arena)?,
            // A stream has no leave-one-out errors.
            Method::Plain | Method::LeaveOneOut => total.plain(),
        };
        Ok(self.finish(total, outcome))
    }

    /// The incremental estimate alone, for programs that need no other of a stream.
    pub(crate) fn incremental(&self, sums: &[R]) -> Result<Estimate, Error> {
        Ok(self.incremental_of(self.totals(sums)?))
    }

    fn incremental_of(&self, total: Totals<R>) -> Estimate {
        let outcome = incremental::outcome(&self.incremental, self.samples).relative_to(&total);
        self.finish(total, outcome)
    }

    fn totals(&self, sums: &[R]) -> Result<Totals<R>, Error> {
        if sums.len() < self.len() {
            return Err(Error::Memory);
        }
        if self.samples == 0 {
            return Err(Error::NoSamples);
        }
        Totals::new(self, sums)
    }

    fn finish(&self, total: Totals<R>, outcome: Outcome<R>) -> Estimate {
        let samples = self.samples;
        let summary = Summary {
            samples: usize::try_from(samples).unwrap_or(usize::MAX),
            channels: self.channels,
            units: total.units,
            plain_variance: total.variance,
            colour: (self.config.color == Color::LuminanceRatio).then(|| {
                let inverse = 1.0 / samples as f64;
                let [red, green, blue, luminance] = self.colour.map(|sum| sum * inverse);
                ([red, green, blue], luminance)
            }),
        };
        result::finish(summary, outcome)
    }

    #[inline(never)]
    fn basis(&self) -> Result<Basis, Error> {
        let mut basis = Basis::empty();
        basis.set(self.config.basis, self.shape)?;
        Ok(basis)
    }

    fn sums<'a>(&self, sums: &'a [R], fold: usize) -> Result<Sums<&'a [R]>, Error> {
        Sums::new(row_at(sums, self.group(), fold), self.terms(), self.channels)
    }

    fn penalties<'a>(&self, group: &Sums<&[R]>, arena: &mut Arena<'a, R>) -> Result<&'a [R], Error> {
        let penalties = arena.take(self.columns)?;
        ridge::penalties(&self.config, &self.basis()?, |j| group.mean_square(j), penalties);
        Ok(penalties)
    }

    fn cross_fit(&self, sums: &[R], total: &Totals<R>, arena: &mut Arena<'_, R>) -> Result<Outcome<R>, Error> {
        let (config, basis) = (&self.config, self.basis()?);
        let groups = cross_fit::Groups { sums, folds: self.groups(), columns: self.columns, channels: self.channels };
        let k_fold = self.method == Method::KFold;
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
        group: &Sums<&[R]>,
        total: &Totals<R>,
        arena: &mut Arena<'_, R>,
    ) -> Result<Outcome<R>, Error> {
        let (columns, channels) = (self.columns, self.channels);
        let penalties = self.penalties(group, arena)?;
        let coefficients = arena.take(columns * channels)?;
        let Some(centred) = Centred::new(group, columns, channels, arena)? else { return Ok(total.plain()) };
        let strength = R::from_f64(ridge::least_squares::<R>(self.config.ridge));
        let penalty = Penalty { strength, relative: penalties };
        let factor = centred.normal.solve(penalty, coefficients, arena)?;
        let eccentricity = centred.normal.eccentricity(&factor, arena)?;
        let (correction, residual) = in_sample(&centred, coefficients);
        let variance = result::residual_variance(residual, columns, centred.normal.count, eccentricity);
        Ok(Outcome { correction, variance: variance.or(total.variance) })
    }

    fn descend(&self, group: &Sums<&[R]>, total: &Totals<R>, arena: &mut Arena<'_, R>) -> Result<Outcome<R>, Error> {
        let (columns, channels) = (self.columns, self.channels);
        let Some(centred) = Centred::new(group, columns, channels, arena)? else { return Ok(total.plain()) };
        let coefficients = arena.zeros(columns * channels)?;
        descent::descend(&centred, &self.config, &self.basis()?, coefficients, total.variance, arena)
    }
}

/// What a fit to all samples adds to the mean, and its sums of squared residuals: its intercept is the estimate.
fn in_sample<R: Real>(centred: &Centred<'_, R>, coefficients: &[R]) -> (PerChannel<R>, PerChannel<R>) {
    let (mut correction, mut residual) = (PerChannel::default(), PerChannel::default());
    for (channel, b) in rows(coefficients, centred.normal.means.len()).enumerate() {
        correction[channel] = centred.intercept(channel, b) - centred.value_means[channel];
        residual[channel] = centred.residual_square(channel, b);
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
    fn new(accumulator: &Accumulator<R>, sums: &[R]) -> Result<Self, Error> {
        let mut totals = PerChannel::<R>::default();
        let mut squares = PerChannel::<R>::default();
        for fold in 0..accumulator.groups() {
            let group = accumulator.sums(sums, fold)?;
            for channel in 0..accumulator.channels {
                let (total, square) = if accumulator.method == Method::SquareRoot {
                    givens::totals(&group, channel)
                } else {
                    (group.total(channel), group.square(channel))
                };
                totals[channel] += total;
                squares[channel] += square;
            }
        }
        let n = R::from_f64(accumulator.samples as f64);
        let mut result = Self { units: accumulator.units, mean: PerChannel::default(), variance: None };
        let mut variance = PerChannel::default();
        for (channel, unit) in result.units.iter_mut().enumerate().take(accumulator.channels) {
            let total = totals[channel];
            let mean = total / n;
            unit.offset += mean;
            result.mean[channel] = mean;
            let square = Real::max(squares[channel] - total * mean, R::ZERO);
            variance[channel] = square / result::mean_divisor(n);
        }
        result.variance = (accumulator.samples > 1).then_some(variance);
        Ok(result)
    }

    fn plain(&self) -> Outcome<R> {
        Outcome::plain(self.variance)
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
