//! Many pixels and samples at once: what all samplers' `fill` share.

use crate::error::Error;

/// How many numbers so many dims of each domain are; `None` for more than memory holds.
pub(crate) fn len(dims: impl Iterator<Item = usize>, width: usize, height: usize, samples: usize) -> Option<usize> {
    let dims = dims.into_iter().try_fold(0_usize, |sum, dims| sum.checked_add(dims))?;
    width.checked_mul(height)?.checked_mul(samples)?.checked_mul(dims)
}

/// Draws for `width x height` pixels, `samples` samples of each: `draw(sampler, [x, y], dims, stride, u)` writes the
/// numbers that a sampler, moved by x columns and y rows, draws from a pixel's samples, every `stride`.
#[inline(always)]
pub(crate) fn fill<S>(
    domains: &[(S, usize)],
    [width, height, samples]: [usize; 3],
    u: &mut [f32],
    draw: impl Fn(&S, [u32; 2], usize, usize, &mut [f32]),
) -> Result<(), Error> {
    let dims = || domains.iter().map(|&(_, dims)| dims);
    if !dims().all(|dims| (1..=4).contains(&dims)) {
        return Err(Error::Range);
    }
    let len = len(dims(), width, height, samples).ok_or(Error::Range)?;
    // Without domains or samples, as many places as there may be have nothing to draw.
    if len == 0 {
        return Ok(());
    }
    let u = u.get_mut(..len).ok_or(Error::Memory)?;
    let sample = dims().fold(0_usize, usize::wrapping_add);
    let pixels = u.chunks_exact_mut(sample.wrapping_mul(samples).max(1));
    let places = (0..height).flat_map(|y| (0..width).map(move |x| [x as u32, y as u32]));
    for (mut pixel, place) in pixels.zip(places) {
        for (sampler, dims) in domains {
            draw(sampler, place, *dims, sample, pixel);
            pixel = pixel.get_mut(*dims..).unwrap_or_default();
        }
    }
    Ok(())
}
