/* Generated from capi/ by `cargo xtask header`; do not edit. Conventions: noisefloor.h. */

#ifndef NOISEFLOOR_CV_H
#define NOISEFLOOR_CV_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Control variates: samples of one integral, or of a pixel, made into an estimate of lower error.
 * Guides, in docs/: control_variates.md. */

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
    // there are no leave-one-out errors (streaming, incremental, images), and biases NF_CV_LEAVE_ONE_OUT slightly.
    float ridge;
    // Step of gradient descent: in standard deviations of the values for Adam, else times one over the largest
    // curvature. 0 means the default.
    float learning_rate;
    // Momentum of gradient descent, below 1; 0 means the default.
    float momentum;
} nf_cv_config;

// Sets a configuration to the robust estimator over 2 coordinates, order 2, 1 channel. NULL is ignored.
void nf_cv_config_default(nf_cv_config *config);

// What is wrong with a configuration, in a static sentence with a NUL that names the field and its range: the first of
// them if there are several. NULL if nothing is. Options that only some functions take are not looked at: where those
// fail they return NF_ERR_UNSUPPORTED.
const char *nf_cv_config_check(const nf_cv_config *config);

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
nf_status nf_cv_estimate(const nf_cv_config *config, const float *u, const float *f, size_t n, void *workspace,
    size_t bytes, nf_estimate *out);

// As nf_cv_estimate(), with `controls` functions h of known integral (4.18): h has n rows of `controls` floats, the
// functions at the samples, and h_integral their integrals. Both may be NULL if `controls` is 0.
nf_status nf_cv_estimate_with_controls(const nf_cv_config *config, const float *u, const float *f, const float *h,
    const float *h_integral, size_t n, void *workspace, size_t bytes, nf_estimate *out);

// As nf_cv_estimate() with NF_CV_GRADIENT_DESCENT, which `estimator` must be, starting from `coefficients`, `channels`
// rows (1 for a luminance ratio) of nf_cv_terms() - 1 floats in the values' unit, and leaving the solution there: a
// previous frame's is a good start (4.2.6). A channel whose descent diverges is its mean, and its coefficients are 0.
// NF_ERR_UNSUPPORTED for another estimator or `controls`.
nf_status nf_cv_gradient_descent(const nf_cv_config *config, const float *u, const float *f, size_t n,
    float *coefficients, void *workspace, size_t bytes, nf_estimate *out);

// Writes which pixels must be given for those of `image->wanted`: its windows whole; all zero, and so all, where
// pixels have no places. Reads no array. `out` may be `&image->given`.
//
// NF_ERR_RANGE for windows that nf_cv_image does not allow and for `wanted` beyond the image.
nf_status nf_cv_image_needed(const nf_cv_image *image, nf_cv_rectangle *out);

// Bytes of workspace that nf_cv_image_estimate() needs for n samples in each pixel; 0 as for nf_cv_workspace_size(),
// and for an image that is NULL, has no pixels, or has windows that nf_cv_image does not allow. With `known` it is
// more.
size_t nf_cv_image_workspace_size(const nf_cv_config *config, const nf_cv_image *image, size_t n);

