//! Many pixels and samples in one call, of any sampler.

use crate::convert;
use crate::status::*;

/// How many numbers that is, if every one of dims is 1..4 and memory can have as many.
fn checked_len(dims: &[u32], width: u32, height: u32, samples: u32) -> Option<usize> {
    let mut sum = 0_usize;
    for &dims in dims {
        sum = if (1..=4).contains(&dims) { sum.checked_add(dims as usize)? } else { return None };
    }
    let len = (width as usize).checked_mul(height as usize)?.checked_mul(samples as usize)?.checked_mul(sum)?;
    (len <= isize::MAX as usize / size_of::<f32>()).then_some(len)
}

/// Draws for all pixels and samples: `draw(sampler, [x, y], dims, stride, u)` writes one domain of one pixel, `dims`
/// numbers of each sample, every `stride`.
///
/// # Safety
/// Samplers and dims must be NULL or point to `domains` of them, `u` to `len` numbers.
#[inline(always)]
pub(crate) unsafe fn fill<S>(
    (samplers, dims, domains): (*const S, *const u32, usize),
    [width, height, samples]: [u32; 3],
    (u, len): (*mut f32, usize),
    draw: impl Fn(&S, [u32; 2], usize, usize, &mut [f32]),
) -> Result<(), nf_status> {
    // SAFETY: passed on to the caller.
    let (samplers, dims) = unsafe { (convert::slice(samplers, domains)?, convert::slice(dims, domains)?) };
    let needed = checked_len(dims, width, height, samples).ok_or(NF_ERR_RANGE)?;
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
    let places = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    for (mut pixel, place) in pixels.zip(places) {
        for (sampler, &dims) in samplers.iter().zip(dims) {
            draw(sampler, place, dims as usize, sample, pixel);
            pixel = pixel.get_mut(dims as usize..).unwrap_or_default();
        }
    }
    Ok(())
}
