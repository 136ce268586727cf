//! Least squares with every size known to the compiler: no buffer, no workspace, the stack only.

use super::config::{Config, Estimate};
use super::design::Units;
use super::fit::{Penalty, normal};
use super::per_channel::PerChannel;
use super::result::Summary;
use super::samples::Sample;
use super::sums::{Change, Form, Sums};
use crate::arena::Arena;
use crate::basis::{Basis, Family, MAX_TERMS, Shape};
use crate::error::{Error, ensure};
use crate::matrix::{Panel, Triangle, first_mut, from_mut};
use core::iter;

/// A streaming least-squares regressor (Alg. 1) over `DIMS` coordinates with `TERMS` terms, constant included, and
/// `CHANNELS` values of each sample, in `f64`. For `f32` there is [`Accumulator`](super::Accumulator).
///
/// ```
/// use noisefloor::basis::Family;
/// use noisefloor::control_variate::Regressor;
///
/// // Total degree 2 over 2 coordinates: 6 terms.
/// let mut regressor = Regressor::<2, 6, 1>::new(Family::Legendre, 2)?;
/// for i in 0..32 {
///     let u = [i as f32 / 32.0, (i * 7 % 32) as f32 / 32.0];
///     regressor.add(&u, &[u[0] * u[0] + u[1]])?;
/// }
/// let estimate = regressor.estimate(1e-9)?;
/// assert!((estimate.mean[0] - 5.0 / 6.0).abs() < 1e-6);
/// # Ok::<(), noisefloor::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Regressor<const DIMS: usize, const TERMS: usize, const CHANNELS: usize> {
    basis: Basis,
    samples: u64,
    offset: PerChannel<f64>,
    /// Lower triangles of the sums of products (4.28), packed into the first rows.
    gram: [[f64; TERMS]; TERMS],
    /// Sums of products with the values (4.27).
    rhs: [[f64; CHANNELS]; TERMS],
    square: [f64; CHANNELS],
}

impl<const DIMS: usize, const TERMS: usize, const CHANNELS: usize> Regressor<DIMS, TERMS, CHANNELS> {
    /// An empty regressor of total degree `order`.
    ///
    /// # Errors
    /// [`Error::Range`] if `DIMS`, `order` and `TERMS` do not belong together or `CHANNELS` is not 1 to 4.
    pub fn new(family: Family, order: usize) -> Result<Self, Error> {
        let mut basis = Basis::empty();
        basis.set(family, Shape::new(DIMS, order, 0, MAX_TERMS)?);
        ensure(basis.columns() + 1 == TERMS && (1..=Config::MAX_CHANNELS).contains(&CHANNELS), Error::Range)?;
        Ok(Self {
            basis,
            samples: 0,
            offset: PerChannel::default(),
            gram: [[0.0; TERMS]; TERMS],
            rhs: [[0.0; CHANNELS]; TERMS],
            square: [0.0; CHANNELS],
        })
    }

    /// Adds a sample at `u` in [0, 1]^DIMS.
    ///
    /// # Errors
    /// [`Error::NotFinite`] or [`Error::Range`]; the sample is then not added.
    #[inline]
    pub fn add(&mut self, u: &[f32; DIMS], f: &[f32; CHANNELS]) -> Result<(), Error> {
        Sample::new(u, f).check()?;
        let x = u.map(|u| [f64::from(u)]);
        let mut p = [[1.0]; TERMS];
        self.basis.evaluate(&x, from_mut(&mut p, 1));
        let mut values = f.map(f64::from);
        if self.samples == 0 {
            self.offset = PerChannel::from_row(&values);
        }
        for (value, &offset) in values.iter_mut().zip(&self.offset.0) {
            *value -= offset;
        }
        self.sums_mut().add(p.as_flattened_mut(), &mut values);
        self.samples = self.samples.saturating_add(1);
        Ok(())
    }

    /// Samples added so far.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// The estimate of a fit with a ridge of `strength` per sample; strengths near 1e-9 are least squares.
    ///
    /// # Errors
    /// [`Error::NoSamples`], or [`Error::Range`] for a strength that is not positive and finite.
    #[inline]
    pub fn estimate(&self, strength: f32) -> Result<Estimate, Error> {
        ensure(self.samples > 0, Error::NoSamples)?;
        ensure(strength > 0.0 && strength.is_finite(), Error::Range)?;
        let units = Units { offsets: self.offset, ..Units::default() };
        let summary = Summary::of_sums(iter::once(self.sums()), self.samples, CHANNELS, units);
        let mut penalties = [0.0; TERMS];
        let penalties = first_mut(&mut penalties, self.basis.columns());
        self.basis.penalties(penalties);
        let penalty = Penalty { strength: f64::from(strength), relative: penalties };
        // Enough whatever the sizes are.
        let mut workspace = [[[0.0; TERMS]; TERMS]; 4];
        let needed = normal::len(self.sums().layout());
        let arena = &mut Arena::new(workspace.as_flattened_mut().as_flattened_mut(), Some(needed))?;
        Ok(summary.finish(normal::least_squares(&self.sums(), penalty, arena)))
    }

    /// Adds all samples of another regressor.
    ///
    /// # Errors
    /// [`Error::Mismatch`] if the bases differ.
    pub fn merge(&mut self, other: &Self) -> Result<(), Error> {
        ensure(self.basis == other.basis, Error::Mismatch)?;
        if self.samples == 0 {
            self.offset = other.offset;
        }
        let change = Change { shift: other.offset - self.offset, ..Change::none() };
        self.sums_mut().merge(&other.sums(), &change);
        self.samples = self.samples.saturating_add(other.samples);
        Ok(())
    }

    fn sums(&self) -> Sums<&[f64]> {
        let gram = Triangle::new(self.gram.as_flattened(), TERMS);
        let rhs = Panel::new(self.rhs.as_flattened(), CHANNELS);
        Sums { form: Form::Products, gram, rhs, square: &self.square }
    }

    fn sums_mut(&mut self) -> Sums<&mut [f64]> {
        let gram = Triangle::new(self.gram.as_flattened_mut(), TERMS);
        let rhs = Panel::new(self.rhs.as_flattened_mut(), CHANNELS);
        Sums { form: Form::Products, gram, rhs, square: &mut self.square }
    }
}
