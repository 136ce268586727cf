//! Which estimator and which sampler to use.

use crate::convert;
use crate::cv::{default_config, nf_cv_config};
use crate::status::*;
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
    /// The `stride` of nf_cv_image for NF_METHOD_SHARED, for windows of 8. With surfaces leave it 0, for overlapping
    /// windows.
    pub image_stride: u32,
    /// Which built-in tile to draw from, if there is a choice: its samples per pixel. A tile of 1 sample is continued
    /// as a Sobol sequence.
    pub tile_samples: u32,
    /// The same: its dims.
    pub tile_dims: u32,
    /// What to expect: mean squared error over that of the plain mean of independent samples. Of stratified samples
    /// measured on the tile named above, except: for 5 to 8 dims and 1 to 3 samples, on that of 2 dims; from 64 samples
    /// on, with Sobol points scrambled in each pixel (on the tile of 1 sample, continued, only the plain mean was
    /// measured, at .77 to 1.1 times this error).
    pub error: f32,
    /// The same of the image filtered by a Gaussian of 2.1 pixels, with the same exceptions; the plain mean of the tile
    /// of 1 sample, continued, has .81 to 1.4 times the error of Sobol points scrambled in each pixel that is given
    /// here.
    pub filtered_error: f32,
    /// Nanoseconds that the method takes for each sample on the machine of the report: of NF_METHOD_SHARED in rendered
    /// frames of three channels with surfaces, in windows side by side, of NF_METHOD_PER_PIXEL for one channel. Windows
    /// that overlap by half take three times as long, and pay from twice `pays_from` on.
    pub cost: f32,
    /// The cost of a sample, in nanoseconds, from which a fit pays: below it more samples of the plain mean, in the
    /// same time, would lower the error further. Of NF_METHOD_SHARED the median over eight rendered frames. Infinite if
    /// no fit pays at any cost.
    pub pays_from: f32,
    /// How to estimate. `channels` is 1: set your own. `stride` is all dims.
    pub config: nf_cv_config,
}

/// Which estimator, of which order, and which of the library's tiles to use for samples of `dims` coordinates and `spp`
/// of them per pixel, both at least 1. `sampling` is NF_SAMPLING_*; `can_share` is 1 if neighbouring pixels' samples
/// are at hand together and integrate similar functions, else 0. `sample_cost` is what a sample costs to trace, in
/// nanoseconds: below `pays_from` the plain mean is best. INFINITY compares errors at equal samples. docs/choosing.md
/// has the measurements that it rests on.
///
/// NF_ERR_RANGE also for a cost that is not above 0, NF_ERR_NOT_FINITE for a NaN.
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
        let sampling = match sampling {
            NF_SAMPLING_INDEPENDENT => Sampling::Independent,
            NF_SAMPLING_STRATIFIED => Sampling::Stratified,
            _ => return Err(NF_ERR_RANGE),
        };
        if can_share > 1 {
            return Err(NF_ERR_RANGE);
        }
        let of = recommend(dims as usize, spp as usize, sampling, can_share == 1, sample_cost).map_err(status_of)?;
        let config = nf_cv_config {
            dims: of.config.dims as u32,
            order: of.config.order as u32,
            stratified: u32::from(of.config.stratified),
            stride: dims,
            ..default_config()
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
