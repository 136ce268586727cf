//! Estimates of neighbouring pixels, which share fits.

use super::batch::{len, samples};
use super::config::{c_estimate, core_config, is_narrow, nf_cv_config, nf_estimate};
use crate::convert;
use crate::dispatch;
use crate::status::*;
use noisefloor_core::control_variate::{self as cv, Config, Estimate, Image, Rectangle, Samples};

/// The pixels of an image, or of a part of one, and what is known of them. All zero but width and height: nothing.
/// Pixel (x, y) of frame t has the number (t height + y) width + x.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct nf_cv_image {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Images of the same pixels at other times, which share fits; 0 means 1.
    pub frames: u32,
    /// Width and height of the windows that pixels share a fit in; 0 means 8. At most 1024 pixels in all frames
    /// together.
    pub window: u32,
    /// Pixels from one window to the next, at most `window`; 0 means half of it. Where windows overlap corrections are
    /// averaged. The time of an estimate goes with the square of window / stride.
    pub stride: u32,
    /// 1 if the pixels have no places: all of the same surface, in all frames, then share one fit, whatever `window`
    /// and `stride` say. With `surfaces` they are at most 1024.
    pub unordered: u32,
    /// A number for each pixel, or NULL: only pixels with the same number share a fit. What shows the same material
    /// under a similar normal and depth, for example. Must not depend on the pixel's own samples, or no estimator is
    /// unbiased.
    pub surfaces: *const u32,
    /// `channels` numbers for each pixel, or NULL: what its values are divided by before a fit and multiplied by after
    /// it, such as its albedo. Finite and not negative; 0 counts as 1. Must not depend on the pixel's own samples
    /// either. For textures, where all samples of a pixel see one albedo: with defocus or motion blur they can raise
    /// the error. Pixels near 0 beside others are better kept apart by `surfaces`: their values would decide the fit.
    pub factors: *const f32,
    /// For each sample, as f, what it would be with nothing in the way (its unshadowed contribution), or NULL. Finite.
    /// Pixels are then also corrected by how far it is from `known_integrals`, as far as their neighbours follow it.
    pub known: *const f32,
    /// With `known`, else NULL: `channels` numbers for each pixel, its exact integrals over u: of a polygon light in
    /// closed form, for example. Finite and not negative; a pixel with 0 is not corrected by it. Where a pixel's
    /// samples see several points, the mean of theirs.
    pub known_integrals: *const f32,
    /// The pixels that u, f and the arrays above hold, in all frames; all zero: all of the image. Numbers of pixels
    /// then count these alone.
    pub given: nf_cv_rectangle,
    /// The pixels to estimate, for which `out` has room; all zero: all that are given. A part without pixels is
    /// refused, but at the origin, where it is all zero. Every window that has one of
    /// them must be given whole, see nf_cv_image_needed(). Parts that are estimated on their own, by threads for
    /// example, have the bits of the whole.
    pub wanted: nf_cv_rectangle,
}

/// Some pixels of an image.
#[repr(C)]
#[derive(Clone, Copy, Default)]
#[allow(non_camel_case_types)]
pub struct nf_cv_rectangle {
    /// The first column.
    pub x: u32,
    /// The first row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// Writes which pixels must be given for those of `image->wanted`: its windows whole; all zero, and so all, where
/// pixels have no places. Reads no array. `out` may be `&image->given`.
///
/// NF_ERR_RANGE for windows that nf_cv_image does not allow and for `wanted` beyond the image.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_image_needed(image: *const nf_cv_image, out: *mut nf_cv_rectangle) -> nf_status {
    status((|| {
        // SAFETY: the caller's pointers, checked there. A copy, as `out` may be a part of the image.
        let (image, out) = unsafe { (*convert::reference(image)?, convert::room(out)?) };
        let needed = core_image(&image)?.needed().map_err(status_of)?;
        let [x, y, width, height] = [needed.x, needed.y, needed.width, needed.height].map(|value| value as u32);
        out.write(nf_cv_rectangle { x, y, width, height });
        Ok(())
    })())
}

/// Bytes of workspace that nf_cv_image_estimate() needs for n samples in each pixel; 0 as for nf_cv_workspace_size(),
/// and for an image that is NULL, has no pixels, or has windows that nf_cv_image does not allow. With `known` it is
/// more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_image_workspace_size(
    config: *const nf_cv_config,
    image: *const nf_cv_image,
    n: usize,
) -> usize {
    // SAFETY: the caller's pointers, checked there for NULL and alignment.
    let (Ok(config), Ok(image)) = (unsafe { (convert::reference(config), convert::reference(image)) }) else {
        return 0;
    };
    match core_image(image) {
        Ok(image) => workspace_size(config, &image, n),
        Err(_) => 0,
    }
}

