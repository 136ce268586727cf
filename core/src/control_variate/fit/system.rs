//! One interface to the systems that every fit to a design starts from.

use super::super::design::Design;
use super::dual::Dual;
use super::normal::Normal;
use super::{Fit, Penalty};
use crate::arena::Arena;
use crate::error::Error;
use crate::real::Real;

/// The system of a design that all its fits start from.
pub(crate) enum System<'a, R> {
    Normal(Normal<'a, R>),
    Dual(Dual<'a, R>),
}

impl<R: Real> System<'_, R> {
    /// One fit, with its leave-one-out figures if they are wanted. `coefficients`, if wanted, gets a row for each
    /// channel.
    #[inline(always)]
    pub(crate) fn fit(
        &self,
        design: &Design<'_, R>,
        penalty: Penalty<'_, R>,
        leave_one_out: bool,
        coefficients: Option<&mut [R]>,
        arena: Arena<'_, R>,
    ) -> Result<Fit<R>, Error> {
        match self {
            System::Normal(normal) => normal.fit(design, penalty, leave_one_out, coefficients, arena),
            System::Dual(dual) => dual.fit(design, penalty, leave_one_out, coefficients, arena),
        }
    }
}
