//! How an accumulator's sums lie in its memory of f64.
//!
//! `samples | ratio[J] | matrix[J (J + 1) / 2] | P times balance, progressive, moment[J] | P times alpha[J]`
//!
//! All before the alphas are sums over the samples: they decay and are merged as they lie there.

use super::linear::MAX_TECHNIQUES;
use crate::matrix::packed_len;
use crate::rows::rows;

/// The f64 that [`OptimalMis`](super::OptimalMis) needs; 0 if `techniques` is not in 1..=16, `integrals` is 0, or no
/// memory could hold them.
pub const fn len(techniques: usize, integrals: usize) -> usize {
    if techniques == 0 || techniques > MAX_TECHNIQUES || integrals == 0 {
        return 0;
    }
    let Some(of_integrals) = integrals.checked_mul(record_len(techniques) + techniques) else { return 0 };
    let Some(len) = of_integrals.checked_add(1 + techniques + packed_len(techniques)) else { return 0 };
    if len <= isize::MAX as usize / size_of::<f64>() { len } else { 0 }
}

/// How much of a memory that is long enough are sums.
pub(super) const fn sums_len(techniques: usize, integrals: usize) -> usize {
    1 + techniques + packed_len(techniques) + integrals * record_len(techniques)
}

/// The sums over the samples s, with S = sum_k n_k p_k.
pub(super) struct Sums<'a> {
    /// How many samples, less what has decayed.
    pub(super) samples: f64,
    /// sum_s p / S, one per technique.
    pub(super) ratio: &'a [f64],
    /// A = sum_s p p' / S^2, its lower triangle by rows.
    pub(super) matrix: &'a [f64],
    records: &'a [f64],
}

/// As [`Sums`], to be changed.
pub(super) struct SumsMut<'a> {
    pub(super) samples: &'a mut f64,
    pub(super) ratio: &'a mut [f64],
    pub(super) matrix: &'a mut [f64],
    /// Of each integral balance, progressive and moment.
    pub(super) records: &'a mut [f64],
}

/// The sums of one integral.
pub(super) struct Record<'a> {
    /// sum_s f / S.
    pub(super) balance: f64,
    /// sum_s of the progressive estimator's terms.
    pub(super) progressive: f64,
    /// b = sum_s f p / S^2.
    pub(super) moment: &'a [f64],
}

impl<'a> Sums<'a> {
    pub(super) fn of(sums: &'a [f64], techniques: usize) -> Option<Self> {
        let (&samples, rest) = sums.split_first()?;
        let (ratio, rest) = rest.split_at_checked(techniques)?;
        let (matrix, records) = rest.split_at_checked(packed_len(techniques))?;
        Some(Sums { samples, ratio, matrix, records })
    }

    pub(super) fn records(&self) -> impl Iterator<Item = Record<'a>> + use<'a> {
        rows(self.records, record_len(self.ratio.len())).filter_map(|record| match record {
            &[balance, progressive, ref moment @ ..] => Some(Record { balance, progressive, moment }),
            _ => None,
        })
    }
}

impl<'a> SumsMut<'a> {
    pub(super) fn of(sums: &'a mut [f64], techniques: usize) -> Option<Self> {
        let (samples, rest) = sums.split_first_mut()?;
        let (ratio, rest) = rest.split_at_mut_checked(techniques)?;
        let (matrix, records) = rest.split_at_mut_checked(packed_len(techniques))?;
        Some(SumsMut { samples, ratio, matrix, records })
    }
}

pub(super) const fn record_len(techniques: usize) -> usize {
    2 + techniques
}
