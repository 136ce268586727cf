//! What an estimate is made with.

use crate::basis::{Family, MAX_DIMS, MAX_ORDER, MAX_TERMS, Shape};
use crate::error::{Error, Invalid, ensure, rule};
use core::num::NonZeroUsize;

/// How many folds there are, if the caller names no number.
const FOLDS: NonZeroUsize = NonZeroUsize::MIN.saturating_add(3);

/// How samples become an estimate (chapter 4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Estimator {
    /// A soft mixture of the plain mean and two ridge fits, weighted by their errors on samples that they have not
    /// seen: the default. Never noticeably worse than the mean; slightly biased at low sample counts.
    #[default]
    Robust,
    /// The fit's residuals on its own samples (Alg. 1). Cheapest; biased O(1/n); needs several samples per term.
    LeastSquares,
    /// One ridge fit, each sample corrected by the fit to all others, in closed form. Exactly unbiased, but for
    /// [`Ridge::Auto`], and next to exactly with control functions.
    LeaveOneOut,
    /// Each fold is corrected by a robust fit to the other folds. Exactly unbiased.
    KFold,
    /// The fit by gradient descent, full batch, on its own samples (Alg. 2).
    GradientDescent,
    /// Each sample is corrected by a fit to the samples before it (4.30). Exactly unbiased, any prefix is an estimate.
    Incremental,
}

/// How a least-squares system is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Solver {
    /// The dual where there are fewer samples than terms and no control functions, normal equations otherwise.
    #[default]
    Auto,
    /// Normal equations (4.27) and L D L'.
    NormalEquations,
    /// Givens rotations row by row: twice the digits on badly placed samples, about twice the time. For
    /// [`Estimator::LeastSquares`], without [`Ridge::Auto`].
    SquareRoot,
    /// The n x n system of the samples, at most 4096; not with control functions.
    Dual,
}

/// What happens to a sample with a NaN or an infinity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum NonFinite {
    /// The call fails with [`Error::NotFinite`].
    #[default]
    Error,
    /// The sample is left out and not counted. This is biased if the sample should have been anything but average.
    Skip,
}

/// How the channels of a vector integrand are treated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Color {
    /// One factorisation, one right-hand side for each channel; each channel is as unbiased as the estimator.
    #[default]
    PerChannel,
    /// The thesis's form (section 4.3): regress the Rec. 709 luminance, scale the plain mean by the ratio of
    /// luminances. Standard errors are the luminance's, scaled alike: they leave out what the colour is uncertain by.
    LuminanceRatio,
}

/// The step rule of [`Estimator::GradientDescent`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Optimizer {
    /// Heavy-ball momentum.
    #[default]
    Momentum,
    /// Adam (Kingma and Ba 2015).
    Adam,
    /// Plain gradient descent (4.29).
    Plain,
}

/// The strength of the ridge penalty.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Ridge {
    /// The estimator's documented default.
    #[default]
    Default,
    /// The strength with the smallest leave-one-out error of a few, which biases leave-one-out; the default where there
    /// are no such errors.
    Auto,
    /// Penalty per sample on a first-degree coefficient, times the number of first-degree functions; positive and
    /// finite, raised to 1e-12 or in `f32` to 1e-5.
    Fixed(f32),
}

