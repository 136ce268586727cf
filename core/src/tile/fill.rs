//! Many pixels and samples at once, for renderers that work on whole images.

use super::sampler::Sampler;
use crate::{Error, pixels};

/// How many numbers [`fill`] writes; `None` for more than memory holds.
pub fn fill_len(domains: &[(Sampler<'_>, usize)], width: usize, height: usize, samples: usize) -> Option<usize> {
    pixels::len(domains.iter().map(|&(_, dims)| dims), width, height, samples)
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
    pixels::fill(domains, [width, height, samples], u, |sampler, [x, y], dims, stride, u| {
        sampler.moved(x, y, 0).draw_samples(dims, stride, u);
    })
}
