/* noisefloor: less Monte Carlo noise for the samples you already pay for.
 *
 * Generated from capi/ by `cargo xtask header`; do not edit. MIT OR Apache-2.0.
 *
 * Conventions, written once:
 *  - Arguments: configuration or object first (for an init function, the memory of the object to be), then inputs, then
 *    memory, then outputs. No memory or output may overlap any other argument.
 *  - Samples are points of primary sample space, u in [0, 1]^dims, row after row; f = integrand / pdf, any unit.
 *  - Every function that can fail returns nf_status: 0 (NF_OK) or a negative NF_ERR_*. Outputs are written, and objects
 *    changed, only on success. Inputs are checked: NULL, ranges, lengths, alignment, finite values.
 *  - Memory: nothing is ever allocated. Objects and workspaces live in caller memory, 8-byte aligned, of at least the
 *    bytes that the matching size function returns. Neither they nor outputs need be initialised. Nothing needs to be
 *    destroyed. An object must not be moved or copied while it is in use, unless its description says otherwise. The
 *    bytes of one in caller memory mean something only to the library file that made them, which alone may change
 *    them: NF_ERR_STATE tells memory that holds no object, not an object whose bytes were changed. Tables are kept, and
 *    sent to other builds and machines, with nf_table_save().
 *  - Threads: no locks, and no shared state but a cached answer of the processor's. Any number of threads may read an
 *    object; one at a time may write it.
 *  - Arithmetic: IEEE 754, rounding to nearest. Where the host flushes subnormal numbers to zero, values above 1e-30
 *    give the same bits. Built for x86-64, nothing raises an invalid operation, a division by zero or an overflow for
 *    zeros and for values of magnitude 1e-15 to 1e15 (control functions in float: 1e-8 to 1e8), but for a descent with
 *    a `learning_rate` of the caller's: hosts may trap these.
 *  - Configurations are plain numbers; zero in an optional field means the documented default (of nf_cv_config all but
 *    dims, order and channels are optional), an unknown value is NF_ERR_RANGE.
 *  - NF_ERR_RANGE does not say which argument it means: a function's comment lists those that it can mean, with their
 *    ranges there or where they are declared. Of a configuration and samples, it was the configuration if
 *    nf_cv_workspace_size() is 0 for one sample.
 *  - References such as (4.22) are to C. Salaun, "Toward Improving Monte Carlo Estimator for Rendering and
 *    Machine Learning", 2025.
 */

#ifndef NOISEFLOOR_H
#define NOISEFLOOR_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------------------------------------------
 * Version and status
 *
 *   nf_abi_version     The ABI version the library was built with
 *   nf_status_message  A static, NUL-terminated sentence for a status
 * ------------------------------------------------------------------------------------------------------------------ */

// The version of this header. `nf_abi_version()` returns the library's.
#define NF_ABI_VERSION 1

// The ABI version the library was built with; it must equal `NF_ABI_VERSION`.
uint32_t nf_abi_version(void);

// 0 is success, a negative value an error; `nf_status_message` explains it.
typedef int32_t nf_status;

// Success.
#define NF_OK 0
// A required pointer is NULL.
#define NF_ERR_NULL (-1)
// An argument is outside its documented range.
#define NF_ERR_RANGE (-2)
// An input value is NaN or infinite.
#define NF_ERR_NOT_FINITE (-3)
// Caller-supplied memory is too small.
#define NF_ERR_MEMORY (-4)
// Caller-supplied memory is not aligned as its type needs.
#define NF_ERR_ALIGNMENT (-5)
// There is nothing to estimate or to draw from.
#define NF_ERR_NO_SAMPLES (-6)
// The options exist, but not in this combination.
#define NF_ERR_UNSUPPORTED (-7)
// The memory holds no initialised object.
#define NF_ERR_STATE (-8)
// Two objects were made with different configurations.
#define NF_ERR_MISMATCH (-9)
// The bytes are no tile, or no table.
#define NF_ERR_FOREIGN (-10)
// The format is newer than this library.
#define NF_ERR_VERSION (-11)
// Bytes are missing, or there are too many.
#define NF_ERR_LENGTH (-12)
// The bytes are damaged.
#define NF_ERR_CORRUPT (-13)

// A static, NUL-terminated sentence for a status; never NULL, also for values that are no status.
const char *nf_status_message(nf_status status);

/* ------------------------------------------------------------------------------------------------------------------
 * Control variates: samples of one integral, or of a pixel, made into an estimate of lower error
 * Guides, in docs/: control_variates.md
 *
 *   nf_cv_config_default                 Sets a configuration to the robust estimator over 2 coordinates, order 2
 *   nf_cv_terms                          The number of terms of a regression, constant included
 *   nf_cv_workspace_size                 Bytes of workspace that nf_cv_estimate() and its variants need for n samples
 *   nf_cv_estimate                       Estimates an integral from n samples
 *   nf_cv_estimate_with_controls         As nf_cv_estimate(), with `controls` functions h of known integral (4.18)
 *   nf_cv_gradient_descent               As nf_cv_estimate() with NF_CV_GRADIENT_DESCENT, which `estimator` must be
 *   nf_cv_image_needed                   Writes which pixels must be given for those of `image->wanted`
 *   nf_cv_image_workspace_size           Bytes of workspace that nf_cv_image_estimate() needs for n samples in each
 *                                        pixel
 *   nf_cv_image_estimate                 As nf_cv_block_estimate() for every pixel of an image
 *   nf_cv_estimate_many                  As nf_cv_estimate() for each of `integrals` integrals, n samples of each
 *   nf_cv_block_workspace_size           Bytes of workspace that nf_cv_block_estimate() needs
 *   nf_cv_block_estimate                 Estimates `pixels` integrals that are alike, from n samples of each
 *   nf_cv_accumulator_size               Bytes that an accumulator needs
 *   nf_cv_accumulator_init               Makes an empty accumulator in `memory`
 *   nf_cv_accumulator_add                Adds n samples, laid out as for nf_cv_estimate()
 *   nf_cv_accumulator_add_with_controls  As nf_cv_accumulator_add(), with the control functions of
 *                                        nf_cv_estimate_with_controls()
 *   nf_cv_accumulator_merge              Adds all samples of `other`, which stays as it is
 *   nf_cv_accumulator_workspace_size     Bytes of workspace that nf_cv_accumulator_estimate() needs
 *   nf_cv_accumulator_estimate           The estimate from all samples so far
 *   nf_cv_accumulator_reset              Forgets all samples
 * ------------------------------------------------------------------------------------------------------------------ */

// Estimator: a soft mixture of the plain mean and ridge fits, weighted by their leave-one-out errors (streaming:
// held-out errors). The default; never noticeably worse than the mean: at most 1.03 times its RMSE where that was
// searched, in 1 to 8 dims at orders 1 to 3 and 4 to 64 samples, 1.06 times on stripes that samples rarely see.
// Slightly biased at low sample counts.
#define NF_CV_ROBUST 0
// Estimator: least squares on its own samples (Alg. 1). The cheapest; bias O(1/n); needs several samples per term.
#define NF_CV_LEAST_SQUARES 1
// Estimator: one ridge fit, each sample corrected by the fit to all others. Exactly unbiased for the default or a
// given ridge. Not for streaming.
#define NF_CV_LEAVE_ONE_OUT 2
// Estimator: each fold corrected by a robust fit to the other folds (two folds: 4.2.6). Exactly unbiased.
#define NF_CV_K_FOLD 3
// Estimator: the fit by gradient descent on its own samples (Alg. 2). Biased, below 32 samples more than least
// squares.
#define NF_CV_GRADIENT_DESCENT 4
// Estimator: each sample corrected by a fit to those before it (4.30). Exactly unbiased after every sample.
#define NF_CV_INCREMENTAL 5

// Basis: products of orthonormal shifted Legendre polynomials. The default.
#define NF_BASIS_LEGENDRE 0
// Basis: products of Walsh functions, constant on the cells of a grid of eighths.
#define NF_BASIS_STEP 1
// Basis: products of half-waves sin(pi d x + pi/2).
#define NF_BASIS_SINE 2
// Basis: isotropic Gaussians, as many as Legendre has terms.
#define NF_BASIS_GAUSSIAN 3

// Solver: dual for fewer samples than terms, else normal equations. The default.
#define NF_SOLVER_AUTO 0
// Solver: normal equations (4.27) and LDL'.
#define NF_SOLVER_NORMAL_EQUATIONS 1
// Solver: Givens rotations, for badly placed samples. Only with NF_CV_LEAST_SQUARES.
#define NF_SOLVER_SQUARE_ROOT 2
// Solver: the n x n system of at most 4096 samples. Not for streaming.
#define NF_SOLVER_DUAL 3

// For `ridge`: of a few strengths the one with the smallest leave-one-out error.
#define NF_RIDGE_AUTO (-1.0f)

// Gradient descent with heavy-ball momentum. The default.
#define NF_OPTIMIZER_MOMENTUM 0
// Gradient descent by Adam.
#define NF_OPTIMIZER_ADAM 1
// Plain gradient descent (4.29).
#define NF_OPTIMIZER_PLAIN 2

// Each channel is regressed on its own, with one factorisation. The default.
#define NF_COLOR_PER_CHANNEL 0
// Rec. 709 luminance is regressed and scales the plain mean of 3 channels (section 4.3).
#define NF_COLOR_LUMINANCE_RATIO 1

