//! Estimates of neighbouring pixels, which share fits.

use super::config::{c_estimate, core_config, is_narrow, nf_cv_config, nf_estimate};
use super::samples::{self, nf_cv_samples};
use crate::convert;
use crate::dispatch;
use crate::status::*;
use crate::wrong::{Wrong, pick};
use noisefloor_core::control_variate::{self as cv, Config, Estimate, Image, Rectangle};

/// The pixels of an image, or of a part of one, and what is known of them. All zero but width and height: nothing.
/// In arrays pixel (x, y) of frame t has the number (t height + y) width + x, where x, y, width and height are those
/// within `given` for inputs and within `wanted` for outputs.
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
    /// Width and height of the windows that pixels share a fit in; 0 means 8. At most 1024 pixels over all frames.
    pub window: u32,
    /// Pixels from one window to the next, at most `window`; 0 means half of it. Corrections of overlapping windows are
    /// averaged; the time of an estimate goes with the square of window / stride.
    pub stride: u32,
    /// 1 if the pixels have no places: all of one surface, in all frames, share a fit. With `surfaces` at most 1024
    /// pixels. Their order must not follow a picture: shuffle them, above all for NF_CV_K_FOLD.
    pub unordered: u32,
    /// How many of a pixel's `n` samples count, its first; 0 means all. Nobody may write to the others meanwhile.
    pub samples: usize,
    /// A number for each pixel, or NULL: only pixels of the same number share a fit, those that show one material under
    /// a similar normal, say. It must not depend on the pixel's own samples, or no estimator is unbiased.
    pub surfaces: *const u32,
    /// `channels` numbers for each pixel, or NULL: what its values are divided by before a fit, its albedo say. Finite,
    /// at least 0, and not dependent on its own samples; 0 counts as 1. For textures of which all samples of a pixel
    /// see the same; pixels near 0 beside others are better kept apart by `surfaces`.
    pub factors: *const f32,
    /// The pixels that input arrays hold, in all frames, and that count, at most 2^30 - 1; all zero: all of the image.
    /// Without `wanted` whole windows. Of these only the pixels are read that `wanted` needs.
    pub given: nf_cv_rectangle,
    /// The pixels to estimate, in all frames, of which every window must be given whole: see nf_cv_image_needed(). All
    /// zero: all that are given. Parts that are estimated apart, by threads say, have the bits of the whole.
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

/// Writes which pixels must be given for `image->wanted`, and all zero, for all, where pixels have no places. Reads no
/// array; `out` may be `&image->given`.
///
/// NF_ERR_RANGE: what nf_check() says of the windows and `wanted`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_image_needed(image: *const nf_cv_image, out: *mut nf_cv_rectangle) -> nf_status {
    status((|| {
        // SAFETY: the caller's pointers, checked there. A copy, as `out` may be a part of the image.
        let (image, out) = unsafe { (*convert::reference(image)?, convert::room(out)?) };
        let needed = core_image(&image, false)?.needed()?;
        let [x, y, width, height] = [needed.x, needed.y, needed.width, needed.height].map(|value| value as u32);
        out.write(nf_cv_rectangle { x, y, width, height });
        Ok(())
    })())
}

/// Bytes of workspace that nf_cv_image_estimate() needs with these arguments: more with `known`, and at times for fewer
/// samples. 0 as for nf_cv_workspace_size(), and for what is refused there. No array is read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_image_workspace_size(
    config: *const nf_cv_config,
    image: *const nf_cv_image,
    samples: *const nf_cv_samples,
) -> usize {
    let len = || {
        // SAFETY: the caller's pointers, checked there for NULL and alignment.
        let (config, image, samples) =
            unsafe { (convert::reference(config)?, convert::reference(image)?, convert::reference(samples)?) };
        let image = core_image(image, !samples.known.is_null())?;
        Ok::<_, nf_status>(cv::image_workspace_len(&supported(config)?, &image, samples.n)?)
    };
    len().ok().and_then(|len| len.checked_mul(size_of::<f32>())).unwrap_or(0)
}

