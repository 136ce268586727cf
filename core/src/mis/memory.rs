//! How an accumulator's sums lie in its memory of f64.
//!
//! `samples | ratio[J] | matrix[J (J + 1) / 2] | P records of balance, progressive, moment[J], alpha[J]`

use super::MAX_TECHNIQUES;

/// The f64 that [`OptimalMis`](super::OptimalMis) needs; 0 if `techniques` is not in 1..=16, `integrals` is 0, or no
/// memory could hold them.
pub const fn len(techniques: usize, integrals: usize) -> usize {
    if techniques == 0 || techniques > MAX_TECHNIQUES || integrals == 0 {
        return 0;
    }
    let Some(records) = integrals.checked_mul(record_len(techniques)) else { return 0 };
    let Some(len) = records.checked_add(1 + techniques + pairs(techniques)) else { return 0 };
    if len <= isize::MAX as usize / size_of::<f64>() { len } else { 0 }
}

/// The sums that all integrals share, over the samples s with S = sum_k n_k p_k.
pub(super) struct Sums<'a> {
    /// How many samples, less what has decayed.
    pub(super) samples: &'a f64,
    /// sum_s p / S, one per technique.
    pub(super) ratio: &'a [f64],
    /// A = sum_s p p' / S^2, its lower triangle by rows.
    pub(super) matrix: &'a [f64],
    /// The rest of the memory: [`records`].
    pub(super) rest: &'a [f64],
}

/// As [`Sums`], to be changed.
pub(super) struct SumsMut<'a> {
    pub(super) samples: &'a mut f64,
    pub(super) ratio: &'a mut [f64],
    pub(super) matrix: &'a mut [f64],
    pub(super) rest: &'a mut [f64],
}

/// The sums of one integral.
pub(super) struct Record<'a> {
    /// sum_s f / S.
    pub(super) balance: &'a f64,
    /// sum_s of the progressive estimator's terms.
    pub(super) progressive: &'a f64,
    /// b = sum_s f p / S^2.
    pub(super) moment: &'a [f64],
    /// The coefficients that the progressive estimator uses until the next batch.
    pub(super) alpha: &'a [f64],
}

/// As [`Record`], to be changed.
pub(super) struct RecordMut<'a> {
    pub(super) balance: &'a mut f64,
    pub(super) progressive: &'a mut f64,
    pub(super) moment: &'a mut [f64],
    pub(super) alpha: &'a mut [f64],
}

pub(super) fn sums(memory: &[f64], techniques: usize) -> Option<Sums<'_>> {
    let (samples, rest) = memory.split_first()?;
    let (ratio, rest) = rest.split_at_checked(techniques)?;
    let (matrix, rest) = rest.split_at_checked(pairs(techniques))?;
    Some(Sums { samples, ratio, matrix, rest })
}

pub(super) fn sums_mut(memory: &mut [f64], techniques: usize) -> Option<SumsMut<'_>> {
    let (samples, rest) = memory.split_first_mut()?;
    let (ratio, rest) = rest.split_at_mut_checked(techniques)?;
    let (matrix, rest) = rest.split_at_mut_checked(pairs(techniques))?;
    Some(SumsMut { samples, ratio, matrix, rest })
}

pub(super) fn records(rest: &[f64], techniques: usize, integrals: usize) -> impl Iterator<Item = Record<'_>> {
    rest.chunks_exact(record_len(techniques)).take(integrals).filter_map(move |record| {
        let (balance, record) = record.split_first()?;
        let (progressive, record) = record.split_first()?;
        let (moment, alpha) = record.split_at_checked(techniques)?;
        Some(Record { balance, progressive, moment, alpha })
    })
}

pub(super) fn records_mut(
    rest: &mut [f64],
    techniques: usize,
    integrals: usize,
) -> impl Iterator<Item = RecordMut<'_>> {
    rest.chunks_exact_mut(record_len(techniques)).take(integrals).filter_map(move |record| {
        let (balance, record) = record.split_first_mut()?;
        let (progressive, record) = record.split_first_mut()?;
        let (moment, alpha) = record.split_at_mut_checked(techniques)?;
        Some(RecordMut { balance, progressive, moment, alpha })
    })
}

/// The remainder keeps the length provably positive, as dividing memory into records requires.
const fn record_len(techniques: usize) -> usize {
    2 + 2 * (techniques % (MAX_TECHNIQUES + 1))
}

const fn pairs(techniques: usize) -> usize {
    techniques * (techniques + 1) / 2
}
