//! The estimates that a streaming estimate's sums hold.

use super::accumulator::Accumulator;
use super::config::{Color, Estimate, Ridge};
use super::cross_fit::{self, Groups};
use super::fit::{Penalty, descent, givens, normal};
use super::incremental;
use super::plan::Method;
use super::result::{self, Outcome, Summary};
use super::ridge;
use super::sums::Sums;
use super::totals::Totals;
use crate::arena::Arena;
use crate::basis::Basis;
use crate::error::Error;
use crate::real::Real;

impl<R: Real> Accumulator<R> {
    /// The estimate from all samples so far. More may be added afterwards.
    ///
    /// # Errors
    /// [`Error::NoSamples`] if there are none, [`Error::Memory`] if `workspace` is shorter than
    /// [`Accumulator::workspace_len`] says.
    pub fn estimate(&self, sums: &[R], workspace: &mut [R]) -> Result<Estimate, Error> {
        let (total, arena) = (self.checked_totals(sums)?, &mut Arena::new(workspace));
        let outcome = match self.method {
            Method::Robust | Method::KFold => self.cross_fit(sums, &total, arena)?,
            Method::Incremental => self.corrected_by_past(&total),
            Method::SquareRoot => self.square_root(sums, &total, arena)?,
            Method::Descent => self.descend(&self.layout.group(sums, 0)?, &total, arena)?,
            Method::LeastSquares => self.least_squares(&self.layout.group(sums, 0)?, &total, arena)?,
            // A stream has no leave-one-out errors.
            Method::Plain | Method::LeaveOneOut => total.plain(),
        };
        Ok(self.finish(total, outcome))
    }

    /// The same of the two ways that estimates from arrays go, too, for programs that need no other of a stream.
    pub(crate) fn estimate_of_array(&self, sums: &[R], workspace: &mut [R]) -> Result<Estimate, Error> {
        let total = self.checked_totals(sums)?;
        let outcome = match self.method {
            Method::SquareRoot => self.square_root(sums, &total, &mut Arena::new(workspace))?,
            _ => self.corrected_by_past(&total),
        };
        Ok(self.finish(total, outcome))
    }

    fn corrected_by_past(&self, total: &Totals<R>) -> Outcome<R> {
        total.corrected(incremental::outcome(&self.incremental, self.samples))
    }

    fn square_root(&self, sums: &[R], total: &Totals<R>, arena: &mut Arena<'_, R>) -> Result<Outcome<R>, Error> {
        let outcome = givens::least_squares(&self.layout.group(sums, 0)?, &self.config, &self.basis()?, arena)?;
        Ok(Outcome { variance: outcome.variance.or(total.variance), ..total.corrected(outcome) })
    }

    fn checked_totals(&self, sums: &[R]) -> Result<Totals<R>, Error> {
        if sums.len() < self.len() {
            return Err(Error::Memory);
        }
        if self.samples == 0 { Err(Error::NoSamples) } else { Ok(self.totals(sums)) }
    }

    fn finish(&self, total: Totals<R>, outcome: Outcome<R>) -> Estimate {
        let summary = Summary {
            samples: self.samples,
            channels: self.layout.channels,
            units: total.units,
            plain_variance: total.variance,
            colour: (self.config.color == Color::LuminanceRatio).then(|| {
                let inverse = 1.0 / self.samples as f64;
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

    fn cross_fit(&self, sums: &[R], total: &Totals<R>, arena: &mut Arena<'_, R>) -> Result<Outcome<R>, Error> {
        let (config, basis) = (&self.config, self.basis()?);
        let groups = Groups { sums, folds: self.groups().get(), layout: self.layout };
        let k_fold = self.method == Method::KFold;
        // One fold to fit to and one to judge by, and for K-fold one to correct.
        let needed = if k_fold && !matches!(config.ridge, Ridge::Fixed(_)) { groups.folds.min(3) } else { 2 };
        let Some(variance) = total.variance.filter(|_| groups.has(needed)) else { return Ok(total.plain()) };
        if k_fold {
            cross_fit::nested(&groups, config, &basis, total.mean, arena)
        } else {
            cross_fit::pooled(&groups, config, &basis, total.mean, variance, arena)
        }
    }

    fn least_squares(
        &self,
        group: &Sums<&[R]>,
        total: &Totals<R>,
        arena: &mut Arena<'_, R>,
    ) -> Result<Outcome<R>, Error> {
        let penalties = arena.take(self.layout.columns)?;
        ridge::penalties(&self.config, &self.basis()?, |j| group.mean_square(j), penalties);
        let strength = R::from_f64(ridge::least_squares::<R>(self.config.ridge));
        let outcome = normal::least_squares(group, Penalty { strength, relative: penalties }, arena)?;
        let Some(outcome) = outcome else { return Ok(total.plain()) };
        Ok(Outcome { variance: outcome.variance.or(total.variance), ..outcome })
    }

    fn descend(&self, group: &Sums<&[R]>, total: &Totals<R>, arena: &mut Arena<'_, R>) -> Result<Outcome<R>, Error> {
        let Some(centred) = normal::Centred::new(group, arena)? else { return Ok(total.plain()) };
        let coefficients = arena.zeros(self.layout.coefficients())?;
        descent::descend(&centred, &self.config, &self.basis()?, coefficients, total.variance, arena)
    }
}
