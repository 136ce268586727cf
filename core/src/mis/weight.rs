//! What a sample adds with the optimal weights, for a known alpha (2.15).

use super::linear::MAX_TECHNIQUES;
use crate::error::{Error, ensure};
use crate::real::Real;

/// What one sample adds to the optimal MIS estimate: the term `w_j f / (n_j p_j)` of (2.10) with the optimal weight
/// (2.15), `w_j = alpha_j p_j / f + n_j p_j / S (1 - sum_k alpha_k p_k / f)`,
///
/// `alpha_j / n_j + (f - sum_k alpha_k p_k) / S`, S = sum_k n_k p_k.
///
/// The sum over all samples is the estimate, unbiased if alpha, from
/// [`OptimalMis::alpha`](super::OptimalMis::alpha), came from other samples; of least variance if counts are fixed. The
/// term is not 0 where f is; leaving such samples out keeps the mean and loses part of the gain. These terms, times the
/// number of samples that are regressed together, are what a regression control variate is fitted to (section 4.3.3).
///
/// - `pdf`: p_k(x), finite and at least 0, positive for the technique that drew the point; `counts`: n_k, at least 1;
///   `alpha`: finite; all of one length in 1..=16.
/// - `value`: f(x), finite (not divided by any density).
///
/// # Errors
/// [`Error::Length`] for different lengths; [`Error::Range`] for arguments outside these ranges or a term beyond the
/// range of `f32`; [`Error::NotFinite`] for NaN or infinity among them.
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
    ensure(counts.len() == pdf.len() && alpha.len() == pdf.len(), Error::Length)?;
    ensure((1..=MAX_TECHNIQUES).contains(&pdf.len()), Error::Range)?;
    let own = (pdf.get(technique), counts.get(technique), alpha.get(technique));
    let (Some(&own_pdf), Some(&own_count), Some(&own_alpha)) = own else { return Err(Error::Range) };
    ensure(value.is_finite() && pdf.iter().chain(alpha).all(|x| x.is_finite()), Error::NotFinite)?;
    ensure(own_pdf > 0.0 && pdf.iter().all(|&p| p >= 0.0) && !counts.contains(&0), Error::Range)?;
    let sum: f64 = pdf.iter().zip(counts).map(|(&p, &n)| f64::from(n) * f64::from(p)).sum();
    let control: f64 = pdf.iter().zip(alpha).map(|(&p, &a)| f64::from(a) * f64::from(p)).sum();
    let term = f64::from(own_alpha) / f64::from(own_count) + (f64::from(value) - control) / sum;
    ensure(Real::abs(term) <= f64::from(f32::MAX), Error::Range)?;
    Ok(term as f32)
}
