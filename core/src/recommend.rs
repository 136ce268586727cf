//! Which estimator, of which order, and which built-in tile to use: a table of what was measured.
//!
//! `docs/choosing.md` says why, and when not to follow it; `docs/report/samplers.md` has the measurements.
//!
//! ```
//! use noisefloor::recommend::{Method, Sampling, recommend};
//!
//! // 4 samples per pixel of 2 dims, from a tile, whole images at a time.
//! let best = recommend(2, 4, Sampling::Stratified, true, f32::INFINITY)?;
//! assert_eq!(best.method, Method::Shared);
//! assert_eq!((best.tile_samples, best.tile_dims), (4, 2));
//! let config = noisefloor::control_variate::Config { channels: 3, ..best.config };
//! # assert!(config.terms().is_ok());
//! # Ok::<(), noisefloor::Error>(())
//! ```

use crate::basis::MAX_DIMS;
use crate::control_variate::Config;
use crate::error::{Error, ensure};

/// What a pixel's samples are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sampling {
    /// Independent of each other.
    Independent,
    /// [`sampler`](crate::sampler)'s, a tile's, a Sobol sequence's, or jittered.
    Stratified,
}

/// How samples become estimates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// The mean of the values.
    PlainMean,
    /// [`estimate`](crate::control_variate::estimate) for each pixel.
    PerPixel,
    /// [`estimate_image`](crate::control_variate::estimate_image), with windows of 8 x 8 pixels.
    Shared,
}

/// What [`recommend`] says.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Recommendation {
    /// How to make estimates of the samples.
    pub method: Method,
    /// With which configuration. Its `channels` is 1: set your own. Its `stride` is all dims, its `dims` those that are
    /// regressed.
    pub config: Config,
    /// The [`Image::stride`](crate::control_variate::Image::stride) of [`Method::Shared`], for windows of 8. Where it
    /// is 8, 4, overlapping windows, has less error and pays from twice [`Recommendation::pays_from`] on.
    pub image_stride: usize,
    /// Which built-in tile to draw from, if there is a choice: its samples per pixel. One of 1 sample is continued as a
    /// Sobol sequence.
    pub tile_samples: usize,
    /// The same: its dims.
    pub tile_dims: usize,
    /// Mean squared error over that of the plain mean of independent samples, of the smooth formulas of
    /// `docs/choosing.md`: of rendered frames several times as much is left.
    pub error: f32,
    /// The same of the image filtered by a Gaussian of 2.1 pixels.
    pub filtered_error: f32,
    /// Nanoseconds that the method takes for each sample on the machine of the report: of [`Method::Shared`] three
    /// channels in windows of `image_stride` (overlapping ones take two to three times as long), else one channel.
    pub cost: f32,
    /// The cost of a sample, in nanoseconds, below which more samples of the plain mean lower the error further in the
    /// same time: for overlapping windows twice that of others. Infinite if no fit pays at any cost.
    pub pays_from: f32,
}