// A NaN or infinite sample is NF_ERR_NOT_FINITE. The default.
#define NF_NONFINITE_ERROR 0
// A NaN or infinite sample is left out and not counted; biased unless such samples would have been average ones.
#define NF_NONFINITE_SKIP 1

// Precision: double. The default; NF_ERR_UNSUPPORTED where the library was built for float alone.
#define NF_PRECISION_F64 0
// Precision: float, for targets without double hardware.
#define NF_PRECISION_F32 1

// How to estimate. Zero in any field but dims, order and channels is its default; order 0 is the plain mean.
typedef struct nf_cv_config {
    // Coordinates of a sample that are regressed, 1 to 16.
    uint32_t dims;
    // Largest total degree, 0 to 7; 0 is the plain mean. nf_cv_terms() may not exceed 136.
    uint32_t order;
    // Values of a sample, 1 to 4.
    uint32_t channels;
    // NF_CV_*
    uint32_t estimator;
    // NF_BASIS_*
    uint32_t basis;
    // 1 if the samples are stratified (a tile, Sobol points, a lattice), 0 if independent. With 1, one pixel's
    // estimate is the plain mean, but for NF_CV_LEAST_SQUARES and NF_CV_GRADIENT_DESCENT: what corrects some samples
    // by fits to others undoes what is even about all, and their errors do not show it. Fits shared by pixels correct
    // all the same, and take their std_error from the pixels' spread.
    uint32_t stratified;
    // If above 1, the last coordinate picks one of this many equally likely alternatives, a light say (figure 4.15).
    // Each takes a term: at most 136 less binomial(dims - 1 + order, order), those of the other coordinates, and
    // `controls`. That is 130 at 3 dims, order 2, where up to 43 have functions of their own as well
    // (docs/control_variates.md). Of more alternatives let each slice stand for several.
    uint32_t slices;
    // User-supplied control functions with known integrals (4.18), 0 to 4.
    uint32_t controls;
    // Floats from one sample's u to the next; 0 means dims. A path may be longer than what is regressed (4.3.5); its
    // first dims coordinates must exist, uniform, for every sample, however short its path.
    uint32_t stride;
    // NF_SOLVER_*
    uint32_t solver;
    // NF_PRECISION_*
    uint32_t precision;
    // NF_NONFINITE_*
    uint32_t nonfinite;
    // NF_COLOR_*
    uint32_t color;
    // Folds of NF_CV_K_FOLD and of the streaming NF_CV_ROBUST, 2 to 16; 0 means 4. Runs of samples in the order in
    // which they come.
    uint32_t folds;
    // Steps of gradient descent, at most 2^20; 0 means half as many as samples, 8 to 128.
    uint32_t iterations;
    // NF_OPTIMIZER_*
    uint32_t optimizer;
    // Ridge strength per sample (at least 1e-12, in float 1e-5: less is raised to it), NF_RIDGE_AUTO, or 0 for the
    // estimator's default. NF_CV_ROBUST and NF_CV_GRADIENT_DESCENT do not use it; NF_RIDGE_AUTO is the default where
    // there are no leave-one-out errors (streaming, incremental, blocks), and biases NF_CV_LEAVE_ONE_OUT slightly.
    float ridge;
    // Step of gradient descent: in standard deviations of the values for Adam, else times one over the largest
    // curvature. 0 means the default.
    float learning_rate;
    // Momentum of gradient descent, below 1; 0 means the default.
    float momentum;
} nf_cv_config;

// Sets a configuration to the robust estimator over 2 coordinates, order 2, 1 channel. NULL is ignored.
void nf_cv_config_default(nf_cv_config *config);

// The number of terms of a regression, constant included; 0 for a configuration that is NULL or out of range.
uint32_t nf_cv_terms(const nf_cv_config *config);

// An estimate of an integral over primary sample space.
typedef struct nf_estimate {
    // The integral, for each channel; zero for channels that are not there.
    float mean[4];
    // An estimate of each mean's standard error; infinite if one sample is all there is.
    float std_error[4];
    // Samples used.
    uint32_t samples;
    // Estimated variance relative to the plain mean's, averaged over the channels; 1 is no gain.
    float gain;
} nf_estimate;

// Bytes of workspace that nf_cv_estimate() and its variants need for n samples; 0 for a configuration that is NULL,
// out of range or unsupported, or a size no memory has.
size_t nf_cv_workspace_size(const nf_cv_config *config, size_t n);

// Some pixels of an image.
typedef struct nf_cv_rectangle {
    // The first column.
    uint32_t x;
    // The first row.
    uint32_t y;
    // Columns.
    uint32_t width;
    // Rows.
    uint32_t height;
} nf_cv_rectangle;

// The pixels of an image, or of a part of one, and what is known of them. All zero but width and height: nothing.
// Pixel (x, y) of frame t has the number (t height + y) width + x.
typedef struct nf_cv_image {
    // Pixels in a row.
    uint32_t width;
    // Rows.
    uint32_t height;
    // Images of the same pixels at other times, which share fits; 0 means 1.
    uint32_t frames;
    // Width and height of the windows that pixels share a fit in; 0 means 8. At most 1024 pixels in all frames
    // together.
    uint32_t window;
    // Pixels from one window to the next, at most `window`; 0 means half of it. Where windows overlap corrections are
    // averaged. The time of an estimate goes with the square of window / stride.
    uint32_t stride;
    // 1 if the pixels have no places: all of the same surface, in all frames, then share one fit, whatever `window`
    // and `stride` say. With `surfaces` they are at most 1024.
    uint32_t unordered;
    // A number for each pixel, or NULL: only pixels with the same number share a fit. What shows the same material
    // under a similar normal and depth, for example. Must not depend on the pixel's own samples, or no estimator is
    // unbiased.
    const uint32_t *surfaces;
    // `channels` numbers for each pixel, or NULL: what its values are divided by before a fit and multiplied by after
    // it, such as its albedo. Finite and not negative; 0 counts as 1. Must not depend on the pixel's own samples
    // either. For textures, where all samples of a pixel see one albedo: with defocus or motion blur they can raise
    // the error. Pixels near 0 beside others are better kept apart by `surfaces`: their values would decide the fit.
    const float *factors;
    // For each sample, as f, what it would be with nothing in the way (its unshadowed contribution), or NULL. Finite.
    // Pixels are then also corrected by how far it is from `known_integrals`, as far as their neighbours follow it.
    const float *known;
    // With `known`, else NULL: `channels` numbers for each pixel, its exact integrals over u: of a polygon light in
    // closed form, for example. Finite and not negative; a pixel with 0 is not corrected by it. Where a pixel's
    // samples see several points, the mean of theirs.
    const float *known_integrals;
    // The pixels that u, f and the arrays above hold, in all frames; all zero: all of the image. Numbers of pixels
    // then count these alone.
    nf_cv_rectangle given;
    // The pixels to estimate, for which `out` has room; all zero: all that are given. A part without pixels is
    // refused, but at the origin, where it is all zero. Every window that has one of
    // them must be given whole, see nf_cv_image_needed(). Parts that are estimated on their own, by threads for
    // example, have the bits of the whole.
    nf_cv_rectangle wanted;
} nf_cv_image;

// Estimates an integral from n samples: u has n rows of `stride` floats (the last may end after `dims`), f has n rows
// of `channels`. The workspace's content is used up.
//
// NF_ERR_RANGE for a configuration or coordinate out of range, NF_ERR_NOT_FINITE for a NaN or infinity (but see
// NF_NONFINITE_SKIP), NF_ERR_NO_SAMPLES for n = 0, NF_ERR_MEMORY and NF_ERR_ALIGNMENT for the workspace,
// NF_ERR_UNSUPPORTED for options that exclude each other.
nf_status nf_cv_estimate(const nf_cv_config *config,
                         const float *u,
                         const float *f,
                         size_t n,
                         void *workspace,
                         size_t bytes,
                         nf_estimate *out);

// As nf_cv_estimate(), with `controls` functions h of known integral (4.18): h has n rows of `controls` floats, the
// functions at the samples, and h_integral their integrals. Both may be NULL if `controls` is 0.
nf_status nf_cv_estimate_with_controls(const nf_cv_config *config,
                                       const float *u,
                                       const float *f,
                                       const float *h,
                                       const float *h_integral,
                                       size_t n,
                                       void *workspace,
                                       size_t bytes,
                                       nf_estimate *out);

// As nf_cv_estimate() with NF_CV_GRADIENT_DESCENT, which `estimator` must be, starting from `coefficients`, `channels`
// rows (1 for a luminance ratio) of nf_cv_terms() - 1 floats in the values' unit, and leaving the solution there: a
// previous frame's is a good start (4.2.6). A channel whose descent diverges is its mean, and its coefficients are 0.
// NF_ERR_UNSUPPORTED for another estimator or `controls`.
nf_status nf_cv_gradient_descent(const nf_cv_config *config,
                                 const float *u,
                                 const float *f,
                                 size_t n,
                                 float *coefficients,
                                 void *workspace,
                                 size_t bytes,
                                 nf_estimate *out);

// Writes which pixels must be given for those of `image->wanted`: its windows whole; all zero, and so all, where
// pixels have no places. Reads no array. `out` may be `&image->given`.
//
// NF_ERR_RANGE for windows that nf_cv_image does not allow and for `wanted` beyond the image.
nf_status nf_cv_image_needed(const nf_cv_image *image, nf_cv_rectangle *out);

