//! Optimal multiple importance sampling weights, found from the samples.

use crate::convert::{self, Slice};
use crate::magic::{self, magic};
use crate::mis::NF_MIS_MAX_TECHNIQUES;
use crate::status::*;
use crate::wrong::{Wrong, part, pick, rule};
use noisefloor_core::minibatch::{self, Batch};
use noisefloor_core::mis::{self, DEFAULT_RIDGE, MAX_TECHNIQUES, OptimalMis, Solver};

/// nf_omis solver: alpha = (A + ridge)^-1 b, which shrinks to the balance heuristic where the samples say little. The
/// default. Consistent, not unbiased: alpha comes from the samples it is applied to.
pub const NF_OMIS_RIDGE: u32 = 0;
/// nf_omis solver: alpha = A^-1 b (the pseudo-inverse where A is singular), the direct estimator sum_k alpha_k of
/// Kondapaneni et al. Consistent, not unbiased, and heavy-tailed with similar techniques or few samples.
pub const NF_OMIS_PLAIN: u32 = 1;
/// nf_omis solver: each batch with the alpha of the batches before it (nf_omis_next_batch). Unbiased.
pub const NF_OMIS_PROGRESSIVE: u32 = 2;
/// nf_omis solver: alpha = 0, the balance heuristic. Unbiased.
pub const NF_OMIS_BALANCE: u32 = 3;

/// Optimal multiple importance sampling (Kondapaneni et al. 2019; 2.15): sums over samples of J techniques, from which
/// P integrals are estimated with weights of least variance.
///
/// With S = sum_k n_k p_k it keeps A = sum p p' / S^2, b = sum f p / S^2 and a few sums more. After R rounds of n_k
/// samples an integral is sum f / S / R - (sum p / S / R - 1)' alpha with A alpha = b: the balance estimate, less what
/// the samples got wrong about the densities' integrals. May be moved and copied as nf_cv_accumulator.
#[allow(non_camel_case_types)]
pub struct nf_omis {
    _private: (),
}

/// What stands at the start of the memory, before the f64 sums.
#[repr(C, align(8))]
#[derive(Clone, Copy)]
struct Header {
    magic: u64,
    techniques: u32,
    integrals: u32,
    counts: [u32; MAX_TECHNIQUES],
}

const MAGIC: u64 = magic::<Header>("nf_omis");

/// Bytes of an nf_omis; 0 if techniques is not 1..NF_MIS_MAX_TECHNIQUES, integrals are 0, or no memory has them.
#[unsafe(no_mangle)]
pub extern "C" fn nf_omis_size(techniques: u32, integrals: u32) -> usize {
    convert::object_size::<Header, f64>(mis::len(techniques as usize, integrals as usize))
}

/// Makes an empty nf_omis in `memory`, or empties one: `*out` is its handle, the same address. counts[techniques]: n_k,
/// how many samples of each technique make one round, at least 1.
///
/// NF_ERR_RANGE: techniques, integrals or a count; NF_ERR_MEMORY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_omis_init(
    memory: *mut core::ffi::c_void,
    bytes: usize,
    techniques: u32,
    integrals: u32,
    counts: *const u32,
    out: *mut *mut nf_omis,
) -> nf_status {
    status((|| {
        let size = checked_size(techniques, integrals)?;
        // SAFETY: the caller passes `techniques` counts, at most 16 as just checked.
        let counts = unsafe { convert::slice(counts, techniques as usize) }?;
        check_counts(counts)?;
        let mut header = Header { magic: MAGIC, techniques, integrals, counts: [0; MAX_TECHNIQUES] };
        header.counts.iter_mut().zip(counts).for_each(|(to, &from)| *to = from);
        // SAFETY: the caller passes a place for a pointer.
        let out = unsafe { convert::room(out) }?;
        // SAFETY: the caller passes memory of the size it says; all-zero sums are those of no samples.
        out.write(unsafe { convert::create(memory, bytes, size, header) }?.cast());
        Ok(())
    })())
}

