/* Generated from capi/ by `cargo xtask header`; do not edit. Conventions: noisefloor.h. */

#ifndef NOISEFLOOR_CV_H
#define NOISEFLOOR_CV_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Control variates: samples of one integral, or of a pixel, made into an estimate of lower error.
 * Guides, in docs/: control_variates.md. */

// Estimator: a soft mixture of the plain mean and ridge fits, by their errors on samples they have not seen. The
// default; slightly biased at few samples, and never noticeably worse than the mean.
#define NF_CV_ROBUST 0
// Estimator: least squares on its own samples (Alg. 1). Cheapest; bias O(1/n); wants several samples per term.
#define NF_CV_LEAST_SQUARES 1
// Estimator: each sample corrected by a ridge fit to all others. Exactly unbiased, nearly with `controls`; no streams.
#define NF_CV_LEAVE_ONE_OUT 2
#define NF_CV_K_FOLD 3 // Estimator: each fold corrected by a robust fit to others (section 4.2.6). Exactly unbiased.
// Estimator: gradient descent on its own samples (Alg. 2). Biased; see nf_cv_gradient_descent().
#define NF_CV_GRADIENT_DESCENT 4
// Estimator: each sample corrected by a fit to those before it (4.30). Exactly unbiased after every sample.
#define NF_CV_INCREMENTAL 5

#define NF_BASIS_LEGENDRE 0 // Basis: products of orthonormal shifted Legendre polynomials. The default.
#define NF_BASIS_STEP 1 // Basis: products of Walsh functions, constant on the cells of a grid of eighths.
#define NF_BASIS_SINE 2 // Basis: products of half-waves sin(pi d x + pi/2), which are cos(pi d x).
#define NF_BASIS_GAUSSIAN 3 // Basis: isotropic Gaussians, as many as Legendre has terms.

#define NF_SOLVER_AUTO 0 // Solver: dual for n below the terms and no `controls`, else normal equations. The default.
#define NF_SOLVER_NORMAL_EQUATIONS 1 // Solver: normal equations (4.27) and LDL'.
#define NF_SOLVER_SQUARE_ROOT 2 // Solver: Givens rotations, for badly placed samples. Only with NF_CV_LEAST_SQUARES.
#define NF_SOLVER_DUAL 3 // Solver: the n x n system of at most 4096 samples. Not for streaming, nor with `controls`.

#define NF_RIDGE_AUTO (-1.0f) // For `ridge`: the best of a few by leave-one-out errors; biases NF_CV_LEAVE_ONE_OUT.

#define NF_COLOR_PER_CHANNEL 0 // Each channel is regressed on its own, with one factorisation. The default.
// Rec. 709 luminance is regressed and scales the plain mean of the channels, which must be 3 (section 4.3). Standard
// errors are the luminance's, scaled alike: they leave out what the colour is uncertain by.
#define NF_COLOR_LUMINANCE_RATIO 1

#define NF_NONFINITE_ERROR 0 // A NaN or infinite sample is NF_ERR_NOT_FINITE. The default.
// A NaN or infinite sample is left out and not counted; biased unless such samples would have been average ones.
#define NF_NONFINITE_SKIP 1

// Precision: double. The default; NF_ERR_UNSUPPORTED, of arrays and images too, in a library for float alone.
#define NF_PRECISION_F64 0
#define NF_PRECISION_F32 1 // Precision: float, for targets without double hardware.

