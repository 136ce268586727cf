//! Integration error on random half-spaces and Gaussian bumps.

use super::integrands::{Family, Integrand};
use crate::counted::counted;
use crate::error::{Error, Result};
use crate::points::Points;
use rayon::prelude::*;
use serde::Serialize;

/// Integrands of each family for sets that are not too large, as of the published figures.
const INTEGRANDS: usize = 4096;
/// Evaluations per family, beyond which fewer integrands are taken, but never fewer than `FEWEST`.
const EVALUATIONS: usize = 1 << 27;
const FEWEST: usize = 256;
const SEED: u64 = 0x1e57;
/// Normals have no component below this.
const SMALLEST: f64 = 1e-3;

/// Mean squared integration errors relative to the variance of as many independent uniform points.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Integration {
    /// Over random half-spaces.
    pub half_spaces: f64,
    /// Over random Gaussian bumps.
    pub gaussians: f64,
    /// Integrands of each family.
    pub integrands: usize,
}

/// The errors of the first points of a set.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PrefixError {
    /// How many points.
    pub points: usize,
    /// Root mean square error over random half-spaces.
    pub half_spaces: f64,
    /// Its square, relative to the variance of as many independent points.
    pub half_spaces_relative: f64,
    /// Root mean square error over random Gaussian bumps.
    pub gaussians: f64,
    /// Its square, relative to the variance of as many independent points.
    pub gaussians_relative: f64,
}

/// Integration errors of all of valid points: sum of squared errors over sum of variances, over 4,096 integrands (fewer
/// above 32,768 points: 512 at 262,144).
pub fn integration(points: &Points) -> Integration {
    let integrands = (EVALUATIONS / points.len().max(1)).clamp(FEWEST, INTEGRANDS);
    let [half_spaces, gaussians] = [Family::HalfSpace, Family::Gaussian].map(|family| {
        let (errors, variance) = squared_errors(points, family, &[points.len()], integrands);
        errors[0] / variance * points.len() as f64
    });
    Integration { half_spaces, gaussians, integrands }
}

/// Errors of the first points of progressive sets, averaged over sets (figure 5.17), for the given increasing numbers
/// of points.
///
/// Errors: no set, sets of different sizes, no integrand, a number of points that is 0 or more than there are, or
/// numbers that do not increase.
pub fn prefix_errors(sets: &[Points], counts: &[usize], integrands: usize) -> Result<Vec<PrefixError>> {
    let Some(first) = sets.first() else { return Err(Error::input("no point set")) };
    sets.iter().try_for_each(super::check)?;
    if let Some(other) = sets.iter().find(|s| s.len() != first.len() || s.dims() != first.dims()) {
        let size = |set: &Points| format!("{} in {} dims", counted(set.len(), "point"), set.dims());
        let (first, other) = (size(first), size(other));
        return Err(Error::Input(format!(
            "point sets of different sizes, {first} and {other}: their errors cannot be averaged"
        )));
    }
    if integrands == 0 {
        return Err(Error::input("0 integrands: give at least 1"));
    }
    let increasing = counts.is_sorted_by(|a, b| a < b);
    if !increasing || counts.first() == Some(&0) || counts.last().is_some_and(|&c| c > first.len()) {
        return Err(Error::input(format!(
            "prefixes must be increasing numbers from 1 to the {}",
            counted(first.len(), "point")
        )));
    }
    let [half, bumps] = [Family::HalfSpace, Family::Gaussian].map(|family| {
        let mut mean = vec![0.0; counts.len()];
        let mut variance = 0.0;
        for points in sets {
            let (errors, of_integrands) = squared_errors(points, family, counts, integrands);
            mean.iter_mut().zip(errors).for_each(|(m, e)| *m += e / (sets.len() * integrands) as f64);
            variance = of_integrands / integrands as f64;
        }
        (mean, variance)
    });
    let error = |(i, &points): (usize, &usize)| PrefixError {
        points,
        half_spaces: half.0[i].sqrt(),
        half_spaces_relative: half.0[i] / half.1 * points as f64,
        gaussians: bumps.0[i].sqrt(),
        gaussians_relative: bumps.0[i] / bumps.1 * points as f64,
    };
    Ok(counts.iter().enumerate().map(error).collect())
}

/// Numbers of points from 1 to `points`, about `per_octave` in every doubling, powers of two among them.
pub fn log_spaced(points: usize, per_octave: usize) -> Vec<usize> {
    let per_octave = per_octave.max(1);
    let number = |i: usize| libm::round(libm::pow(2.0, i as f64 / per_octave as f64)) as usize;
    let mut counts: Vec<usize> = (0..).map(number).take_while(|&n| n < points).chain([points]).collect();
    counts.dedup();
    counts
}

/// Sums over integrands of squared errors after each count of points, and of the integrands' variances.
fn squared_errors(points: &Points, family: Family, counts: &[usize], integrands: usize) -> (Vec<f64>, f64) {
    let one = |index: usize| {
        let integrand = Integrand::random(family, points.dims(), SMALLEST, SEED, index as u64);
        let mut sum = 0.0;
        let mut next = 0;
        let mut errors = Vec::with_capacity(counts.len());
        for (i, point) in points.iter().enumerate().take(counts.last().copied().unwrap_or(0)) {
            sum += integrand.value(point);
            if i + 1 == counts[next] {
                let error = sum / counts[next] as f64 - integrand.integral;
                errors.push(error * error);
                next += 1;
            }
        }
        (errors, integrand.variance)
    };
    let all: Vec<(Vec<f64>, f64)> = (0..integrands).into_par_iter().map(one).collect();
    let mut total = vec![0.0; counts.len()];
    all.iter().for_each(|(errors, _)| total.iter_mut().zip(errors).for_each(|(t, e)| *t += e));
    (total, all.iter().map(|a| a.1).sum())
}
