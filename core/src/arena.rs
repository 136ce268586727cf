//! Handing out parts of one caller-supplied buffer.

use crate::error::Error;
use crate::lanes::{LANES, Lanes};
use crate::matrix::{Triangle, packed_len};
use crate::real::Real;

/// A buffer that is given out piece by piece, front to back.
pub(crate) struct Arena<'a, R> {
    rest: &'a mut [R],
}

impl<'a, R: Real> Arena<'a, R> {
    pub(crate) fn new(buffer: &'a mut [R]) -> Self {
        Self { rest: buffer }
    }

    /// The next `len` numbers, with whatever they held.
    #[inline]
    pub(crate) fn take(&mut self, len: usize) -> Result<&'a mut [R], Error> {
        let (part, rest) = core::mem::take(&mut self.rest).split_at_mut_checked(len).ok_or(Error::Memory)?;
        self.rest = rest;
        Ok(part)
    }

    /// The next `len` numbers, all zero.
    #[inline]
    pub(crate) fn zeros(&mut self, len: usize) -> Result<&'a mut [R], Error> {
        let part = self.take(len)?;
        part.fill(R::ZERO);
        Ok(part)
    }

    /// A packed triangle of `order` rows, with whatever they held.
    #[inline]
    pub(crate) fn triangle(&mut self, order: usize) -> Result<Triangle<&'a mut [R]>, Error> {
        Triangle::new(self.take(packed_len(order))?, order)
    }

    /// The next `panels` groups of eight numbers.
    #[inline]
    pub(crate) fn take_lanes(&mut self, panels: usize) -> Result<&'a mut [Lanes<R>], Error> {
        let len = panels.checked_mul(LANES).ok_or(Error::Memory)?;
        Ok(self.take(len)?.as_chunks_mut::<LANES>().0)
    }

    /// The rest of the buffer, to be given out again after the borrow ends.
    #[inline]
    pub(crate) fn scratch(&mut self) -> Arena<'_, R> {
        Arena { rest: self.rest }
    }
}
