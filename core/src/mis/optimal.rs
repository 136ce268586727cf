//! The optimal MIS weights, found from the samples: Kondapaneni et al., "Optimal Multiple Importance Sampling", 2019.
//!
//! Put (2.15) into (2.10) and the estimate becomes a control variate g = sum_k alpha_k p_k, whose integral sum_k
//! alpha_k is known, on top of the balance heuristic: with S = sum_k n_k p_k and s over all samples of all techniques,
//!
//! `F = sum_k alpha_k + sum_s (f - sum_k alpha_k p_k) / S`.
//!
//! Its variance is least where A alpha = b, A = int p p' / S, b = int f p / S. As sum_s h / S estimates int h without
//! bias, sum_s p p' / S^2 and sum_s f p / S^2 estimate A and b. After R rounds of the n_k samples,
//!
//! `F = sum_s f / S / R - (sum_s p / S / R - 1)' alpha`,
//!
//! the balance estimate less what the samples got wrong about the densities' integrals, each of which is 1.
//!
//! The sums lie in a memory of f64 as
//!
//! `samples | ratio[J] | matrix[J (J + 1) / 2] | P times balance, progressive, moment[J] | P times alpha[J]`
//!
//! All before the alphas are sums over the samples: they decay and are merged as they lie there.

use super::linear::{self, MAX_TECHNIQUES, System, Vector};
use super::solver::Solver;
use crate::error::{Error, check_part, ensure};
use crate::matrix::{at, copy, first, first_mut, is_same, packed_len, rows, rows_mut};
use crate::real::saturate;

/// The f64 that [`OptimalMis`] needs; 0 if `techniques` is not in 1..=16, `integrals` is 0, or no memory could hold
/// them.
pub const fn len(techniques: usize, integrals: usize) -> usize {
    if techniques == 0 || techniques > MAX_TECHNIQUES || integrals == 0 {
        return 0;
    }
    let Some(of_integrals) = integrals.checked_mul(record_len(techniques) + techniques) else { return 0 };
    let Some(len) = of_integrals.checked_add(sums_len(techniques, 0)) else { return 0 };
    if len <= isize::MAX as usize / size_of::<f64>() { len } else { 0 }
}

/// How much of a memory that is long enough are sums.
const fn sums_len(techniques: usize, integrals: usize) -> usize {
    1 + techniques + packed_len(techniques) + integrals * record_len(techniques)
}

const fn record_len(techniques: usize) -> usize {
    2 + techniques
}

/// Sums from which the integrals of several functions are estimated with optimal MIS weights.
///
/// The memory is [`len`]`(techniques, integrals)` values of `f64`, borrowed or owned:
///
/// ```
/// use noisefloor::mis::{self, OptimalMis, Solver};
///
/// let mut omis = OptimalMis::new([0.0; mis::len(2, 1)], &[1, 1], 1)?;
/// omis.add(0, &[1.0, 0.5], &[3.0])?;
/// omis.add(1, &[1.0, 1.5], &[4.0])?;
/// let mut estimate = [0.0];
/// omis.solve(Solver::default(), &mut estimate)?;
/// # Ok::<(), noisefloor::Error>(())
/// ```
///
/// Add **every** sample, those with f = 0 included: each says something about the densities, and the number of rounds R
/// is taken to be samples / sum n, so that without them every estimate is too large. The samples should make whole
/// rounds of `counts`, or be drawn from technique j with probability n_j / sum n: a round interrupted in the middle
/// over- or under-weights the techniques accordingly.
///
/// A draw that failed (no point: nothing below the horizon, say) is added too, with value 0, density 1 of the technique
/// that drew it and 0 of the others. It stands for a point that only this technique has, at which f is 0: with it the
/// technique's density integrates to 1, as everything here assumes. Any positive density says the same, as only p / S =
/// 1 / n_j counts. Its [`optimal_contribution`](super::optimal_contribution) is 0.
#[derive(Clone, Debug, PartialEq)]
pub struct OptimalMis<M> {
    counts: [u32; MAX_TECHNIQUES],
    techniques: usize,
    integrals: usize,
    memory: M,
}