// Bytes of workspace that nf_cv_image_estimate() needs for n samples in each pixel; 0 as for nf_cv_workspace_size(),
// and for an image that is NULL, has no pixels, or has windows that nf_cv_image does not allow. With `known` it is
// more.
size_t nf_cv_image_workspace_size(const nf_cv_config *config, const nf_cv_image *image, size_t n);

// As nf_cv_block_estimate() for every pixel of an image: u and f hold n samples of pixel after pixel, and pixels of
// the same window and surface share a fit. Fits also follow integrands that change across the window.
//
// With `known`, NF_CV_LEAVE_ONE_OUT corrects by that alone and is the only one that is exactly unbiased; NF_CV_ROBUST
// chooses among fits to f and to what is left of it, and with order 0 between the mean and what is known. NF_CV_K_FOLD
// is then unsupported.
//
// NF_ERR_RANGE also for an image without pixels, for windows and parts that nf_cv_image does not allow, for negative
// factors or integrals and for `known` without `known_integrals`; NF_ERR_NOT_FINITE if any of the three is not finite.
nf_status nf_cv_image_estimate(const nf_cv_config *config,
                               const nf_cv_image *image,
                               const float *u,
                               const float *f,
                               size_t n,
                               void *workspace,
                               size_t bytes,
                               nf_estimate *out);

// As nf_cv_estimate() for each of `integrals` integrals, n samples of each: u and f hold integral after integral, out
// one estimate for each, with the bits of single calls. The workspace is that of one. For interpreters and others
// whose calls are dear.
//
// NF_ERR_UNSUPPORTED also for `controls` and NF_NONFINITE_SKIP; else as nf_cv_estimate().
nf_status nf_cv_estimate_many(const nf_cv_config *config,
                              const float *u,
                              const float *f,
                              size_t n,
                              size_t integrals,
                              void *workspace,
                              size_t bytes,
                              nf_estimate *out);

// Bytes of workspace that nf_cv_block_estimate() needs; 0 as for nf_cv_workspace_size().
size_t nf_cv_block_workspace_size(const nf_cv_config *config, size_t pixels, size_t n);

// Estimates `pixels` integrals that are alike, from n samples of each: u and f hold pixel after pixel what
// nf_cv_estimate() takes, out one estimate for each pixel. Every pixel is corrected by a fit to other pixels' samples
// (4.3.6), even from one sample in each. All is computed in float, whatever `precision` says.
//
// The estimator says how fits are chosen. NF_CV_ROBUST weighs fits of rising degree and the plain mean by the variance
// of their estimates across the pixels and, from 2 samples on, by what they leave of the variance within pixels that
// they have not seen; unbiased as the block grows. NF_CV_K_FOLD lets two halves of the pixels choose for each other,
// NF_CV_LEAVE_ONE_OUT or a `ridge` is one fit: both exactly unbiased, if the pixels' samples are independent. Groups
// of up to 4 pixels stay at their mean, but for one fit to several samples in each; one fit to 2 to 12 pixels can be a
// fifth worse than the mean. Where fits explain little, NF_CV_ROBUST and NF_CV_K_FOLD leave pixels far brighter or
// darker than all others out of the fits to others.
//
// Of a texture one sample in each pixel cannot tell: say it by `surfaces` or `factors` of nf_cv_image. Several do:
// pixels whose samples are all alike stay as they are.
//
// With one sample, or `stratified`, std_error is the spread of the pixels' estimates about their linear trend: an
// upper bound where the signal varies otherwise.
//
// NF_ERR_UNSUPPORTED for other estimators, controls, skipping and luminance ratio; else as nf_cv_estimate().
nf_status nf_cv_block_estimate(const nf_cv_config *config,
                               const float *u,
                               const float *f,
                               size_t pixels,
                               size_t n,
                               void *workspace,
                               size_t bytes,
                               nf_estimate *out);

// A streaming estimate of fixed size, in caller memory. It may be moved or copied as bytes between calls, in one
// process or among those that run the same library file. The bytes are no file format: another build may lay them out
// otherwise. NF_ERR_STATE tells those of another version, or of another size, not of every other build. No one but
// the library may change them: behind the first 8 they are not checked.
typedef struct nf_cv_accumulator nf_cv_accumulator;

// Bytes that an accumulator needs; 0 for a configuration that is NULL, out of range or not for streaming.
size_t nf_cv_accumulator_size(const nf_cv_config *config);

// Makes an empty accumulator in `memory`, 8-byte aligned and of at least nf_cv_accumulator_size() bytes, and returns
// it in out.
//
// NF_ERR_UNSUPPORTED for NF_CV_LEAVE_ONE_OUT, which needs all samples at once, and for NF_SOLVER_DUAL.
nf_status nf_cv_accumulator_init(void *memory,
                                 size_t bytes,
                                 const nf_cv_config *config,
                                 nf_cv_accumulator **out);

// Adds n samples, laid out as for nf_cv_estimate(): all of them or, on an error, none. Several at a time are cheaper.
// In single precision an accumulator holds 2^22 samples: NF_ERR_RANGE beyond. A configuration with `controls` needs
// nf_cv_accumulator_add_with_controls().
nf_status nf_cv_accumulator_add(nf_cv_accumulator *accumulator, const float *u, const float *f, size_t n);

// As nf_cv_accumulator_add(), with the control functions of nf_cv_estimate_with_controls().
nf_status nf_cv_accumulator_add_with_controls(nf_cv_accumulator *accumulator,
                                              const float *u,
                                              const float *f,
                                              const float *h,
                                              const float *h_integral,
                                              size_t n);

// Adds all samples of `other`, which stays as it is. NF_ERR_MISMATCH if the configurations differ, NF_ERR_RANGE if
// both are the same object. Like every function of an accumulator, NF_ERR_STATE for memory that holds none.
nf_status nf_cv_accumulator_merge(nf_cv_accumulator *accumulator, const nf_cv_accumulator *other);

// Bytes of workspace that nf_cv_accumulator_estimate() needs; 0 as for nf_cv_accumulator_size().
size_t nf_cv_accumulator_workspace_size(const nf_cv_config *config);

// The estimate from all samples so far; more may be added afterwards. NF_ERR_NO_SAMPLES if there are none.
nf_status nf_cv_accumulator_estimate(const nf_cv_accumulator *accumulator,
                                     void *workspace,
                                     size_t bytes,
                                     nf_estimate *out);

// Forgets all samples.
nf_status nf_cv_accumulator_reset(nf_cv_accumulator *accumulator);

/* ------------------------------------------------------------------------------------------------------------------
 * Guidance: which estimator and which tile to use
 * Guides, in docs/: choosing.md
 *
 *   nf_recommend  Which estimator, of which order, and which of the library's tiles to use for samples of `dims`
 *                 coordinates and `spp` of them per pixel, both at least 1
 * ------------------------------------------------------------------------------------------------------------------ */

// Sampling: a pixel's samples are independent of each other.
#define NF_SAMPLING_INDEPENDENT 0
// Sampling: a tile's, a Sobol sequence's, or jittered.
#define NF_SAMPLING_STRATIFIED 1

// Method: the mean of the values; nf_cv_estimate() with order 0 gives it, too.
#define NF_METHOD_PLAIN_MEAN 0
// Method: nf_cv_estimate() for each pixel.
#define NF_METHOD_PER_PIXEL 1
// Method: nf_cv_image_estimate().
#define NF_METHOD_SHARED 2

// What nf_recommend() says.
typedef struct nf_recommendation {
    // How to make estimates of the samples: NF_METHOD_*
    uint32_t method;
    // The `stride` of nf_cv_image for NF_METHOD_SHARED, for windows of 8. With surfaces leave it 0, for overlapping
    // windows.
    uint32_t image_stride;
    // Which built-in tile to draw from, if there is a choice: its samples per pixel. A tile of 1 sample is continued
    // as a Sobol sequence.
    uint32_t tile_samples;
    // The same: its dims.
    uint32_t tile_dims;
    // What to expect: mean squared error over that of the plain mean of independent samples. Of stratified samples
    // measured on the tile named above, except: for 5 to 8 dims and 1 to 3 samples, on that of 2 dims; from 64 samples
    // on, with Sobol points scrambled in each pixel (on the tile of 1 sample, continued, only the plain mean was
    // measured, at .77 to 1.1 times this error).
    float error;
    // The same of the image filtered by a Gaussian of 2.1 pixels, with the same exceptions; the plain mean of the tile
    // of 1 sample, continued, has .81 to 1.4 times the error of Sobol points scrambled in each pixel that is given
    // here.
    float filtered_error;
    // Nanoseconds that the method takes for each sample on the machine of the report: of NF_METHOD_SHARED in rendered
    // frames of three channels with surfaces, in windows side by side, of NF_METHOD_PER_PIXEL for one channel. Windows
    // that overlap by half take three times as long, and pay from twice `pays_from` on.
    float cost;
    // The cost of a sample, in nanoseconds, from which a fit pays: below it more samples of the plain mean, in the
    // same time, would lower the error further. Of NF_METHOD_SHARED the median over eight rendered frames. Infinite if
    // no fit pays at any cost.
    float pays_from;
    // How to estimate. `channels` is 1: set your own. `stride` is all dims.
    nf_cv_config config;
} nf_recommendation;

