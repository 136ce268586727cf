//! The functions a regression combines: everything but the constant (4.22).
//!
//! Every function is centred, its integral over [0,1]^d is exactly zero, and scaled to unit variance. The integral of
//! a fitted sum is therefore its constant coefficient (4.23), and a ridge penalty means the same for every basis.
//!
//! - [`Family::Legendre`]: products of orthonormal shifted Legendre polynomials, of total degree 1 to `order`.
//!   Monomials span the same space but at (dims, order) = (3, 7) their normal equations have condition 5e10; these 2.
//! - [`Family::Step`]: the same products of Walsh functions in sequency order, constant on the cells of an 8-cell grid.
//! - [`Family::Sine`]: the same products of sin(pi d x + pi/2), d half-waves with an antinode at each border.
//!   The phase makes them orthonormal with integral zero, and able to follow a trend from border to border.
//! - [`Family::Gaussian`]: as many isotropic Gaussians as Legendre has terms, their centres on a Kronecker sequence.
//!   The integral of each is a product of error functions and is subtracted.
//!
//! With `slices` S > 1 the last coordinate picks one of S equally likely alternatives (a light, say; figure 4.15) and
//! is not regressed as a number. The functions of the other coordinates are shared by all slices, each slice adds its
//! indicator, and as many degrees of its own copy of the functions as fit in [`MAX_TERMS`].

mod functions;
mod gaussian;
mod terms;

use crate::error::Error;
use crate::lanes::Lanes;
use crate::real::Real;
use crate::rows::rows_mut;
use functions::Argument;
use gaussian::Gaussians;
use heapless::Vec;
use terms::Term;

/// The largest number of coordinates.
pub const MAX_DIMS: usize = 16;
/// The largest total degree.
pub const MAX_ORDER: usize = 7;
/// The largest number of terms, constant included: 15 coordinates at order 2.
pub const MAX_TERMS: usize = 136;

/// Which one-dimensional functions a basis is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Family {
    /// Orthonormal shifted Legendre polynomials.
    #[default]
    Legendre,
    /// Walsh functions: piecewise constant on eighths.
    Step,
    /// Half-waves sin(pi d x + pi/2).
    Sine,
    /// Isotropic Gaussians.
    Gaussian,
}

/// A set of centred functions of unit variance on [0,1]^dims.
#[derive(Clone, Debug)]
pub struct Basis {
    family: Family,
    /// Coordinates that are regressed as numbers.
    continuous: usize,
    slices: usize,
    terms: Vec<Term, MAX_TERMS>,
    gaussians: Option<Gaussians>,
    /// Columns of degree one: the continuous coordinates and the indicators.
    first_degree: usize,
    /// First columns and their count, of the per-slice copies; (0, 0) without.
    copies: usize,
    columns: usize,
}

impl Basis {
    /// A basis over `dims` (1 to 16) coordinates of total degree at most `order` (0 to 7).
    ///
    /// # Errors
    /// [`Error::Range`] if a number is out of range or the terms, constant included, would exceed [`MAX_TERMS`].
    #[inline]
    pub fn new(family: Family, dims: usize, order: usize, slices: usize) -> Result<Self, Error> {
        let slices = if slices > 1 { slices } else { 0 };
        if dims == 0 || dims > MAX_DIMS || order > MAX_ORDER || slices >= MAX_TERMS {
            return Err(Error::Range);
        }
        let continuous = if slices > 0 { dims - 1 } else { dims };
        let indicators = if order > 0 { slices } else { 0 };
        let terms = terms::total_degree(continuous, order, indicators).ok_or(Error::Range)?;
        let shared = terms.len();
        if 1 + shared + indicators > MAX_TERMS {
            return Err(Error::Range);
        }
        // As many whole degrees of per-slice copies as fit.
        let fits = |degree: usize| {
            let count = terms.iter().filter(|term| term.degree() <= degree).count();
            (1 + shared + indicators + indicators * count <= MAX_TERMS).then_some(count)
        };
        let copies = (1..=order).rev().find_map(fits).unwrap_or(0);
        let gaussians = (family == Family::Gaussian).then(|| Gaussians::new(continuous, shared));
        Ok(Self {
            family,
            continuous,
            slices,
            first_degree: if order > 0 { continuous + indicators } else { 0 },
            copies: if indicators > 0 { copies } else { 0 },
            columns: shared + indicators + if indicators > 0 { indicators * copies } else { 0 },
            terms,
            gaussians,
        })
    }

    /// How many functions there are; the constant is not one of them.
    #[inline(always)]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// How many leading functions are of degree one.
    #[inline(always)]
    pub fn first_degree(&self) -> usize {
        self.first_degree
    }