impl<M: AsRef<[f64]>> OptimalMis<M> {
    /// Takes up the sums that `memory` already holds, made earlier with the same `counts` and `integrals`.
    ///
    /// # Errors
    /// As for [`OptimalMis::new`].
    pub fn resume(memory: M, counts: &[u32], integrals: usize) -> Result<Self, Error> {
        let needed = len(counts.len(), integrals);
        ensure(needed > 0 && !counts.contains(&0), Error::Range)?;
        ensure(memory.as_ref().len() >= needed, Error::Memory)?;
        let mut all = [0; MAX_TECHNIQUES];
        copy(&mut all, counts);
        Ok(OptimalMis { counts: all, techniques: counts.len(), integrals, memory })
    }

    /// The number of techniques J.
    pub fn techniques(&self) -> usize {
        self.techniques
    }

    /// The number of integrals P.
    pub fn integrals(&self) -> usize {
        self.integrals
    }

    /// Estimates every integral from all samples so far; `estimate` has one element per integral.
    ///
    /// Nothing is changed: the same call gives the same answer, and more samples may follow. An estimate beyond the
    /// range of `f32` becomes the largest finite one.
    ///
    /// # Errors
    /// [`Error::Length`]; [`Error::Range`] for a ridge outside [`RIDGE_RANGE`](super::RIDGE_RANGE);
    /// [`Error::NotFinite`] for a ridge that is NaN or infinite; [`Error::NoSamples`].
    pub fn solve(&self, solver: Solver, estimate: &mut [f32]) -> Result<(), Error> {
        ensure(estimate.len() == self.integrals, Error::Length)?;
        let (sums, rounds) = self.sums()?;
        let system = self.system(solver)?;
        for (out, record) in estimate.iter_mut().zip(rows(sums.records, record_len(self.techniques))) {
            let [balance, progressive, moment @ ..] = record else { break };
            *out = saturate(match solver {
                Solver::Progressive => progressive / rounds,
                Solver::Balance => balance / rounds,
                Solver::Plain | Solver::Ridge(_) => {
                    let alpha = system.solve(moment);
                    let error = sums.ratio.iter().zip(&alpha).map(|(ratio, alpha)| (ratio / rounds - 1.0) * alpha);
                    balance / rounds - error.sum::<f64>()
                }
            });
        }
        Ok(())
    }

    /// The alpha of (2.15), for [`optimal_contribution`](super::optimal_contribution): `alpha[p * J + j]` of integral p
    /// and technique j.
    ///
    /// Used on samples other than the ones it came from, it gives unbiased estimates. [`Solver::Progressive`] stands
    /// for the alpha that the current batch uses, [`Solver::Balance`] for zeros. Errors as for [`OptimalMis::solve`].
    pub fn alpha(&self, solver: Solver, alpha: &mut [f32]) -> Result<(), Error> {
        ensure(self.integrals.checked_mul(self.techniques) == Some(alpha.len()), Error::Length)?;
        let (sums, _) = self.sums()?;
        let system = self.system(solver)?;
        let records = rows(sums.records, record_len(self.techniques)).zip(rows(sums.alphas, self.techniques));
        for (row, (record, current)) in rows_mut(alpha, self.techniques).zip(records) {
            let [_, _, moment @ ..] = record else { break };
            let solved = system.solve(moment);
            let alpha = if solver == Solver::Progressive { current } else { &solved };
            row.iter_mut().zip(alpha).for_each(|(out, &alpha)| *out = saturate(alpha));
        }
        Ok(())
    }

    fn check(&self, technique: usize, pdf: &[f32], value: &[f32]) -> Result<(), Error> {
        ensure(pdf.len() == self.techniques && value.len() == self.integrals, Error::Length)?;
        let own = *pdf.get(technique).ok_or(Error::Range)?;
        ensure(pdf.iter().chain(value).all(|x| x.is_finite()), Error::NotFinite)?;
        ensure(own > 0.0 && pdf.iter().all(|&p| p >= 0.0), Error::Range)
    }

    fn system(&self, solver: Solver) -> Result<System, Error> {
        solver.check()?;
        let (sums, rounds) = self.sums()?;
        let scale = self.counts.map(|count| libm::sqrt(f64::from(count)));
        Ok(System::new(solver, sums.matrix, rounds, scale, self.techniques, at(sums.samples, 0)))
    }

