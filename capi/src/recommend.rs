//! Which estimator and which sampler to use.

use crate::convert;
use crate::cv::{NF_PRECISION_F32, NF_PRECISION_F64, nf_cv_config};
use crate::status::*;
use crate::wrong::pick;
use noisefloor_core::recommend::{Method, Sampling, recommend};

/// Sampling: a pixel's samples are independent of each other.
pub const NF_SAMPLING_INDEPENDENT: u32 = 0;
/// Sampling: a tile's, a Sobol sequence's, or jittered.
pub const NF_SAMPLING_STRATIFIED: u32 = 1;

/// Method: the mean of the values; nf_cv_estimate() with order 0 gives it, too.
pub const NF_METHOD_PLAIN_MEAN: u32 = 0;
/// Method: nf_cv_estimate() for each pixel.
pub const NF_METHOD_PER_PIXEL: u32 = 1;
/// Method: nf_cv_image_estimate().
pub const NF_METHOD_SHARED: u32 = 2;

/// What nf_recommend() says.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct nf_recommendation {
    /// How to make estimates of the samples: NF_METHOD_*
    pub method: u32,
    /// `stride` of nf_cv_image for NF_METHOD_SHARED, in windows of 8. Where 8, 4 has less error in more time.
    pub image_stride: u32,
    /// Which tile of the library to draw from, if there is a choice: its samples per pixel. One of 1 sample is
    /// continued as a Sobol sequence.
    pub tile_samples: u32,
    /// The same: its dims.
    pub tile_dims: u32,
    /// Mean squared error over that of the mean of independent samples, of smooth formulas: frames keep far more.
    pub error: f32,
    /// The same of the image filtered by a Gaussian of 2.1 pixels.
    pub filtered_error: f32,
    /// Nanoseconds that the method takes for each sample on the machine of the report: of NF_METHOD_SHARED three
    /// channels in windows of image_stride (overlapping ones take two to three times as long), else one channel.
    pub cost: f32,
    /// The cost of a sample, in nanoseconds, below which more samples of the plain mean lower the error further in the
    /// same time: for overlapping windows twice that of others. Infinite if no fit pays at any cost.
    pub pays_from: f32,
    /// How to estimate, as precisely as can be. `channels` is 1: set your own. `stride` is all dims.
    pub config: nf_cv_config,
}

/// Which estimator, order and tile to use for `spp` samples per pixel of `dims` coordinates, both at least 1.
///
/// sampling: NF_SAMPLING_*. can_share: 1 if neighbouring pixels' samples are at hand together and integrate similar
/// functions, else 0. sample_cost: nanoseconds to trace a sample, above 0; INFINITY: the best fit, if one pays.
///
/// NF_ERR_RANGE; NF_ERR_NOT_FINITE: a NaN.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_recommend(
    dims: u32,
    spp: u32,
    sampling: u32,
    can_share: u32,
    sample_cost: f32,
    out: *mut nf_recommendation,
) -> nf_status {
    status((|| {
        let samplings = [Sampling::Independent, Sampling::Stratified];
        let sampling = pick(sampling, &samplings, c"sampling must be one of NF_SAMPLING_*, 0 or 1")?;
        let can_share = pick(can_share, &[false, true], c"can_share must be 0 or 1")?;
        let of = recommend(dims as usize, spp as usize, sampling, can_share, sample_cost)?;
        let config = nf_cv_config {
            dims: of.config.dims as u32,
            order: of.config.order as u32,
            channels: 1,
            stratified: u32::from(of.config.stratified),
            stride: dims,
            precision: if cfg!(feature = "double") { NF_PRECISION_F64 } else { NF_PRECISION_F32 },
            ..Default::default()
        };
        let found = nf_recommendation {
            method: match of.method {
                Method::PlainMean => NF_METHOD_PLAIN_MEAN,
                Method::PerPixel => NF_METHOD_PER_PIXEL,
                Method::Shared => NF_METHOD_SHARED,
            },
            image_stride: of.image_stride as u32,
            tile_samples: of.tile_samples as u32,
            tile_dims: of.tile_dims as u32,
            error: of.error,
            filtered_error: of.filtered_error,
            cost: of.cost,
            pays_from: of.pays_from,
            config,
        };
        // SAFETY: the caller's pointer, checked there.
        unsafe { convert::write(out, found) }
    })())
}