/// Adds n samples, all or none: every one that was drawn, those of value 0 too, in whole rounds of the counts or from
/// technique k with probability n_k / sum n. A draw that failed, without a point, has value 0, pdf 1 of its technique
/// and 0 of the others.
///
/// pdf[n * techniques]: the density of each technique at each point, finite, at least 0, that of the technique which
/// drew it, technique[n], positive. value[n * integrals]: the integrands there, not divided by any density, finite.
///
/// NF_ERR_RANGE: a technique, a density, or more samples than a memory can hold; NF_ERR_NOT_FINITE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_omis_add(
    omis: *mut nf_omis,
    pdf: *const f32,
    technique: *const u32,
    value: *const f32,
    n: usize,
) -> nf_status {
    status((|| {
        // SAFETY: the caller passes an object that no one else uses meanwhile.
        let mut omis: OptimalMis<&mut [f64]> = unsafe { open(omis) }?;
        let (techniques, integrals) = (omis.techniques(), omis.integrals());
        let (pdfs, values) = (convert::product(n, techniques)?, convert::product(n, integrals)?);
        // SAFETY: the caller passes arrays of the lengths that the object was made for, n times.
        let (pdf, technique, value) =
            unsafe { (convert::slice(pdf, pdfs)?, convert::slice(technique, n)?, convert::slice(value, values)?) };
        Ok(omis.add_samples(pdf, technique, value)?)
    })())
}

/// Estimates the integrals from all samples so far, or the weights' coefficients alpha (2.15); NULL: not wanted.
///
/// solver: NF_OMIS_*. ridge: for NF_OMIS_RIDGE, as many samples that know nothing of the integrand: 1e-8..1e8, or 0 for
/// the default 2. It adds ridge (tr(N A) - 1) / n N^-1 to A, here that of one round, A / R, N being the counts and n
/// the samples, and at least 1e-8 tr(N A) N^-1. estimate[integrals], alpha[integrals * techniques], of integral p and
/// technique j at p * techniques + j: outputs; one beyond the range of float becomes the largest finite float. alpha is
/// for nf_mis_optimal_contribution, of NF_OMIS_PROGRESSIVE the current batch's.
///
/// NF_ERR_NULL also if nothing is wanted; NF_ERR_RANGE: solver, ridge; NF_ERR_NOT_FINITE: ridge; NF_ERR_NO_SAMPLES.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_omis_solve(
    omis: *const nf_omis,
    solver: u32,
    ridge: f32,
    estimate: *mut f32,
    alpha: *mut f32,
) -> nf_status {
    status((|| {
        // SAFETY: the caller passes an object that no one writes meanwhile.
        let omis: OptimalMis<&[f64]> = unsafe { open(omis) }?;
        ensure(!estimate.is_null() || !alpha.is_null(), NF_ERR_NULL)?;
        let len = convert::product(omis.integrals(), omis.techniques())?;
        // SAFETY: the caller passes NULL or room for its integrals, and for those times its techniques.
        let (estimate, alpha) =
            unsafe { (convert::optional_outputs(estimate, omis.integrals())?, convert::optional_outputs(alpha, len)?) };
        let solver = solver_of(solver, ridge)?;
        // Both refuse the same.
        if let Some(alpha) = alpha {
            omis.alpha(solver, alpha)?;
        }
        Ok(estimate.map_or(Ok(()), |estimate| omis.solve(solver, estimate))?)
    })())
}

