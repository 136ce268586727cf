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
/// Heuristic: (n_j p_j)^beta / sum_k (n_k p_k)^beta; the parameter is beta, positive and finite, 0 means the usual 2.
/// (2.13) prints the exponent outside the sum; those weights would not sum to 1, and these are Veach's.
pub const NF_MIS_POWER: u32 = 1;
/// Heuristic: the balance heuristic among the techniques with n_k p_k >= epsilon * max_i n_i p_i; the parameter is
/// epsilon, 0..1. 0 is the balance heuristic, 1 the maximum heuristic with ties shared. (2.14) prints an absolute
/// threshold on p_k, without the counts; it would depend on the unit of the density, and leave points where no
/// technique reaches it. This is Veach's form.
pub const NF_MIS_CUTOFF: u32 = 2;
/// Heuristic: 1 for the technique with the largest n_k p_k (the first of them if several tie), 0 for others.
pub const NF_MIS_MAXIMUM: u32 = 3;

/// The weight of technique j at one point by a heuristic, NF_MIS_BALANCE to NF_MIS_MAXIMUM.
///
/// parameter: beta or epsilon; the other two heuristics do not read it. pdf[techniques]: p_k, the density of each
/// technique at the point, in any one measure, at least 0. Infinity stands for a delta distribution: where any is
/// infinite the finite ones count as 0 and the infinite ones are equally dense. counts[techniques]: n_k, the number of
/// samples of each technique; one with 0 has no part in it. techniques: 1..NF_MIS_MAX_TECHNIQUES. technique: j, below
/// techniques.
///
/// The weights of all techniques sum to 1 and are safe for densities from 1e-38 to 1e38. Where every n_k p_k is 0, so
/// that the point cannot have been drawn, each is 0. With them, the sum over all samples of weight * f / (n_j p_j) is
/// unbiased (2.10).
///
/// NF_ERR_NULL; NF_ERR_RANGE: heuristic, parameter, techniques, technique, or a negative density; NF_ERR_NOT_FINITE: a
/// density is NaN, or the parameter not finite.
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

/// The optimal weight (2.15) of Kondapaneni et al. (2019), for an alpha from nf_omis_alpha:
/// w_j = alpha_j p_j / f + n_j p_j / S (1 - sum_k alpha_k p_k / f), S = sum_k n_k p_k.
///
/// pdf[techniques]: finite and at least 0. counts[techniques]: at least 1. alpha[techniques]: finite. value: f at the
/// point, not divided by a density, finite and not 0. Where f is 0 the weight does not exist, though the sample still
/// contributes: see nf_mis_optimal_contribution.
///
/// Whatever alpha is, the weights sum to 1; they may be negative or above 1. Where no density is positive each is 0.
///
/// NF_ERR_NULL; NF_ERR_RANGE: an argument is outside these ranges, or the weight outside float's; NF_ERR_NOT_FINITE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_mis_optimal(
    pdf: *const f32,
    counts: *const u32,
    techniques: u32,
    technique: u32,
    alpha: *const f32,
    value: f32,
    weight: *mut f32,
) -> nf_status {
    // SAFETY: as for nf_mis_weight.
    unsafe {
        with_alpha(pdf, counts, techniques, alpha, weight, |pdf, counts, alpha| {
            mis::optimal(pdf, counts, technique as usize, alpha, value)
        })
    }
}

/// What one sample of technique j adds to the estimate (2.10) with optimal weights:
/// w_j f / (n_j p_j) = alpha_j / n_j + (f - sum_k alpha_k p_k) / S, S = sum_k n_k p_k.
///
/// The sum over all samples is the estimate, unbiased if alpha came from other samples. The term is not 0 where f is;
/// leaving such samples out keeps the mean and loses part of the gain. These terms, times the number of samples, are
/// what a regression control variate is fitted to (4.3.3).
///
/// Arguments and errors as for nf_mis_optimal, except that value may be 0, and pdf[technique] must be positive.
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
        if !(1..=MAX_TECHNIQUES).contains(&len) {
            return Err(NF_ERR_RANGE);
        }
        // SAFETY: passed on to the caller.
        let (pdf, counts, alpha) =
            unsafe { (convert::slice(pdf, len)?, convert::slice(counts, len)?, convert::slice(alpha, len)?) };
        let value = compute(pdf, counts, alpha).map_err(status_of)?;
        // SAFETY: passed on to the caller.
        unsafe { convert::write(weight, value) }
    })();
    status(result)
}