// How to estimate. Zero in any field but dims, order and channels is its default, so that
// `nf_cv_config config = {.dims = 2, .order = 2, .channels = 1};` is the robust estimator over 2 coordinates.
typedef struct nf_cv_config {
    uint32_t dims; // Coordinates of a sample that are regressed, 1 to 16.
    uint32_t order; // Largest total degree, 0 to 7; at 0 `controls` alone correct. nf_cv_terms() may not exceed 136.
    uint32_t channels; // Values of a sample, 1 to 4.
    uint32_t estimator; // NF_CV_*
    uint32_t basis; // NF_BASIS_*
    // 1 if a pixel's samples are stratified (nf_sampler, a tile, Sobol points). One pixel's estimate is then the plain
    // mean, but for NF_CV_LEAST_SQUARES and NF_CV_GRADIENT_DESCENT: fits to some of the samples undo what is even
    // about all. Fits shared by pixels correct all the same.
    uint32_t stratified;
    // If above 1, the last coordinate picks one of this many equally likely alternatives, lights say (figure 4.15): at
    // most 136 - binomial(dims - 1 + order, order) - `controls`. Of more let each slice stand for several.
    uint32_t slices;
    // Of two coordinates that pick a point of a light the first, counted from 1, below dims, with `slices` below
    // dims - 1; 0: none. From 4 samples on image fits by NF_CV_ROBUST and NF_CV_K_FOLD, without a `ridge`, then also
    // follow shadows' edges in them, in groups of 8 and more pixels with values above 0 and others.
    uint32_t edges;
    uint32_t controls; // User-supplied control functions with known integrals (4.18), 0 to 4.
    // Floats from one sample's u to the next; 0 means dims. A path may be longer than what is regressed (section
    // 4.3.5); its first dims coordinates must be uniform for every sample, however short its path.
    uint32_t stride;
    uint32_t solver; // NF_SOLVER_*
    // NF_PRECISION_*, of accumulators. Arrays take the best that the library was built for, images float.
    uint32_t precision;
    uint32_t nonfinite; // NF_NONFINITE_*
    uint32_t color; // NF_COLOR_*
    // Runs of samples, in order, for NF_CV_K_FOLD (images have two) and streaming NF_CV_ROBUST: 2 to 16; 0 means 4.
    uint32_t folds;
    // Ridge strength per sample, above 0, raised to 1e-12, in float 1e-5; 0, and NF_RIDGE_AUTO of images,
    // NF_CV_INCREMENTAL and streaming NF_CV_K_FOLD: the default. Descent, and NF_CV_ROBUST of one integral, ignore it.
    float ridge;
} nf_cv_config;

// Samples of integrals, row after row. What there is not is zero: `nf_cv_samples s = {.u = u, .f = f, .n = n};`.
typedef struct nf_cv_samples {
    // n rows of `stride` floats, uniform as drawn, of which the first `dims` count; the last may end after them.
    const float *u;
    const float *f; // n rows of `channels` floats.
    size_t n; // Samples of each integral; below 2^32, of an image in all. Of several, arrays hold one after the other.
    const float *controls; // n rows of `controls` floats: functions of known integral at the samples (4.18).
    const float *control_integrals; // The integrals of the `controls` functions, finite.
    // For nf_cv_image_estimate(), n rows of `channels` finite floats: f with nothing in the way, the unshadowed light.
    // Pixels are then also corrected by how far its mean is from `known_integrals`, as far as neighbours follow it.
    const float *known;
    // With `known`: `channels` floats for each pixel, its exact integrals over u, those of a polygon, say. Finite, at
    // least 0; a pixel with 0 is not corrected by it. Where a pixel's samples see several points, the mean of theirs.
    const float *known_integrals;
} nf_cv_samples;

// The number of terms of a regression, constant included; 0 for NULL, and what nf_check() refuses but precision.
uint32_t nf_cv_terms(const nf_cv_config *config);

// An estimate of an integral over primary sample space.
typedef struct nf_estimate {
    float mean[4]; // The integral, for each channel; zero for channels that are not there.
    // Each mean's standard error; infinite of one sample, where a ratio's luminances cancel, and, with `gain`, of
    // least squares from no more samples than terms.
    float std_error[4];
    uint32_t samples; // Samples used; 2^32 - 1 if there are more.
    float gain; // Estimated variance relative to the plain mean's, averaged over the channels; 1 is no gain.
} nf_estimate;

// Bytes of workspace for n samples of each integral, or fewer; never less for more. 0 where nf_check() refuses,
// the solver or a library for float alone takes fewer samples, or no memory is enough.
size_t nf_cv_workspace_size(const nf_cv_config *config, size_t n);