// Which estimator, of which order, and which of the library's tiles to use for samples of `dims` coordinates and `spp`
// of them per pixel, both at least 1. `sampling` is NF_SAMPLING_*; `can_share` is 1 if neighbouring pixels' samples
// are at hand together and integrate similar functions, else 0. `sample_cost` is what a sample costs to trace, in
// nanoseconds: below `pays_from` the plain mean is best. INFINITY compares errors at equal samples. docs/choosing.md
// has the measurements that it rests on.
//
// NF_ERR_RANGE also for a cost that is not above 0, NF_ERR_NOT_FINITE for a NaN.
nf_status nf_recommend(uint32_t dims,
                       uint32_t spp,
                       uint32_t sampling,
                       uint32_t can_share,
                       float sample_cost,
                       nf_recommendation *out);

/* ------------------------------------------------------------------------------------------------------------------
 * Multiple importance sampling: the weight of one technique at one point
 * Guides, in docs/: mis.md
 *
 *   nf_mis_balance               The balance heuristic (2.12)
 *   nf_mis_power                 The power heuristic
 *   nf_mis_cutoff                The cutoff heuristic
 *   nf_mis_maximum               The maximum heuristic
 *   nf_mis_optimal               The optimal weight (2.15) of Kondapaneni et al. (2019)
 *   nf_mis_optimal_contribution  What one sample of technique j adds to the estimate (2.10) with optimal weights
 * ------------------------------------------------------------------------------------------------------------------ */

// The most techniques that multiple importance sampling combines.
#define NF_MIS_MAX_TECHNIQUES 16

// The balance heuristic (2.12): the weight n_j p_j / sum_k n_k p_k of technique j at one point.
//
// pdf[techniques]: p_k, the density of each technique at the point, in any one measure, at least 0. Infinity stands
// for a delta distribution: where any is infinite the finite ones count as 0 and the infinite ones are equally dense.
// counts[techniques]: n_k, the number of samples of each technique; one with 0 has no part in it. techniques:
// 1..NF_MIS_MAX_TECHNIQUES. technique: j, below techniques.
//
// The weights of all techniques sum to 1 and are safe for densities from 1e-38 to 1e38. Where every n_k p_k is 0, so
// that the point cannot have been drawn, each is 0. With them, the sum over all samples of weight * f / (n_j p_j) is
// unbiased (2.10).
//
// NF_ERR_NULL; NF_ERR_RANGE: techniques, technique, or a negative density; NF_ERR_NOT_FINITE: a density is NaN.
nf_status nf_mis_balance(const float *pdf,
                         const uint32_t *counts,
                         uint32_t techniques,
                         uint32_t technique,
                         float *weight);

// The power heuristic: the weight (n_j p_j)^beta / sum_k (n_k p_k)^beta.
//
// beta: positive and finite; 0 means the usual 2. 1 is the balance heuristic. (2.13) prints the exponent outside the
// sum; those weights would not sum to 1, and these are Veach's.
//
// Other arguments and errors as for nf_mis_balance; NF_ERR_RANGE: beta is negative; NF_ERR_NOT_FINITE: beta is not
// finite.
nf_status nf_mis_power(const float *pdf,
                       const uint32_t *counts,
                       uint32_t techniques,
                       uint32_t technique,
                       float beta,
                       float *weight);

// The cutoff heuristic: the balance heuristic among the techniques with n_k p_k >= epsilon * max_i n_i p_i.
//
// epsilon: 0..1; 0 is the balance heuristic, 1 the maximum heuristic with ties shared. (2.14) prints an absolute
// threshold on p_k, without the counts; it would depend on the unit of the density, and leave points where no
// technique reaches it. This is Veach's form.
//
// Other arguments and errors as for nf_mis_balance; NF_ERR_RANGE: epsilon; NF_ERR_NOT_FINITE: epsilon is not finite.
nf_status nf_mis_cutoff(const float *pdf,
                        const uint32_t *counts,
                        uint32_t techniques,
                        uint32_t technique,
                        float epsilon,
                        float *weight);

// The maximum heuristic: 1 for the technique with the largest n_k p_k (the first of them if several tie), 0 for
// others.
//
// Arguments and errors as for nf_mis_balance.
nf_status nf_mis_maximum(const float *pdf,
                         const uint32_t *counts,
                         uint32_t techniques,
                         uint32_t technique,
                         float *weight);

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
nf_status nf_mis_optimal(const float *pdf,
                         const uint32_t *counts,
                         uint32_t techniques,
                         uint32_t technique,
                         const float *alpha,
                         float value,
                         float *weight);

// What one sample of technique j adds to the estimate (2.10) with optimal weights:
// w_j f / (n_j p_j) = alpha_j / n_j + (f - sum_k alpha_k p_k) / S, S = sum_k n_k p_k.
//
// The sum over all samples is the estimate, unbiased if alpha came from other samples. The term is not 0 where f is;
// leaving such samples out keeps the mean and loses part of the gain. These terms, times the number of samples, are
// what a regression control variate is fitted to (4.3.3).
//
// Arguments and errors as for nf_mis_optimal, except that value may be 0, and pdf[technique] must be positive.
nf_status nf_mis_optimal_contribution(const float *pdf,
                                      const uint32_t *counts,
                                      uint32_t techniques,
                                      uint32_t technique,
                                      const float *alpha,
                                      float value,
                                      float *contribution);