    fn sum_counts(&self) -> f64 {
        self.counts.iter().map(|&count| f64::from(count)).sum()
    }

    /// The sums and the number of rounds R, which is positive.
    fn sums(&self) -> Result<(Sums<&[f64]>, f64), Error> {
        let sums = Sums::of(self.memory.as_ref(), self.techniques, self.integrals, <[f64]>::split_at_checked)?;
        let rounds = at(sums.samples, 0) / self.sum_counts();
        ensure(rounds > 0.0, Error::NoSamples)?;
        Ok((sums, rounds))
    }
}

impl<M: AsRef<[f64]> + AsMut<[f64]>> OptimalMis<M> {
    /// Empty sums for techniques that draw `counts[j]` samples each, and `integrals` functions.
    ///
    /// # Errors
    /// [`Error::Range`] unless there are 1..=16 counts, all at least 1, and at least one integral;
    /// [`Error::Memory`] for less than [`len`]`(counts.len(), integrals)` elements of memory.
    pub fn new(memory: M, counts: &[u32], integrals: usize) -> Result<Self, Error> {
        let mut omis = OptimalMis::resume(memory, counts, integrals)?;
        omis.reset();
        Ok(omis)
    }

    /// Forgets every sample, and the progressive estimator's alpha: all of the memory becomes 0.
    pub fn reset(&mut self) {
        self.memory.as_mut().fill(0.0);
    }

    /// Adds one sample that `technique` drew: `pdf[j]` of each technique at its point, and the value f of each
    /// integrand there (not divided by any density).
    ///
    /// # Errors
    /// These leave the sums as they were: [`Error::Length`]; [`Error::Range`] for a technique that does not exist,
    /// a negative density, or a density of 0 for the technique that drew the sample; [`Error::NotFinite`] for NaN or
    /// infinity among the densities (combine delta distributions outside) or values.
    pub fn add(&mut self, technique: usize, pdf: &[f32], value: &[f32]) -> Result<(), Error> {
        self.check(technique, pdf, value)?;
        self.add_checked(pdf, value)
    }

    /// Adds n samples, all or none: `pdf[n * J]`, `technique[n]` and `value[n * P]` are those of one after the other.
    ///
    /// # Errors
    /// As for [`OptimalMis::add`].
    pub fn add_samples(&mut self, pdf: &[f32], technique: &[u32], value: &[f32]) -> Result<(), Error> {
        let (n, techniques, integrals) = (technique.len(), self.techniques, self.integrals);
        let are_rows = n.checked_mul(techniques) == Some(pdf.len()) && n.checked_mul(integrals) == Some(value.len());
        ensure(are_rows, Error::Length)?;
        let samples = || rows(pdf, techniques).zip(rows(value, integrals));
        let mut drawn = technique.iter().zip(samples());
        drawn.try_for_each(|(&technique, (pdf, value))| self.check(technique as usize, pdf, value))?;
        samples().try_for_each(|(pdf, value)| self.add_checked(pdf, value))
    }

    fn add_checked(&mut self, pdf: &[f32], value: &[f32]) -> Result<(), Error> {
        let techniques = self.techniques;
        let sum: f64 = pdf.iter().zip(&self.counts).map(|(&p, &n)| f64::from(p) * f64::from(n)).sum();
        let mut ratio = Vector::default();
        ratio.iter_mut().zip(pdf).for_each(|(ratio, &p)| *ratio = f64::from(p) / sum);

        let per_sample = 1.0 / self.sum_counts();
        let sums = self.sums_mut()?;
        sums.samples.iter_mut().for_each(|samples| *samples += 1.0);
        sums.ratio.iter_mut().zip(&ratio).for_each(|(sum, ratio)| *sum += ratio);
        linear::add_products(sums.matrix, first(&ratio, techniques), 1.0);
        let records = rows_mut(sums.records, record_len(techniques)).zip(rows(sums.alphas, techniques));
        for (&value, (record, alpha)) in value.iter().zip(records) {
            let [balance, progressive, moment @ ..] = record else { break };
            let value = f64::from(value) / sum;
            *balance += value;
            // sum alpha, shared out over the round's samples, + (f - sum alpha p) / S.
            let control: f64 = alpha.iter().zip(&ratio).map(|(alpha, ratio)| *alpha * (per_sample - ratio)).sum();
            *progressive += value + control;
            moment.iter_mut().zip(&ratio).for_each(|(b, ratio)| *b += value * ratio);
        }
        Ok(())
    }