// Estimates `integrals` integrals from `samples->n` samples of each, apart from each other: out[integrals]. Nothing of
// the workspace, nf_cv_workspace_size() bytes, is kept.
// NF_ERR_RANGE: the configuration, a coordinate, 2^32 samples, more than the solver takes or than a memory can hold;
// NF_ERR_NOT_FINITE: a sample; NF_ERR_NO_SAMPLES; NF_ERR_MEMORY: the workspace; NF_ERR_UNSUPPORTED: what nf_check()
// says excludes each other, `known` and its integrals, or of several integrals `controls` and NF_NONFINITE_SKIP.
nf_status nf_cv_estimate(const nf_cv_config *config, const nf_cv_samples *samples, size_t integrals, void *workspace,
    size_t bytes, nf_estimate *out);

// Some pixels of an image.
typedef struct nf_cv_rectangle {
    uint32_t x; // The first column.
    uint32_t y; // The first row.
    uint32_t width; // Columns.
    uint32_t height; // Rows.
} nf_cv_rectangle;

// The pixels of an image, or of a part of one, and what is known of them. All zero but width and height: nothing.
// In arrays pixel (x, y) of frame t has the number (t height + y) width + x, where x, y, width and height are those
// within `given` for inputs and within `wanted` for outputs.
typedef struct nf_cv_image {
    uint32_t width; // Pixels in a row.
    uint32_t height; // Rows.
    uint32_t frames; // Images of the same pixels at other times, which share fits; 0 means 1.
    // Width and height of the windows that pixels share a fit in; 0 means 8. At most 1024 pixels over all frames.
    uint32_t window;
    // Pixels from one window to the next, at most `window`; 0 means half of it. Corrections of overlapping windows are
    // averaged; the time of an estimate goes with the square of window / stride.
    uint32_t stride;
    // 1 if the pixels have no places: all of one surface, in all frames, share a fit. With `surfaces` at most 1024
    // pixels. Their order must not follow a picture: shuffle them, above all for NF_CV_K_FOLD.
    uint32_t unordered;
    // How many of a pixel's `n` samples count, its first; 0 means all. Nobody may write to the others meanwhile.
    size_t samples;
    // A number for each pixel, or NULL: only pixels of the same number share a fit, those that show one material under
    // a similar normal, say. It must not depend on the pixel's own samples, or no estimator is unbiased.
    const uint32_t *surfaces;
    // `channels` numbers for each pixel, or NULL: what its values are divided by before a fit, its albedo say. Finite,
    // at least 0, and not dependent on its own samples; 0 counts as 1. For textures of which all samples of a pixel
    // see the same; pixels near 0 beside others are better kept apart by `surfaces`.
    const float *factors;
    // The pixels that input arrays hold, in all frames, and that count, at most 2^30 - 1; all zero: all of the image.
    // Without `wanted` whole windows. Of these only the pixels are read that `wanted` needs.
    nf_cv_rectangle given;
    // The pixels to estimate, in all frames, of which every window must be given whole: see nf_cv_image_needed(). All
    // zero: all that are given. Parts that are estimated apart, by threads say, have the bits of the whole.
    nf_cv_rectangle wanted;
} nf_cv_image;

// Writes which pixels must be given for `image->wanted`, and all zero, for all, where pixels have no places. Reads no
// array; `out` may be `&image->given`.
// NF_ERR_RANGE: what nf_check() says of the windows and `wanted`.
nf_status nf_cv_image_needed(const nf_cv_image *image, nf_cv_rectangle *out);

// Bytes of workspace that nf_cv_image_estimate() needs with these arguments: more with `known`, and at times for fewer
// samples. 0 as for nf_cv_workspace_size(), and for what is refused there. No array is read.
size_t nf_cv_image_workspace_size(const nf_cv_config *config, const nf_cv_image *image, const nf_cv_samples *samples);

