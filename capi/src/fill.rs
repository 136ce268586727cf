//! Many pixels and samples in one call, of any sampler.

use crate::convert;
use crate::status::*;
use crate::wrong::Wrong;
use noisefloor_core::sampler::{self, PixelSampler};

/// Draws for all pixels and samples, as [`sampler::fill`] does, `of` each of the caller's samplers, which must pass
/// `check`.
///
/// # Safety
/// Samplers and dims must be NULL or point to `domains` of them, `u` to `len` numbers.
pub(crate) unsafe fn fill<'a, T: 'a, S: PixelSampler>(
    (samplers, dims, domains): (*const T, *const u32, usize),
    sizes: [u32; 3],
    (u, len): (*mut f32, usize),
    check: impl FnMut(&'a T) -> Result<(), Wrong>,
    of: impl Fn(&'a T) -> S + Clone,
) -> nf_status {
    status((|| {
        // SAFETY: passed on to the caller.
        let samplers = unsafe { convert::slice(samplers, domains)? };
        samplers.iter().try_for_each(check)?;
        // SAFETY: passed on to the caller.
        let dims = unsafe { convert::slice(dims, domains)? };
        let domains = samplers.iter().map(of).zip(dims.iter().map(|&dims| dims as usize));
        let [width, height, samples] = sizes.map(|size| size as usize);
        let needed = sampler::fill_len(domains.clone(), width, height, samples).ok_or(NF_ERR_RANGE)?;
        ensure(len >= needed, NF_ERR_MEMORY)?;
        // SAFETY: the caller passes room for `len` numbers, which are no fewer.
        let u = unsafe { convert::outputs(u, needed) }?;
        Ok(sampler::fill(domains, width, height, samples, u)?)
    })())
}