/// Ends a batch, between whole rounds: NF_OMIS_PROGRESSIVE uses the alpha that solver and ridge find in all samples so
/// far on those that follow, and 0 before the first call. Then multiplies all sums by beta: 1 unless integrals drift,
/// as gradients do; 0 forgets all samples.
///
/// NF_ERR_UNSUPPORTED: NF_OMIS_PROGRESSIVE as the solver; NF_ERR_RANGE, NF_ERR_NOT_FINITE also for a beta outside 0..1;
/// else as for nf_omis_solve.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_omis_next_batch(omis: *mut nf_omis, solver: u32, ridge: f32, beta: f32) -> nf_status {
    status((|| {
        // SAFETY: the caller passes an object that no one else uses meanwhile.
        let mut omis: OptimalMis<&mut [f64]> = unsafe { open(omis) }?;
        check_beta(beta)?;
        omis.next_batch(solver_of(solver, ridge)?)?;
        Ok(omis.decay(beta)?)
    })())
}

/// Adds the samples of `other`, of another thread or pass. Of NF_OMIS_PROGRESSIVE `omis` keeps its alpha, and samples
/// what they had when they were added: that of a fresh object is 0.
///
/// NF_ERR_RANGE: both are the same object; NF_ERR_MISMATCH: other techniques, integrals or counts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_omis_merge(omis: *mut nf_omis, other: *const nf_omis) -> nf_status {
    status((|| {
        // Two references to one object, one of them exclusive, must never exist.
        ensure(!core::ptr::eq(omis, other) || other.is_null(), NF_ERR_RANGE)?;
        // SAFETY: the caller passes two objects that no one else uses meanwhile; they are two, as just checked.
        let (mut omis, other) = unsafe { (open::<&mut [f64]>(omis)?, open::<&[f64]>(other)?) };
        Ok(omis.merge(&other)?)
    })())
}

/// The optimal MIS gradient of a minibatch as a weight for each drawn item (section 6.2): (1 / batch) sum_s weight[s] *
/// gradient_s is the mean loss's, for every parameter at once, by one backward pass over weighted losses.
///
/// solver: NF_OMIS_RIDGE or NF_OMIS_PLAIN, consistent, of weights that may be negative, or NF_OMIS_BALANCE, unbiased.
/// ridge: as for nf_omis_solve. techniques: J, 1..NF_MIS_MAX_TECHNIQUES. items: N, of the data set, at least 1.
/// pdf[batch * J]: the probability, above 0 to 1 (1.001 for rounding), with which technique j draws the item of sample
/// s, at s * J + j, before any update; 0 only for others than the technique that drew it: technique[batch].
/// weight[batch]: the output; one beyond the range of float becomes the largest finite float.
///
/// With n_j samples of technique j, S_s = sum_k n_k p_k, q = sum_s p_s / S_s and A = sum_s p_s p_s' / S_s^2, weight_s =
/// (1 / S_s - (q - 1)' (A + ridge)^-1 p_s / S_s^2) batch / items.
///
/// NF_ERR_RANGE: solver, ridge, techniques, items, a technique or a probability; NF_ERR_NOT_FINITE: ridge or a
/// probability; NF_ERR_NO_SAMPLES: an empty batch; NF_ERR_UNSUPPORTED: NF_OMIS_PROGRESSIVE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_omis_weights(
    solver: u32,
    ridge: f32,
    techniques: u32,
    items: u32,
    pdf: *const f32,
    technique: *const u32,
    batch: u32,
    weight: *mut f32,
) -> nf_status {
    status((|| {
        ensure(techniques as usize <= MAX_TECHNIQUES, NF_ERR_RANGE)?;
        let samples = batch as usize;
        let pdfs = convert::product(samples, techniques as usize)?;
        // SAFETY: the caller passes arrays of these lengths, of which the last is written and no part of another.
        let (pdf, technique, weight) = unsafe {
            (convert::slice(pdf, pdfs)?, convert::slice(technique, samples)?, convert::outputs(weight, samples)?)
        };
        let solver = solver_of(solver, ridge)?;
        let batch = Batch::new(items, techniques as usize, pdf, technique)?;
        Ok(minibatch::weights(&batch, solver, weight)?)
    })())
}