// Estimates an image's pixels from `samples->n` samples in each, or `image->samples`: out[wanted pixels * frames].
// Pixels of one window and surface share a fit, which follows integrands that change across the window; each pixel is
// corrected by a fit to the others' samples (section 4.3.6), even from one sample. Computed in float.
//
// NF_CV_ROBUST weighs fits of rising degree, and the plain mean, by their errors across the pixels and within those
// they have not seen; unbiased as the group grows. NF_CV_K_FOLD, NF_CV_LEAVE_ONE_OUT and, without `known`, a `ridge`
// are exactly unbiased for independent samples. Groups of fewer pixels than 3 plus the window's axes keep their
// mean; with several samples NF_CV_LEAVE_ONE_OUT and a `ridge` correct 2. One sample in each pixel tells no texture:
// say it by `surfaces` or `factors`. With one, or `stratified`, std_error is the estimates' spread about a trend.
//
// With `known`, NF_CV_LEAVE_ONE_OUT corrects by that alone, exactly unbiased; NF_CV_ROBUST without a `ridge` chooses
// among fits to f and to what is left of it, with order 0 between the mean and what is known.
// NF_ERR_UNSUPPORTED: other estimators and solvers, `controls`, NF_NONFINITE_SKIP, luminance ratio, `known` with
// NF_CV_K_FOLD; NF_ERR_RANGE also for the image, `samples` above n, negative factors or integrals, and `known` without
// integrals or they without it; else as for nf_cv_estimate().
nf_status nf_cv_image_estimate(const nf_cv_config *config, const nf_cv_image *image, const nf_cv_samples *samples,
    void *workspace, size_t bytes, nf_estimate *out);

#define NF_OPTIMIZER_MOMENTUM 0 // Heavy-ball momentum. The default.
#define NF_OPTIMIZER_ADAM 1 // Adam.
#define NF_OPTIMIZER_PLAIN 2 // Plain steps (4.29).

// How nf_cv_gradient_descent() steps. Zero in any field is its default.
typedef struct nf_cv_descent {
    uint32_t optimizer; // NF_OPTIMIZER_*
    uint32_t iterations; // Steps, at most 2^20; by default half as many as samples, 8 to 128.
    // Step length, at least 0: for Adam in standard deviations of values (.05), else over the largest curvature (1).
    float learning_rate;
    float momentum; // At least 0, below 1; 0 means .5, for Adam .9. Plain steps have none.
} nf_cv_descent;

// nf_cv_estimate() of one integral by NF_CV_GRADIENT_DESCENT, which `estimator` must be, from a start: `coefficients`
// are `channels` rows (1 for a luminance ratio) of nf_cv_terms() - 1 floats in the values' unit, and the solution
// afterwards. The solution of a previous frame is a good start (section 4.2.6). A channel whose descent ends farther
// from the values than their mean is that mean; its coefficients are then 0, unless they came nearer than the start.
//
// Other errors as for nf_cv_estimate(); NF_ERR_RANGE also for the descent, NF_ERR_NOT_FINITE for the start,
// NF_ERR_UNSUPPORTED for another estimator and `controls`.
nf_status nf_cv_gradient_descent(const nf_cv_config *config, const nf_cv_samples *samples, const nf_cv_descent *descent,
    float *coefficients, void *workspace, size_t bytes, nf_estimate *out);

// A streaming estimate of fixed size, in caller memory. It may be moved or copied as bytes between calls, among
// processes that run the same library file.
typedef struct nf_cv_accumulator nf_cv_accumulator;

// Bytes of an accumulator, and in `workspace`, unless NULL, those that nf_cv_accumulator_estimate() needs; both 0 for
// a configuration that is NULL, out of range or not for streaming, and the first for a misaligned `workspace`.
size_t nf_cv_accumulator_size(const nf_cv_config *config, size_t *workspace);

