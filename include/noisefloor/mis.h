/* Generated from capi/ by `cargo xtask header`; do not edit. Conventions: noisefloor.h. */

#ifndef NOISEFLOOR_MIS_H
#define NOISEFLOOR_MIS_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Multiple importance sampling: the weight of one technique at one point.
 * Guides, in docs/: mis.md. */

#define NF_MIS_MAX_TECHNIQUES 16 // The most techniques that multiple importance sampling combines.

#define NF_MIS_BALANCE 0 // Heuristic (2.12): n_j p_j / sum_k n_k p_k. The default.
// Heuristic: (n_j p_j)^beta / sum_k (n_k p_k)^beta, the parameter being beta, above 0; 0 means the usual 2. Veach's:
// the exponents of (2.13) would not sum to 1.
#define NF_MIS_POWER 1
// Heuristic: balance among techniques with n_k p_k >= epsilon max_i n_i p_i, the parameter being epsilon, 0..1.
// Veach's: the threshold of (2.14) on p_k alone would depend on the density's unit.
#define NF_MIS_CUTOFF 2
#define NF_MIS_MAXIMUM 3 // Heuristic: 1 for the first technique with the largest n_k p_k, 0 for others.

// The weight of technique j at one point by a heuristic. The sum over all samples of weight * f / (n_j p_j) is
// unbiased (2.10). Where p_j is infinite, take for f / p_j the finite ratio that the renderer has.
// parameter: beta or epsilon, else not read. pdf[techniques]: p_k, the density of each technique at the point, at
// least 0; infinite ones (delta distributions) are equally dense, and finite ones then count as 0. counts[techniques]:
// n_k, samples of each technique; one with 0 has no part. techniques: 1..NF_MIS_MAX_TECHNIQUES. technique: j.
//
// The weights of all techniques sum to 1, for densities from 1e-38 to 1e38; each is 0 where every n_k p_k is.
// NF_ERR_RANGE: heuristic, parameter, techniques, technique, a density; NF_ERR_NOT_FINITE: a density is NaN, or the
// parameter not finite.
nf_status nf_mis_weight(uint32_t heuristic, float parameter, const float *pdf, const uint32_t *counts,
    uint32_t techniques, uint32_t technique, float *weight);

// What one sample of technique j adds to the estimate (2.10) with the optimal weights (2.15) of Kondapaneni et al.
// (2019): w_j f / (n_j p_j) = alpha_j / n_j + (f - sum_k alpha_k p_k) / S, S = sum_k n_k p_k.
//
// Unbiased if alpha came from other samples; of least variance if counts are fixed. The term is not 0 where f is: add
// those samples too. Times the number of samples regressed together, a regression is fitted to it (section 4.3.3).
// pdf[techniques]: finite, at least 0, that of the technique positive. counts[techniques]: at least 1.
// alpha[techniques]: from nf_omis_solve. value: f, not divided by a density. All finite.
// NF_ERR_RANGE: an argument, or the term in float; NF_ERR_NOT_FINITE.
nf_status nf_mis_optimal_contribution(const float *pdf, const uint32_t *counts, uint32_t techniques, uint32_t technique,
    const float *alpha, float value, float *contribution);

/* Optimal multiple importance sampling: weights of least variance, found from the samples.
 * Guides, in docs/: mis.md. */

// nf_omis solver: alpha = (A + ridge)^-1 b, which shrinks to the balance heuristic where the samples say little. The
// default. Consistent, not unbiased: alpha comes from the samples it is applied to.
#define NF_OMIS_RIDGE 0
// nf_omis solver: alpha = A^-1 b (the pseudo-inverse where A is singular), the direct estimator sum_k alpha_k of
// Kondapaneni et al. Consistent, not unbiased, and heavy-tailed with similar techniques or few samples.
#define NF_OMIS_PLAIN 1
// nf_omis solver: each batch with the alpha of the batches before it (nf_omis_next_batch). Unbiased.
#define NF_OMIS_PROGRESSIVE 2
#define NF_OMIS_BALANCE 3 // nf_omis solver: alpha = 0, the balance heuristic. Unbiased.

// Optimal multiple importance sampling (Kondapaneni et al. 2019; 2.15): sums over samples of J techniques, from which
// P integrals are estimated with weights of least variance.
//
// With S = sum_k n_k p_k it keeps A = sum p p' / S^2, b = sum f p / S^2 and a few sums more. After R rounds of n_k
// samples an integral is sum f / S / R - (sum p / S / R - 1)' alpha with A alpha = b: the balance estimate, less what
// the samples got wrong about the densities' integrals. May be moved and copied as nf_cv_accumulator.
typedef struct nf_omis nf_omis;

