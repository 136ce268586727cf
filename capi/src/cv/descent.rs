//! The fit by gradient descent, with its options and its solution.

use super::batch::Best;
use super::config::{c_estimate, check_core, core_config, is_narrow, nf_cv_config, nf_estimate};
use super::samples::{self, nf_cv_samples};
use crate::convert;
use crate::status::*;
use crate::wrong::{Wrong, pick};
use core::ffi::c_void;
use noisefloor_core::control_variate::{self as cv, Config, Estimator, Optimizer};

/// Heavy-ball momentum. The default.
pub const NF_OPTIMIZER_MOMENTUM: u32 = 0;
/// Adam.
pub const NF_OPTIMIZER_ADAM: u32 = 1;
/// Plain steps (4.29).
pub const NF_OPTIMIZER_PLAIN: u32 = 2;

/// How nf_cv_gradient_descent() steps. Zero in any field is its default.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct nf_cv_descent {
    /// NF_OPTIMIZER_*
    pub optimizer: u32,
    /// Steps, at most 2^20; by default half as many as samples, 8 to 128.
    pub iterations: u32,
    /// Step length, at least 0: for Adam in standard deviations of values (.05), else over the largest curvature (1).
    pub learning_rate: f32,
    /// At least 0, below 1; 0 means .5, for Adam .9. Plain steps have none.
    pub momentum: f32,
}

/// nf_cv_estimate() of one integral by NF_CV_GRADIENT_DESCENT, which `estimator` must be, from a start: `coefficients`
/// are `channels` rows (1 for a luminance ratio) of nf_cv_terms() - 1 floats in the values' unit, and the solution
/// afterwards. The solution of a previous frame is a good start (section 4.2.6). A channel whose descent ends farther
/// from the values than their mean is that mean; its coefficients are then 0, unless they came nearer than the start.
///
/// Other errors as for nf_cv_estimate(); NF_ERR_RANGE also for the descent, NF_ERR_NOT_FINITE for the start,
/// NF_ERR_UNSUPPORTED for another estimator and `controls`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_gradient_descent(
    config: *const nf_cv_config,
    samples: *const nf_cv_samples,
    descent: *const nf_cv_descent,
    coefficients: *mut f32,
    workspace: *mut c_void,
    bytes: usize,
    out: *mut nf_estimate,
) -> nf_status {
    status((|| {
        // SAFETY: the caller's pointers, each checked there.
        let (config, given, descent, out) = unsafe {
            let (config, samples) = (convert::reference(config)?, convert::reference(samples)?);
            (config, samples, convert::reference(descent)?, convert::room(out)?)
        };
        let core = with(core_config(config)?, descent)?;
        is_narrow(config)?;
        ensure(core.estimator == Estimator::GradientDescent && core.controls == 0, NF_ERR_UNSUPPORTED)?;
        let columns = core.terms()? - 1;
        // SAFETY: the caller's arrays and workspace, of the lengths the header states.
        let (samples, coefficients, workspace) = unsafe {
            let samples = samples::read(&core, given, 1, false)?;
            let coefficients = convert::slice_mut(coefficients, convert::product(core.regressed(), columns)?)?;
            let len = cv::workspace_len::<Best>(&core, given.n)?;
            (samples, coefficients, convert::workspace::<Best>(workspace, bytes, len)?)
        };
        let estimate = cv::gradient_descent(&core, samples, coefficients, workspace)?;
        out.write(c_estimate(&estimate));
        Ok(())
    })())
}

/// What is wrong with a descent.
pub(crate) fn check_descent(descent: &nf_cv_descent) -> Result<(), Wrong> {
    check_core(&with(Config::new(1, 0, 1), descent)?)
}

/// The core's configuration with that of a descent.
fn with(config: Config, descent: &nf_cv_descent) -> Result<Config, Wrong> {
    let optimizers = [Optimizer::Momentum, Optimizer::Adam, Optimizer::Plain];
    Ok(Config {
        optimizer: pick(descent.optimizer, &optimizers, c"optimizer must be one of NF_OPTIMIZER_*, 0 to 2")?,
        iterations: descent.iterations as usize,
        learning_rate: descent.learning_rate,
        momentum: descent.momentum,
        ..config
    })
}