// Makes an empty accumulator in `memory`, or empties one: `*out` is its handle, the same address.
// NF_ERR_RANGE: the configuration; NF_ERR_MEMORY; NF_ERR_UNSUPPORTED: what needs all samples at once, which are
// NF_CV_LEAVE_ONE_OUT, NF_SOLVER_DUAL, and NF_RIDGE_AUTO of least squares; and NF_SOLVER_SQUARE_ROOT of all else.
nf_status nf_cv_accumulator_init(void *memory, size_t bytes, const nf_cv_config *config, nf_cv_accumulator **out);

// Adds samples of the one integral: all of them or, on an error, none. Several at a time are cheaper. In single
// precision an accumulator holds 2^22 samples.
// NF_ERR_RANGE also for more samples than it holds; NF_ERR_NO_SAMPLES: n is 0; else as for nf_cv_estimate(), but
// NF_NONFINITE_SKIP may skip all.
nf_status nf_cv_accumulator_add(nf_cv_accumulator *accumulator, const nf_cv_samples *samples);

// Adds all samples of `other`, which stays as it is. The same parts in the same order have the same bits.
// NF_ERR_MISMATCH: other configurations; NF_ERR_RANGE: both are the same object, or hold too many samples together.
nf_status nf_cv_accumulator_merge(nf_cv_accumulator *accumulator, const nf_cv_accumulator *other);

// The estimate from all samples so far; more may be added afterwards.
// NF_ERR_MEMORY; NF_ERR_NO_SAMPLES.
nf_status nf_cv_accumulator_estimate(const nf_cv_accumulator *accumulator, void *workspace, size_t bytes,
    nf_estimate *out);

/* Guidance: which estimator and which tile to use.
 * Guides, in docs/: choosing.md. */

#define NF_SAMPLING_INDEPENDENT 0 // Sampling: a pixel's samples are independent of each other.
#define NF_SAMPLING_STRATIFIED 1 // Sampling: a tile's, a Sobol sequence's, or jittered.

#define NF_METHOD_PLAIN_MEAN 0 // Method: the mean of the values; nf_cv_estimate() with order 0 gives it, too.
#define NF_METHOD_PER_PIXEL 1 // Method: nf_cv_estimate() for each pixel.
#define NF_METHOD_SHARED 2 // Method: nf_cv_image_estimate().

// What nf_recommend() says.
typedef struct nf_recommendation {
    uint32_t method; // How to make estimates of the samples: NF_METHOD_*
    // `stride` of nf_cv_image for NF_METHOD_SHARED, in windows of 8. Where 8, 4 has less error in more time.
    uint32_t image_stride;
    // Which tile of the library to draw from, if there is a choice: its samples per pixel. One of 1 sample is
    // continued as a Sobol sequence.
    uint32_t tile_samples;
    uint32_t tile_dims; // The same: its dims.
    // Mean squared error over that of the mean of independent samples, of smooth formulas: frames keep far more.
    float error;
    float filtered_error; // The same of the image filtered by a Gaussian of 2.1 pixels.
    // Nanoseconds that the method takes for each sample on the machine of the report: of NF_METHOD_SHARED three
    // channels in windows of image_stride (overlapping ones take two to three times as long), else one channel.
    float cost;
    // The cost of a sample, in nanoseconds, below which more samples of the plain mean lower the error further in the
    // same time: for overlapping windows twice that of others. Infinite if no fit pays at any cost.
    float pays_from;
    // How to estimate, as precisely as can be. `channels` is 1: set your own. `stride` is all dims.
    nf_cv_config config;
} nf_recommendation;

// Which estimator, order and tile to use for `spp` samples per pixel of `dims` coordinates, both at least 1.
// sampling: NF_SAMPLING_*. can_share: 1 if neighbouring pixels' samples are at hand together and integrate similar
// functions, else 0. sample_cost: nanoseconds to trace a sample, above 0; INFINITY: the best fit, if one pays.
// NF_ERR_RANGE; NF_ERR_NOT_FINITE: a NaN.
nf_status nf_recommend(uint32_t dims, uint32_t spp, uint32_t sampling, uint32_t can_share, float sample_cost,
    nf_recommendation *out);

#ifdef __cplusplus
}
#endif

#endif /* NOISEFLOOR_CV_H */