    /// Ends a batch: the progressive estimator uses the alpha of all samples so far on those that follow.
    ///
    /// Before the first call alpha is 0, the balance heuristic. [`Solver::Balance`] returns to that. Call it between
    /// whole rounds, whenever you like: what alpha adds has expectation 0 over a round, not over a part of one.
    ///
    /// # Errors
    /// These change nothing: [`Error::Unsupported`] for [`Solver::Progressive`]; others as for
    /// [`OptimalMis::solve`].
    pub fn next_batch(&mut self, solver: Solver) -> Result<(), Error> {
        ensure(solver != Solver::Progressive, Error::Unsupported)?;
        let system = self.system(solver)?;
        let techniques = self.techniques;
        let sums = self.sums_mut()?;
        for (alpha, record) in rows_mut(sums.alphas, techniques).zip(rows(sums.records, record_len(techniques))) {
            let [_, _, moment @ ..] = record else { break };
            copy(alpha, &system.solve(moment));
        }
        Ok(())
    }

    /// Multiplies all sums by `beta` in 0..=1, so that older samples count for less: for integrals that drift.
    ///
    /// With beta = 0 nothing is left but the progressive estimator's alpha.
    ///
    /// # Errors
    /// [`Error::NotFinite`] for NaN or infinity, [`Error::Range`] outside 0..=1.
    pub fn decay(&mut self, beta: f32) -> Result<(), Error> {
        check_part(beta)?;
        let sums = sums_len(self.techniques, self.integrals);
        first_mut(self.memory.as_mut(), sums).iter_mut().for_each(|sum| *sum *= f64::from(beta));
        Ok(())
    }

    /// Adds the samples of `other`, of another thread or pass. The progressive estimator's alpha stays this one's.
    ///
    /// # Errors
    /// [`Error::Mismatch`] unless both have the same counts and number of integrals.
    pub fn merge<N: AsRef<[f64]>>(&mut self, other: &OptimalMis<N>) -> Result<(), Error> {
        let like = self.techniques == other.techniques && self.integrals == other.integrals;
        ensure(like && is_same(&self.counts, &other.counts), Error::Mismatch)?;
        let sums = sums_len(self.techniques, self.integrals);
        let into = first_mut(self.memory.as_mut(), sums).iter_mut();
        into.zip(other.memory.as_ref()).for_each(|(to, from)| *to += from);
        Ok(())
    }

    fn sums_mut(&mut self) -> Result<Sums<&mut [f64]>, Error> {
        Sums::of(self.memory.as_mut(), self.techniques, self.integrals, <[f64]>::split_at_mut_checked)
    }
}

/// The memory's parts: sums over the samples s, with S = sum_k n_k p_k.
struct Sums<S> {
    /// How many samples, less what has decayed: one number.
    samples: S,
    /// sum_s p / S, one per technique.
    ratio: S,
    /// A = sum_s p p' / S^2, its lower triangle by rows.
    matrix: S,
    /// Of each integral sum_s f / S, the sum of the progressive estimator's terms, and b = sum_s f p / S^2.
    records: S,
    /// Of each integral the progressive estimator's alpha, which is no sum.
    alphas: S,
}

impl<S> Sums<S> {
    fn of(
        memory: S,
        techniques: usize,
        integrals: usize,
        split: impl Fn(S, usize) -> Option<(S, S)>,
    ) -> Result<Self, Error> {
        let split = |memory, len| split(memory, len).ok_or(Error::Memory);
        let (sums, alphas) = split(memory, sums_len(techniques, integrals))?;
        let (samples, rest) = split(sums, 1)?;
        let (ratio, rest) = split(rest, techniques)?;
        let (matrix, records) = split(rest, packed_len(techniques))?;
        Ok(Sums { samples, ratio, matrix, records, alphas })
    }
}
