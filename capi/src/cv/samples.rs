//! Samples, as all estimates take them.

use crate::convert;
use crate::status::*;
use noisefloor_core::control_variate::{Config, Samples};

/// Samples of integrals, row after row. What there is not is zero: `nf_cv_samples s = {.u = u, .f = f, .n = n};`.
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct nf_cv_samples {
    /// n rows of `stride` floats, uniform as drawn, of which the first `dims` count; the last may end after them.
    pub u: *const f32,
    /// n rows of `channels` floats.
    pub f: *const f32,
    /// Samples of each integral; below 2^32, of an image in all. Of several, arrays hold one after the other.
    pub n: usize,
    /// n rows of `controls` floats: functions of known integral at the samples (4.18).
    pub controls: *const f32,
    /// The integrals of the `controls` functions, finite.
    pub control_integrals: *const f32,
    /// For nf_cv_image_estimate(), n rows of `channels` finite floats: f with nothing in the way, the unshadowed light.
    /// Pixels are then also corrected by how far its mean is from `known_integrals`, as far as neighbours follow it.
    pub known: *const f32,
    /// With `known`: `channels` floats for each pixel, its exact integrals over u, those of a polygon, say. Finite, at
    /// least 0; a pixel with 0 is not corrected by it. Where a pixel's samples see several points, the mean of theirs.
    pub known_integrals: *const f32,
}

/// What an estimate reads: the arrays of `integrals` times n rows. `knows`: whether it takes `known`.
///
/// # Safety
/// Non-NULL pointers must point to as many floats as the configuration says for so many rows.
pub(super) unsafe fn read<'a>(
    config: &Config,
    samples: &nf_cv_samples,
    integrals: usize,
    knows: bool,
) -> Result<Samples<'a>, nf_status> {
    let has_known = !samples.known.is_null() || !samples.known_integrals.is_null();
    ensure(knows || !has_known, NF_ERR_UNSUPPORTED)?;
    // What a configuration out of range says about lengths means nothing; these fields are all that matters here.
    let in_range = config.dims <= 16 && config.channels <= 4 && config.controls <= 4;
    ensure(in_range && config.step() >= config.dims, NF_ERR_RANGE)?;
    let rows = convert::product(samples.n, integrals)?;
    let last = rows.checked_sub(1).ok_or(NF_ERR_NO_SAMPLES)?;
    let u_len = convert::product(last, config.step())?.checked_add(config.dims).ok_or(NF_ERR_RANGE)?;
    // SAFETY: the caller's promise, see above.
    unsafe {
        Ok(Samples {
            u: convert::slice(samples.u, u_len)?,
            f: convert::slice(samples.f, convert::product(rows, config.channels)?)?,
            controls: convert::slice(samples.controls, convert::product(rows, config.controls)?)?,
            control_integrals: convert::slice(samples.control_integrals, config.controls)?,
        })
    }
}