/// Estimates an image's pixels from `samples->n` samples in each, or `image->samples`: out[wanted pixels * frames].
/// Pixels of one window and surface share a fit, which follows integrands that change across the window; each pixel is
/// corrected by a fit to the others' samples (section 4.3.6), even from one sample. Computed in float.
///
/// NF_CV_ROBUST weighs fits of rising degree, and the plain mean, by their errors across the pixels and within those
/// they have not seen; unbiased as the group grows. NF_CV_K_FOLD, NF_CV_LEAVE_ONE_OUT and, without `known`, a `ridge`
/// are exactly unbiased for independent samples. Groups of fewer pixels than 3 plus the window's axes keep their
/// mean; with several samples NF_CV_LEAVE_ONE_OUT and a `ridge` correct 2. One sample in each pixel tells no texture:
/// say it by `surfaces` or `factors`. With one, or `stratified`, std_error is the estimates' spread about a trend.
///
/// With `known`, NF_CV_LEAVE_ONE_OUT corrects by that alone, exactly unbiased; NF_CV_ROBUST without a `ridge` chooses
/// among fits to f and to what is left of it, with order 0 between the mean and what is known.
///
/// NF_ERR_UNSUPPORTED: other estimators and solvers, `controls`, NF_NONFINITE_SKIP, luminance ratio, `known` with
/// NF_CV_K_FOLD; NF_ERR_RANGE also for the image, `samples` above n, negative factors or integrals, and `known` without
/// integrals or they without it; else as for nf_cv_estimate().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_image_estimate(
    config: *const nf_cv_config,
    image: *const nf_cv_image,
    samples: *const nf_cv_samples,
    workspace: *mut core::ffi::c_void,
    bytes: usize,
    out: *mut nf_estimate,
) -> nf_status {
    status((|| {
        // SAFETY: the caller's pointers, checked there.
        let (config, of, given) =
            unsafe { (convert::reference(config)?, convert::reference(image)?, convert::reference(samples)?) };
        let core = supported(config)?;
        let mut image = core_image(of, !given.known.is_null())?;
        let [pixels, estimates] = image.counts()?;
        let values = convert::product(pixels, core.channels)?;
        // SAFETY: the caller's arrays and workspace, of the lengths the header states.
        let (samples, out, workspace) = unsafe {
            image.surfaces = array(of.surfaces, pixels)?;
            image.factors = array(of.factors, values)?;
            image.known = array(given.known, convert::product(values, given.n)?)?;
            image.known_integrals = array(given.known_integrals, values)?;
            let (samples, out) = (samples::read(&core, given, pixels, true)?, convert::rooms(out, estimates)?);
            let len = cv::image_workspace_len(&core, &image, given.n)?;
            (samples, out, convert::workspace(workspace, bytes, len)?)
        };
        let mut write = |pixel: usize, estimate: Estimate| {
            if let Some(out) = out.get_mut(pixel) {
                out.write(c_estimate(&estimate));
            }
        };
        Ok(dispatch::estimate_image(&core, &image, samples, workspace, &mut write)?)
    })())
}

/// `len` elements; none for NULL.
///
/// # Safety
/// As for [`convert::slice`].
unsafe fn array<'a, T>(pointer: *const T, len: usize) -> Result<&'a [T], nf_status> {
    // SAFETY: passed on to the caller.
    if pointer.is_null() { Ok(&[]) } else { unsafe { convert::slice(pointer, len) } }
}

/// What is wrong with an image.
pub(crate) fn check_image(image: &nf_cv_image) -> Result<(), Wrong> {
    Ok(core_image(image, false)?.check_windows()?)
}

/// The core's configuration.
fn supported(config: &nf_cv_config) -> Result<Config, nf_status> {
    let core = core_config(config)?;
    // All is computed in float, but a wrong number is an error.
    is_narrow(config)?;
    ensure(core.controls == 0, NF_ERR_UNSUPPORTED)?;
    Ok(core)
}

/// The image without its arrays; of `known` and `surfaces` only whether there are any, on which the workspace depends.
fn core_image(image: &nf_cv_image, has_known: bool) -> Result<Image<'static>, Wrong> {
    let [width, height, frames, window, stride] =
        [image.width, image.height, image.frames, image.window, image.stride].map(|value| value as usize);
    let unordered = pick(image.unordered, &[false, true], c"unordered must be 0 or 1")?;
    let known: &[f32] = if has_known { &[0.0] } else { &[] };
    let surfaces: &[u32] = if image.surfaces.is_null() { &[] } else { &[0] };
    let rectangle = |of: &nf_cv_rectangle| {
        let [x, y, width, height] = [of.x, of.y, of.width, of.height].map(|value| value as usize);
        Rectangle::new(x, y, width, height)
    };
    let (given, wanted) = (rectangle(&image.given), rectangle(&image.wanted));
    let all = Image { samples: image.samples, frames, window, stride, unordered, ..Image::new(width, height) };
    Ok(Image { surfaces, known, given, wanted, ..all })
}
