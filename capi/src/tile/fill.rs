//! Many pixels and samples in one call.

use super::sampler::{nf_tile_sampler, state};
use super::view::core_view;
use crate::convert;
use crate::status::*;
use noisefloor_core::tile::Sampler;

/// How many numbers nf_tile_sampler_fill writes: width * height * samples * (the sum of dims). 0 if one of dims is
/// outside 1..4, or memory has not that many.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_tile_sampler_fill_len(
    dims: *const u32,
    domains: usize,
    width: u32,
    height: u32,
    samples: u32,
) -> usize {
    // SAFETY: the caller passes `domains` numbers.
    let Ok(dims) = (unsafe { convert::slice(dims, domains) }) else { return 0 };
    fill_len(dims, width, height, samples).unwrap_or(0)
}

/// Draws for many pixels and samples at once, for renderers that work on whole images. The same bits as single draws.
///
/// samplers[domains]: one for each domain, all at the first pixel and the first sample. dims[domains]: how many numbers
/// to draw from each, 1..4. width, height: how many pixels, to the right and down. samples: how many samples of each,
/// by ascending index. u[height][width][samples][sum of dims]: what the samplers draw there, one after the other; len
/// numbers are there, at least nf_tile_sampler_fill_len.
///
/// NF_ERR_NULL; NF_ERR_ALIGNMENT; NF_ERR_RANGE: dims, or sizes that memory cannot have; NF_ERR_MEMORY: len.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_tile_sampler_fill(
    samplers: *const nf_tile_sampler,
    dims: *const u32,
    domains: usize,
    width: u32,
    height: u32,
    samples: u32,
    u: *mut f32,
    len: usize,
) -> nf_status {
    status((|| {
        // SAFETY: the caller passes `domains` samplers and numbers.
        let (samplers, dims) = unsafe { (convert::slice(samplers, domains)?, convert::slice(dims, domains)?) };
        let needed = fill_len(dims, width, height, samples).ok_or(NF_ERR_RANGE)?;
        // Without domains or samples, as many places as there may be have nothing to draw.
        if needed == 0 {
            return Ok(());
        }
        if len < needed {
            return Err(NF_ERR_MEMORY);
        }
        // SAFETY: the caller passes room for `len` numbers, which are no fewer.
        let u = unsafe { convert::outputs(u, needed) }?;
        let sample = dims.iter().fold(0_usize, |sum, &dims| sum.wrapping_add(dims as usize));
        let pixels = u.chunks_exact_mut(sample.wrapping_mul(samples as usize).max(1));
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (y, x)));
        for (mut pixel, (y, x)) in pixels.zip(places) {
            for (sampler, &dims) in samplers.iter().zip(dims) {
                // SAFETY: the caller passes samplers whose tiles, checked by nf_tile_sampler_pixel, are NULL or live.
                unsafe { samples_of(sampler, x, y, dims as usize, sample, pixel) };
                pixel = pixel.get_mut(dims as usize..).unwrap_or_default();
            }
        }
        Ok(())
    })())
}

/// One domain of one pixel: `dims` numbers of each sample, every `stride`.
///
/// # Safety
/// The sampler's tile must be NULL or live.
#[inline(always)]
unsafe fn samples_of(sampler: &nf_tile_sampler, x: u32, y: u32, dims: usize, stride: usize, u: &mut [f32]) {
    // SAFETY: passed on to the caller.
    match unsafe { core_view(sampler.tile) } {
        Some(tile) => Sampler::resume(&tile, state(sampler)).moved(x, y, 0).draw_samples(dims, stride, u),
        None => u.chunks_mut(stride.max(1)).filter_map(|u| u.get_mut(..dims)).for_each(|u| u.fill(0.0)),
    }
}

/// How many numbers that are, if memory can have as many.
pub(crate) fn fill_len(dims: &[u32], width: u32, height: u32, samples: u32) -> Option<usize> {
    let mut sum = 0_usize;
    for &dims in dims {
        sum = if (1..=4).contains(&dims) { sum.checked_add(dims as usize)? } else { return None };
    }
    let len = (width as usize).checked_mul(height as usize)?.checked_mul(samples as usize)?.checked_mul(sum)?;
    (len <= isize::MAX as usize / size_of::<f32>()).then_some(len)
}
