//! Least squares with every size known to the compiler: no buffer, no workspace, the stack only.

use super::config::{Config, Estimate};
use super::design::Units;
use super::per_channel::{PerChannel, set};
use super::result::{self, Outcome, Summary};
use crate::basis::{Basis, Family};
use crate::error::Error;
use crate::linalg::ldlt;
use crate::linalg::{row, row_mut};

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
    offset: [f32; CHANNELS],
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
        let basis = Basis::new(family, DIMS, order, 0)?;
        if basis.columns() + 1 != TERMS || CHANNELS == 0 || CHANNELS > Config::MAX_CHANNELS {
            return Err(Error::Range);
        }
        Ok(Self {
            basis,
            samples: 0,
            offset: [0.0; CHANNELS],
            gram: [[0.0; TERMS]; TERMS],
            rhs: [[0.0; CHANNELS]; TERMS],
            square: [0.0; CHANNELS],
        })
    }

    /// Adds a sample at `u` in [0, 1]^DIMS.
    ///
    /// # Errors
    /// [`Error::NotFinite`] or [`Error::Range`]; the sample is then not added.
    #[inline(always)]
    pub fn add(&mut self, u: &[f32; DIMS], f: &[f32; CHANNELS]) -> Result<(), Error> {
        if !u.iter().chain(f).all(|value| value.is_finite()) {
            return Err(Error::NotFinite);
        }
        if !u.iter().all(|u| (0.0..=1.0).contains(u)) {
            return Err(Error::Range);
        }
        if self.samples == 0 {
            self.offset = *f;
        }
        let x = u.map(|u| [f64::from(u)]);
        let mut p = [[1.0]; TERMS];
        self.basis.evaluate(&x, p.get_mut(1..).unwrap_or(&mut []));
        let p = p.as_flattened();
        let gram = self.gram.as_flattened_mut();
        for (j, &value) in p.iter().enumerate() {
            for (out, &other) in row_mut(gram, j).iter_mut().zip(p) {
                *out += value * other;
            }
        }
        let values =
            core::array::from_fn::<f64, CHANNELS, _>(|channel| f64::from(f[channel]) - f64::from(self.offset[channel]));
        for (out, &p) in self.rhs.iter_mut().zip(p) {
            for (out, &value) in out.iter_mut().zip(&values) {
                *out += p * value;
            }
        }
        for (out, &value) in self.square.iter_mut().zip(&values) {
            *out += value * value;
        }
        self.samples += 1;
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
    #[inline(always)]
    pub fn estimate(&self, strength: f32) -> Result<Estimate, Error> {
        if self.samples == 0 {
            return Err(Error::NoSamples);
        }
        if !(strength > 0.0 && strength.is_finite()) {
            return Err(Error::Range);
        }
        let n = self.samples as f64;
        let sums = self.gram.as_flattened();
        let mut factor = self.gram;
        let factor = factor.as_flattened_mut();
        let mut penalties = [0.0; TERMS];
        self.basis.penalties(penalties.get_mut(1..).unwrap_or(&mut []));
        let strength = f64::from(strength) * n;
        ldlt::add_diagonal(factor, TERMS, |j| strength * penalties.get(j).copied().unwrap_or(0.0));
        // The intercept is the first unknown and has no penalty.
        ldlt::factor(factor, TERMS);
        let mut outcome = Outcome { correction: PerChannel::default(), variance: None };
        let mut units = [Units::default(); Config::MAX_CHANNELS];
        let mut residuals = PerChannel::default();
        let mut plain_variance = PerChannel::default();
        for channel in 0..CHANNELS {
            let rhs = core::array::from_fn::<f64, TERMS, _>(|j| self.rhs[j][channel]);
            let mut solution = rhs;
            ldlt::solve(factor, &mut solution);
            let total = rhs.first().copied().unwrap_or(0.0);
            let mean = total / n;
            set(&mut outcome.correction, channel, solution.first().copied().unwrap_or(0.0) - mean);
            if let (Some(unit), Some(&offset)) = (units.get_mut(channel), self.offset.get(channel)) {
                unit.offset = f64::from(offset) + mean;
            }
            // f'f - 2 b'r + b'G b
            let cross: f64 = solution.iter().zip(&rhs).map(|(b, r)| b * r).sum();
            let residual = self.square[channel] + quadratic(sums, &solution) - cross - cross;
            let plain = (self.square[channel] - total * total / n).max(0.0) / result::mean_divisor(n);
            set(&mut plain_variance, channel, plain);
            set(&mut residuals, channel, residual.max(0.0));
        }
        let plain_variance = (self.samples > 1).then_some(plain_variance);
        // With e the first unit vector and x = A^-1 e, the intercept's weights on the samples have squares of sum x'P'P
        // x.
        let mut x = [0.0; TERMS];
        if let Some(first) = x.first_mut() {
            *first = 1.0;
        }
        ldlt::solve(factor, &mut x);
        let eccentricity = (n * quadratic(sums, &x) - 1.0).max(0.0);
        let variance = result::residual_variance(residuals, TERMS.saturating_sub(1), n, eccentricity);
        outcome.variance = variance.or(plain_variance);
        let samples = usize::try_from(self.samples).unwrap_or(usize::MAX);
        Ok(result::finish(Summary { samples, channels: CHANNELS, units, plain_variance, colour: None }, outcome))
    }

    /// Adds all samples of another regressor.
    ///
    /// # Errors
    /// [`Error::Mismatch`] if the bases differ.
    pub fn merge(&mut self, other: &Self) -> Result<(), Error> {
        if !self.basis.is_same(&other.basis) {
            return Err(Error::Mismatch);
        }
        if self.samples == 0 {
            self.offset = other.offset;
        }
        let count = other.samples as f64;
        for channel in 0..CHANNELS {
            let shift = f64::from(other.offset[channel]) - f64::from(self.offset[channel]);
            let total = other.rhs.first().map_or(0.0, |row| row[channel]);
            self.square[channel] += other.square[channel] + shift * (total + total + shift * count);
            for (j, (ours, theirs)) in self.rhs.iter_mut().zip(&other.rhs).enumerate() {
                let column = row(other.gram.as_flattened(), j).first().copied().unwrap_or(0.0);
                ours[channel] += theirs[channel] + shift * column;
            }
        }
        for (ours, theirs) in self.gram.as_flattened_mut().iter_mut().zip(other.gram.as_flattened()) {
            *ours += *theirs;
        }
        self.samples = self.samples.saturating_add(other.samples);
        Ok(())
    }
}

/// x'G x for a packed G.
fn quadratic(gram: &[f64], x: &[f64]) -> f64 {
    let mut total = 0.0;
    for (j, &value) in x.iter().enumerate() {
        for (k, (&gram, &other)) in row(gram, j).iter().zip(x).enumerate() {
            total += value * if k == j { gram * other } else { (gram + gram) * other };
        }
    }
    total
}
