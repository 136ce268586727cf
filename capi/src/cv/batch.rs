//! Estimates from arrays of samples.

use super::config::{c_estimate, check_core, core_config, is_narrow, nf_cv_config, nf_estimate};
use super::samples::{self, nf_cv_samples};
use crate::convert;
use crate::dispatch;
use crate::status::*;
use core::ffi::c_void;
use noisefloor_core::control_variate::{self as cv, NonFinite, Samples};

/// What estimates from arrays are computed in: the best that the library was built for.
#[cfg(feature = "double")]
pub(super) type Best = f64;
#[cfg(not(feature = "double"))]
pub(super) type Best = f32;

/// Bytes of workspace for n samples of each integral, or fewer; never less for more. 0 where nf_check() refuses,
/// the solver or a library for float alone takes fewer samples, or no memory is enough.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_workspace_size(config: *const nf_cv_config, n: usize) -> usize {
    let len = || {
        // SAFETY: the caller's pointer, checked there for NULL and alignment.
        let config = unsafe { convert::reference(config) }?;
        is_narrow(config)?;
        Ok::<_, nf_status>(cv::workspace_len::<Best>(&core_config(config)?, n)?)
    };
    len().ok().and_then(|len| len.checked_mul(size_of::<Best>())).unwrap_or(0)
}

/// Estimates `integrals` integrals from `samples->n` samples of each, apart from each other: out[integrals]. Nothing of
/// the workspace, nf_cv_workspace_size() bytes, is kept.
///
/// NF_ERR_RANGE: the configuration, a coordinate, 2^32 samples, more than the solver takes or than a memory can hold;
/// NF_ERR_NOT_FINITE: a sample; NF_ERR_NO_SAMPLES; NF_ERR_MEMORY: the workspace; NF_ERR_UNSUPPORTED: what nf_check()
/// says excludes each other, `known` and its integrals, or of several integrals `controls` and NF_NONFINITE_SKIP.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_estimate(
    config: *const nf_cv_config,
    samples: *const nf_cv_samples,
    integrals: usize,
    workspace: *mut c_void,
    bytes: usize,
    out: *mut nf_estimate,
) -> nf_status {
    status((|| {
        // SAFETY: the caller's pointers, each checked there.
        let (config, given) = unsafe { (convert::reference(config)?, convert::reference(samples)?) };
        let core = core_config(config)?;
        is_narrow(config)?;
        let is_plain = core.controls == 0 && core.non_finite == NonFinite::Error;
        ensure(integrals <= 1 || is_plain, NF_ERR_UNSUPPORTED)?;
        if given.n > 0 && integrals == 0 {
            return Ok(check_core(&core)?);
        }
        // SAFETY: the caller's arrays and workspace, of the lengths the header states.
        let (samples, out, workspace) = unsafe {
            let samples = samples::read(&core, given, integrals, false)?;
            let len = cv::workspace_len::<Best>(&core, given.n)?;
            (samples, convert::rooms(out, integrals)?, convert::workspace::<Best>(workspace, bytes, len)?)
        };
        if let [out] = out {
            out.write(c_estimate(&dispatch::estimate(&core, samples, workspace)?));
            return Ok(());
        }
        let (n, stride) = (given.n, core.step());
        let integral = |index: usize| {
            let (first, end) = (index * n, (index + 1) * n);
            // The last row may end early.
            let u = samples.u.get(first * stride..(end * stride).min(samples.u.len()));
            let f = samples.f.get(first * core.channels..end * core.channels);
            Samples::new(u.unwrap_or_default(), f.unwrap_or_default())
        };
        // Before anything is written.
        (0..integrals).try_for_each(|index| integral(index).check(&core))?;
        for (index, out) in out.iter_mut().enumerate() {
            out.write(c_estimate(&dispatch::estimate(&core, integral(index), workspace)?));
        }
        Ok(())
    })())
}
