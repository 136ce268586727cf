//! Multi-indices of total degree, as a program that computes each product from earlier ones.

use super::functions::{self, Family};
use super::shape::{MAX_DIMS, MAX_ORDER, MAX_TERMS};
use crate::lanes::{self, Lanes};
use crate::matrix::at;
use crate::real::Real;
use core::hint::black_box;
use heapless::Vec;

/// A column number that stands for the constant function.
const CONSTANT: u8 = u8::MAX;

/// One function: either a one-dimensional one, from the two lower degrees of the same coordinate, or the product of
/// two earlier columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Term {
    /// Which column the value goes to.
    column: u8,
    /// The total degree.
    degree: u8,
    /// The coordinate of a one-dimensional function; the last coordinate of a product.
    dim: u8,
    /// Whether this is a product.
    product: bool,
    /// Product: the two factors. Otherwise: the columns of degree - 1 and degree - 2.
    sources: [u8; 2],
}

impl Term {
    pub(crate) fn degree(&self) -> usize {
        usize::from(self.degree)
    }

    pub(crate) fn column(&self) -> usize {
        usize::from(self.column)
    }

    // See `functions.rs`.
    #[inline(always)]
    pub(crate) fn value<R: Real, const L: usize>(
        &self,
        family: Family,
        arguments: &[Lanes<R, L>; MAX_DIMS],
        columns: &[Lanes<R, L>],
    ) -> Lanes<R, L> {
        // The constant is no column: reading past the end gives it.
        let [a, b] = self.sources;
        let constant = [R::ONE; L];
        // Behind a black box, or compilers choose anew for every lane.
        let a = black_box(columns.get(usize::from(a)).unwrap_or(&constant));
        let b = black_box(columns.get(usize::from(b)).unwrap_or(&constant));
        if self.product {
            return lanes::zip(a, b, |a, b| a * b);
        }
        let argument = arguments.get(usize::from(self.dim)).unwrap_or(&constant);
        functions::next(family, usize::from(self.degree), argument, a, b)
    }
}

/// Adds to `terms`, which are empty, every multi-index of degree 1 to `order` over `dims` coordinates, degree by
/// degree; None if there is no room for more. Columns `dims..dims + gap` are left free for the slices' indicators.
pub(crate) fn total_degree(dims: usize, order: usize, gap: usize, terms: &mut Vec<Term, MAX_TERMS>) -> Option<()> {
    let column = |index: usize| u8::try_from(if index < dims { index } else { index + gap }).ok();
    // The columns of the one-dimensional functions, by coordinate and degree.
    let mut pure = [[CONSTANT; MAX_ORDER + 1]; MAX_DIMS];
    for degree in 1..=order {
        for (dim, pure) in pure.iter_mut().enumerate().take(dims) {
            let column = column(terms.len())?;
            // Below degree 1 is the constant.
            let below = |steps: usize| at(pure, degree.saturating_sub(steps));
            let sources = [below(1), below(2)];
            terms.push(Term { column, degree: degree as u8, dim: dim as u8, product: false, sources }).ok()?;
            *pure.get_mut(degree)? = column;
        }
        // A product is a lower-degree function of the coordinates before `dim` times a one-dimensional one of `dim`.
        for left in 0..terms.len() {
            let left = *terms.get(left)?;
            let power = degree.saturating_sub(left.degree());
            if power == 0 {
                continue;
            }
            for dim in usize::from(left.dim) + 1..dims {
                let sources = [left.column, *pure.get(dim)?.get(power)?];
                let column = column(terms.len())?;
                terms.push(Term { column, degree: degree as u8, dim: dim as u8, product: true, sources }).ok()?;
            }
        }
    }
    Some(())
}
