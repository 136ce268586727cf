//! Handing out parts of one caller-supplied buffer.

use crate::error::{Error, ensure};
use crate::lanes::{LANES, Lanes};
use crate::matrix::{Triangle, packed_len};
use crate::real::Real;

/// A buffer that is given out piece by piece, front to back. How long it must be is checked once, when it comes in.
pub(crate) struct Arena<'a, R> {
    rest: &'a mut [R],
    /// How much was asked for, where that alone is wanted.
    counted: Option<usize>,
}

impl<'a, R: Real> Arena<'a, R> {
    /// Of a buffer that `needed` numbers will be taken from, None for more than there can be.
    ///
    /// # Errors
    /// [`Error::Memory`] if it has fewer, [`Error::Range`] for None.
    pub(crate) fn new(buffer: &'a mut [R], needed: Option<usize>) -> Result<Self, Error> {
        ensure(needed.ok_or(Error::Range)? <= buffer.len(), Error::Memory)?;
        Ok(Self { rest: buffer, counted: None })
    }

    /// One that gives out nothing, and counts what it is asked for.
    pub(crate) fn count() -> Self {
        Self { rest: &mut [], counted: Some(0) }
    }

    /// What was counted; None if that is more than there can be.
    pub(crate) fn counted(&self) -> Option<usize> {
        self.counted.filter(|&counted| counted < usize::MAX)
    }

    /// The next `len` numbers, with whatever they held.
    pub(crate) fn take(&mut self, len: usize) -> &'a mut [R] {
        if let Some(counted) = &mut self.counted {
            *counted = counted.saturating_add(len);
            return &mut [];
        }
        debug_assert!(len <= self.rest.len(), "more is taken than was said to be needed");
        let (part, rest) = core::mem::take(&mut self.rest).split_at_mut_checked(len).unwrap_or_default();
        self.rest = rest;
        part
    }

    /// The next `len` numbers, all zero.
    pub(crate) fn zeros(&mut self, len: usize) -> &'a mut [R] {
        let part = self.take(len);
        part.fill(R::ZERO);
        part
    }

    /// A packed triangle of `order` rows, with whatever they held.
    pub(crate) fn triangle(&mut self, order: usize) -> Triangle<&'a mut [R]> {
        Triangle::new(self.take(packed_len(order)), order)
    }

    /// The next `panels` groups of eight numbers.
    pub(crate) fn take_lanes(&mut self, panels: usize) -> &'a mut [Lanes<R>] {
        self.take(panels.saturating_mul(LANES)).as_chunks_mut::<LANES>().0
    }

    /// The rest of the buffer, to be given out again after the borrow ends.
    pub(crate) fn scratch(&mut self) -> Arena<'_, R> {
        Arena { rest: self.rest, counted: None }
    }
}