/// What is best for samples of `dims` coordinates, `samples_per_pixel` of them, both at least 1. `can_share` says
/// whether neighbouring pixels' samples are at hand together and integrate similar functions.
///
/// `sample_cost` is what a sample costs to trace, in nanoseconds: below [`Recommendation::pays_from`] the plain mean is
/// best, though a cheaper fit than the one that is best at equal samples may pay earlier. Infinity asks for the best
/// fit, if one pays at any cost.
///
/// What was measured are 1, 2, 4, 5, 8 and 15 dims with 1, 4, 16, 64 and 256 samples: dims are rounded up, those above
/// 15 count as 15, samples are rounded down. Fits shared by pixels of 2 or 3 samples take as long as those of 4.
///
/// # Errors
/// [`Error::Range`] if `dims`, `samples_per_pixel` or the cost is not above 0, [`Error::NotFinite`] for a cost of NaN.
pub fn recommend(
    dims: usize,
    samples_per_pixel: usize,
    sampling: Sampling,
    can_share: bool,
    sample_cost: f32,
) -> Result<Recommendation, Error> {
    ensure(!sample_cost.is_nan(), Error::NotFinite)?;
    ensure(dims > 0 && samples_per_pixel > 0 && sample_cost > 0.0, Error::Range)?;
    let (error, filtered_error) = match sampling {
        Sampling::Independent => (1.0, 1.0),
        Sampling::Stratified => cell(&STRATIFIED_ALONE, dims, samples_per_pixel),
    };
    let mean = plain(error, filtered_error);
    let measured = |samples| match (sampling, can_share) {
        (Sampling::Independent, false) => cell(&INDEPENDENT_ALONE, dims, samples),
        (Sampling::Independent, true) => cell(&INDEPENDENT_SHARED, dims, samples),
        (Sampling::Stratified, false) => mean,
        (Sampling::Stratified, true) => cell(&STRATIFIED_SHARED, dims, samples),
    };
    let mut best = measured(samples_per_pixel);
    if best.method == Method::Shared && matches!(samples_per_pixel, 2 | 3) {
        let four = measured(4);
        best = if four.method == Method::PlainMean { mean } else { Cell { cost: four.cost, ..best } };
    }
    let (_, pays_from) = best.time(sampling, samples_per_pixel);
    let is_too_dear = best.method != Method::PlainMean && sample_cost < pays_from;
    let chosen = if is_too_dear { mean } else { best };
    let (cost, _) = chosen.time(sampling, samples_per_pixel);
    let Cell { method, order, image_stride, error, filtered_error, .. } = chosen;
    let (tile_samples, tile_dims) = cell(&TILES, dims, samples_per_pixel);
    // 15 dims are the most of order 2.
    let regressed = dims.min(if order < 2 { MAX_DIMS } else { 15 });
    let config =
        Config { stride: dims, stratified: sampling == Sampling::Stratified, ..Config::new(regressed, order, 1) };
    Ok(Recommendation { method, config, image_stride, tile_samples, tile_dims, error, filtered_error, cost, pays_from })
}

/// For 1, 4, 16, 64 and 256 samples.
type Row<T> = [T; 5];
/// For 1, 2, 4, 5, 8 and 15 dims.
type Table<T> = [Row<T>; 6];

fn cell<T: Copy>(table: &Table<T>, dims: usize, samples: usize) -> T {
    let [single, two, four, five, eight, more] = table;
    let [one, few, some, many, most] = match dims {
        ..=1 => single,
        2 => two,
        3..=4 => four,
        5 => five,
        6..=8 => eight,
        _ => more,
    };
    *match samples {
        ..4 => one,
        4..16 => few,
        16..64 => some,
        64..256 => many,
        _ => most,
    }
}

/// A decision, and the errors that were measured: mean squares over those of the plain mean of independent samples, raw
/// and filtered by a Gaussian of 2.1 pixels.
#[derive(Clone, Copy)]
struct Cell {
    method: Method,
    order: usize,
    image_stride: usize,
    /// Nanoseconds a sample: instructions that callgrind counts of one channel, of shared fits without surfaces in
    /// windows side by side, 12 in a nanosecond.
    cost: f32,
    error: f32,
    filtered_error: f32,
}

const fn plain(error: f32, filtered_error: f32) -> Cell {
    Cell { method: Method::PlainMean, ..pixel(0, 0, error, filtered_error) }
}

const fn pixel(order: usize, cost: u16, error: f32, filtered_error: f32) -> Cell {
    Cell { method: Method::PerPixel, order, image_stride: 8, cost: cost as f32, error, filtered_error }
}

/// Windows of 8 x 8 pixels, one beside the other.
const fn blocks(order: usize, cost: u16, error: f32, filtered_error: f32) -> Cell {
    Cell { method: Method::Shared, ..pixel(order, cost, error, filtered_error) }
}

/// Windows that overlap by half.
const fn windows(order: usize, cost: u16, error: f32, filtered_error: f32) -> Cell {
    Cell { image_stride: 4, ..blocks(order, cost, error, filtered_error) }
}

