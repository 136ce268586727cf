//! Configuration and result, and their translation to the core's types.

use crate::convert;
use crate::status::*;
use crate::wrong::{Wrong, pick};
use noisefloor_core::basis::Family;
use noisefloor_core::control_variate::{Color, Config, Estimate, Estimator, NonFinite, Ridge, Solver};

/// Estimator: a soft mixture of the plain mean and ridge fits, by their errors on samples they have not seen. The
/// default; slightly biased at few samples, and never noticeably worse than the mean.
pub const NF_CV_ROBUST: u32 = 0;
/// Estimator: least squares on its own samples (Alg. 1). Cheapest; bias O(1/n); wants several samples per term.
pub const NF_CV_LEAST_SQUARES: u32 = 1;
/// Estimator: each sample corrected by a ridge fit to all others. Exactly unbiased, nearly with `controls`; no streams.
pub const NF_CV_LEAVE_ONE_OUT: u32 = 2;
/// Estimator: each fold corrected by a robust fit to others (section 4.2.6). Exactly unbiased.
pub const NF_CV_K_FOLD: u32 = 3;
/// Estimator: gradient descent on its own samples (Alg. 2). Biased; see nf_cv_gradient_descent().
pub const NF_CV_GRADIENT_DESCENT: u32 = 4;
/// Estimator: each sample corrected by a fit to those before it (4.30). Exactly unbiased after every sample.
pub const NF_CV_INCREMENTAL: u32 = 5;

/// Basis: products of orthonormal shifted Legendre polynomials. The default.
pub const NF_BASIS_LEGENDRE: u32 = 0;
/// Basis: products of Walsh functions, constant on the cells of a grid of eighths.
pub const NF_BASIS_STEP: u32 = 1;
/// Basis: products of half-waves sin(pi d x + pi/2), which are cos(pi d x).
pub const NF_BASIS_SINE: u32 = 2;
/// Basis: isotropic Gaussians, as many as Legendre has terms.
pub const NF_BASIS_GAUSSIAN: u32 = 3;

/// Solver: dual for n below the terms and no `controls`, else normal equations. The default.
pub const NF_SOLVER_AUTO: u32 = 0;
/// Solver: normal equations (4.27) and LDL'.
pub const NF_SOLVER_NORMAL_EQUATIONS: u32 = 1;
/// Solver: Givens rotations, for badly placed samples. Only with NF_CV_LEAST_SQUARES.
pub const NF_SOLVER_SQUARE_ROOT: u32 = 2;
/// Solver: the n x n system of at most 4096 samples. Not for streaming, nor with `controls`.
pub const NF_SOLVER_DUAL: u32 = 3;

/// Precision: double. The default; NF_ERR_UNSUPPORTED, of arrays and images too, in a library for float alone.
pub const NF_PRECISION_F64: u32 = 0;
/// Precision: float, for targets without double hardware.
pub const NF_PRECISION_F32: u32 = 1;

/// A NaN or infinite sample is NF_ERR_NOT_FINITE. The default.
pub const NF_NONFINITE_ERROR: u32 = 0;
/// A NaN or infinite sample is left out and not counted; biased unless such samples would have been average ones.
pub const NF_NONFINITE_SKIP: u32 = 1;

/// Each channel is regressed on its own, with one factorisation. The default.
pub const NF_COLOR_PER_CHANNEL: u32 = 0;
/// Rec. 709 luminance is regressed and scales the plain mean of the channels, which must be 3 (section 4.3). Standard
/// errors are the luminance's, scaled alike: they leave out what the colour is uncertain by.
pub const NF_COLOR_LUMINANCE_RATIO: u32 = 1;

/// For `ridge`: the best of a few by leave-one-out errors; biases NF_CV_LEAVE_ONE_OUT.
pub const NF_RIDGE_AUTO: f32 = -1.0;

/// How to estimate. Zero in any field but dims, order and channels is its default, so that
/// `nf_cv_config config = {.dims = 2, .order = 2, .channels = 1};` is the robust estimator over 2 coordinates.
#[repr(C)]
#[derive(Clone, Copy, Default)]
#[allow(non_camel_case_types)]
pub struct nf_cv_config {
    /// Coordinates of a sample that are regressed, 1 to 16.
    pub dims: u32,
    /// Largest total degree, 0 to 7; at 0 `controls` alone correct. nf_cv_terms() may not exceed 136.
    pub order: u32,
    /// Values of a sample, 1 to 4.
    pub channels: u32,
    /// NF_CV_*
    pub estimator: u32,
    /// NF_BASIS_*
    pub basis: u32,
    /// 1 if a pixel's samples are stratified (nf_sampler, a tile, Sobol points). One pixel's estimate is then the plain
    /// mean, but for NF_CV_LEAST_SQUARES and NF_CV_GRADIENT_DESCENT: fits to some of the samples undo what is even
    /// about all. Fits shared by pixels correct all the same.
    pub stratified: u32,
    /// If above 1, the last coordinate picks one of this many equally likely alternatives, lights say (figure 4.15): at
    /// most 136 - binomial(dims - 1 + order, order) - `controls`. Of more let each slice stand for several.
    pub slices: u32,
    /// Of two coordinates that pick a point of a light the first, counted from 1, below dims, with `slices` below
    /// dims - 1; 0: none. From 4 samples on image fits by NF_CV_ROBUST and NF_CV_K_FOLD, without a `ridge`, then also
    /// follow shadows' edges in them, in groups of 8 and more pixels with values above 0 and others.
    pub edges: u32,
    /// User-supplied control functions with known integrals (4.18), 0 to 4.
    pub controls: u32,
    /// Floats from one sample's u to the next; 0 means dims. A path may be longer than what is regressed (section
    /// 4.3.5); its first dims coordinates must be uniform for every sample, however short its path.
    pub stride: u32,
    /// NF_SOLVER_*
    pub solver: u32,
    /// NF_PRECISION_*, of accumulators. Arrays take the best that the library was built for, images float.
    pub precision: u32,
    /// NF_NONFINITE_*
    pub nonfinite: u32,
    /// NF_COLOR_*
    pub color: u32,
    /// Runs of samples, in order, for NF_CV_K_FOLD (images have two) and streaming NF_CV_ROBUST: 2 to 16; 0 means 4.
    pub folds: u32,
    /// Ridge strength per sample, above 0, raised to 1e-12, in float 1e-5; 0, and NF_RIDGE_AUTO of images,
    /// NF_CV_INCREMENTAL and streaming NF_CV_K_FOLD: the default. Descent, and NF_CV_ROBUST of one integral, ignore it.
    pub ridge: f32,
}

