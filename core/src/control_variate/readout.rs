//! The estimates that a streaming estimate's sums hold.

use super::accumulator::Accumulator;
use super::config::{Estimate, Ridge};
use super::cross_fit::{self, Groups};
use super::fit::{Penalty, descent, givens, normal};
use super::incremental;
use super::plan::Method;
use super::result::{Outcome, Summary};
use super::ridge;
use super::sums::Sums;
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
        let (summary, arena) = (self.checked_summary(sums)?, &mut Arena::new(workspace));
        let outcome = match self.method {
            Method::Robust | Method::KFold => self.cross_fit(sums, &summary, arena)?,
            Method::Incremental | Method::SquareRoot => self.one_by_one(sums, &summary, arena)?,
            Method::Descent => self.descend(&self.layout.group(sums, 0)?, &summary, arena)?,
            Method::LeastSquares => self.least_squares(&self.layout.group(sums, 0)?, arena)?,
            // A stream has no leave-one-out errors.
            Method::Plain | Method::LeaveOneOut => Outcome::default(),
        };
        Ok(summary.finish(outcome))
    }

    pub(crate) fn checked_summary(&self, sums: &[R]) -> Result<Summary<R>, Error> {
        self.check_length(sums)?;
        if self.samples == 0 { Err(Error::NoSamples) } else { Ok(self.summary(sums)) }
    }

    /// What takes one sample after the other, also from arrays.
    pub(crate) fn one_by_one(
        &self,
        sums: &[R],
        summary: &Summary<R>,
        arena: &mut Arena<'_, R>,
    ) -> Result<Outcome<R>, Error> {
        let outcome = if self.method == Method::SquareRoot {
            givens::least_squares(&self.layout.group(sums, 0)?, &self.config, &self.basis()?, arena)?
        } else {
            incremental::outcome(&self.incremental, self.samples)
        };
        Ok(Outcome { correction: outcome.correction - summary.mean, ..outcome })
    }

    #[inline(never)]
    fn basis(&self) -> Result<Basis, Error> {
        let mut basis = Basis::empty();
        basis.set(self.config.basis, self.shape)?;
        Ok(basis)
    }

    fn cross_fit(&self, sums: &[R], summary: &Summary<R>, arena: &mut Arena<'_, R>) -> Result<Outcome<R>, Error> {
        let (config, layout, basis) = (&self.config, self.layout, &self.basis()?);
        let groups = Groups { sums, folds: self.groups().get(), layout, config, basis };
        let k_fold = self.method == Method::KFold;
        // One fold to fit to and one to judge by, and for K-fold one to correct.
        let needed = if k_fold && !matches!(config.ridge, Ridge::Fixed(_)) { groups.folds.min(3) } else { 2 };
        let Some(variance) = summary.variance.filter(|_| groups.filled() >= needed) else {
            return Ok(Outcome::default());
        };
        if k_fold {
            cross_fit::nested(&groups, summary.mean, arena)
        } else {
            cross_fit::pooled(&groups, summary.mean, variance, arena)
        }
    }

    fn least_squares(&self, group: &Sums<&[R]>, arena: &mut Arena<'_, R>) -> Result<Outcome<R>, Error> {
        let penalties = arena.take(self.layout.columns)?;
        ridge::penalties(&self.config, &self.basis()?, |j| group.mean_square(j), penalties);
        let strength = R::from_f64(ridge::least_squares::<R>(self.config.ridge));
        normal::least_squares(group, Penalty { strength, relative: penalties }, arena)
    }

    fn descend(&self, group: &Sums<&[R]>, summary: &Summary<R>, arena: &mut Arena<'_, R>) -> Result<Outcome<R>, Error> {
        let centred = normal::Centred::new(group, arena)?;
        let coefficients = arena.zeros(self.layout.coefficients())?;
        descent::descend(&centred, &self.config, &self.basis()?, coefficients, summary.variance, arena)
    }
}