impl Cell {
    /// What it takes for each sample, and the cost of a sample from which it pays, in nanoseconds.
    ///
    /// Shared fits of 2 dims in rendered frames of three channels, with surfaces, in windows side by side (those that
    /// overlap take two to three times as long, and pay from twice as much on): medians of eight scenes, if more
    /// samples lower the mean's squared error as 1 / N, of stratified ones as 1 / N^1.5. Other dims by their cost. Of
    /// one pixel's fits: they leave .78 in those frames.
    fn time(&self, sampling: Sampling, samples: usize) -> (f32, f32) {
        // A pixel of 2 or 3 samples takes as long as one of 4, and gains what lies between it and one of 1.
        let longer_by = (4.0 / samples as f32).max(1.0);
        let (unit, cost, independent, stratified) = match samples {
            ..2 => (56.0, 246.0, 1710.0, 2830.0),
            2..16 => (30.0, 185.0 * longer_by, 1160.0 * longer_by, 5140.0),
            _ => (15.0, 78.0, 339.0, 46900.0),
        };
        let scale = self.cost / unit;
        let (longer, later) = if self.image_stride == 4 { (3.0, 2.0) } else { (1.0, 1.0) };
        match (self.method, sampling) {
            (Method::PlainMean, _) => (0.0, f32::INFINITY),
            (Method::PerPixel, _) => (self.cost, self.cost * (0.78 / 0.22)),
            (Method::Shared, Sampling::Independent) => (cost * scale * longer, independent * scale * later),
            (Method::Shared, Sampling::Stratified) => (cost * scale * longer, stratified * scale * later),
        }
    }
}

/// Independent samples of one pixel: a fit, as soon as there are several samples to a term. In 2 dims the order is 5
/// from 64 samples on: 6 and 7 gain more on the smooth integrands of the study, and lose on harder ones
/// (docs/choosing.md).
#[rustfmt::skip]
const INDEPENDENT_ALONE: Table<Cell> = [
    [plain(1.0, 1.0),               plain(1.0, 0.92),              pixel(5, 91, 0.049, 0.15),
     pixel(7, 69, 0.00036, 0.003),  pixel(7, 52, 0.0001, 0.00086)],
    [plain(1.0, 1.0),               plain(1.0, 1.0),               pixel(3, 169, 0.27, 0.36),
     pixel(5, 237, 0.025, 0.042),   pixel(5, 169, 0.011, 0.016)],
    [plain(1.0, 0.99),              plain(0.99, 1.0),              pixel(3, 602, 0.49, 0.58),
     pixel(3, 547, 0.16, 0.21),     pixel(3, 370, 0.079, 0.11)],
    [plain(1.0, 0.96),              plain(0.99, 0.91),             pixel(2, 488, 0.61, 0.67),
     pixel(2, 240, 0.24, 0.29),     pixel(3, 817, 0.094, 0.14)],
    [plain(0.98, 0.98),             plain(1.0, 1.0),               pixel(2, 684, 0.74, 0.75),
     pixel(2, 853, 0.39, 0.44),     pixel(2, 557, 0.21, 0.22)],
    [plain(0.94, 0.92),             plain(0.99, 0.94),             pixel(2, 1662, 0.89, 0.88),
     pixel(1, 174, 0.58, 0.59),     pixel(1, 133, 0.47, 0.33)],
];

/// Independent samples of an image.
#[rustfmt::skip]
const INDEPENDENT_SHARED: Table<Cell> = [
    [blocks(5, 60, 0.035, 0.06),    blocks(5, 26, 0.033, 0.056),   blocks(5, 15, 0.037, 0.064),
     pixel(7, 69, 0.00036, 0.003),  pixel(7, 52, 0.0001, 0.00086)],
    [blocks(3, 56, 0.13, 0.17),     blocks(3, 30, 0.11, 0.14),     blocks(3, 15, 0.12, 0.15),
     pixel(5, 237, 0.025, 0.042),   pixel(5, 169, 0.011, 0.016)],
    [blocks(3, 123, 0.22, 0.26),    blocks(3, 126, 0.15, 0.18),    blocks(3, 60, 0.14, 0.18),
     pixel(3, 547, 0.16, 0.21),     pixel(3, 370, 0.079, 0.11)],
    [blocks(2, 80, 0.3, 0.31),      blocks(2, 71, 0.23, 0.24),     blocks(2, 36, 0.23, 0.25),
     pixel(2, 240, 0.24, 0.29),     pixel(3, 817, 0.094, 0.14)],
    [blocks(2, 163, 0.39, 0.39),    blocks(2, 207, 0.28, 0.29),    blocks(2, 91, 0.27, 0.28),
     blocks(2, 62, 0.29, 0.3),      pixel(2, 557, 0.21, 0.22)],
    [blocks(1, 73, 0.58, 0.57),     blocks(1, 96, 0.51, 0.51),     blocks(1, 44, 0.52, 0.58),
     blocks(1, 31, 0.54, 0.56),     pixel(1, 133, 0.47, 0.33)],
];