/// An estimate of an integral over primary sample space.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct nf_estimate {
    /// The integral, for each channel; zero for channels that are not there.
    pub mean: [f32; 4],
    /// Each mean's standard error; infinite of one sample, where a ratio's luminances cancel, and, with `gain`, of
    /// least squares from no more samples than terms.
    pub std_error: [f32; 4],
    /// Samples used; 2^32 - 1 if there are more.
    pub samples: u32,
    /// Estimated variance relative to the plain mean's, averaged over the channels; 1 is no gain.
    pub gain: f32,
}

/// The number of terms of a regression, constant included; 0 for NULL, and what nf_check() refuses but precision.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_terms(config: *const nf_cv_config) -> u32 {
    // SAFETY: the caller's pointer, checked there for NULL and alignment.
    let config = unsafe { convert::reference(config) }.and_then(|config| Ok(core_config(config)?));
    config.ok().and_then(|config| config.terms().ok()).map_or(0, |terms| terms as u32)
}

/// What is wrong with a configuration.
pub(crate) fn check_config(config: &nf_cv_config) -> Result<(), Wrong> {
    check_core(&core_config(config)?)?;
    is_narrow(config).map(|_| ())
}

/// What the core finds wrong.
pub(super) fn check_core(config: &Config) -> Result<(), Wrong> {
    Ok(config.check()?)
}

/// The core's configuration, precision apart, see [`is_narrow`]; no more is checked than the numbers that stand for a
/// choice.
pub(super) fn core_config(config: &nf_cv_config) -> Result<Config, Wrong> {
    use Estimator::{GradientDescent, Incremental, KFold, LeastSquares, LeaveOneOut, Robust};
    let estimators = [Robust, LeastSquares, LeaveOneOut, KFold, GradientDescent, Incremental];
    let solvers = [Solver::Auto, Solver::NormalEquations, Solver::SquareRoot, Solver::Dual];
    let non_finites = [NonFinite::Error, NonFinite::Skip];
    let colors = [Color::PerChannel, Color::LuminanceRatio];
    Ok(Config {
        dims: config.dims as usize,
        order: config.order as usize,
        channels: config.channels as usize,
        estimator: pick(config.estimator, &estimators, c"estimator must be one of NF_CV_*, 0 to 5")?,
        basis: pick(config.basis, &Family::ALL, c"basis must be one of NF_BASIS_*, 0 to 3")?,
        stratified: pick(config.stratified, &[false, true], c"stratified must be 0 or 1")?,
        slices: config.slices as usize,
        edges: config.edges as usize,
        controls: config.controls as usize,
        stride: config.stride as usize,
        solver: pick(config.solver, &solvers, c"solver must be one of NF_SOLVER_*, 0 to 3")?,
        non_finite: pick(config.nonfinite, &non_finites, c"nonfinite must be one of NF_NONFINITE_*, 0 or 1")?,
        color: pick(config.color, &colors, c"color must be one of NF_COLOR_*, 0 or 1")?,
        folds: config.folds as usize,
        ridge: match config.ridge {
            0.0 => Ridge::Default,
            NF_RIDGE_AUTO => Ridge::Auto,
            strength => Ridge::Fixed(strength),
        },
        ..Config::new(0, 0, 0)
    })
}

/// Whether the configuration asks for float instead of double.
#[inline(always)]
pub(super) fn is_narrow(config: &nf_cv_config) -> Result<bool, Wrong> {
    const ALONE: Wrong =
        Wrong(NF_ERR_UNSUPPORTED, c"precision must be NF_PRECISION_F32: this library was built for float alone");
    // Written so that, without double precision, the compiler sees that the answer is always yes.
    match config.precision {
        NF_PRECISION_F32 => Ok(true),
        NF_PRECISION_F64 if cfg!(feature = "double") => Ok(false),
        NF_PRECISION_F64 => Err(ALONE),
        _ => Err(Wrong(NF_ERR_RANGE, c"precision must be one of NF_PRECISION_*, 0 or 1")),
    }
}

pub(super) fn c_estimate(estimate: &Estimate) -> nf_estimate {
    nf_estimate { mean: estimate.mean, std_error: estimate.std_error, samples: estimate.samples, gain: estimate.gain }
}
