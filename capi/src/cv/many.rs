//! Many integrals in one call.

use super::batch::{len, samples};
use super::config::{c_estimate, core_config, is_narrow, nf_cv_config, nf_estimate};
use crate::status::*;
use crate::{convert, dispatch};
use noisefloor_core::control_variate::{self as cv, Config, NonFinite, Samples};
use noisefloor_core::real::Real;

/// As nf_cv_estimate() for each of `integrals` integrals, n samples of each: u and f hold integral after integral, out
/// one estimate for each, with the bits of single calls. The workspace is that of one. For interpreters and others
/// whose calls are dear.
///
/// NF_ERR_UNSUPPORTED also for `controls` and NF_NONFINITE_SKIP; else as nf_cv_estimate().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_estimate_many(
    config: *const nf_cv_config,
    u: *const f32,
    f: *const f32,
    n: usize,
    integrals: usize,
    workspace: *mut core::ffi::c_void,
    bytes: usize,
    out: *mut nf_estimate,
) -> nf_status {
    status((|| {
        // SAFETY: the caller's pointer, checked there.
        let config = unsafe { convert::reference(config)? };
        let (core, narrow) = (core_config(config)?, is_narrow(config)?);
        if core.controls > 0 || core.non_finite == NonFinite::Skip {
            return Err(NF_ERR_UNSUPPORTED);
        }
        let (none, rows) = (core::ptr::null(), convert::product(n, integrals)?);
        if rows == 0 {
            return if n == 0 { Err(NF_ERR_NO_SAMPLES) } else { Ok(()) };
        }
        // SAFETY: the caller's arrays, of the lengths the header states.
        let (samples, out) = unsafe { (samples(&core, u, f, none, none, rows)?, convert::rooms(out, integrals)?) };
        if narrow {
            let needed = len(cv::workspace_len::<f32>(&core, n))?;
            // SAFETY: the caller's workspace, `bytes` long.
            estimate(&core, samples, n, unsafe { convert::workspace::<f32>(workspace, bytes, needed)? }, out)
        } else {
            let needed = len(cv::workspace_len::<f64>(&core, n))?;
            // SAFETY: the caller's workspace, `bytes` long.
            estimate(&core, samples, n, unsafe { convert::workspace::<f64>(workspace, bytes, needed)? }, out)
        }
    })())
}

fn estimate<R: Real>(
    config: &Config,
    samples: Samples<'_>,
    n: usize,
    workspace: &mut [R],
    out: &mut [convert::Room<nf_estimate>],
) -> Result<(), nf_status> {
    let stride = if config.stride == 0 { config.dims } else { config.stride };
    check(samples, n * out.len(), stride, config.dims)?;
    for (integral, out) in out.iter_mut().enumerate() {
        let (first, end) = (integral * n, (integral + 1) * n);
        // The last row may end early.
        let u = samples.u.get(first * stride..(end * stride).min(samples.u.len()));
        let f = samples.f.get(first * config.channels..end * config.channels);
        let samples = Samples::new(u.unwrap_or_default(), f.unwrap_or_default());
        out.write(c_estimate(&dispatch::estimate(config, samples, workspace).map_err(status_of)?));
    }
    Ok(())
}

/// Refuses, before anything is written, what a later integral's estimate would refuse.
fn check(samples: Samples<'_>, rows: usize, stride: usize, dims: usize) -> Result<(), nf_status> {
    let u = || (0..rows).filter_map(|row| samples.u.get(row * stride..row * stride + dims)).flatten();
    if !u().chain(samples.f).all(|value| value.is_finite()) {
        return Err(NF_ERR_NOT_FINITE);
    }
    if u().all(|u| (0.0..=1.0).contains(u)) { Ok(()) } else { Err(NF_ERR_RANGE) }
}
