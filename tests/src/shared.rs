//! Shared fits with fresh workspaces full of NaN: an estimator that relied on their content would show it. Not generic,
//! so that they are compiled once for all test files.

use noisefloor::Error;
use noisefloor::control_variate::{
    Config, Estimate, Image, Samples, block_workspace_len, estimate_block, estimate_image, image_workspace_len,
};
use noisefloor::real::Real;

/// The estimates of an image's pixels.
pub fn image(config: &Config, image: &Image<'_>, samples: Samples<'_>) -> Result<Vec<Estimate>, Error> {
    image_of(config, image, samples)
}

/// As [`image()`] in `f32`.
pub fn image_narrow(config: &Config, image: &Image<'_>, samples: Samples<'_>) -> Result<Vec<Estimate>, Error> {
    image_of(config, image, samples)
}

/// The estimates of pixels in no order.
pub fn block(config: &Config, pixels: usize, samples: Samples<'_>) -> Result<Vec<Estimate>, Error> {
    block_of(config, pixels, samples)
}

/// As [`block()`] in `f32`.
pub fn block_narrow(config: &Config, pixels: usize, samples: Samples<'_>) -> Result<Vec<Estimate>, Error> {
    block_of(config, pixels, samples)
}

/// [`block()`] or [`block_narrow()`], as `R` is.
pub fn block_as<R: Real>(config: &Config, pixels: usize, samples: Samples<'_>) -> Result<Vec<Estimate>, Error> {
    if R::NARROW { block_narrow(config, pixels, samples) } else { block(config, pixels, samples) }
}

fn image_of(config: &Config, image: &Image<'_>, samples: Samples<'_>) -> Result<Vec<Estimate>, Error> {
    let pixels = image.width.saturating_mul(image.height).saturating_mul(image.frames.max(1));
    let n = samples.f.len().checked_div(pixels.saturating_mul(config.channels)).unwrap_or(0);
    let mut workspace = vec![f32::NAN; image_workspace_len(config, image, n)?];
    let mut out = Vec::new();
    let result = estimate_image(config, image, samples, &mut workspace, collect(&mut out));
    finish(result, out, pixels)
}

fn block_of(config: &Config, pixels: usize, samples: Samples<'_>) -> Result<Vec<Estimate>, Error> {
    let n = samples.f.len().checked_div(pixels.saturating_mul(config.channels)).unwrap_or(0);
    let mut workspace = vec![f32::NAN; block_workspace_len(config, pixels, n)?];
    let mut out = Vec::new();
    let result = estimate_block(config, samples, pixels, &mut workspace, collect(&mut out));
    finish(result, out, pixels)
}

fn collect(out: &mut Vec<Estimate>) -> impl FnMut(usize, Estimate) + '_ {
    |index, estimate| {
        assert_eq!(index, out.len(), "pixels in order");
        out.push(estimate);
    }
}

/// Every pixel, or none on an error.
fn finish(result: Result<(), Error>, out: Vec<Estimate>, pixels: usize) -> Result<Vec<Estimate>, Error> {
    assert_eq!(out.len(), if result.is_ok() { pixels } else { 0 });
    result.map(|()| out)
}
