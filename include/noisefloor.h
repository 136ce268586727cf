/* noisefloor: less Monte Carlo noise for the samples you already pay for.
 *
 * Generated from capi/ by `cargo xtask header`; do not edit. MIT OR Apache-2.0.
 *
 * Conventions, written once:
 *  - Arguments: configuration or object first, then inputs, then memory, then outputs.
 *  - Samples are points of primary sample space, u in [0, 1]^dims, row after row; f = integrand / pdf, any unit.
 *  - Every function that can fail returns nf_status: 0 (NF_OK) or a negative NF_ERR_*. Outputs are written, and objects
 *    changed, only on success. Inputs are checked: NULL, ranges, lengths, alignment, finite values.
 *  - Memory: nothing is ever allocated. Objects and workspaces live in caller memory, 8-byte aligned, of at least the
 *    bytes that the matching size function returns. Nothing needs to be destroyed. An object must not be moved or
 *    copied while it is in use, unless its description says otherwise.
 *  - Threads: no locks and no shared mutable state. Any number of threads may read an object; one at a time may write it.
 *  - Configurations are plain integers; zero in an optional field means the documented default, an unknown value is
 *    NF_ERR_RANGE.
 *  - References such as (4.22) are to C. Salaun, "Toward Improving Monte Carlo Estimator for Rendering and
 *    Machine Learning", 2025.
 */

#ifndef NOISEFLOOR_H
#define NOISEFLOOR_H

#include <stddef.h>
#include <stdint.h>

/*
 Estimator: a soft mixture of the plain mean and ridge fits, weighted by their leave-one-out errors (streaming:
 held-out errors). The default; never noticeably worse than the mean. Slightly biased at low sample counts.
 */
#define NF_CV_ROBUST 0

/*
 Estimator: least squares on its own samples (Alg. 1). The cheapest; bias O(1/n); needs several samples per term.
 */
#define NF_CV_LEAST_SQUARES 1

/*
 Estimator: one ridge fit, each sample corrected by the fit to all others. Exactly unbiased. Not for streaming.
 */
#define NF_CV_LEAVE_ONE_OUT 2

/*
 Estimator: each fold corrected by a robust fit to the other folds (two folds: 4.2.6). Exactly unbiased.
 */
#define NF_CV_K_FOLD 3

/*
 Estimator: the fit by gradient descent on its own samples (Alg. 2). Biased as least squares is.
 */
#define NF_CV_GRADIENT_DESCENT 4

/*
 Estimator: each sample corrected by a fit to those before it (4.30). Exactly unbiased after every sample.
 */
#define NF_CV_INCREMENTAL 5

/*
 Basis: products of orthonormal shifted Legendre polynomials. The default.
 */
#define NF_BASIS_LEGENDRE 0

/*
 Basis: products of Walsh functions, constant on the cells of a grid of eighths.
 */
#define NF_BASIS_STEP 1

/*
 Basis: products of half-waves sin(pi d x + pi/2).
 */
#define NF_BASIS_SINE 2

/*
 Basis: isotropic Gaussians, as many as Legendre has terms.
 */
#define NF_BASIS_GAUSSIAN 3

/*
 Solver: dual for fewer samples than terms, else normal equations. The default.
 */
#define NF_SOLVER_AUTO 0

/*
 Solver: normal equations (4.27) and LDL'.
 */
#define NF_SOLVER_NORMAL_EQUATIONS 1

/*
 Solver: Givens rotations, for badly placed samples. Only with NF_CV_LEAST_SQUARES.
 */
#define NF_SOLVER_SQUARE_ROOT 2

/*
 Solver: the n x n system of at most 4096 samples. Not for streaming.
 */
#define NF_SOLVER_DUAL 3

/*
 Precision: double. The default.
 */
#define NF_PRECISION_F64 0

/*
 Precision: float, for targets without double hardware.
 */
#define NF_PRECISION_F32 1

/*
 A NaN or infinite sample is NF_ERR_NOT_FINITE. The default.
 */
#define NF_NONFINITE_ERROR 0

/*
 A NaN or infinite sample is left out and not counted; biased unless such samples would have been average ones.
 */
#define NF_NONFINITE_SKIP 1

/*
 Each channel is regressed on its own, with one factorisation. The default.
 */
#define NF_COLOR_PER_CHANNEL 0

/*
 Rec. 709 luminance is regressed and scales the plain mean of 3 channels (4.3).
 */
#define NF_COLOR_LUMINANCE_RATIO 1

/*
 Gradient descent by Adam. The default.
 */
#define NF_OPTIMIZER_ADAM 0

/*
 Gradient descent with heavy-ball momentum.
 */
#define NF_OPTIMIZER_MOMENTUM 1

/*
 Plain gradient descent (4.29).
 */
#define NF_OPTIMIZER_PLAIN 2

/*
 For `ridge`: of a few strengths the one with the smallest leave-one-out error.
 */
#define NF_RIDGE_AUTO -1.0

