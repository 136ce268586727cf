//! How an accumulator's sums lie in its memory of f64.
//!
//! `samples | ratio[J] | matrix[J (J + 1) / 2] | P times balance, progressive, moment[J] | P times alpha[J]`
//!
//! All before the alphas are sums over the samples: they decay and are merged as they lie there.

use super::linear::MAX_TECHNIQUES;
use crate::matrix::packed_len;

/// The f64 that [`OptimalMis`](super::OptimalMis) needs; 0 if `techniques` is not in 1..=16, `integrals` is 0, or no
/// memory could hold them.
pub const fn len(techniques: usize, integrals: usize) -> usize {
    if techniques == 0 || techniques > MAX_TECHNIQUES || integrals == 0 {
        return 0;
    }
    let Some(of_integrals) = integrals.checked_mul(record_len(techniques) + techniques) else { return 0 };
    let Some(len) = of_integrals.checked_add(sums_len(techniques, 0)) else { return 0 };
    if len <= isize::MAX as usize / size_of::<f64>() { len } else { 0 }
}

/// How much of a memory that is long enough are sums.
pub(super) const fn sums_len(techniques: usize, integrals: usize) -> usize {
    1 + techniques + packed_len(techniques) + integrals * record_len(techniques)
}

/// The memory's parts: sums over the samples s, with S = sum_k n_k p_k.
pub(super) struct Sums<N, S> {
    /// How many samples, less what has decayed.
    pub(super) samples: N,
    /// sum_s p / S, one per technique.
    pub(super) ratio: S,
    /// A = sum_s p p' / S^2, its lower triangle by rows.
    pub(super) matrix: S,
    /// Of each integral sum_s f / S, the sum of the progressive estimator's terms, and b = sum_s f p / S^2.
    pub(super) records: S,
    /// Of each integral the progressive estimator's alpha, which is no sum.
    pub(super) alphas: S,
}

impl<'a> Sums<f64, &'a [f64]> {
    pub(super) fn of(memory: &'a [f64], techniques: usize, integrals: usize) -> Option<Self> {
        let (sums, alphas) = memory.split_at_checked(sums_len(techniques, integrals))?;
        let (&samples, rest) = sums.split_first()?;
        let (ratio, rest) = rest.split_at_checked(techniques)?;
        let (matrix, records) = rest.split_at_checked(packed_len(techniques))?;
        Some(Sums { samples, ratio, matrix, records, alphas })
    }
}

impl<'a> Sums<&'a mut f64, &'a mut [f64]> {
    pub(super) fn of_mut(memory: &'a mut [f64], techniques: usize, integrals: usize) -> Option<Self> {
        let (sums, alphas) = memory.split_at_mut_checked(sums_len(techniques, integrals))?;
        let (samples, rest) = sums.split_first_mut()?;
        let (ratio, rest) = rest.split_at_mut_checked(techniques)?;
        let (matrix, records) = rest.split_at_mut_checked(packed_len(techniques))?;
        Some(Sums { samples, ratio, matrix, records, alphas })
    }
}

pub(super) const fn record_len(techniques: usize) -> usize {
    2 + techniques
}