/// How to estimate. `Config::new(dims, order, channels)` gives the defaults.
///
/// ```
/// use noisefloor::control_variate::Config;
///
/// // RGB; a point on a light, and behind it the number that picks one of six lights.
/// let config = Config { slices: 6, ..Config::new(3, 2, 3) };
/// assert_eq!(config.terms(), Ok(42)); // the constant, 5 shared, and for each light an indicator and 5 of its own
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Config {
    /// Coordinates of a sample that are regressed, 1 to 16.
    pub dims: usize,
    /// Largest total degree, 0 to 7; 0 is the plain mean, but for control functions. Terms, see [`Config::terms`], may
    /// not exceed 136.
    pub order: usize,
    /// Values of a sample, 1 to 4.
    pub channels: usize,
    /// How samples become an estimate.
    pub estimator: Estimator,
    /// The functions that are combined.
    pub basis: Family,
    /// Whether the samples are stratified ([`sampler`](crate::sampler), a tile, Sobol points, a lattice) instead of
    /// independent. Of one pixel all estimators are then the mean but [`Estimator::LeastSquares`] and
    /// [`Estimator::GradientDescent`]: what corrects some samples by fits to others undoes what is even about all, and
    /// the errors that decide how far do not show it. Fits shared by pixels correct all the same, take their standard
    /// errors from the pixels' spread, and trust it alone where it speaks for a fit.
    pub stratified: bool,
    /// If above 1, the last coordinate picks one of this many equally likely alternatives (figure 4.15). Each takes a
    /// term: at most 136 less binomial(dims - 1 + order, order), the terms of the other coordinates, less `controls`.
    /// That is 130 at 3 dims and order 2, of which up to 43 have functions of their own as well. Order 0 takes none.
    pub slices: usize,
    /// Of two coordinates that pick a point of a light the first, counted from 1, below `dims`, with `slices` below
    /// `dims` - 1; 0 for none. With 4 and more samples in each pixel [`Estimator::Robust`] and [`Estimator::KFold`],
    /// without a fixed ridge, then fit to images also a shadow's edge in the two, in groups of 8 and more pixels with
    /// lit (above 0) and dark samples. Nothing else uses it.
    pub edges: usize,
    /// User-supplied control functions with known integrals (4.18), 0 to 4.
    pub controls: usize,
    /// Numbers from one sample's coordinates to the next; 0 means `dims`. A path may be longer than what is regressed
    /// (section 4.3.5); its first `dims` coordinates must exist, uniform, for every sample, however short its path.
    pub stride: usize,
    /// How least-squares systems are solved.
    pub solver: Solver,
    /// What happens to NaN and infinity.
    pub non_finite: NonFinite,
    /// How channels are treated.
    pub color: Color,
    /// Folds of [`Estimator::KFold`] and of the streaming robust estimate: 2 to 16; 0 means 4. They are runs of samples
    /// in the order in which they come. Images have two, of their pixels, whatever this says.
    pub folds: usize,
    /// Steps of gradient descent, at most 2^20; 0 means half as many as samples, at least 8 and at most 128.
    pub iterations: usize,
    /// The step rule of gradient descent.
    pub optimizer: Optimizer,
    /// Ridge strength. [`Estimator::GradientDescent`], and of one integral [`Estimator::Robust`], do not use it; of
    /// images any strength, but not [`Ridge::Auto`], makes one fit, unbiased.
    pub ridge: Ridge,
    /// Step length of gradient descent, in units of the value's standard deviation for Adam, and of one over the
    /// largest curvature otherwise; 0 means the default.
    pub learning_rate: f32,
    /// Momentum of gradient descent, 0 to below 1; 0 means the default.
    pub momentum: f32,
}

impl Config {
    /// Largest `folds`.
    pub const MAX_FOLDS: usize = 16;
    /// Largest `controls`.
    pub const MAX_CONTROLS: usize = 4;
    /// Largest `channels`.
    pub const MAX_CHANNELS: usize = 4;

    /// The default estimator over `dims` coordinates, of total degree `order`, for `channels` values.
    #[inline]
    pub fn new(dims: usize, order: usize, channels: usize) -> Self {
        Self { dims, order, channels, ..Self::default() }
    }

    /// Terms of the regression, constant included.
    ///
    /// # Errors
    /// [`Error::Range`] if a field is out of range, [`Error::Unsupported`] for options that exclude each other.
    pub fn terms(&self) -> Result<usize, Error> {
        Ok(1 + self.controls + self.checked_shape()?.columns())
    }

    /// Checks every field.
    ///
    /// # Errors
    /// The rule that is broken, with what [`terms`](Self::terms) answers. Functions may allow less, as their own errors
    /// say.
    pub fn check(&self) -> Result<(), Invalid> {
        self.checked_shape().map(|_| ())
    }