    /// The ridge penalty of each column, relative: 4^(degree - 1) times the number of columns of that degree.
    ///
    /// High degrees are less often needed, and the more functions share a degree the less each one explains.
    pub(crate) fn penalties<R: Real>(&self, out: &mut [R]) {
        let mut counts = [0usize; MAX_ORDER + 1];
        let degree = |column: usize| self.degree(column);
        for column in 0..self.columns {
            if let Some(count) = counts.get_mut(degree(column)) {
                *count += 1;
            }
        }
        for (column, penalty) in out.iter_mut().enumerate().take(self.columns) {
            let degree = degree(column);
            let count = counts.get(degree).copied().unwrap_or(1);
            *penalty = R::from_usize(count) * R::from_usize(1).scale(2 * (degree as i32 - 1));
        }
    }

    /// 2^(1 - degree) for each column.
    pub(crate) fn scales<R: Real>(&self, out: &mut [R]) {
        for (column, scale) in out.iter_mut().enumerate().take(self.columns) {
            *scale = R::ONE.scale(1 - self.degree(column) as i32);
        }
    }

    /// The total degree of a column; indicators count as one, a slice's copy of a function as the function.
    fn degree(&self, column: usize) -> usize {
        let indicators = self.indicators();
        let shared = self.terms.len();
        let term = if column < self.continuous {
            column
        } else if column < self.continuous + indicators {
            return 1;
        } else if column < shared + indicators {
            column - indicators
        } else {
            (column - shared - indicators).checked_rem(self.copies).unwrap_or(0)
        };
        self.terms.get(term).map_or(1, Term::degree)
    }

    /// Whether another basis has the same functions in the same order.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.family == other.family
            && self.continuous == other.continuous
            && self.slices == other.slices
            && self.terms.len() == other.terms.len()
    }

    #[inline(always)]
    fn indicators(&self) -> usize {
        if self.first_degree > 0 { self.slices } else { 0 }
    }

    /// Evaluates every function at `L` points: `x` has a group of lanes for each coordinate, `out` gets one for each
    /// column. Coordinates are taken to be in [0, 1].
    #[inline(always)]
    pub(crate) fn evaluate<R: Real, const L: usize>(&self, x: &[Lanes<R, L>], out: &mut [Lanes<R, L>]) {
        let indicators = self.indicators();
        match &self.gaussians {
            Some(gaussians) => gaussians.evaluate(x, self.continuous, indicators, out),
            None => {
                let mut arguments = [[R::ZERO; L]; MAX_DIMS];
                for (argument, x) in arguments.iter_mut().zip(x).take(self.continuous) {
                    *argument = Argument::new(self.family, x);
                }
                for term in &self.terms {
                    let value = term.value(self.family, &arguments, out);
                    if let Some(column) = out.get_mut(term.column()) {
                        *column = value;
                    }
                }
            }
        }
        if indicators > 0
            && let Some(choice) = x.get(self.continuous)
        {
            self.evaluate_slices(choice, out);
        }
    }

    /// The indicators (S [k = s] - 1) / sqrt(S - 1), and sqrt(S) [k = s] times each copied function.
    #[inline(never)]
    fn evaluate_slices<R: Real, const L: usize>(&self, choice: &Lanes<R, L>, out: &mut [Lanes<R, L>]) {
        let slices = R::from_usize(self.slices);
        let outside = -R::ONE / (slices - R::ONE).sqrt();
        let inside = (slices - R::ONE).sqrt();
        let scale = slices.sqrt();
        let picked = choice.map(|u| slice_of(u, self.slices));
        let indicators = out.get_mut(self.continuous..self.continuous + self.slices).unwrap_or(&mut []);
        for (s, column) in indicators.iter_mut().enumerate() {
            for (value, &k) in column.iter_mut().zip(&picked) {
                *value = if k == s { inside } else { outside };
            }
        }
        let (shared, copies) = out.split_at_mut_checked(self.terms.len() + self.slices).unwrap_or((&mut [], &mut []));
        for (s, block) in rows_mut(copies, self.copies).enumerate().take(self.slices) {
            for (term, column) in self.terms.iter().zip(block) {
                let source = shared.get(term.column()).copied().unwrap_or([R::ZERO; L]);
                for ((value, source), &k) in column.iter_mut().zip(source).zip(&picked) {
                    *value = if k == s { scale * source } else { R::ZERO };
                }
            }
        }
    }
}

/// Which of `slices` equal parts of [0, 1] holds `u`; 1 belongs to the last.
#[inline(always)]
fn slice_of<R: Real>(u: R, slices: usize) -> usize {
    // A float-to-integer cast saturates, so this is total.
    ((u.to_f32() * slices as f32) as usize).min(slices - 1)
}