/*
 The version of this header. `nf_abi_version()` returns the library's.
 */
#define NF_ABI_VERSION 1

/*
 A streaming estimate of fixed size, in caller memory. It may be moved or copied as bytes between calls.
 */
typedef struct nf_cv_accumulator nf_cv_accumulator;

/*
 How to estimate. Zero in any field but dims and channels is its default.
 */
typedef struct nf_cv_config {
    /*
     Coordinates of a sample that are regressed, 1 to 16.
     */
    uint32_t dims;
    /*
     Largest total degree, 0 to 7; 0 is the plain mean. nf_cv_terms() may not exceed 136.
     */
    uint32_t order;
    /*
     Values of a sample, 1 to 4.
     */
    uint32_t channels;
    /*
     NF_CV_*
     */
    uint32_t estimator;
    /*
     NF_BASIS_*
     */
    uint32_t basis;
    /*
     1 if the samples are stratified (a tile, Sobol), 0 if independent. Leave-one-out errors cannot see
     stratification: with 1, NF_CV_ROBUST returns the plain mean.
     */
    uint32_t stratified;
    /*
     If above 1, the last coordinate picks one of this many equally likely alternatives, a light say (4.15).
     */
    uint32_t slices;
    /*
     User-supplied control functions with known integrals (4.18), 0 to 4.
     */
    uint32_t controls;
    /*
     Floats from one sample's u to the next; 0 means dims. A path may be longer than what is regressed (4.3.5); its
     first dims coordinates must exist, uniform, for every sample, however short its path.
     */
    uint32_t stride;
    /*
     NF_SOLVER_*
     */
    uint32_t solver;
    /*
     NF_PRECISION_*
     */
    uint32_t precision;
    /*
     NF_NONFINITE_*
     */
    uint32_t nonfinite;
    /*
     NF_COLOR_*
     */
    uint32_t color;
    /*
     Folds of NF_CV_K_FOLD and of the streaming NF_CV_ROBUST, 2 to 16; 0 means 4.
     */
    uint32_t folds;
    /*
     Steps of gradient descent, at most 2^20; 0 means 32.
     */
    uint32_t iterations;
    /*
     NF_OPTIMIZER_*
     */
    uint32_t optimizer;
    /*
     Ridge strength per sample, NF_RIDGE_AUTO, or 0 for the estimator's default.
     */
    float ridge;
    /*
     Step of gradient descent: in standard deviations of the values for Adam, else times one over the largest
     curvature. 0 means the default.
     */
    float learning_rate;
    /*
     Momentum of gradient descent, below 1; 0 means the default.
     */
    float momentum;
} nf_cv_config;

/*
 0 is success, a negative value an error; `nf_status_message` explains it.
 */
typedef int32_t nf_status;

/*
 An estimate of an integral over primary sample space.
 */
typedef struct nf_estimate {
    /*
     The integral, for each channel; zero for channels that are not there.
     */
    float mean[4];
    /*
     An estimate of each mean's standard error; infinite if one sample is all there is.
     */
    float std_error[4];
    /*
     Samples used.
     */
    uint32_t samples;
    /*
     Estimated variance relative to the plain mean's, averaged over the channels; 1 is no gain.
     */
    float gain;
} nf_estimate;

/*
 Success.
 */
#define NF_OK 0

/*
 A required pointer is NULL.
 */
#define NF_ERR_NULL -1

/*
 An argument is outside its documented range.
 */
#define NF_ERR_RANGE -2

/*
 An input value is NaN or infinite.
 */
#define NF_ERR_NOT_FINITE -3

/*
 Caller-supplied memory is too small.
 */
#define NF_ERR_MEMORY -4

/*
 Caller-supplied memory is not aligned as its type needs.
 */
#define NF_ERR_ALIGNMENT -5

/*
 There is nothing to estimate from.
 */
#define NF_ERR_NO_SAMPLES -6

/*
 The options exist, but not in this combination.
 */
#define NF_ERR_UNSUPPORTED -7

/*
 The memory holds no initialised object.
 */
#define NF_ERR_STATE -8

/*
 Two objects were made with different configurations.
 */
#define NF_ERR_MISMATCH -9

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 Bytes that an accumulator needs; 0 for a configuration that is NULL, out of range or not for streaming.
 */
size_t nf_cv_accumulator_size(const struct nf_cv_config *config);

/*
 Makes an empty accumulator in `memory`, 8-byte aligned and of at least nf_cv_accumulator_size() bytes, and returns
 it in out.

 NF_ERR_UNSUPPORTED for NF_CV_LEAVE_ONE_OUT, which needs all samples at once, and for NF_SOLVER_DUAL.
 */
nf_status nf_cv_accumulator_init(void *memory,
                                 size_t bytes,
                                 const struct nf_cv_config *config,
                                 struct nf_cv_accumulator **out);

/*
 Adds n samples, laid out as for nf_cv_estimate(): all of them or, on an error, none. A configuration with `controls`
 needs nf_cv_accumulator_add_with_controls().
 */