/* ------------------------------------------------------------------------------------------------------------------
 * Optimal multiple importance sampling: weights of least variance, found from the samples
 * Guides, in docs/: mis.md
 *
 *   nf_omis_size        The bytes of memory an nf_omis needs
 *   nf_omis_init        Makes an empty nf_omis in `memory`, `*out` being its handle (the same address)
 *   nf_omis_add         Adds one sample, drawn by `technique`
 *   nf_omis_solve       Estimates the integrals from all samples so far
 *   nf_omis_alpha       The coefficients of the weights (2.15), for nf_mis_optimal and nf_mis_optimal_contribution
 *   nf_omis_next_batch  Ends a batch
 *   nf_omis_decay       Multiplies all sums by beta in 0..1, so that older samples count for less
 *   nf_omis_reset       Forgets every sample and NF_OMIS_PROGRESSIVE's alpha
 *   nf_omis_merge       Adds the samples of `other`, of another thread or pass, to `omis`
 * ------------------------------------------------------------------------------------------------------------------ */

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
nf_status nf_omis_init(void *memory,
                       size_t bytes,
                       uint32_t techniques,
                       uint32_t integrals,
                       const uint32_t *counts,
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

/* ------------------------------------------------------------------------------------------------------------------
 * Samplers and tiles: sample points whose error is spread over the image where it shows least
 * Guides, in docs/: tiles.md, renderer.md
 *
 *   nf_tile_builtin           One of the tiles that come with the library, by number
 *   nf_tile_from_bytes        The tile of an .nft file's bytes, all of them checked
 *   nf_sampler_pixel          Sample `index` of pixel (x, y) in `frame`, any values of each
 *   nf_sampler_white          As nf_sampler_pixel(), but neighbours know nothing of each other
 *   nf_sampler_domain         The child domain of a key, any value
 *   nf_sampler_scramble       An independent version of the sampler for each seed but 0
 *   nf_sampler_draw           Writes `dims` numbers, 1..4, to u[dims]
 *   nf_sampler_table          The table that all draws look into, 65,536 numbers, for copies on other devices
 *   nf_sampler_fill_len       How many numbers nf_sampler_fill writes
 *   nf_sampler_fill           Draws for many pixels and samples at once, for renderers that work on whole images
 *   nf_tile_sampler_pixel     Sample `index` of pixel (x, y) in `frame`, any values of each
 *   nf_tile_sampler_domain    The child domain of a key, any value
 *   nf_tile_sampler_scramble  An independent version of the sampler for each seed but 0
 *   nf_tile_sampler_draw      Writes the first `dims` coordinates, 1..4, of the sampler's point to u[dims]
 *   nf_tile_sampler_fill_len  As nf_sampler_fill_len()
 *   nf_tile_sampler_fill      As nf_sampler_fill(), of tiles' samplers
 * ------------------------------------------------------------------------------------------------------------------ */

// nf_tile_builtin: 128 x 128 pixels, 1 sample, 2 dims.
#define NF_TILE_128_1SPP_2D 1
// nf_tile_builtin: 128 x 128 pixels, 4 samples, 2 dims.
#define NF_TILE_128_4SPP_2D 2
// nf_tile_builtin: 128 x 128 pixels, 16 samples, 2 dims.
#define NF_TILE_128_16SPP_2D 3
// nf_tile_builtin: 128 x 128 pixels, 16 samples, 2 dims; the first 1, 2, 4 and 8 samples are well distributed too.
#define NF_TILE_128_16SPP_2D_PROGRESSIVE 4
// nf_tile_builtin: 128 x 128 pixels, 1 sample, 4 dims.
#define NF_TILE_128_1SPP_4D 5
// nf_tile_builtin: 128 x 128 pixels, 4 samples, 4 dims.
#define NF_TILE_128_4SPP_4D 6
// nf_tile_builtin: 128 x 128 pixels, 1 sample, 2 dims, for images reconstructed with a Gaussian filter (figures 5.21,
// 5.22).
#define NF_TILE_128_1SPP_2D_GAUSSIAN 7
// nf_tile_builtin: 128 x 128 pixels, 4 samples, 2 dims, for images reconstructed with a Gaussian filter.
#define NF_TILE_128_4SPP_2D_GAUSSIAN 8
// nf_tile_builtin: 128 x 128 pixels, 1 sample, 2 dims, 16 frames.
#define NF_TILE_128_1SPP_2D_TEMPORAL 9
// nf_tile_builtin: 64 x 64 pixels, 1 sample, 2 dims.
#define NF_TILE_64_1SPP_2D 10
// nf_tile_builtin: 64 x 64 pixels, 4 samples, 2 dims.
#define NF_TILE_64_4SPP_2D 11
// nf_tile_builtin: 64 x 64 pixels, 4 samples, 2 dims, 16 frames.
#define NF_TILE_64_4SPP_2D_TEMPORAL 12

// A view of a tile: sample points for a square of pixels that repeats over the image (chapter 5; docs/tiles.md).
//
// A complete struct, to be copied freely; it owns nothing. `nf_tile_128_1spp_2d` and its like come with the library,
// and a program linked with `--gc-sections` carries those that it names; nf_tile_from_bytes makes others. The fields
// are to be read, never written; all zero is a valid tile, whose samples are all 0.
typedef struct nf_tile {
    // The stored values, in the memory that the tile was made from.
    const void *values;
    // How many bytes they are.
    size_t bytes;
    // Pixels on a side: a power of two, 1..1024.
    uint32_t size;
    // Samples of each pixel: a power of two, 1..256.
    uint32_t spp;
    // Dimensions of each sample that were optimised together: 1..8.
    uint32_t dims;
    // Frames that follow each other in time: 1..256.
    uint32_t frames;
    // Bits of each stored coordinate: 8 or 16.
    uint32_t bits;
    // 1 if the first 1, 2, 4, ... samples of a pixel are well distributed too, otherwise 0.
    uint32_t progressive;
} nf_tile;

// The tile NF_TILE_128_1SPP_2D.
extern const nf_tile nf_tile_128_1spp_2d;
// The tile NF_TILE_128_4SPP_2D.
extern const nf_tile nf_tile_128_4spp_2d;
// The tile NF_TILE_128_16SPP_2D.
extern const nf_tile nf_tile_128_16spp_2d;
// The tile NF_TILE_128_16SPP_2D_PROGRESSIVE.
extern const nf_tile nf_tile_128_16spp_2d_progressive;
// The tile NF_TILE_128_1SPP_4D.
extern const nf_tile nf_tile_128_1spp_4d;
// The tile NF_TILE_128_4SPP_4D.
extern const nf_tile nf_tile_128_4spp_4d;
// The tile NF_TILE_128_1SPP_2D_GAUSSIAN.
extern const nf_tile nf_tile_128_1spp_2d_gaussian;
// The tile NF_TILE_128_4SPP_2D_GAUSSIAN.
extern const nf_tile nf_tile_128_4spp_2d_gaussian;
// The tile NF_TILE_128_1SPP_2D_TEMPORAL.
extern const nf_tile nf_tile_128_1spp_2d_temporal;
// The tile NF_TILE_64_1SPP_2D.
extern const nf_tile nf_tile_64_1spp_2d;
// The tile NF_TILE_64_4SPP_2D.
extern const nf_tile nf_tile_64_4spp_2d;
// The tile NF_TILE_64_4SPP_2D_TEMPORAL.
extern const nf_tile nf_tile_64_4spp_2d_temporal;

// One of the tiles that come with the library, by number: id is NF_TILE_*. A program that calls it carries all of
// them.
//
// NF_ERR_NULL; NF_ERR_RANGE: id; NF_ERR_UNSUPPORTED: this library was built without that tile.
nf_status nf_tile_builtin(uint32_t id, nf_tile *out);

// The tile of an .nft file's bytes, all of them checked: about 3 ms for a megabyte. The bytes must outlive the tile,
// unchanged; any alignment will do.
//
// NF_ERR_NULL; NF_ERR_RANGE: len; NF_ERR_FOREIGN: the bytes are no tile; NF_ERR_VERSION: one of a newer format;
// NF_ERR_LENGTH: truncated, or followed by other bytes; NF_ERR_CORRUPT: damaged.
nf_status nf_tile_from_bytes(const void *bytes, size_t len, nf_tile *out);

// One sample of one pixel, of the default sampler: a small struct, passed and copied by value. Drawing does not change
// it, and there is nothing to set up.
//
// A sampler stands for a point of a cube with as many dimensions as are asked for. There are no dimension counters:
// each decision of a path (lens, light, bounce, ...) has a domain, a child of the sampler by a key of its own. A
// domain's numbers depend on nothing but pixel, frame, index and the keys that led to it, so that any sample can be
// drawn in any order, on any thread, and at any time. Made by nf_sampler_pixel; the fields are not to be written.
typedef struct nf_sampler {
    // The domain: 0 is the root.
    uint32_t domain;
    // The sample of the pixel.
    uint32_t index;
    // The pixel's column, its last 16 bits.
    uint16_t x;
    // The pixel's row, likewise.
    uint16_t y;
    // Whether it is scrambled, or white.
    uint32_t flags;
} nf_sampler;

// Sample `index` of pixel (x, y) in `frame`, any values of each.
//
// The samples of a pixel are one sequence, best at powers of two: take any number, and stop where you like. Each frame
// is unrelated to the others. Where frames are averaged, by a viewer or by TAA, leave the frame 0 and let the index
// count on.
nf_sampler nf_sampler_pixel(uint32_t x, uint32_t y, uint32_t frame, uint32_t index);

// As nf_sampler_pixel(), but neighbours know nothing of each other: the error is that of each pixel, white over the
// image. For denoisers that were made for white noise.
nf_sampler nf_sampler_white(uint32_t x, uint32_t y, uint32_t frame, uint32_t index);

// The child domain of a key, any value. Children of different keys are unrelated to each other and to their parent.
// Keys mean something only among the children of one parent: a bounce's light may have the same key as the next
// bounce's.
nf_sampler nf_sampler_domain(nf_sampler sampler, uint32_t key);

// An independent version of the sampler for each seed but 0; seed 0 changes nothing.
//
// All values of a dimension are shifted, modulo 1, by a hash of seed and domain. Over random seeds every value is
// uniform, so that estimates are unbiased, as far as a hash of 32 bits is random. The shift costs quality: where good
// images are wanted, and not exact unbiasedness, take another frame instead. Children of a scrambled sampler are
// scrambled.
nf_sampler nf_sampler_scramble(nf_sampler sampler, uint32_t seed);

// Writes `dims` numbers, 1..4, to u[dims]: each in [0, 1), a multiple of 2^-24.
//
// The first two are optimised together, across pixels too; all four are stratified together. Fewer are the first of
// those. More come from a domain of their own. Writes nothing if dims is out of range or u is NULL.
void nf_sampler_draw(nf_sampler sampler, uint32_t dims, float *u);

// The table that all draws look into, 65,536 numbers, for copies on other devices: see noisefloor_sampler.h.
const uint32_t *nf_sampler_table(void);

// How many numbers nf_sampler_fill writes: width * height * samples * (the sum of dims). 0 if one of dims is outside
// 1..4, or memory has not that many.
size_t nf_sampler_fill_len(const uint32_t *dims, size_t domains, uint32_t width, uint32_t height, uint32_t samples);

// Draws for many pixels and samples at once, for renderers that work on whole images. The same bits as single draws.
//
// samplers[domains]: one for each domain, all at the first pixel and the first sample. dims[domains]: how many numbers
// to draw from each, 1..4. width, height: how many pixels, to the right and down. samples: how many samples of each,
// by ascending index. u[height][width][samples][sum of dims]: what the samplers draw there, one after the other; len
// numbers are there, at least nf_sampler_fill_len.
//
// NF_ERR_NULL; NF_ERR_ALIGNMENT; NF_ERR_RANGE: dims, or sizes that memory cannot have; NF_ERR_MEMORY: len.
nf_status nf_sampler_fill(const nf_sampler *samplers,
                          const uint32_t *dims,
                          size_t domains,
                          uint32_t width,
                          uint32_t height,
                          uint32_t samples,
                          float *u,
                          size_t len);

// One sample of one pixel: a small struct, passed and copied by value. Drawing does not change it.
//
// A sampler stands for a point of a cube with as many dimensions as are asked for. There are no dimension counters:
// each decision of a path (lens, light, bounce, ...) has a domain, a child of the sampler by a key of its own. A
// domain's numbers depend on nothing but tile, pixel, frame, index and the keys that led to it, so that any sample can
// be drawn in any order, on any thread, and at any time. Made by nf_tile_sampler_pixel; the fields are not to be
// written.
typedef struct nf_tile_sampler {
    // The tile; it must outlive the sampler and stay where it is.
    const nf_tile *tile;
    // The domain: 0 is the root.
    uint32_t domain;
    // The sample of the pixel.
    uint32_t index;
    // The pixel's column, modulo the tile's size.
    uint16_t x;
    // The pixel's row, modulo the tile's size.
    uint16_t y;
    // The frame, modulo the tile's frames.
    uint16_t frame;
    // 1 after nf_tile_sampler_scramble, otherwise 0.
    uint16_t scrambled;
} nf_tile_sampler;

// Sample `index` of pixel (x, y) in `frame`, any values of each: pixels repeat with the tile's size.
//
// The first tile->spp samples are the tile's. Those that follow continue with a scrambled Sobol sequence in their
// place; none is repeated. Frames 0 to tile->frames - 1 are the tile's; each later run of them is the tile at another
// place, unrelated to it. For an image that is refined over time leave the frame and count the index.
//
// tile: it must outlive the sampler and stay where it is. All draws of a sampler without a tile, NULL, are 0.
nf_tile_sampler nf_tile_sampler_pixel(const nf_tile *tile,
                                      uint32_t x,
                                      uint32_t y,
                                      uint32_t frame,
                                      uint32_t index);

// The child domain of a key, any value. Children of different keys are unrelated to each other and to their parent.
// Keys mean something only among the children of one parent: a bounce's light may have the same key as the next
// bounce's.
nf_tile_sampler nf_tile_sampler_domain(nf_tile_sampler sampler, uint32_t key);

// An independent version of the sampler for each seed but 0; seed 0 changes nothing.
//
// It is the tile at another place, with all values of a dimension shifted, modulo 1, by a hash of seed and domain.
// Over random seeds every value is uniform, so an estimate is unbiased, as far as a hash of 32 bits is random (the
// tile's own values are fixed, and an estimate from them is what it is). The shift costs quality: where good images
// are wanted, and not exact unbiasedness, take another frame instead. Children of a scrambled sampler are scrambled.
nf_tile_sampler nf_tile_sampler_scramble(nf_tile_sampler sampler, uint32_t seed);

// Writes the first `dims` coordinates, 1..4, of the sampler's point to u[dims]: each in [0, 1), a multiple of 2^-24.
//
// Up to tile->dims they are optimised together, and more come from other places of the tile; fewer are the first of
// those. If the tile has at least two dims and spp, and is not progressive, each further number of its samples is
// stratified, and the third of a tile of two dims with those two: draw a choice, or a time, after the two numbers that
// it goes with. Two further numbers that belong together are better drawn from a domain of their own. Writes nothing
// if dims is out of range or u is NULL.
void nf_tile_sampler_draw(nf_tile_sampler sampler, uint32_t dims, float *u);

// As nf_sampler_fill_len().
size_t nf_tile_sampler_fill_len(const uint32_t *dims,
                                size_t domains,
                                uint32_t width,
                                uint32_t height,
                                uint32_t samples);

// As nf_sampler_fill(), of tiles' samplers. Those without a tile draw zeros.
nf_status nf_tile_sampler_fill(const nf_tile_sampler *samplers,
                               const uint32_t *dims,
                               size_t domains,
                               uint32_t width,
                               uint32_t height,
                               uint32_t samples,
                               float *u,
                               size_t len);

/* ------------------------------------------------------------------------------------------------------------------
 * Random numbers
 *
 *   nf_rng_seed     Starts a generator
 *   nf_rng_next     The next 32 random bits
 *   nf_rng_uniform  The next number uniform in [0, 1), a multiple of 2^-24
 * ------------------------------------------------------------------------------------------------------------------ */

// A PCG32 random number generator (O'Neill 2014), for minibatches, examples and tests: the same numbers on every
// target.
//
// A complete struct, kept by value. A copy repeats the numbers its original has yet to give. Give each thread its own,
// with its own seed. Any value of the fields is valid; nf_rng_seed sets them well. Not for cryptography.
typedef struct nf_rng {
    // Where the generator is.
    uint64_t state;
    // Which of 2^63 streams it is on; the lowest bit counts as set.
    uint64_t increment;
} nf_rng;

// Starts a generator. Any seed is good, and neighbouring seeds (pixel numbers, say) give unrelated numbers. Does
// nothing if `rng` is NULL.
void nf_rng_seed(nf_rng *rng, uint64_t seed);

// The next 32 random bits; 0 if `rng` is NULL.
uint32_t nf_rng_next(nf_rng *rng);

// The next number uniform in [0, 1), a multiple of 2^-24; 0 if `rng` is NULL.
float nf_rng_uniform(nf_rng *rng);

/* ------------------------------------------------------------------------------------------------------------------
 * Minibatches: items drawn in proportion to their importance, and gradients of the mean loss from them
 * Guides, in docs/: minibatch.md, minibatch_gradients.md
 *
 *   nf_table_size                     The bytes of memory a table of so many items needs
 *   nf_table_init                     Makes a table of `items` items in `memory`
 *   nf_table_draw                     Draws `batch` items with replacement, independently
 *   nf_table_draw_stratified          As nf_table_draw, from `batch` equal parts of the line of probabilities
 *   nf_table_draw_distinct            Draws `batch` different items, without replacement
 *   nf_table_update                   Sets the importance of visited items, one after the other
 *   nf_table_set_uniform_fraction     Sets the uniform fraction d, 0..1
 *   nf_table_add_epsilon              Adds epsilon, at least 0, to every importance
 *   nf_table_append                   Adds `count` items behind the last
 *   nf_table_probability              The probability p_i of drawing an item
 *   nf_table_probabilities            The probabilities of count items
 *   nf_table_importance               The importance q_i of an item
 *   nf_table_total                    The sum of all importances
 *   nf_table_saved_size               The bytes that nf_table_save writes
 *   nf_table_save                     Writes the table, the same bytes on every target
 *   nf_table_saved_items              The number of items in what nf_table_save wrote
 *   nf_table_load                     A table as it was when nf_table_save wrote it, in memory as for nf_table_init
 *   nf_table_shard                    What the other processes must know of this table
 *   nf_shards_allocate                How many of a batch's items each process draws
 *   nf_table_draw_shard               As nf_table_draw, for this process's part of a batch over all shards
 *   nf_shuffle                        The element at `position` of a random permutation of 0..items-1
 *   nf_importance_cross_entropy       || softmax(logits) - onehot(label) ||, the norm of the cross-entropy loss's
 *                                     derivative by the logits (6.10)
 *   nf_importance_cross_entropy_loss  The cross-entropy loss -ln softmax(logits)[label] itself, at least 0
 *   nf_importance_squared_error       || 2 (output - target) ||, the norm of the derivative of the loss sum (output -
 *                                     target)^2 by the outputs
 *   nf_importance_gradient            The L2 norm of any derivative of the loss by the outputs
 *   nf_cross_entropy_gradient         The derivative of the cross-entropy loss by the logits
 *   nf_importance_nodes               Importances of one item for several tables
 *   nf_omis_weights                   The optimal MIS gradient of a minibatch as one weight per drawn item (6.2)
 *   nf_gradient_size                  The bytes of memory an nf_gradient needs
 *   nf_gradient_init                  Makes an nf_gradient that has seen no batch in `memory`
 *   nf_gradient_estimate              Adds a batch of drawn items, and estimates the gradient of the mean loss from
 *                                     it and, with momentum, those before
 *   nf_gradient_reset                 Forgets every batch
 * ------------------------------------------------------------------------------------------------------------------ */

// The importances of the items of a data set, from which minibatches are drawn (Algorithm 3).
//
// Item i is drawn with probability p_i = (1 - d) q_i / sum q + d / N: q_i is its importance, d the uniform fraction,
// .2 unless set. No weight 1 / (N p_i) is then above 1 / d. Where all importances are 0 draws are uniform, or
// NF_ERR_NO_SAMPLES if d is 0.
//
// A complete struct that refers to the memory its items live in; the fields are to be read, never written. A copy
// refers to the same memory: keep one. Nothing to destroy. Should that memory change on its own, what is drawn are
// still items that exist, if not as often as they should be.
typedef struct nf_table {
    // The importance of each item, in the memory given to nf_table_init.
    float *importance;
    // The sums over them, behind.
    int64_t *sums;
    // A power of two: importances times this are what is summed.
    double scale;
    // How many items there are: N.
    uint32_t items;
    // How many blocks of 16 items there is room for.
    uint32_t blocks;
    // The part of draws that are uniform.
    float uniform_fraction;
    // Says that this is a table.
    uint32_t magic;
} nf_table;

// The bytes of memory a table of so many items needs, at most 4.6 for each and a few hundred; 0 for 0 items or a size
// that no memory has.
size_t nf_table_size(uint32_t items);

// Makes a table of `items` items in `memory`.
//
// memory: at least nf_table_size(items) bytes, 8-byte aligned; what it holds is lost. More is room for
// nf_table_append. importance[items]: at least 0, finite, not all 0; or NULL, which makes all 1, for an initial epoch
// that visits every item (Algorithm 4).
//
// NF_ERR_NULL; NF_ERR_RANGE: no items, or a negative importance; NF_ERR_NOT_FINITE; NF_ERR_NO_SAMPLES: all are 0;
// NF_ERR_MEMORY; NF_ERR_ALIGNMENT.
nf_status nf_table_init(nf_table *table, void *memory, size_t bytes, uint32_t items, const float *importance);

// Draws `batch` items with replacement, independently, in proportion to importance.
//
// index[batch]: the items. weight[batch]: 1 / (N p) of each, for importance sampling: gradients times weights,
// averaged over the batch, estimate the gradient of the mean loss without bias (6.3). NULL where they are not wanted:
// without weights it is adaptive sampling (w = p in Algorithm 3), which favours important items, a bias by design.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_NO_SAMPLES: nothing can be drawn. A batch of 0 is no error.
nf_status nf_table_draw(const nf_table *table,
                        nf_rng *rng,
                        uint32_t batch,
                        uint32_t *index,
                        float *weight);

// As nf_table_draw, from `batch` equal parts of the line of probabilities: item i comes about `batch` p_i times, so
// that the estimate varies less where neighbouring items are alike. Items drawn uniformly come first, and all in the
// order of the data set: use the batch as a whole.
nf_status nf_table_draw_stratified(const nf_table *table,
                                   nf_rng *rng,
                                   uint32_t batch,
                                   uint32_t *index,
                                   float *weight);

// Draws `batch` different items, without replacement, the k-th being item i with probability
//     c_i = ((1 - d) q_i / sum q + d / N) / (1 - d (k - 1) / N),
// the sum being that of the items not yet drawn, and d the uniform fraction (1 where that sum is 0). Weights make the
// same estimate as nf_table_draw's, without bias (Raj 1956): (1 / c_k + batch - k) / N for the k-th item.
//
// The table is the same afterwards, but is written meanwhile. A draw takes the time of some ten updates; where a few
// items have nearly all of the sum the table is built again without them, which takes time for every item.
//
// Other arguments and errors as for nf_table_draw; NF_ERR_RANGE: more than there are items; NF_ERR_NO_SAMPLES also
// where the uniform fraction is 0 and fewer items have an importance above 0.
nf_status nf_table_draw_distinct(nf_table *table,
                                 nf_rng *rng,
                                 uint32_t batch,
                                 uint32_t *index,
                                 float *weight);

// Sets the importance of visited items, one after the other: q = momentum q + (1 - momentum) importance (line 13 of
// Algorithm 3, (6.11)). An item that comes twice is changed twice.
//
// index[batch]; importance[batch]: at least 0, finite. momentum: 0..1; 0 forgets the old value, .3 is a good choice.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_RANGE: an item that does not exist, a negative importance, momentum;
// NF_ERR_NOT_FINITE.
nf_status nf_table_update(nf_table *table,
                          const uint32_t *index,
                          const float *importance,
                          uint32_t batch,
                          float momentum);

// Sets the uniform fraction d, 0..1. 0 draws by importance alone: an item of importance 0 is never drawn, and one
// whose importance is out of date can get a weight of thousands. 1 draws uniformly.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_RANGE; NF_ERR_NOT_FINITE.
nf_status nf_table_set_uniform_fraction(nf_table *table, float fraction);

// Adds epsilon, at least 0, to every importance: line 15 of Algorithm 3, after an epoch. The uniform fraction does as
// much and costs nothing.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_RANGE; NF_ERR_NOT_FINITE.
nf_status nf_table_add_epsilon(nf_table *table, float epsilon);

// Adds `count` items behind the last.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_MEMORY: the memory given to nf_table_init has no room; NF_ERR_RANGE: a negative
// importance; NF_ERR_NOT_FINITE.
nf_status nf_table_append(nf_table *table, const float *importance, uint32_t count);

// The probability p_i of drawing an item; 0 if there is no such item or no table. It comes with the item in
// nf_table_draw's weight; this is for items that another table drew.
float nf_table_probability(const nf_table *table, uint32_t item);

// The probabilities of count items: p[k * stride] of index[k]. With J tables, stride J and p + j for the j-th table
// make the rows of densities that nf_omis_weights takes.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_RANGE: an item that does not exist, or stride 0; NF_ERR_NO_SAMPLES as for
// nf_table_draw.
nf_status nf_table_probabilities(const nf_table *table,
                                 const uint32_t *index,
                                 uint32_t count,
                                 uint32_t stride,
                                 float *p);

// The importance q_i of an item; 0 if there is no such item or no table.
float nf_table_importance(const nf_table *table, uint32_t item);

// The sum of all importances; 0 if there is no table.
double nf_table_total(const nf_table *table);

// The bytes that nf_table_save writes; 0 if there is no table.
size_t nf_table_saved_size(const nf_table *table);

// Writes the table, the same bytes on every target, to exactly nf_table_saved_size bytes, of any alignment.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_LENGTH.
nf_status nf_table_save(const nf_table *table, void *saved, size_t len);

// The number of items in what nf_table_save wrote, to make memory for it with nf_table_size; 0 if it is no saved
// table. Only the first bytes are looked at.
uint32_t nf_table_saved_items(const void *saved, size_t len);

// A table as it was when nf_table_save wrote it, in memory as for nf_table_init. It draws the same items from the same
// generator.
//
// NF_ERR_NULL; NF_ERR_FOREIGN, NF_ERR_VERSION, NF_ERR_LENGTH, NF_ERR_CORRUPT: what is wrong with the bytes;
// NF_ERR_MEMORY; NF_ERR_ALIGNMENT.
nf_status nf_table_load(nf_table *table, void *memory, size_t bytes, const void *saved, size_t len);

// What the processes of a data-parallel trainer must know of each other's tables. Each owns the table of its part of
// the data; before a draw all gather these 16 bytes from each (MPI_Allgather, for example).
typedef struct nf_shard {
    // The sum of the importances.
    double importance;
    // The number of items.
    uint64_t items;
} nf_shard;

// What the other processes must know of this table.
//
// NF_ERR_NULL; NF_ERR_STATE.
nf_status nf_table_shard(const nf_table *table, nf_shard *out);

// How many of a batch's items each process draws: counts[shards], in proportion to the shards' probabilities, rounded
// up or down at random so that each is right on average. They sum to batch.
//
// Every process calls it with the same shards and a generator of the same seed, and finds its own count among the
// results. uniform_fraction: 0..1, that of all tables.
//
// NF_ERR_NULL; NF_ERR_RANGE: a negative sum, 2^53 items or more, uniform_fraction; NF_ERR_NOT_FINITE;
// NF_ERR_NO_SAMPLES: no shards, no items, or nothing that can be drawn.
nf_status nf_shards_allocate(const nf_shard *shard,
                             uint32_t shards,
                             float uniform_fraction,
                             nf_rng *rng,
                             uint32_t batch,
                             uint32_t *counts);

// As nf_table_draw, for this process's part of a batch over all shards, of which this table is one: weights are those
// of the whole. Gradients times weights, summed over all processes and divided by the whole batch's size, estimate the
// gradient of the mean loss over all items.
//
// All tables must have the same uniform fraction; batch is what nf_shards_allocate gave to this process.
//
// Other arguments and errors as for nf_table_draw and nf_shards_allocate; NF_ERR_RANGE: the shards together have less
// than this table. A table must not have changed since its nf_shard was made. Where the others dwarf it a weight may
// be infinite.
nf_status nf_table_draw_shard(const nf_table *table,
                              const nf_shard *shard,
                              uint32_t shards,
                              nf_rng *rng,
                              uint32_t batch,
                              uint32_t *index,
                              float *weight);

// The element at `position` of a random permutation of 0..items-1, which seed chooses: the order of an initial epoch
// (Algorithm 4), or of minibatches drawn uniformly without replacement, with no array of indices. 0 if there are no
// items; positions beyond the last start again.
uint32_t nf_shuffle(uint64_t seed, uint32_t items, uint32_t position);

// nf_importance_nodes split: one importance per group of nodes, the norm over it.
#define NF_NODES_NORM 0
// nf_importance_nodes split: two per group, the norm of the positive parts and that of the negative parts. Importances
// of one sign can combine linearly to the derivative itself, which norms cannot: the choice for optimal MIS.
#define NF_NODES_SIGN 1

// || softmax(logits) - onehot(label) ||, the norm of the cross-entropy loss's derivative by the logits (6.10):
// 0..1.4143.
//
// logits[classes]: finite, of any size. label: below classes. No backward pass is needed; a norm near 0 keeps its
// relative accuracy.
//
// NaN, which nf_table_update refuses, for NULL, misaligned, a label out of range, or a logit that is NaN or infinite.
float nf_importance_cross_entropy(const float *logits, uint32_t classes, uint32_t label);

// The cross-entropy loss -ln softmax(logits)[label] itself, at least 0; one beyond the range of float becomes the
// largest finite float.
//
// Arguments, and NaN, as for nf_importance_cross_entropy.
float nf_importance_cross_entropy_loss(const float *logits, uint32_t classes, uint32_t label);

// || 2 (output - target) ||, the norm of the derivative of the loss sum (output - target)^2 by the outputs.
//
// output[outputs], target[outputs]: finite. One beyond the range of float becomes the largest finite float.
//
// NaN for NULL, misaligned, no outputs, or a value that is NaN or infinite.
float nf_importance_squared_error(const float *output, const float *target, uint32_t outputs);

// The L2 norm of any derivative of the loss by the outputs: || dL/dm || of (6.1.4).
//
// gradient[outputs]: finite. A norm beyond the range of float becomes the largest finite float.
//
// NaN for NULL, misaligned, no outputs, or a value that is NaN or infinite.
float nf_importance_gradient(const float *gradient, uint32_t outputs);

// The derivative of the cross-entropy loss by the logits, softmax(logits) - onehot(label) (6.10), where
// backpropagation starts.
//
// logits[classes]: finite, of any size. label: below classes. gradient[classes]: the output.
//
// NF_ERR_NULL; NF_ERR_RANGE: label; NF_ERR_NOT_FINITE: a logit.
nf_status nf_cross_entropy_gradient(const float *logits, uint32_t classes, uint32_t label, float *gradient);

// Importances of one item for several tables, from the derivative of the loss by each output node (6.2.3).
//
// gradient[outputs]: dL/dm, finite; at least one node per group. Node k belongs to group k % groups, so that every
// node has its table: a subset of the nodes, as section 6.2.3 proposes, leaves the gradients of the others uncovered.
// split: NF_NODES_NORM: groups = techniques, importance[g] = the norm over group g. NF_NODES_SIGN: techniques is even,
// groups = techniques / 2, importance[2 g] = the norm of max(gradient, 0) over group g, importance[2 g + 1] that of
// max(-gradient, 0).
// techniques: 1..NF_MIS_MAX_TECHNIQUES. importance[techniques]: the output, at least 0. An importance may be 0: the
// tables' uniform fraction is what still draws the item.
//
// NF_ERR_NULL; NF_ERR_RANGE: split, techniques, or fewer outputs than groups; NF_ERR_NOT_FINITE: a gradient.
nf_status nf_importance_nodes(const float *gradient,
                              uint32_t outputs,
                              uint32_t split,
                              uint32_t techniques,
                              float *importance);

// The optimal MIS gradient of a minibatch as one weight per drawn item (6.2): the gradient of the mean loss is
// (1 / batch) sum_s weight[s] * gradient_s for every parameter at once, so that one backward pass over weighted losses
// computes it. The same convention as the weights of nf_table_draw.
//
// solver: NF_OMIS_RIDGE, the default: shrinks to the balance heuristic where the batch says little. NF_OMIS_PLAIN:
// exact where a gradient is a linear combination of the probabilities; heavy-tailed with similar techniques or small
// batches. Both are consistent, not unbiased, and their weights may be negative. NF_OMIS_BALANCE: unbiased, positive.
// ridge: for NF_OMIS_RIDGE, as for nf_omis_solve: 1e-8..1e8, or 0 for the default 2; otherwise ignored. techniques: J
// in 1..NF_MIS_MAX_TECHNIQUES. items: N, the size of the data set, at least 1. pdf[batch * techniques]: at s *
// techniques + j the probability with which technique j draws the item of sample s; each technique's sum to 1 over the
// items. Finite, at least 0 and at most 1, positive for the technique that drew it. Those of before the batch was
// drawn: tables may be updated meanwhile. technique[batch]: which technique drew sample s. Their numbers n_j are
// counted from it; a technique that drew nothing has no part in the weights. batch: the number of samples, at least 1.
// weight[batch]: the output. One beyond the range of float becomes the largest finite float.
//
// With S_s = sum_k n_k p_k, q = sum_s p_s / S_s and A = sum_s p_s p_s' / S_s^2,
// weight_s = (1 / S_s - (q - 1)' (A + ridge)^-1 p_s / S_s^2) batch / items.
//
// NF_ERR_NULL; NF_ERR_RANGE: solver, ridge, techniques, items, a technique or a probability; NF_ERR_NOT_FINITE: ridge
// or a probability; NF_ERR_NO_SAMPLES: an empty batch; NF_ERR_UNSUPPORTED: NF_OMIS_PROGRESSIVE.
nf_status nf_omis_weights(uint32_t solver,
                          float ridge,
                          uint32_t techniques,
                          uint32_t items,
                          const float *pdf,
                          const uint32_t *technique,
                          uint32_t batch,
                          float *weight);

// Optimal MIS gradients from explicit per-item gradients, with momentum over steps (6.2.3): averages over the batches
// so far of the linear system that all parameters share, and J + 1 floats per parameter.
//
// Without momentum nf_omis_weights gives the same estimate, at the cost of one weighted backward pass.
//
// Lives in caller memory of nf_gradient_size bytes, 8-byte aligned; nothing to destroy. May be moved and copied as
// bytes between calls, in one process or among those that run the same library file; no file format, and for no one
// else to change, as for nf_cv_accumulator.
typedef struct nf_gradient nf_gradient;

// The bytes of memory an nf_gradient needs: 4 (techniques + 1) per parameter and about 1.4 kB. 0 unless techniques is
// in 1..NF_MIS_MAX_TECHNIQUES, parameters at least 1, and the size one that memory can have.
size_t nf_gradient_size(uint32_t techniques, uint32_t parameters);

// Makes an nf_gradient that has seen no batch in `memory`, `*out` being its handle (the same address).
//
// memory: at least nf_gradient_size(techniques, parameters) bytes, 8-byte aligned; what it holds is lost.
// techniques: J in 1..NF_MIS_MAX_TECHNIQUES. parameters: at least 1.
//
// NF_ERR_NULL; NF_ERR_RANGE: techniques or parameters; NF_ERR_MEMORY; NF_ERR_ALIGNMENT.
nf_status nf_gradient_init(void *memory,
                           size_t bytes,
                           uint32_t techniques,
                           uint32_t parameters,
                           nf_gradient **out);

// Adds a batch of drawn items, and estimates the gradient of the mean loss from it and, with momentum, those before.
//
// solver: NF_OMIS_RIDGE, NF_OMIS_PLAIN or NF_OMIS_BALANCE, and ridge, as for nf_omis_weights, where it is said which
// is unbiased. They may change from call to call. beta: 0..1, the momentum. A batch that is t steps old counts beta^t,
// divided by the sum of those weights: the estimate has its right size from the first step on. 0 forgets the earlier
// batches, and the estimate is that of nf_omis_weights but for rounding, which NF_OMIS_PLAIN magnifies where
// techniques are nearly alike; 1 averages all. Older gradients lag: under an optimiser with momentum of its own, such
// as Adam, use 0. items, pdf[batch * techniques], technique[batch]: as for nf_omis_weights, with the techniques of
// nf_gradient_init. gradient[batch * parameters]: that of sample s by parameter p at s * parameters + p, finite,
// unweighted. It is read twice: once to see that all of it is finite. batch: the number of samples.
// estimate[parameters]: the output. One beyond the range of float becomes the largest finite float.
//
// Sums are in float, in an order that does not depend on the processor.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_RANGE: solver, ridge, beta, items, a technique or probability, or gradients over
// probabilities beyond the range of float; NF_ERR_NOT_FINITE: ridge, beta, a probability or gradient;
// NF_ERR_NO_SAMPLES: an empty batch; NF_ERR_UNSUPPORTED: NF_OMIS_PROGRESSIVE.
nf_status nf_gradient_estimate(nf_gradient *state,
                               uint32_t solver,
                               float ridge,
                               float beta,
                               uint32_t items,
                               const float *pdf,
                               const uint32_t *technique,
                               const float *gradient,
                               uint32_t batch,
                               float *estimate);

// Forgets every batch; techniques and parameters stay.
//
// NF_ERR_NULL; NF_ERR_STATE.
nf_status nf_gradient_reset(nf_gradient *state);

/* Layouts: what the library was compiled with. C99 has no alignment operator. */
#if defined(__cplusplus) && __cplusplus >= 201103L
#define NF_ASSERT_LAYOUT(condition) static_assert(condition, "noisefloor: unexpected struct layout")
#define NF_ASSERT_ALIGNED_AS(a, b) NF_ASSERT_LAYOUT(alignof(a) == alignof(b))
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define NF_ASSERT_LAYOUT(condition) _Static_assert(condition, "noisefloor: unexpected struct layout")
#define NF_ASSERT_ALIGNED_AS(a, b) NF_ASSERT_LAYOUT(_Alignof(a) == _Alignof(b))
#else
#define NF_ASSERT_LAYOUT(condition) extern char nf_assert_layout[(condition) ? 1 : -1]
#define NF_ASSERT_ALIGNED_AS(a, b) NF_ASSERT_LAYOUT(sizeof(a) % sizeof(b) == 0)
#endif
NF_ASSERT_LAYOUT(sizeof(nf_status) == 4);
NF_ASSERT_LAYOUT(sizeof(nf_cv_config) == 76 && offsetof(nf_cv_config, ridge) == 64);
NF_ASSERT_ALIGNED_AS(nf_cv_config, uint32_t);
NF_ASSERT_LAYOUT(sizeof(nf_estimate) == 40 && offsetof(nf_estimate, samples) == 32);
NF_ASSERT_ALIGNED_AS(nf_estimate, float);
NF_ASSERT_LAYOUT(sizeof(nf_cv_image) == 24 + 4 * sizeof(void *) + 32 && offsetof(nf_cv_image, surfaces) == 24);
NF_ASSERT_LAYOUT(sizeof(nf_cv_rectangle) == 16 && offsetof(nf_cv_rectangle, width) == 8);
NF_ASSERT_ALIGNED_AS(nf_cv_rectangle, uint32_t);
NF_ASSERT_LAYOUT(sizeof(nf_recommendation) == 108 && offsetof(nf_recommendation, config) == 32);
NF_ASSERT_ALIGNED_AS(nf_recommendation, uint32_t);
NF_ASSERT_LAYOUT(sizeof(nf_tile) == 2 * sizeof(void *) + 24 && offsetof(nf_tile, size) == 2 * sizeof(void *));
NF_ASSERT_ALIGNED_AS(nf_tile, void *);
NF_ASSERT_LAYOUT(sizeof(nf_tile_sampler) == sizeof(void *) + 16 && offsetof(nf_tile_sampler, domain) == sizeof(void *));
NF_ASSERT_ALIGNED_AS(nf_tile_sampler, void *);
NF_ASSERT_LAYOUT(sizeof(nf_sampler) == 16 && offsetof(nf_sampler, x) == 8);
NF_ASSERT_ALIGNED_AS(nf_sampler, uint32_t);
NF_ASSERT_LAYOUT(sizeof(nf_rng) == 16 && offsetof(nf_rng, increment) == 8);
NF_ASSERT_ALIGNED_AS(nf_rng, uint64_t);
NF_ASSERT_LAYOUT(sizeof(nf_table) == 2 * sizeof(void *) + 24 && offsetof(nf_table, items) == 2 * sizeof(void *) + 8);
NF_ASSERT_ALIGNED_AS(nf_table, double);
NF_ASSERT_LAYOUT(sizeof(nf_shard) == 16 && offsetof(nf_shard, items) == 8);
NF_ASSERT_ALIGNED_AS(nf_shard, uint64_t);
#undef NF_ASSERT_LAYOUT
#undef NF_ASSERT_ALIGNED_AS

#ifdef __cplusplus
}
#endif

#endif /* NOISEFLOOR_H */
