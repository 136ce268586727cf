//! Shared fits with fresh workspaces full of NaN: an estimator that relied on their content would show it. Not generic,
//! so that they are compiled once for all test files.

use noisefloor::Error;
use noisefloor::control_variate::{Config, Estimate, Image, Samples, estimate_image, image_workspace_len};

/// The estimates of an image's pixels.
pub fn image(config: &Config, image: &Image<'_>, samples: Samples<'_>) -> Result<Vec<Estimate>, Error> {
    let [pixels, estimated] = image.counts()?;
    let n = samples.f.len().checked_div(pixels.saturating_mul(config.channels)).unwrap_or(0);
    let mut workspace = vec![f32::NAN; image_workspace_len(config, image, n)?];
    let mut out = vec![None; estimated];
    let mut put = |index: usize, estimate| assert!(out[index].replace(estimate).is_none(), "pixel {index} twice");
    let result = estimate_image(config, image, samples, &mut workspace, &mut put);
    // Every pixel, or none on an error.
    assert!(out.iter().all(|pixel| pixel.is_some() == result.is_ok()));
    result.map(|()| out.into_iter().flatten().collect())
}

/// The estimates of pixels in no order.
pub fn block(config: &Config, pixels: usize, samples: Samples<'_>) -> Result<Vec<Estimate>, Error> {
    image(config, &Image::unordered(pixels), samples)
}