nf_status nf_cv_accumulator_add(struct nf_cv_accumulator *accumulator, const float *u, const float *f, size_t n);

/*
 As nf_cv_accumulator_add(), with the control functions of nf_cv_estimate_with_controls().
 */
nf_status nf_cv_accumulator_add_with_controls(struct nf_cv_accumulator *accumulator,
                                              const float *u,
                                              const float *f,
                                              const float *h,
                                              const float *h_integral,
                                              size_t n);

/*
 Adds all samples of `other`, which stays as it is. NF_ERR_MISMATCH if the configurations differ.
 */
nf_status nf_cv_accumulator_merge(struct nf_cv_accumulator *accumulator, const struct nf_cv_accumulator *other);

/*
 Bytes of workspace that nf_cv_accumulator_estimate() needs; 0 as for nf_cv_accumulator_size().
 */
size_t nf_cv_accumulator_workspace_size(const struct nf_cv_config *config);

/*
 The estimate from all samples so far; more may be added afterwards. NF_ERR_NO_SAMPLES if there are none.
 */
nf_status nf_cv_accumulator_estimate(const struct nf_cv_accumulator *accumulator,
                                     void *workspace,
                                     size_t bytes,
                                     struct nf_estimate *out);

/*
 Forgets all samples.
 */
nf_status nf_cv_accumulator_reset(struct nf_cv_accumulator *accumulator);

/*
 Bytes of workspace that nf_cv_estimate() and its variants need for n samples; 0 for a configuration that is NULL or
 out of range, or a size no memory has.
 */
size_t nf_cv_workspace_size(const struct nf_cv_config *config, size_t n);

/*
 Estimates an integral from n samples: u has n rows of `stride` floats (the last may end after `dims`), f has n rows
 of `channels`. The workspace's content is used up.

 NF_ERR_RANGE for a configuration or coordinate out of range, NF_ERR_NOT_FINITE for a NaN or infinity (but see
 NF_NONFINITE_SKIP), NF_ERR_NO_SAMPLES for n = 0, NF_ERR_MEMORY and NF_ERR_ALIGNMENT for the workspace,
 NF_ERR_UNSUPPORTED for options that exclude each other.
 */
nf_status nf_cv_estimate(const struct nf_cv_config *config,
                         const float *u,
                         const float *f,
                         size_t n,
                         void *workspace,
                         size_t bytes,
                         struct nf_estimate *out);

/*
 As nf_cv_estimate(), with `controls` functions h of known integral (4.18): h has n rows of `controls` floats, the
 functions at the samples, and h_integral their integrals. Both may be NULL if `controls` is 0.
 */
nf_status nf_cv_estimate_with_controls(const struct nf_cv_config *config,
                                       const float *u,
                                       const float *f,
                                       const float *h,
                                       const float *h_integral,
                                       size_t n,
                                       void *workspace,
                                       size_t bytes,
                                       struct nf_estimate *out);

/*
 As nf_cv_estimate() with NF_CV_GRADIENT_DESCENT, which `estimator` must be, starting from `coefficients`, `channels`
 rows (1 for a luminance ratio) of nf_cv_terms() - 1 floats in the values' unit, and leaving the solution there: a
 previous frame's is a good start (4.2.6).
 */
nf_status nf_cv_gradient_descent(const struct nf_cv_config *config,
                                 const float *u,
                                 const float *f,
                                 size_t n,
                                 float *coefficients,
                                 void *workspace,
                                 size_t bytes,
                                 struct nf_estimate *out);

/*
 Bytes of workspace that nf_cv_block_estimate() needs; 0 as for nf_cv_workspace_size().
 */
size_t nf_cv_block_workspace_size(const struct nf_cv_config *config, size_t pixels, size_t n);

/*
 Estimates `pixels` integrals that are alike, from n samples of each: u and f hold pixel after pixel what
 nf_cv_estimate() takes, out one estimate for each pixel. Every pixel is corrected by a fit to the other pixels'
 samples (4.3.6): exactly unbiased for a given `ridge`; by default the block weighs four fits and the plain mean by
 the variance across its pixels.
 */
nf_status nf_cv_block_estimate(const struct nf_cv_config *config,
                               const float *u,
                               const float *f,
                               size_t pixels,
                               size_t n,
                               void *workspace,
                               size_t bytes,
                               struct nf_estimate *out);

/*
 Sets a configuration to the robust estimator over 2 coordinates, order 2, 1 channel. NULL is ignored.
 */
void nf_cv_config_default(struct nf_cv_config *config);

/*
 The number of terms of a regression, constant included; 0 for a configuration that is NULL or out of range.
 */
uint32_t nf_cv_terms(const struct nf_cv_config *config);

/*
 The ABI version the library was built with; it must equal `NF_ABI_VERSION`.
 */
uint32_t nf_abi_version(void);

/*
 A static, NUL-terminated sentence for a status; never NULL, also for values that are no status.
 */
const char *nf_status_message(nf_status status);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* NOISEFLOOR_H */
