//! The functions a regression combines: everything but the constant (4.22).
//!
//! Every function is centred, its integral over `[0, 1]^d` is exactly zero, and scaled to unit variance. The integral
//! of a fitted sum is therefore its constant coefficient (4.23), and a ridge penalty means the same for every basis.
//!
//! - [`Family::Legendre`]: products of orthonormal shifted Legendre polynomials, of total degree 1 to `order`.
//!   Monomials span the same space but at (dims, order) = (3, 7) their normal equations have condition 5e10; these 2.
//! - [`Family::Step`]: the same products of Walsh functions in sequency order, constant on the cells of an 8-cell grid.
//! - [`Family::Sine`]: the same products of sin(pi d x + pi/2) = cos(pi d x), d half-waves with an antinode at each
//!   border. The phase makes them orthonormal with integral zero, and able to follow a trend from border to border.
//! - [`Family::Gaussian`]: as many isotropic Gaussians as Legendre has terms, their centres on a Kronecker sequence.
//!   The integral of each is a product of error functions and is subtracted.
//!
//! With `slices` S > 1 the last coordinate picks one of S equally likely alternatives (a light, say; figure 4.15) and
//! is not regressed as a number. The functions of the other coordinates are shared by all slices, each slice adds its
//! indicator, and as many degrees of its own copy of the functions as fit in [`MAX_TERMS`].

mod functions;
mod gaussian;
mod shape;
mod terms;

pub use functions::Family;
pub(crate) use shape::Shape;
pub use shape::{MAX_DIMS, MAX_ORDER, MAX_TERMS};

use crate::lanes::Lanes;
use crate::matrix::{at, halves_mut, rows_mut, set};
use crate::real::Real;
use gaussian::Gaussians;
use heapless::Vec;
use terms::Term;

/// A set of centred functions of unit variance on `[0, 1]^dims`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Basis {
    family: Family,
    shape: Shape,
    terms: Vec<Term, MAX_TERMS>,
    gaussians: Option<Gaussians>,
}

impl Basis {
    /// A basis of no functions, to be set.
    pub(crate) fn empty() -> Self {
        Self { family: Family::Legendre, shape: Shape::default(), terms: Vec::new(), gaussians: None }
    }

    /// Makes it, that was empty, one of a shape that was checked. A basis is a few kilobytes, which are better not
    /// moved.
    pub(crate) fn set(&mut self, family: Family, shape: Shape) {
        (self.family, self.shape) = (family, shape);
        terms::total_degree(shape.continuous, shape.order, shape.indicators(), &mut self.terms);
        if family == Family::Gaussian && shape.shared > 0 {
            self.gaussians = Some(Gaussians::new(shape.continuous, shape.shared));
        }
    }

    /// How many functions there are; the constant is not one of them.
    #[inline]
    pub(crate) fn columns(&self) -> usize {
        self.shape.columns()
    }

    /// The ridge penalty of each column, relative: 4^(degree - 1) times the number of columns of that degree.
    ///
    /// High degrees are less often needed, and the more functions share a degree the less each one explains.
    pub(crate) fn penalties<R: Real>(&self, out: &mut [R]) {
        let mut counts = [0usize; MAX_ORDER + 1];
        // Slices apart have their functions all the same.
        let (slices, copies) = self.shape.slices_apart();
        for column in 0..self.columns() {
            if let Some(count) = counts.get_mut(self.degree(column)) {
                *count += if column < copies { 1 + slices } else { 1 };
            }
        }
        counts[1] += slices;
        for (column, penalty) in out.iter_mut().enumerate().take(self.columns()) {
            let degree = self.degree(column);
            let count = at(&counts, degree);
            *penalty = R::from_usize(count) * R::from_usize(1).scale(2 * (degree as i32 - 1));
        }
    }

    /// 2^(1 - degree) for each column.
    pub(crate) fn scales<R: Real>(&self, out: &mut [R]) {
        for (column, scale) in out.iter_mut().enumerate().take(self.columns()) {
            *scale = R::ONE.scale(1 - self.degree(column) as i32);
        }
    }

    /// The total degree of a column; indicators count as one, a slice's copy of a function as the function.
    fn degree(&self, column: usize) -> usize {
        let Shape { continuous, shared, copies, .. } = self.shape;
        let slices = self.shape.indicators();
        let term = if column < continuous {
            column
        } else if column < continuous + slices {
            return 1;
        } else if column < shared + slices {
            column - slices
        } else {
            (column - shared - slices).checked_rem(copies).unwrap_or(0)
        };
        self.terms.get(term).map_or(1, Term::degree)
    }

    /// Evaluates every function at `L` points: `x` has a group of lanes for each coordinate, `out` gets one for each
    /// column. Coordinates are taken to be in [0, 1].
    // See `functions.rs`.
    #[inline(always)]
    pub(crate) fn evaluate<R: Real, const L: usize>(&self, x: &[Lanes<R, L>], out: &mut [Lanes<R, L>]) {
        let (Shape { continuous, .. }, slices) = (self.shape, self.shape.indicators());
        match &self.gaussians {
            Some(gaussians) => gaussians.evaluate(x, continuous, slices, out),
            None => {
                let mut arguments = [[R::ZERO; L]; MAX_DIMS];
                for (argument, x) in arguments.iter_mut().zip(x).take(continuous) {
                    *argument = functions::argument(self.family, x);
                }
                for term in &self.terms {
                    let value = term.value(self.family, &arguments, out);
                    set(out, term.column(), value);
                }
            }
        }
        if slices > 0
            && let Some(choice) = x.get(continuous)
        {
            self.evaluate_slices(choice, out);
        }
    }

    /// The slices of `L` points.
    pub(crate) fn slices_at<R: Real, const L: usize>(&self, x: &[Lanes<R, L>]) -> [usize; L] {
        let choice = x.get(self.shape.continuous).copied().unwrap_or([R::ZERO; L]);
        choice.map(|u| slice_of(u, self.shape.slices))
    }

    /// The indicators (S [k = s] - 1) / sqrt(S - 1), and sqrt(S) [k = s] times each copied function.
    #[inline(never)]
    fn evaluate_slices<R: Real, const L: usize>(&self, choice: &Lanes<R, L>, out: &mut [Lanes<R, L>]) {
        let Shape { continuous, slices, shared, copies, .. } = self.shape;
        let count = R::from_usize(slices);
        let inside = (count - R::ONE).sqrt();
        let outside = -R::ONE / inside;
        let scale = count.sqrt();
        let picked = choice.map(|u| slice_of(u, slices));
        for (s, column) in out.iter_mut().skip(continuous).take(slices).enumerate() {
            for (value, &k) in column.iter_mut().zip(&picked) {
                *value = if k == s { inside } else { outside };
            }
        }
        let (shared, blocks) = halves_mut(out, shared + slices);
        for (s, block) in rows_mut(blocks, copies).enumerate().take(slices) {
            for (term, column) in self.terms.iter().zip(block) {
                let Some(source) = shared.get(term.column()) else { continue };
                for ((value, &source), &k) in column.iter_mut().zip(source).zip(&picked) {
                    *value = if k == s { scale * source } else { R::ZERO };
                }
            }
        }
    }
}

/// Which of `slices` equal parts of [0, 1] holds `u`; 1 belongs to the last.
fn slice_of<R: Real>(u: R, slices: usize) -> usize {
    // A float-to-integer cast saturates, so this is total.
    ((u.to_f32() * slices as f32) as usize).min(slices - 1)
}