    /// Checks every field, and returns how many functions there are.
    pub(crate) fn checked_shape(&self) -> Result<Shape, Invalid> {
        rule((1..=MAX_DIMS).contains(&self.dims), c"dims must be 1 to 16")?;
        rule(self.order <= MAX_ORDER, c"order must be 0 to 7")?;
        rule((1..=Self::MAX_CHANNELS).contains(&self.channels), c"channels must be 1 to 4")?;
        let end = self.dims - usize::from(self.slices > 1);
        let edges = c"edges must be 0, or at least 1 and below dims, with slices below dims - 1";
        rule(self.edges == 0 || self.edges < end, edges)?;
        rule(self.controls <= Self::MAX_CONTROLS, c"controls must be 0 to 4")?;
        rule(self.stride == 0 || self.stride >= self.dims, c"stride must be 0 or at least dims")?;
        rule(self.folds != 1 && self.folds <= Self::MAX_FOLDS, c"folds must be 0, or 2 to 16")?;
        rule(self.iterations <= 1 << 20, c"iterations must be 0 to 1048576")?;
        let is_strength = match self.ridge {
            Ridge::Fixed(strength) => strength > 0.0 && strength.is_finite(),
            Ridge::Default | Ridge::Auto => true,
        };
        rule(is_strength, c"ridge must be the default, automatic, or finite and above 0")?;
        let is_rate = (0.0..f32::INFINITY).contains(&self.learning_rate);
        rule(is_rate, c"learning_rate must be finite and at least 0")?;
        rule((0.0..1.0).contains(&self.momentum), c"momentum must be at least 0 and below 1")?;
        let excluded = |is_kept, rule| ensure(is_kept, Invalid { error: Error::Unsupported, rule });
        let color = c"color must not be the luminance ratio but for 3 channels";
        excluded(self.color == Color::PerChannel || self.channels == 3, color)?;
        let is_least_squares = self.estimator == Estimator::LeastSquares && self.ridge != Ridge::Auto;
        let square_root = c"solver must not be the square root but for least squares without an automatic ridge";
        excluded(self.solver != Solver::SquareRoot || is_least_squares, square_root)?;
        let is_dual = self.solver == Solver::Dual;
        excluded(!is_dual || self.controls == 0, c"solver must not be the dual with controls")?;
        let incremental = c"solver must not be the dual for the incremental estimator";
        excluded(!is_dual || self.estimator != Estimator::Incremental, incremental)?;
        let terms = c"dims, order, slices and controls make more than 136 terms: lower one of them";
        let shape = Shape::new(self.dims, self.order, self.slices, MAX_TERMS - self.controls);
        shape.map_err(|error| Invalid { error, rule: terms })
    }

    /// Numbers from one sample's coordinates to the next.
    #[inline]
    pub fn step(&self) -> usize {
        if self.stride == 0 { self.dims } else { self.stride }
    }

    /// How many values of a sample are regressed: its channels, or 1 for its luminance.
    #[inline]
    pub fn regressed(&self) -> usize {
        if self.color == Color::LuminanceRatio { 1 } else { self.channels }
    }

    pub(crate) fn fold_count(&self) -> NonZeroUsize {
        NonZeroUsize::new(self.folds).unwrap_or(FOLDS)
    }
}

/// An estimate of an integral over primary sample space.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Estimate {
    /// The integral, for each channel; unused channels are zero.
    pub mean: [f32; 4],
    /// An estimate of the standard error of each mean; infinite for one sample alone, for a luminance ratio of samples
    /// whose luminances cancel and, of values that are not all equal, for least squares of no more samples than terms,
    /// of which no residual is left to tell.
    pub std_error: [f32; 4],
    /// Samples that were used, at most [`u32::MAX`].
    pub samples: u32,
    /// Estimated variance relative to the plain mean's, averaged over the channels: 1 means no gain. Infinite
    /// where the standard error is for lack of residuals.
    pub gain: f32,
}