/// The object as the core sees it.
///
/// # Safety
/// A non-NULL, aligned `omis` must point to at least 8 initialised bytes that no one writes while the result is used,
/// nor reads if that can write them. If they are the magic number, an nf_omis must stand there: what nf_omis_init
/// wrote, changed since by this library alone. So memory follows for as many sums as its header says.
unsafe fn open<S: Slice<f64>>(omis: *const nf_omis) -> Result<OptimalMis<S>, nf_status> {
    // SAFETY: passed on to the caller.
    unsafe { magic::check::<Header>(omis.cast(), MAGIC) }?;
    // SAFETY: passed on to the caller, who promises more where the number has been found.
    let header = *unsafe { convert::reference(omis.cast::<Header>()) }?;
    let (techniques, integrals) = (header.techniques as usize, header.integrals as usize);
    let len = mis::len(techniques, integrals);
    let counts = header.counts.get(..techniques).filter(|_| len > 0).ok_or(NF_ERR_STATE)?;
    // SAFETY: nf_omis_init made the sums right behind the header.
    let sums = unsafe { S::of(omis.cast_mut().cast::<Header>().add(1).cast(), len) }?;
    Ok(OptimalMis::resume(sums, counts, integrals)?)
}

/// What nf_omis_init, nf_omis_solve, nf_omis_next_batch, nf_omis_weights and nf_gradient_estimate take, for nf_check();
/// zero where a function does not take it, but for `techniques`.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct nf_omis_arguments {
    /// Samples of each technique in a round, each at least 1; or NULL.
    pub counts: *const u32,
    /// 1 to NF_MIS_MAX_TECHNIQUES.
    pub techniques: u32,
    /// At most as many as memory can hold sums of.
    pub integrals: u32,
    /// NF_OMIS_*
    pub solver: u32,
    /// 1e-8 to 1e8, or 0 for the default.
    pub ridge: f32,
    /// 0 to 1.
    pub beta: f32,
}

/// What is wrong with arguments.
///
/// # Safety
/// Aligned `counts` must be NULL or `techniques` of them, if that is in its range.
pub(crate) unsafe fn check_omis(of: &nf_omis_arguments) -> Result<(), Wrong> {
    checked_size(of.techniques, of.integrals.max(1))?;
    if !of.counts.is_null() {
        // SAFETY: passed on to the caller.
        let counts = unsafe { convert::slice(of.counts, of.techniques as usize) };
        check_counts(counts.map_err(|status| Wrong(status, c"counts are misaligned"))?)?;
    }
    solver_of(of.solver, of.ridge)?;
    check_beta(of.beta)
}

fn checked_size(techniques: u32, integrals: u32) -> Result<usize, Wrong> {
    rule((1..=NF_MIS_MAX_TECHNIQUES).contains(&techniques), c"techniques must be 1 to 16")?;
    let size = nf_omis_size(techniques, integrals);
    rule(size > 0, c"integrals must be at least 1, and no more than memory can hold sums of")?;
    Ok(size)
}

fn check_counts(counts: &[u32]) -> Result<(), Wrong> {
    rule(!counts.contains(&0), c"counts must be at least 1")
}

fn check_beta(beta: f32) -> Result<(), Wrong> {
    part(beta, c"beta must be 0 to 1")
}

pub(crate) fn solver_of(solver: u32, ridge: f32) -> Result<Solver, Wrong> {
    let ridge = if ridge == 0.0 { DEFAULT_RIDGE } else { ridge };
    let solvers = [Solver::Ridge(ridge), Solver::Plain, Solver::Progressive, Solver::Balance];
    let solver = pick(solver, &solvers, c"solver must be one of NF_OMIS_*, 0 to 3")?;
    solver.check().map_err(|error| Wrong(error.into(), c"ridge must be 1e-8 to 1e8, or 0 for the default 2"))?;
    Ok(solver)
}
