//! Estimates from arrays of samples.

use super::config::{c_estimate, core_config, is_narrow, nf_cv_config, nf_estimate};
use crate::convert;
use crate::dispatch;
use crate::status::*;
use noisefloor_core::Error;
use noisefloor_core::control_variate::{self as cv, Config, Samples};

/// Bytes of workspace that nf_cv_estimate() and its variants need for n samples; 0 for a configuration that is NULL,
/// out of range or unsupported, or a size no memory has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_workspace_size(config: *const nf_cv_config, n: usize) -> usize {
    // SAFETY: the caller's pointer, checked there for NULL and alignment.
    let Ok(config) = (unsafe { convert::reference(config) }) else { return 0 };
    size(
        config,
        |config, narrow| {
            if narrow { cv::workspace_len::<f32>(config, n) } else { cv::workspace_len::<f64>(config, n) }
        },
    )
}

/// Estimates an integral from n samples: u has n rows of `stride` floats (the last may end after `dims`), f has n rows
/// of `channels`. The workspace's content is used up.
///
/// NF_ERR_RANGE for a configuration or coordinate out of range, NF_ERR_NOT_FINITE for a NaN or infinity (but see
/// NF_NONFINITE_SKIP), NF_ERR_NO_SAMPLES for n = 0, NF_ERR_MEMORY and NF_ERR_ALIGNMENT for the workspace,
/// NF_ERR_UNSUPPORTED for options that exclude each other.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_estimate(
    config: *const nf_cv_config,
    u: *const f32,
    f: *const f32,
    n: usize,
    workspace: *mut core::ffi::c_void,
    bytes: usize,
    out: *mut nf_estimate,
) -> nf_status {
    // SAFETY: the caller's arrays; there are no control functions.
    unsafe {
        nf_cv_estimate_with_controls(config, u, f, core::ptr::null(), core::ptr::null(), n, workspace, bytes, out)
    }
}

/// As nf_cv_estimate(), with `controls` functions h of known integral (4.18): h has n rows of `controls` floats, the
/// functions at the samples, and h_integral their integrals. Both may be NULL if `controls` is 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_estimate_with_controls(
    config: *const nf_cv_config,
    u: *const f32,
    f: *const f32,
    h: *const f32,
    h_integral: *const f32,
    n: usize,
    workspace: *mut core::ffi::c_void,
    bytes: usize,
    out: *mut nf_estimate,
) -> nf_status {
    status((|| {
        // SAFETY: the caller's pointers, each checked there.
        let (config, out) = unsafe { (convert::reference(config)?, convert::room(out)?) };
        let (core, narrow) = (core_config(config)?, is_narrow(config)?);
        // SAFETY: the caller's arrays, of the lengths the header states.
        let samples = unsafe { samples(&core, u, f, h, h_integral, n)? };
        let estimate = if narrow {
            // SAFETY: the caller's workspace, `bytes` long.
            let workspace =
                unsafe { convert::workspace::<f32>(workspace, bytes, len(cv::workspace_len::<f32>(&core, n))?)? };
            dispatch::estimate(&core, samples, workspace)
        } else {
            // SAFETY: the caller's workspace, `bytes` long.
            let workspace =
                unsafe { convert::workspace::<f64>(workspace, bytes, len(cv::workspace_len::<f64>(&core, n))?)? };
            dispatch::estimate(&core, samples, workspace)
        };
        out.write(c_estimate(&estimate.map_err(status_of)?));
        Ok(())
    })())
}

/// As nf_cv_estimate() with NF_CV_GRADIENT_DESCENT, which `estimator` must be, starting from `coefficients`, `channels`
/// rows (1 for a luminance ratio) of nf_cv_terms() - 1 floats in the values' unit, and leaving the solution there: a
/// previous frame's is a good start (4.2.6). A channel whose descent diverges is its mean, and its coefficients are 0.
/// NF_ERR_UNSUPPORTED for another estimator or `controls`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_gradient_descent(
    config: *const nf_cv_config,
    u: *const f32,
    f: *const f32,
    n: usize,
    coefficients: *mut f32,
    workspace: *mut core::ffi::c_void,
    bytes: usize,
    out: *mut nf_estimate,
) -> nf_status {
    status((|| {
        // SAFETY: the caller's pointers, each checked there.
        let (config, out) = unsafe { (convert::reference(config)?, convert::room(out)?) };
        let (core, narrow) = (core_config(config)?, is_narrow(config)?);
        if core.estimator != cv::Estimator::GradientDescent || core.controls > 0 {
            return Err(NF_ERR_UNSUPPORTED);
        }
        let rows = if core.color == cv::Color::LuminanceRatio { 1 } else { core.channels };
        let columns = core.terms().map_err(status_of)? - 1;
        // SAFETY: the caller's arrays, of the lengths the header states.
        let samples = unsafe { samples(&core, u, f, core::ptr::null(), core::ptr::null(), n)? };
        // SAFETY: as above.
        let coefficients = unsafe { convert::slice_mut(coefficients, convert::product(rows, columns)?)? };
        let estimate = if narrow {
            // SAFETY: the caller's workspace, `bytes` long.
            let workspace =
                unsafe { convert::workspace::<f32>(workspace, bytes, len(cv::workspace_len::<f32>(&core, n))?)? };
            cv::gradient_descent(&core, samples, coefficients, workspace)
        } else {
            // SAFETY: the caller's workspace, `bytes` long.
            let workspace =
                unsafe { convert::workspace::<f64>(workspace, bytes, len(cv::workspace_len::<f64>(&core, n))?)? };
            cv::gradient_descent(&core, samples, coefficients, workspace)
        };
        out.write(c_estimate(&estimate.map_err(status_of)?));
        Ok(())
    })())
}

/// # Safety
/// Non-NULL pointers must point to as many floats as the configuration says for n samples.
pub(super) unsafe fn samples<'a>(
    config: &Config,
    u: *const f32,
    f: *const f32,
    h: *const f32,
    h_integral: *const f32,
    n: usize,
) -> Result<Samples<'a>, nf_status> {
    // What a configuration out of range says about lengths means nothing; these fields are all that matters here.
    let in_range = config.dims <= 16 && config.channels <= 4 && config.controls <= 4;
    if !in_range || (config.stride != 0 && config.stride < config.dims) {
        return Err(NF_ERR_RANGE);
    }
    if n == 0 {
        return Err(NF_ERR_NO_SAMPLES);
    }
    let stride = if config.stride == 0 { config.dims } else { config.stride };
    let u_len = convert::product(n - 1, stride)?.checked_add(config.dims).ok_or(NF_ERR_RANGE)?;
    // SAFETY: the caller's promise, see above.
    unsafe {
        Ok(Samples {
            u: convert::slice(u, u_len)?,
            f: convert::slice(f, convert::product(n, config.channels)?)?,
            controls: convert::slice(h, convert::product(n, config.controls)?)?,
            control_integrals: convert::slice(h_integral, config.controls)?,
        })
    }
}

/// Bytes for a count of numbers, 0 for an error.
pub(super) fn size(config: &nf_cv_config, count: impl Fn(&Config, bool) -> Result<usize, Error>) -> usize {
    let (Ok(core), Ok(narrow)) = (core_config(config), is_narrow(config)) else { return 0 };
    let width = if narrow { size_of::<f32>() } else { size_of::<f64>() };
    count(&core, narrow).ok().and_then(|count| count.checked_mul(width)).unwrap_or(0)
}

pub(super) fn len(count: Result<usize, Error>) -> Result<usize, nf_status> {
    count.map_err(status_of)
}