/// The plain mean of stratified samples of one pixel: leave-one-out errors do not see strata, and a fit may be many
/// times worse. From 64 samples on the figures, here and below, are those of Sobol points scrambled in each pixel; for
/// 5 and 8 dims and 1 sample, of the tile of 2 dims. On the tile of 1 sample, continued, the plain mean alone was
/// measured, at .77 to 1.1 times these errors, filtered .81 to 1.4 times.
const STRATIFIED_ALONE: Table<(f32, f32)> = [
    [(0.99, 0.039), (0.17, 0.011), (0.042, 0.0035), (0.0017, 0.0024), (0.00018, 0.00027)],
    [(0.99, 0.045), (0.2, 0.011), (0.052, 0.0035), (0.009, 0.012), (0.0016, 0.0022)],
    [(0.99, 0.08), (0.36, 0.026), (0.15, 0.085), (0.028, 0.035), (0.011, 0.014)],
    [(0.98, 0.2), (0.3, 0.14), (0.15, 0.094), (0.072, 0.097), (0.046, 0.065)],
    [(1.0, 0.24), (0.33, 0.17), (0.2, 0.14), (0.14, 0.17), (0.1, 0.12)],
    [(1.0, 0.28), (0.35, 0.19), (0.23, 0.14), (0.2, 0.2), (0.16, 0.13)],
];

/// Stratified samples of an image. From 64 on the mean: at 16 fits hardly gain in rendered frames, and larger numbers,
/// which were not rendered, are taken to be alike.
#[rustfmt::skip]
const STRATIFIED_SHARED: Table<Cell> = [
    [blocks(5, 60, 0.034, 0.03),    blocks(5, 26, 0.019, 0.0096),  blocks(5, 15, 0.011, 0.0038),
     plain(0.0017, 0.0024),         plain(0.00018, 0.00027)],
    [blocks(3, 56, 0.13, 0.048),    blocks(3, 30, 0.079, 0.011),   windows(3, 15, 0.032, 0.0028),
     plain(0.009, 0.012),           plain(0.0016, 0.0022)],
    [blocks(2, 66, 0.25, 0.096),    blocks(2, 50, 0.19, 0.028),    blocks(3, 60, 0.073, 0.051),
     plain(0.028, 0.035),           plain(0.011, 0.014)],
    [blocks(2, 80, 0.29, 0.19),     blocks(2, 71, 0.18, 0.099),    blocks(2, 36, 0.11, 0.075),
     plain(0.072, 0.097),           plain(0.046, 0.065)],
    [blocks(2, 163, 0.39, 0.26),    blocks(2, 207, 0.23, 0.14),    blocks(2, 91, 0.15, 0.11),
     plain(0.14, 0.17),             plain(0.1, 0.12)],
    [blocks(1, 73, 0.61, 0.32),     plain(0.35, 0.19),             plain(0.23, 0.14),
     plain(0.2, 0.2),               plain(0.16, 0.13)],
];

/// Samples and dims of the tile with the least error of the plain mean, √(raw filtered). From 64 samples on a tile of 1
/// sample, continued as a Sobol sequence: at 64 samples it has .0096 in 2 dims and .033 in 4, the tile of 16 samples,
/// continued, .029 and .12.
const TILES: Table<(usize, usize)> = [
    [(1, 2), (4, 2), (16, 2), (1, 4), (1, 4)],
    [(1, 2), (4, 2), (16, 2), (1, 2), (1, 2)],
    [(1, 4), (4, 4), (16, 2), (1, 4), (1, 4)],
    [(1, 4), (4, 2), (16, 2), (1, 4), (1, 4)],
    [(1, 4), (4, 2), (16, 2), (1, 4), (1, 4)],
    [(1, 2), (4, 2), (16, 2), (1, 4), (1, 4)],
];