// Estimates the integrals of the pixels of an image, or with `unordered` of any integrals that are alike: u and f hold
// n samples of pixel after pixel as nf_cv_estimate() takes them, out has one estimate for each wanted pixel. Pixels of
// the same window and surface share a fit, which follows integrands that change across the window; every pixel is
// corrected by a fit to other pixels' samples (4.3.6), even from one sample in each. All is computed in float,
// whatever `precision` says.
//
// The estimator says how fits are chosen. NF_CV_ROBUST weighs fits of rising degree and the plain mean by the variance
// of their estimates across the pixels and, from 2 samples on, by what they leave of the variance within pixels that
// they have not seen; unbiased as the group grows. NF_CV_K_FOLD lets two halves of the pixels choose for each other,
// NF_CV_LEAVE_ONE_OUT or a `ridge` is one fit: both exactly unbiased, if the pixels' samples are independent. Groups
// of up to 4 pixels stay at their mean, but for one fit to several samples in each; one fit to 2 to 12 pixels can be a
// fifth worse than the mean. Where fits explain little, NF_CV_ROBUST and NF_CV_K_FOLD leave pixels far brighter or
// darker than all others out of the fits to others.
//
// Of a texture one sample in each pixel cannot tell: say it by `surfaces` or `factors`. Several do: pixels whose
// samples are all alike stay as they are. With one sample, or `stratified`, std_error is the spread of the pixels'
// estimates about their linear trend: an upper bound where the signal varies otherwise.
//
// With `known`, NF_CV_LEAVE_ONE_OUT corrects by that alone and is the only one that is exactly unbiased; NF_CV_ROBUST
// chooses among fits to f and to what is left of it, and with order 0 between the mean and what is known. NF_CV_K_FOLD
// is then unsupported.
//
// NF_ERR_UNSUPPORTED for other estimators, controls, skipping and luminance ratio; NF_ERR_RANGE also for an image
// without pixels, for windows and parts that nf_cv_image does not allow, for negative factors or integrals and for
// `known` without `known_integrals`; NF_ERR_NOT_FINITE if any of the three is not finite; else as nf_cv_estimate().
nf_status nf_cv_image_estimate(const nf_cv_config *config, const nf_cv_image *image, const float *u, const float *f,
    size_t n, void *workspace, size_t bytes, nf_estimate *out);

// As nf_cv_estimate() for each of `integrals` integrals, n samples of each: u and f hold integral after integral, out
// one estimate for each, with the bits of single calls. The workspace is that of one. For interpreters and others
// whose calls are dear.
//
// NF_ERR_UNSUPPORTED also for `controls` and NF_NONFINITE_SKIP; else as nf_cv_estimate().
nf_status nf_cv_estimate_many(const nf_cv_config *config, const float *u, const float *f, size_t n, size_t integrals,
    void *workspace, size_t bytes, nf_estimate *out);

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
nf_status nf_cv_accumulator_init(void *memory, size_t bytes, const nf_cv_config *config, nf_cv_accumulator **out);

// Adds n samples, laid out as for nf_cv_estimate(): all of them or, on an error, none. Several at a time are cheaper.
// In single precision an accumulator holds 2^22 samples: NF_ERR_RANGE beyond. A configuration with `controls` needs
// nf_cv_accumulator_add_with_controls().
nf_status nf_cv_accumulator_add(nf_cv_accumulator *accumulator, const float *u, const float *f, size_t n);

// As nf_cv_accumulator_add(), with the control functions of nf_cv_estimate_with_controls().
nf_status nf_cv_accumulator_add_with_controls(nf_cv_accumulator *accumulator, const float *u, const float *f,
    const float *h, const float *h_integral, size_t n);

// Adds all samples of `other`, which stays as it is. NF_ERR_MISMATCH if the configurations differ, NF_ERR_RANGE if
// both are the same object. Like every function of an accumulator, NF_ERR_STATE for memory that holds none.
nf_status nf_cv_accumulator_merge(nf_cv_accumulator *accumulator, const nf_cv_accumulator *other);

// Bytes of workspace that nf_cv_accumulator_estimate() needs; 0 as for nf_cv_accumulator_size().
size_t nf_cv_accumulator_workspace_size(const nf_cv_config *config);

// The estimate from all samples so far; more may be added afterwards. NF_ERR_NO_SAMPLES if there are none.
nf_status nf_cv_accumulator_estimate(const nf_cv_accumulator *accumulator, void *workspace, size_t bytes,
    nf_estimate *out);

// Forgets all samples.
nf_status nf_cv_accumulator_reset(nf_cv_accumulator *accumulator);

/* Guidance: which estimator and which tile to use.
 * Guides, in docs/: choosing.md. */

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
nf_status nf_recommend(uint32_t dims, uint32_t spp, uint32_t sampling, uint32_t can_share, float sample_cost,
    nf_recommendation *out);

#ifdef __cplusplus
}
#endif

#endif /* NOISEFLOOR_CV_H */
