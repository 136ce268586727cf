//! The balance, power, cutoff and maximum heuristics (2.12-2.14).

use super::linear::MAX_TECHNIQUES;
use crate::error::{Error, check_part, ensure};
use crate::matrix::at;
use crate::real::Real;

/// The exponent that Veach recommends for [`power`].
pub const DEFAULT_BETA: f32 = 2.0;

/// The balance heuristic (2.12): `n_j p_j / sum_k n_k p_k`.
///
/// Arguments and errors are the same for every heuristic, at one point x:
///
/// - `pdf`: p_k(x) of each of the 1..=16 techniques, in any common measure, at least 0. Infinity stands for a delta
///   distribution: where any is infinite the finite ones count as 0, and the infinite ones are equally dense.
/// - `counts`: n_k, the samples taken of each technique. One with n_k = 0 has no part in it, whatever its density.
/// - `technique`: which one's weight is asked for.
///
/// The weights of all techniques sum to one. Where every n_k p_k is 0, so that x cannot have been drawn, each is 0.
///
/// # Errors
/// [`Error::Length`] for slices of different lengths; [`Error::Range`] for lengths outside 1..=16, a technique that
/// does not exist or a negative density; [`Error::NotFinite`] for a NaN.
///
/// ```
/// // The point is three times as dense under the second technique; one sample of each.
/// assert_eq!(noisefloor::mis::balance(&[1.0, 3.0], &[1, 1], 1)?, 0.75);
/// # Ok::<(), noisefloor::Error>(())
/// ```
pub fn balance(pdf: &[f32], counts: &[u32], technique: usize) -> Result<f32, Error> {
    let densities = Densities::new(pdf, counts, technique)?;
    Ok(densities.weight(|density| density))
}

/// The power heuristic: `(n_j p_j)^beta / sum_k (n_k p_k)^beta`; [`DEFAULT_BETA`] is 2.
///
/// `beta` is positive and finite ([`Error::Range`], [`Error::NotFinite`]): 1 is the balance heuristic, and the limit at
/// infinity the maximum heuristic, where none tie. (2.13) prints the exponent outside the sum of its denominator; those
/// weights would not sum to one, and these are Veach's. Other arguments and errors as for [`balance`].
pub fn power(pdf: &[f32], counts: &[u32], technique: usize, beta: f32) -> Result<f32, Error> {
    ensure(beta.is_finite(), Error::NotFinite)?;
    ensure(beta > 0.0, Error::Range)?;
    let densities = Densities::new(pdf, counts, technique)?;
    if beta == DEFAULT_BETA {
        return Ok(densities.weight(|density| density * density));
    }
    // Over the largest of them: no power is beyond f64.
    let largest = densities.largest().or_one();
    let raised = |density: f64| libm::pow(density / largest, f64::from(beta));
    // 0 stays 0 however small beta is.
    Ok(densities.weight(|density| if density > 0.0 { raised(density) } else { 0.0 }))
}

/// The cutoff heuristic: the balance heuristic among the techniques with `n_k p_k >= epsilon max_i n_i p_i`.
///
/// `epsilon` is in 0..=1 ([`Error::Range`], [`Error::NotFinite`]): 0 is the balance heuristic, 1 the maximum heuristic
/// with ties shared. (2.14) prints an absolute threshold on p_k, without the counts. An absolute one has the unit of a
/// density, so it changes with the scale of the scene, and where no technique reaches it the weights are 0/0; without
/// counts the weights ignore how often each technique was used. This is Veach's form, which always keeps the best
/// technique. Other arguments and errors as for [`balance`].
pub fn cutoff(pdf: &[f32], counts: &[u32], technique: usize, epsilon: f32) -> Result<f32, Error> {
    check_part(epsilon)?;
    let densities = Densities::new(pdf, counts, technique)?;
    let least = f64::from(epsilon) * densities.largest();
    Ok(densities.weight(|density| if density >= least { density } else { 0.0 }))
}

/// The maximum heuristic: 1 for the technique with the largest `n_k p_k`, the first of them if several tie; else 0.
///
/// Arguments and errors as for [`balance`].
pub fn maximum(pdf: &[f32], counts: &[u32], technique: usize) -> Result<f32, Error> {
    let densities = Densities::new(pdf, counts, technique)?;
    let largest = densities.largest();
    let is_first = densities.all().position(|density| density == largest) == Some(technique);
    Ok(if is_first && largest > 0.0 { 1.0 } else { 0.0 })
}

/// n_k p_k of every technique: a `u32` times an `f32`, so that sums and squares of them are far from `f64`'s limits.
struct Densities {
    each: [f64; MAX_TECHNIQUES],
    techniques: usize,
    /// That of the technique whose weight is asked for.
    own: f64,
}

impl Densities {
    #[inline]
    fn new(pdf: &[f32], counts: &[u32], technique: usize) -> Result<Densities, Error> {
        let techniques = pdf.len();
        ensure(counts.len() == techniques, Error::Length)?;
        ensure((1..=MAX_TECHNIQUES).contains(&techniques) && technique < techniques, Error::Range)?;
        let (mut each, mut is_usual) = ([0.0; MAX_TECHNIQUES], true);
        for (density, (&p, &n)) in each.iter_mut().zip(pdf.iter().zip(counts)) {
            is_usual &= (0.0..=f32::MAX).contains(&p);
            *density = f64::from(n) * f64::from(p);
        }
        if !is_usual {
            each = unusual(pdf, counts)?;
        }
        Ok(Densities { each, techniques, own: at(&each, technique) })
    }

    fn all(&self) -> impl Iterator<Item = f64> {
        self.each.iter().take(self.techniques).copied()
    }

    fn largest(&self) -> f64 {
        self.all().fold(0.0, f64::max)
    }

    /// The part that the technique's own density has of the sum over all, once `f` has been applied to each.
    #[inline]
    fn weight(&self, f: impl Fn(f64) -> f64) -> f32 {
        let sum: f64 = self.all().map(&f).sum();
        (f(self.own) / sum.or_one()) as f32
    }
}

/// Where a density is infinite, NaN or negative.
#[cold]
fn unusual(pdf: &[f32], counts: &[u32]) -> Result<[f64; MAX_TECHNIQUES], Error> {
    ensure(!pdf.iter().any(|p| p.is_nan()), Error::NotFinite)?;
    ensure(pdf.iter().all(|&p| p >= 0.0), Error::Range)?;
    let delta = pdf.iter().zip(counts).any(|(&p, &n)| n > 0 && p == f32::INFINITY);
    let mut each = [0.0; MAX_TECHNIQUES];
    for (density, (&p, &n)) in each.iter_mut().zip(pdf.iter().zip(counts)) {
        let p = match (delta, p == f32::INFINITY) {
            (true, true) => 1.0,
            (false, false) => f64::from(p),
            // An infinite density beside none that counts has n = 0: it must not become 0 * infinity.
            _ => 0.0,
        };
        *density = f64::from(n) * p;
    }
    Ok(each)
}
