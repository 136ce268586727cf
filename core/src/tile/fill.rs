//! Many pixels and samples at once, for renderers that work on whole images.

use super::sampler::Sampler;
use crate::Error;

/// How many numbers [`fill`] writes; `None` for more than memory holds.
pub fn fill_len(domains: &[(Sampler<'_>, usize)], width: usize, height: usize, samples: usize) -> Option<usize> {
    let dims = domains.iter().try_fold(0_usize, |sum, &(_, dims)| sum.checked_add(dims))?;
    width.checked_mul(height)?.checked_mul(samples)?.checked_mul(dims)
}

/// Draws for `width x height` pixels, `samples` samples of each, in several domains: the same bits as single draws.
///
/// Each element of `domains` is a sampler, for the first pixel and sample, and how many dimensions to draw from it, 1
/// to 4. `u[y][x][sample][..]` is what those samplers, moved by y rows, x columns and `sample` samples, draw, one after
/// the other: [`fill_len`] numbers; more stay as they are.
///
/// # Errors
/// [`Error::Range`] for dims outside 1 to 4 or sizes that overflow; [`Error::Memory`] if `u` is too short.
///
/// ```
/// use noisefloor::tile::{Sampler, Shape, Tile, fill};
///
/// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
/// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
/// let tile = Tile::new(shape, &payload)?;
/// let sampler = Sampler::pixel(&tile, 0, 0, 0, 0).domain(1);
/// let mut u = [0.0; 3 * 2 * 2]; // 3 columns, 2 rows, 2 numbers
/// fill(&[(sampler, 2)], 3, 2, 1, &mut u)?;
/// assert_eq!(u[4..6], sampler.moved(2, 0, 0).draw::<2>());
/// # Ok::<(), noisefloor::Error>(())
/// ```
pub fn fill(
    domains: &[(Sampler<'_>, usize)],
    width: usize,
    height: usize,
    samples: usize,
    u: &mut [f32],
) -> Result<(), Error> {
    if domains.iter().any(|&(_, dims)| !(1..=4).contains(&dims)) {
        return Err(Error::Range);
    }
    let len = fill_len(domains, width, height, samples).ok_or(Error::Range)?;
    // Without domains or samples, as many places as there may be have nothing to draw.
    if len == 0 {
        return Ok(());
    }
    let u = u.get_mut(..len).ok_or(Error::Memory)?;
    let sample = domains.iter().fold(0_usize, |sum, &(_, dims)| sum.wrapping_add(dims));
    let pixels = u.chunks_exact_mut(sample.wrapping_mul(samples).max(1));
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (y, x)));
    for (mut pixel, (y, x)) in pixels.zip(places) {
        for &(sampler, dims) in domains {
            sampler.moved(x as u32, y as u32, 0).draw_samples(dims, sample, pixel);
            pixel = pixel.get_mut(dims..).unwrap_or_default();
        }
    }
    Ok(())
}