/// Estimates the integrals of the pixels of an image, or with `unordered` of any integrals that are alike: u and f hold
/// n samples of pixel after pixel as nf_cv_estimate() takes them, out has one estimate for each wanted pixel. Pixels of
/// the same window and surface share a fit, which follows integrands that change across the window; every pixel is
/// corrected by a fit to other pixels' samples (4.3.6), even from one sample in each. All is computed in float,
/// whatever `precision` says.
///
/// The estimator says how fits are chosen. NF_CV_ROBUST weighs fits of rising degree and the plain mean by the variance
/// of their estimates across the pixels and, from 2 samples on, by what they leave of the variance within pixels that
/// they have not seen; unbiased as the group grows. NF_CV_K_FOLD lets two halves of the pixels choose for each other,
/// NF_CV_LEAVE_ONE_OUT or a `ridge` is one fit: both exactly unbiased, if the pixels' samples are independent. Groups
/// of up to 4 pixels stay at their mean, but for one fit to several samples in each; one fit to 2 to 12 pixels can be a
/// fifth worse than the mean. Where fits explain little, NF_CV_ROBUST and NF_CV_K_FOLD leave pixels far brighter or
/// darker than all others out of the fits to others.
///
/// Of a texture one sample in each pixel cannot tell: say it by `surfaces` or `factors`. Several do: pixels whose
/// samples are all alike stay as they are. With one sample, or `stratified`, std_error is the spread of the pixels'
/// estimates about their linear trend: an upper bound where the signal varies otherwise.
///
/// With `known`, NF_CV_LEAVE_ONE_OUT corrects by that alone and is the only one that is exactly unbiased; NF_CV_ROBUST
/// chooses among fits to f and to what is left of it, and with order 0 between the mean and what is known. NF_CV_K_FOLD
/// is then unsupported.
///
/// NF_ERR_UNSUPPORTED for other estimators, controls, skipping and luminance ratio; NF_ERR_RANGE also for an image
/// without pixels, for windows and parts that nf_cv_image does not allow, for negative factors or integrals and for
/// `known` without `known_integrals`; NF_ERR_NOT_FINITE if any of the three is not finite; else as nf_cv_estimate().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_image_estimate(
    config: *const nf_cv_config,
    image: *const nf_cv_image,
    u: *const f32,
    f: *const f32,
    n: usize,
    workspace: *mut core::ffi::c_void,
    bytes: usize,
    out: *mut nf_estimate,
) -> nf_status {
    status((|| {
        // SAFETY: the caller's pointers, checked there.
        let (config, of) = unsafe { (convert::reference(config)?, convert::reference(image)?) };
        let core = supported(config)?;
        let mut image = core_image(of)?;
        let [pixels, estimates] = image.counts().map_err(status_of)?;
        let total = convert::product(pixels, n)?;
        // SAFETY: the caller's arrays, of the lengths the header states.
        let (samples, out) = unsafe {
            (samples(&core, u, f, core::ptr::null(), core::ptr::null(), total)?, convert::rooms(out, estimates)?)
        };
        if !of.surfaces.is_null() {
            // SAFETY: as above.
            image.surfaces = unsafe { convert::slice(of.surfaces, pixels)? };
        }
        if !of.factors.is_null() {
            // SAFETY: as above.
            image.factors = unsafe { convert::slice(of.factors, convert::product(pixels, core.channels)?)? };
        }
        image.known = &[];
        if !of.known.is_null() {
            // SAFETY: as above.
            image.known = unsafe { convert::slice(of.known, convert::product(total, core.channels)?)? };
        }
        if !of.known_integrals.is_null() {
            // SAFETY: as above.
            image.known_integrals =
                unsafe { convert::slice(of.known_integrals, convert::product(pixels, core.channels)?)? };
        }
        // SAFETY: the caller's workspace, `bytes` long.
        unsafe { estimate(&core, &image, samples, n, (workspace, bytes), out) }
    })())
}

/// The core's configuration.
fn supported(config: &nf_cv_config) -> Result<Config, nf_status> {
    let core = core_config(config)?;
    // All is computed in float, but a wrong number is an error.
    is_narrow(config)?;
    if core.controls > 0 { Err(NF_ERR_UNSUPPORTED) } else { Ok(core) }
}

/// The image without its arrays; of `known` only whether there is one, on which the workspace depends.
fn core_image(image: &nf_cv_image) -> Result<Image<'static>, nf_status> {
    let [width, height, frames, window, stride] =
        [image.width, image.height, image.frames, image.window, image.stride].map(|value| value as usize);
    let unordered = match image.unordered {
        0 => false,
        1 => true,
        _ => return Err(NF_ERR_RANGE),
    };
    let known: &[f32] = if image.known.is_null() { &[] } else { &[0.0] };
    let rectangle = |of: &nf_cv_rectangle| {
        let [x, y, width, height] = [of.x, of.y, of.width, of.height].map(|value| value as usize);
        Rectangle::new(x, y, width, height)
    };
    let (given, wanted) = (rectangle(&image.given), rectangle(&image.wanted));
    Ok(Image { frames, window, stride, unordered, known, given, wanted, ..Image::new(width, height) })
}

/// Bytes, 0 for what is not supported or out of range.
fn workspace_size(config: &nf_cv_config, image: &Image<'_>, n: usize) -> usize {
    let size = || {
        let core = supported(config)?;
        let len = cv::image_workspace_len(&core, image, n).map_err(status_of)?;
        len.checked_mul(size_of::<f32>()).ok_or(NF_ERR_MEMORY)
    };
    size().unwrap_or(0)
}

/// # Safety
/// The workspace's pointer must be NULL or point to as many bytes as stand beside it.
unsafe fn estimate(
    config: &Config,
    image: &Image<'_>,
    samples: Samples<'_>,
    n: usize,
    (workspace, bytes): (*mut core::ffi::c_void, usize),
    out: &mut [convert::Room<nf_estimate>],
) -> Result<(), nf_status> {
    let write = |pixel: usize, estimate: Estimate| {
        if let Some(out) = out.get_mut(pixel) {
            out.write(c_estimate(&estimate));
        }
    };
    let needed = len(cv::image_workspace_len(config, image, n))?;
    // SAFETY: the caller's promise, see above.
    let workspace = unsafe { convert::workspace::<f32>(workspace, bytes, needed)? };
    dispatch::estimate_image(config, image, samples, workspace, write).map_err(status_of)
}
