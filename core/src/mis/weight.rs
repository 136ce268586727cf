//! The optimal weights at a point, for a known alpha (2.15).

use super::linear::MAX_TECHNIQUES;
use crate::Error;

/// The optimal weight of one technique (2.15), for alpha from [`OptimalMis::alpha`](super::OptimalMis::alpha):
///
/// `w_j = alpha_j p_j / f + n_j p_j / S (1 - sum_k alpha_k p_k / f)`, S = sum_k n_k p_k.
///
/// Whatever alpha is, the weights sum to one. They may be negative or above 1. Where f is 0 they do not exist, though
/// such a sample still contributes: use [`optimal_contribution`], which needs no such exception.
///
/// - `pdf`: p_k(x), finite and at least 0; `counts`: n_k, at least 1; `alpha`: finite; all of one length in 1..=16.
/// - `value`: f(x), finite and not 0 (not divided by any density).
///
/// Where no density is positive each weight is 0.
///
/// Errors: [`Error::Range`] for arguments outside these ranges or a weight beyond the range of `f32` (f much too
/// small); [`Error::NotFinite`] for NaN or infinity among them.
pub fn optimal(pdf: &[f32], counts: &[u32], technique: usize, alpha: &[f32], value: f32) -> Result<f32, Error> {
    let point = Point::new(pdf, counts, technique, alpha, value)?;
    if value == 0.0 {
        return Err(Error::Range);
    }
    if point.own_pdf == 0.0 {
        return Ok(0.0);
    }
    let value = f64::from(value);
    let balance = point.own_count * point.own_pdf / point.sum;
    let weight = point.own_alpha * point.own_pdf / value + balance * (1.0 - point.control / value);
    narrowed(weight)
}

/// What one sample adds to the optimal MIS estimate: the term `w_j f / (n_j p_j)` of (2.10) with the weight of (2.15),
///
/// `alpha_j / n_j + (f - sum_k alpha_k p_k) / S`, S = sum_k n_k p_k.
///
/// The sum over all samples is the estimate, unbiased if alpha came from other samples. The term is not 0 where f is;
/// leaving such samples out keeps the mean and loses part of the gain. These terms, times the number of samples that
/// are regressed together, are what a regression control variate is fitted to (4.3.3).
///
/// Arguments and errors as for [`optimal`], except that `value` may be 0 and that the technique's own density must be
/// positive, as it is for the technique that drew the point ([`Error::Range`]).
///
/// ```
/// // f is exactly 2 p_0: the samples of technique 0 add 2, those of technique 1 nothing.
/// let add = |technique| noisefloor::mis::optimal_contribution(&[1.0, 3.0], &[1, 1], technique, &[2.0, 0.0], 2.0);
/// assert_eq!((add(0)?, add(1)?), (2.0, 0.0));
/// # Ok::<(), noisefloor::Error>(())
/// ```
pub fn optimal_contribution(
    pdf: &[f32],
    counts: &[u32],
    technique: usize,
    alpha: &[f32],
    value: f32,
) -> Result<f32, Error> {
    let point = Point::new(pdf, counts, technique, alpha, value)?;
    if point.own_pdf == 0.0 {
        return Err(Error::Range);
    }
    let term = point.own_alpha / point.own_count + (f64::from(value) - point.control) / point.sum;
    narrowed(term)
}

/// As an f32, if it is in range: a NaN is not.
fn narrowed(value: f64) -> Result<f32, Error> {
    if libm::fabs(value) <= f64::from(f32::MAX) { Ok(value as f32) } else { Err(Error::Range) }
}

/// The checked arguments, in f64.
struct Point {
    own_pdf: f64,
    own_count: f64,
    own_alpha: f64,
    /// S = sum n p.
    sum: f64,
    /// sum alpha p.
    control: f64,
}

impl Point {
    fn new(pdf: &[f32], counts: &[u32], technique: usize, alpha: &[f32], value: f32) -> Result<Point, Error> {
        let one_length = counts.len() == pdf.len() && alpha.len() == pdf.len();
        if !one_length || !(1..=MAX_TECHNIQUES).contains(&pdf.len()) {
            return Err(Error::Range);
        }
        let own = (pdf.get(technique), counts.get(technique), alpha.get(technique));
        let (Some(&own_pdf), Some(&own_count), Some(&own_alpha)) = own else { return Err(Error::Range) };
        if !value.is_finite() || !pdf.iter().chain(alpha).all(|x| x.is_finite()) {
            return Err(Error::NotFinite);
        }
        if pdf.iter().any(|&p| p < 0.0) || counts.contains(&0) {
            return Err(Error::Range);
        }
        Ok(Point {
            own_pdf: own_pdf.into(),
            own_count: own_count.into(),
            own_alpha: own_alpha.into(),
            sum: pdf.iter().zip(counts).map(|(&p, &n)| f64::from(n) * f64::from(p)).sum(),
            control: pdf.iter().zip(alpha).map(|(&p, &a)| f64::from(a) * f64::from(p)).sum(),
        })
    }
}
