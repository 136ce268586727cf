//! Power spectra in the plane, their radial average and anisotropy (figures 5.7 to 5.9, 5.14).
//!
//! Of n points `P(k) = |sum_j exp(-2 pi i k . x_j)|^2 / n`, on integer frequencies up to twice the principal one: above
//! 2 dims one spectrum for each pair of coordinates.

use super::exponential_sums;
use crate::counted::counted;
use crate::error::{Error, Result};
use crate::points::Points;
use serde::Serialize;

/// Frequencies beyond this integer are not computed: it bounds the memory at about 0.7 GB plus 230 bytes per point.
const FARTHEST: usize = 2400;
/// A ring of less power than this is empty, one whose power varies by less of its square is flat: their anisotropy
/// would be that of rounding errors.
const EMPTY: f64 = 1e-14;

/// A power spectrum on integer frequencies, white noise = 1, perhaps averaged over several realisations.
#[derive(Clone, Debug)]
pub struct Spectrum {
    /// Frequencies per axis.
    pub side: usize,
    /// Row after row; zero frequency at row and column `side / 2`.
    pub power: Vec<f64>,
    /// The integer frequency that counts as 1: for points the principal frequency, for tiles the size (cycles per
    /// pixel).
    pub unit: f64,
    /// How many independent realisations were averaged: point sets, or frames of a tile.
    pub realisations: usize,
    /// Rings about zero frequency, of width 1, from 1.
    pub rings: Vec<Ring>,
}

/// The frequencies whose distance to zero rounds to the same integer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ring {
    /// Distance to zero frequency, relative to the spectrum's unit.
    pub frequency: f64,
    /// Mean power.
    pub power: f64,
    /// Variance of the power over its squared mean, in dB: Ulichney's anisotropy (1988). One realisation of an
    /// isotropic process: 0; an average of N: -10 log10 N. Not a number where the power is 0, or the same everywhere.
    pub anisotropy: f64,
}

/// The figures that sum up a point spectrum.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct SpectrumSummary {
    /// Mean power below half the principal frequency: random points 1, blue noise near 0.
    pub low: f64,
    /// The largest mean power of a ring.
    pub peak: f64,
    /// Where that ring is, in principal frequencies.
    pub peak_frequency: f64,
    /// Mean anisotropy in dB of the rings between half and twice the principal frequency.
    pub anisotropy: f64,
}

/// The principal frequency of `points` points in the unit square: that of the hexagonal lattice, sqrt(2 n / sqrt 3).
pub fn principal_frequency(points: usize) -> f64 {
    (2.0 * points as f64 / 3.0_f64.sqrt()).sqrt()
}

impl Spectrum {
    /// The periodogram `|sum_j exp(-2 pi i k . x_j)|^2 / n` of two coordinates of a point set, up to twice the
    /// principal frequency or 2,400 (1.2 million points), whatever is less. Errors: fewer than one point, axes out of
    /// range.
    pub fn of_points(points: &Points, axes: [usize; 2]) -> Result<Spectrum> {
        super::check(points)?;
        if axes.iter().any(|&a| a >= points.dims()) {
            return Err(Error::input(format!("axes {axes:?} of points with {}", counted(points.dims(), "coordinate"))));
        }
        let plane: Vec<[f64; 2]> = points.iter().map(|p| axes.map(|a| f64::from(p[a]))).collect();
        let unit = principal_frequency(plane.len());
        let extent = ((2.0 * unit).ceil() as usize).min(FARTHEST);
        let mut power = exponential_sums::power(&plane, extent);
        power.iter_mut().for_each(|p| *p /= plane.len() as f64);
        Ok(Spectrum::new(2 * extent + 1, power, unit, 1))
    }

    /// A spectrum from its power.
    pub(crate) fn new(side: usize, power: Vec<f64>, unit: f64, realisations: usize) -> Spectrum {
        let mut spectrum = Spectrum { side, power, unit, realisations, rings: Vec::new() };
        spectrum.rings = spectrum.measure_rings();
        spectrum
    }

    /// The average of several spectra of the same size. Errors: none given, sizes differ.
    pub fn average(spectra: &[Spectrum]) -> Result<Spectrum> {
        let Some(first) = spectra.first() else { return Err(Error::input("no spectrum to average")) };
        if spectra.iter().any(|s| s.side != first.side || s.unit != first.unit) {
            return Err(Error::input(
                "spectra of different sizes cannot be averaged: give sets of as many points each",
            ));
        }
        let mut power = vec![0.0; first.power.len()];
        for spectrum in spectra {
            power.iter_mut().zip(&spectrum.power).for_each(|(sum, p)| *sum += p / spectra.len() as f64);
        }
        Ok(Spectrum::new(first.side, power, first.unit, spectra.iter().map(|s| s.realisations).sum()))
    }

    /// Distance to zero frequency and power of every place.
    fn frequencies(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let middle = (self.side / 2) as f64;
        self.power.iter().enumerate().map(move |(i, &p)| {
            let (x, y) = ((i % self.side) as f64 - middle, (i / self.side) as f64 - middle);
            ((x * x + y * y).sqrt(), p)
        })
    }

    fn measure_rings(&self) -> Vec<Ring> {
        // Whole rings only; the last partial one, at the extent itself, is left out too.
        let count = ((self.side - 1) / 2).max(1);
        let mut sums = vec![[0.0; 3]; count + 1];
        for (radius, p) in self.frequencies() {
            let ring = radius.round() as usize;
            if ring >= 1 && ring <= count {
                sums[ring][0] += 1.0;
                sums[ring][1] += p;
            }
        }
        for (radius, p) in self.frequencies() {
            let ring = radius.round() as usize;
            if ring >= 1 && ring <= count {
                let [n, sum, _] = sums[ring];
                sums[ring][2] += (p - sum / n) * (p - sum / n);
            }
        }
        let ring = |(radius, &[n, sum, squares]): (usize, &[f64; 3])| {
            let power = sum / n;
            let variance = squares / (n - 1.0);
            let relative = variance / (power * power);
            let flat = power < EMPTY || relative < EMPTY;
            let anisotropy = if flat { f64::NAN } else { 10.0 * libm::log10(relative) };
            Ring { frequency: radius as f64 / self.unit, power, anisotropy }
        };
        let rings = sums.iter().enumerate().skip(1).map(ring);
        // Points: below twice the principal frequency, as the extent is that rounded up.
        rings.take((2.0 * self.unit) as usize - 1).filter(|r| r.power.is_finite()).collect()
    }

    /// The figures that sum it up.
    pub fn summary(&self) -> SpectrumSummary {
        let low = self.frequencies().filter(|&(r, _)| r > 0.0 && r < 0.5 * self.unit);
        let (count, sum) = low.fold((0.0, 0.0), |(count, sum), (_, p)| (count + 1.0, sum + p));
        let none = Ring { frequency: f64::NAN, power: f64::NAN, anisotropy: f64::NAN };
        let peak = self.rings.iter().fold(none, |best, r| if r.power <= best.power { best } else { *r });
        let band: Vec<f64> = self
            .rings
            .iter()
            .filter(|r| r.frequency >= 0.5 && r.frequency <= 2.0 && r.anisotropy.is_finite())
            .map(|r| r.anisotropy)
            .collect();
        SpectrumSummary {
            low: sum / count,
            peak: peak.power,
            peak_frequency: peak.frequency,
            anisotropy: band.iter().sum::<f64>() / band.len() as f64,
        }
    }
}