// Bytes of an nf_omis; 0 if techniques is not 1..NF_MIS_MAX_TECHNIQUES, integrals are 0, or no memory has them.
size_t nf_omis_size(uint32_t techniques, uint32_t integrals);

// Makes an empty nf_omis in `memory`, or empties one: `*out` is its handle, the same address. counts[techniques]: n_k,
// how many samples of each technique make one round, at least 1.
// NF_ERR_RANGE: techniques, integrals or a count; NF_ERR_MEMORY.
nf_status nf_omis_init(void *memory, size_t bytes, uint32_t techniques, uint32_t integrals, const uint32_t *counts,
    nf_omis **out);

// Adds n samples, all or none: every one that was drawn, those of value 0 too, in whole rounds of the counts or from
// technique k with probability n_k / sum n. A draw that failed, without a point, has value 0, pdf 1 of its technique
// and 0 of the others.
// pdf[n * techniques]: the density of each technique at each point, finite, at least 0, that of the technique which
// drew it, technique[n], positive. value[n * integrals]: the integrands there, not divided by any density, finite.
// NF_ERR_RANGE: a technique, a density, or more samples than a memory can hold; NF_ERR_NOT_FINITE.
nf_status nf_omis_add(nf_omis *omis, const float *pdf, const uint32_t *technique, const float *value, size_t n);

// Estimates the integrals from all samples so far, or the weights' coefficients alpha (2.15); NULL: not wanted.
// solver: NF_OMIS_*. ridge: for NF_OMIS_RIDGE, as many samples that know nothing of the integrand: 1e-8..1e8, or 0 for
// the default 2. It adds ridge (tr(N A) - 1) / n N^-1 to A, here that of one round, A / R, N being the counts and n
// the samples, and at least 1e-8 tr(N A) N^-1. estimate[integrals], alpha[integrals * techniques], of integral p and
// technique j at p * techniques + j: outputs; one beyond the range of float becomes the largest finite float. alpha is
// for nf_mis_optimal_contribution, of NF_OMIS_PROGRESSIVE the current batch's.
// NF_ERR_NULL also if nothing is wanted; NF_ERR_RANGE: solver, ridge; NF_ERR_NOT_FINITE: ridge; NF_ERR_NO_SAMPLES.
nf_status nf_omis_solve(const nf_omis *omis, uint32_t solver, float ridge, float *estimate, float *alpha);

// Ends a batch, between whole rounds: NF_OMIS_PROGRESSIVE uses the alpha that solver and ridge find in all samples so
// far on those that follow, and 0 before the first call. Then multiplies all sums by beta: 1 unless integrals drift,
// as gradients do; 0 forgets all samples.
// NF_ERR_UNSUPPORTED: NF_OMIS_PROGRESSIVE as the solver; NF_ERR_RANGE, NF_ERR_NOT_FINITE also for a beta outside 0..1;
// else as for nf_omis_solve.
nf_status nf_omis_next_batch(nf_omis *omis, uint32_t solver, float ridge, float beta);

// Adds the samples of `other`, of another thread or pass. Of NF_OMIS_PROGRESSIVE `omis` keeps its alpha, and samples
// what they had when they were added: that of a fresh object is 0.
// NF_ERR_RANGE: both are the same object; NF_ERR_MISMATCH: other techniques, integrals or counts.
nf_status nf_omis_merge(nf_omis *omis, const nf_omis *other);

// What nf_omis_init, nf_omis_solve, nf_omis_next_batch, nf_omis_weights and nf_gradient_estimate take, for nf_check();
// zero where a function does not take it, but for `techniques`.
typedef struct nf_omis_arguments {
    const uint32_t *counts; // Samples of each technique in a round, each at least 1; or NULL.
    uint32_t techniques; // 1 to NF_MIS_MAX_TECHNIQUES.
    uint32_t integrals; // At most as many as memory can hold sums of.
    uint32_t solver; // NF_OMIS_*
    float ridge; // 1e-8 to 1e8, or 0 for the default.
    float beta; // 0 to 1.
} nf_omis_arguments;

#ifdef __cplusplus
}
#endif

#endif /* NOISEFLOOR_MIS_H */
