/* Generated from capi/ by `cargo xtask header`; do not edit. Conventions: noisefloor.h. */

#ifndef NOISEFLOOR_MIS_H
#define NOISEFLOOR_MIS_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Multiple importance sampling: the weight of one technique at one point.
 * Guides, in docs/: mis.md. */

// The most techniques that multiple importance sampling combines.
#define NF_MIS_MAX_TECHNIQUES 16

// Heuristic (2.12): n_j p_j / sum_k n_k p_k. The default.
#define NF_MIS_BALANCE 0
// Heuristic: (n_j p_j)^beta / sum_k (n_k p_k)^beta; the parameter is beta, positive and finite, 0 means the usual 2.
// (2.13) prints the exponent outside the sum; those weights would not sum to 1, and these are Veach's.
#define NF_MIS_POWER 1
// Heuristic: the balance heuristic among the techniques with n_k p_k >= epsilon * max_i n_i p_i; the parameter is
// epsilon, 0..1. 0 is the balance heuristic, 1 the maximum heuristic with ties shared. (2.14) prints an absolute
// threshold on p_k, without the counts; it would depend on the unit of the density, and leave points where no
// technique reaches it. This is Veach's form.
#define NF_MIS_CUTOFF 2
// Heuristic: 1 for the technique with the largest n_k p_k (the first of them if several tie), 0 for others.
#define NF_MIS_MAXIMUM 3

// The weight of technique j at one point by a heuristic, NF_MIS_BALANCE to NF_MIS_MAXIMUM.
//
// parameter: beta or epsilon; the other two heuristics do not read it. pdf[techniques]: p_k, the density of each
// technique at the point, in any one measure, at least 0. Infinity stands for a delta distribution: where any is
// infinite the finite ones count as 0 and the infinite ones are equally dense. counts[techniques]: n_k, the number of
// samples of each technique; one with 0 has no part in it. techniques: 1..NF_MIS_MAX_TECHNIQUES. technique: j, below
// techniques.
//
// The weights of all techniques sum to 1 and are safe for densities from 1e-38 to 1e38. Where every n_k p_k is 0, so
// that the point cannot have been drawn, each is 0. With them, the sum over all samples of weight * f / (n_j p_j) is
// unbiased (2.10).
//
// NF_ERR_NULL; NF_ERR_RANGE: heuristic, parameter, techniques, technique, or a negative density; NF_ERR_NOT_FINITE: a
// density is NaN, or the parameter not finite.
nf_status nf_mis_weight(uint32_t heuristic, float parameter, const float *pdf, const uint32_t *counts,
    uint32_t techniques, uint32_t technique, float *weight);

// The optimal weight (2.15) of Kondapaneni et al. (2019), for an alpha from nf_omis_alpha:
// w_j = alpha_j p_j / f + n_j p_j / S (1 - sum_k alpha_k p_k / f), S = sum_k n_k p_k.
//
// pdf[techniques]: finite and at least 0. counts[techniques]: at least 1. alpha[techniques]: finite. value: f at the
// point, not divided by a density, finite and not 0. Where f is 0 the weight does not exist, though the sample still
// contributes: see nf_mis_optimal_contribution.
//
// Whatever alpha is, the weights sum to 1; they may be negative or above 1. Where no density is positive each is 0.
//
// NF_ERR_NULL; NF_ERR_RANGE: an argument is outside these ranges, or the weight outside float's; NF_ERR_NOT_FINITE.
nf_status nf_mis_optimal(const float *pdf, const uint32_t *counts, uint32_t techniques, uint32_t technique,
    const float *alpha, float value, float *weight);

// What one sample of technique j adds to the estimate (2.10) with optimal weights:
// w_j f / (n_j p_j) = alpha_j / n_j + (f - sum_k alpha_k p_k) / S, S = sum_k n_k p_k.
//
// The sum over all samples is the estimate, unbiased if alpha came from other samples. The term is not 0 where f is;
// leaving such samples out keeps the mean and loses part of the gain. These terms, times the number of samples, are
// what a regression control variate is fitted to (4.3.3).
//
// Arguments and errors as for nf_mis_optimal, except that value may be 0, and pdf[technique] must be positive.
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
// nf_omis solver: alpha = 0, the balance heuristic. Unbiased.
#define NF_OMIS_BALANCE 3

// Optimal multiple importance sampling (Kondapaneni et al. 2019; 2.15): sums over samples of J techniques, from which
// P integrals are estimated with weights of least variance.
//
// With S = sum_k n_k p_k and s over all samples, it keeps A = sum_s p p' / S^2 and b = sum_s f p / S^2 and a few sums
// more. After R rounds of n_k samples each, an integral is sum_s f / S / R - (sum_s p / S / R - 1)' alpha with alpha
// from A alpha = b: the balance estimate, less what the samples got wrong about the densities' integrals.
//
// Lives in caller memory of nf_omis_size bytes, 8-byte aligned; never moved or copied in use, nor changed by anyone
// else; nothing to destroy.
typedef struct nf_omis nf_omis;

