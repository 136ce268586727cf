//! Multiple importance sampling weights at a point.

use crate::convert;
use crate::status::*;
use noisefloor_core::Error;
use noisefloor_core::mis::{self, MAX_TECHNIQUES};

/// The most techniques that multiple importance sampling combines.
pub const NF_MIS_MAX_TECHNIQUES: u32 = 16;

const _: () = assert!(NF_MIS_MAX_TECHNIQUES as usize == MAX_TECHNIQUES);

/// Heuristic (2.12): n_j p_j / sum_k n_k p_k. The default.
pub const NF_MIS_BALANCE: u32 = 0;
/// Heuristic: (n_j p_j)^beta / sum_k (n_k p_k)^beta, the parameter being beta, above 0; 0 means the usual 2. Veach's:
/// the exponents of (2.13) would not sum to 1.
pub const NF_MIS_POWER: u32 = 1;
/// Heuristic: balance among techniques with n_k p_k >= epsilon max_i n_i p_i, the parameter being epsilon, 0..1.
/// Veach's: the threshold of (2.14) on p_k alone would depend on the density's unit.
pub const NF_MIS_CUTOFF: u32 = 2;
/// Heuristic: 1 for the first technique with the largest n_k p_k, 0 for others.
pub const NF_MIS_MAXIMUM: u32 = 3;

/// The weight of technique j at one point by a heuristic. The sum over all samples of weight * f / (n_j p_j) is
/// unbiased (2.10). Where p_j is infinite, take for f / p_j the finite ratio that the renderer has.
///
/// parameter: beta or epsilon, else not read. pdf[techniques]: p_k, the density of each technique at the point, at
/// least 0; infinite ones (delta distributions) are equally dense, and finite ones then count as 0. counts[techniques]:
/// n_k, samples of each technique; one with 0 has no part. techniques: 1..NF_MIS_MAX_TECHNIQUES. technique: j.
///
/// The weights of all techniques sum to 1, for densities from 1e-38 to 1e38; each is 0 where every n_k p_k is.
///
/// NF_ERR_RANGE: heuristic, parameter, techniques, technique, a density; NF_ERR_NOT_FINITE: a density is NaN, or the
/// parameter not finite.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_mis_weight(
    heuristic: u32,
    parameter: f32,
    pdf: *const f32,
    counts: *const u32,
    techniques: u32,
    technique: u32,
    weight: *mut f32,
) -> nf_status {
    let technique = technique as usize;
    let beta = if parameter == 0.0 { mis::DEFAULT_BETA } else { parameter };
    let compute = |pdf: &[f32], counts: &[u32], _: &[f32]| match heuristic {
        NF_MIS_BALANCE => mis::balance(pdf, counts, technique),
        NF_MIS_POWER => mis::power(pdf, counts, technique, beta),
        NF_MIS_CUTOFF => mis::cutoff(pdf, counts, technique, parameter),
        NF_MIS_MAXIMUM => mis::maximum(pdf, counts, technique),
        _ => Err(Error::Range),
    };
    // SAFETY: the caller passes arrays of the length it says and an output that is no part of them; the densities stand
    // in for an alpha that is not read.
    unsafe { with_alpha(pdf, counts, techniques, pdf, weight, compute) }
}

/// What one sample of technique j adds to the estimate (2.10) with the optimal weights (2.15) of Kondapaneni et al.
/// (2019): w_j f / (n_j p_j) = alpha_j / n_j + (f - sum_k alpha_k p_k) / S, S = sum_k n_k p_k.
///
/// Unbiased if alpha came from other samples; of least variance if counts are fixed. The term is not 0 where f is: add
/// those samples too. Times the number of samples regressed together, a regression is fitted to it (section 4.3.3).
///
/// pdf[techniques]: finite, at least 0, that of the technique positive. counts[techniques]: at least 1.
/// alpha[techniques]: from nf_omis_solve. value: f, not divided by a density. All finite.
///
/// NF_ERR_RANGE: an argument, or the term in float; NF_ERR_NOT_FINITE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_mis_optimal_contribution(
    pdf: *const f32,
    counts: *const u32,
    techniques: u32,
    technique: u32,
    alpha: *const f32,
    value: f32,
    contribution: *mut f32,
) -> nf_status {
    // SAFETY: as for nf_mis_weight.
    unsafe {
        with_alpha(pdf, counts, techniques, alpha, contribution, |pdf, counts, alpha| {
            mis::optimal_contribution(pdf, counts, technique as usize, alpha, value)
        })
    }
}

/// # Safety
/// `pdf`, `counts` and `alpha` must be NULL or `techniques` elements, `weight` NULL or one that is no part of them.
unsafe fn with_alpha(
    pdf: *const f32,
    counts: *const u32,
    techniques: u32,
    alpha: *const f32,
    weight: *mut f32,
    compute: impl FnOnce(&[f32], &[u32], &[f32]) -> Result<f32, Error>,
) -> nf_status {
    let result = (|| {
        let len = techniques as usize;
        // Before any slice is made: a wild length may reach beyond the caller's arrays.
        ensure((1..=MAX_TECHNIQUES).contains(&len), NF_ERR_RANGE)?;
        // SAFETY: passed on to the caller.
        let (pdf, counts, alpha) =
            unsafe { (convert::slice(pdf, len)?, convert::slice(counts, len)?, convert::slice(alpha, len)?) };
        let value = compute(pdf, counts, alpha)?;
        // SAFETY: passed on to the caller.
        unsafe { convert::write(weight, value) }
    })();
    status(result)
}
