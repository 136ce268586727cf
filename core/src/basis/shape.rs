//! How many functions a basis has.

use crate::error::{Error, ensure};

/// The largest number of coordinates.
pub const MAX_DIMS: usize = 16;
/// The largest total degree.
pub const MAX_ORDER: usize = 7;
/// The largest number of terms, constant included: 15 coordinates at order 2.
pub const MAX_TERMS: usize = 136;

/// How many functions there are of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Shape {
    /// Coordinates that are regressed as numbers.
    pub(super) continuous: usize,
    pub(super) order: usize,
    /// Slices, each with its indicator; 0 without.
    pub(super) slices: usize,
    /// Functions that all slices share.
    pub(super) shared: usize,
    /// Functions that each slice has its own copy of.
    pub(super) copies: usize,
    /// Whether only the shared functions are columns: who knows the slices makes their own from those.
    is_apart: bool,
}

impl Shape {
    /// Of at most `room` terms, constant included.
    ///
    /// # Errors
    /// [`Error::Range`] for other than 1 to 16 `dims` or an `order` beyond 7, and if there is no room.
    pub(crate) fn new(dims: usize, order: usize, slices: usize, room: usize) -> Result<Self, Error> {
        let in_range = (1..=MAX_DIMS).contains(&dims) && order <= MAX_ORDER && slices < MAX_TERMS;
        ensure(in_range, Error::Range)?;
        let slices = if slices > 1 && order > 0 { slices } else { 0 };
        let continuous = if slices > 0 { dims - 1 } else { dims };
        let shared = count(continuous, order);
        ensure(1 + shared + slices <= room, Error::Range)?;
        // As many whole degrees of per-slice copies as fit.
        let fits = |&copies: &usize| 1 + shared + slices + slices * copies <= room;
        let degrees = 0..=if slices > 0 { order } else { 0 };
        let copies = degrees.map(|degree| count(continuous, degree)).filter(fits).fold(0, usize::max);
        Ok(Self { continuous, order, slices, shared, copies, is_apart: false })
    }

    /// The same with the shared functions alone as columns, where the others are so many more that this pays.
    pub(crate) fn apart(self) -> Self {
        const FEW: usize = 32;
        Self { is_apart: self.slices * (1 + self.copies) > FEW.max(2 * self.shared), ..self }
    }

    /// Slices whose own functions are no columns, and how many functions each has a copy of.
    pub(crate) fn slices_apart(&self) -> (usize, usize) {
        if self.is_apart { (self.slices, self.copies) } else { (0, 0) }
    }

    /// Slices whose indicators are columns.
    pub(super) fn indicators(&self) -> usize {
        if self.is_apart { 0 } else { self.slices }
    }

    /// All functions; the constant is not one of them.
    pub(crate) fn columns(&self) -> usize {
        self.shared + self.indicators() * (1 + self.copies)
    }

    /// The functions of degree 1: their number is their penalty.
    pub(crate) fn linear(&self) -> usize {
        let copied = if self.copies > 0 { self.slices } else { 0 };
        self.continuous * (1 + copied) + self.slices
    }

    /// How many leading functions are of at most this degree. Slices' copies of functions come last and do not count.
    pub(crate) fn up_to_degree(&self, degree: usize) -> usize {
        let degree = degree.min(self.order);
        if degree == 0 { 0 } else { count(self.continuous, degree) + self.indicators() }
    }
}

/// The multi-indices over `dims` coordinates of degree 1 to `order`: binomial(dims + order, order) - 1.
fn count(dims: usize, order: usize) -> usize {
    // Exact at each step, and no larger than binomial(23, 7): 32 bits divide faster than 64.
    let mut binomial = 1u32;
    for k in 1..=order as u32 {
        binomial = binomial * (dims as u32 + k) / k;
    }
    binomial as usize - 1
}