// The bytes of memory an nf_omis needs; 0 unless techniques is in 1..NF_MIS_MAX_TECHNIQUES, integrals at least 1, and
// the size one that memory can have.
size_t nf_omis_size(uint32_t techniques, uint32_t integrals);

// Makes an empty nf_omis in `memory`, `*out` being its handle (the same address).
//
// memory: at least nf_omis_size(techniques, integrals) bytes, 8-byte aligned; what it holds is lost.
// counts[techniques]: n_k, how many samples of each technique make one round, at least 1.
//
// NF_ERR_NULL; NF_ERR_RANGE: techniques, integrals or a count; NF_ERR_MEMORY; NF_ERR_ALIGNMENT.
nf_status nf_omis_init(void *memory, size_t bytes, uint32_t techniques, uint32_t integrals, const uint32_t *counts,
    nf_omis **out);

// Adds one sample, drawn by `technique`.
//
// pdf[techniques]: the density of each technique at the sample's point, finite and at least 0, positive for the
// technique that drew it. value[integrals]: the value of each integrand there, not divided by any density, finite.
//
// Add every sample, those of value 0 included: without them no solver but NF_OMIS_BALANCE is unbiased or consistent.
// The samples should make whole rounds of the counts, or each be drawn from technique k with probability n_k / sum n.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_RANGE: technique, or a density; NF_ERR_NOT_FINITE: a density (combine delta
// distributions outside) or a value.
nf_status nf_omis_add(nf_omis *omis, uint32_t technique, const float *pdf, const float *value);

// Estimates the integrals from all samples so far. The object does not change: the same call gives the same answer,
// and more samples may be added.
//
// solver: NF_OMIS_RIDGE, NF_OMIS_PLAIN, NF_OMIS_PROGRESSIVE or NF_OMIS_BALANCE; each says whether it is unbiased.
// ridge: for NF_OMIS_RIDGE, as many samples that know nothing of the integrand: 1e-8..1e8, or 0 for the default 2;
// otherwise ignored. With the densities' counts N and n samples it adds L = ridge (tr(N A) - 1) / n N^-1 to A, at
// least 1e-8 tr(N A) N^-1. estimate[integrals]: the outputs. One beyond the range of float becomes the largest finite
// float.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_RANGE: solver or ridge; NF_ERR_NOT_FINITE: ridge; NF_ERR_NO_SAMPLES.
nf_status nf_omis_solve(const nf_omis *omis, uint32_t solver, float ridge, float *estimate);

// The coefficients of the weights (2.15), for nf_mis_optimal and nf_mis_optimal_contribution:
// alpha[p * techniques + j] of integral p and technique j.
//
// Used on samples other than those it came from, an alpha gives unbiased estimates. NF_OMIS_PROGRESSIVE stands for the
// alpha of the current batch, NF_OMIS_BALANCE for zeros. Arguments and errors as for nf_omis_solve.
nf_status nf_omis_alpha(const nf_omis *omis, uint32_t solver, float ridge, float *alpha);

// Ends a batch: NF_OMIS_PROGRESSIVE uses the alpha that solver and ridge find in all samples so far on those that
// follow.
//
// Before the first call alpha is 0, the balance heuristic; NF_OMIS_BALANCE returns to that. Call it between whole
// rounds, whenever you like: what alpha adds has expectation 0 over a round, not over a part of one.
//
// Other arguments and errors as for nf_omis_solve; NF_ERR_UNSUPPORTED: NF_OMIS_PROGRESSIVE as the solver.
nf_status nf_omis_next_batch(nf_omis *omis, uint32_t solver, float ridge);

// Multiplies all sums by beta in 0..1, so that older samples count for less: for integrals that drift, as gradients
// do. NF_OMIS_PROGRESSIVE keeps its alpha.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_RANGE, NF_ERR_NOT_FINITE: beta.
nf_status nf_omis_decay(nf_omis *omis, float beta);

// Forgets every sample and NF_OMIS_PROGRESSIVE's alpha; techniques, integrals and counts stay.
//
// NF_ERR_NULL; NF_ERR_STATE.
nf_status nf_omis_reset(nf_omis *omis);

// Adds the samples of `other`, of another thread or pass, to `omis`. `other` does not change and must be another
// object; NF_OMIS_PROGRESSIVE's alpha stays that of `omis`.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_RANGE: both are the same object; NF_ERR_MISMATCH: their techniques, integrals or
// counts differ.
nf_status nf_omis_merge(nf_omis *omis, const nf_omis *other);

#ifdef __cplusplus
}
#endif

#endif /* NOISEFLOOR_MIS_H */
