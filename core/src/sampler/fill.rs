//! Many pixels and samples at once, for renderers that work on whole images.

use super::Sampler;
use crate::error::Error;
use crate::pixels;

/// Draws for `width x height` pixels, `samples` samples of each, in several domains: the same bits as single draws.
///
/// Each element of `domains` is a sampler, for the first pixel and sample, and how many numbers to draw from it, 1 to
/// 4. `u[y][x][sample][..]` is what those samplers, moved by y rows, x columns and `sample` samples, draw, one after
/// the other; more numbers stay as they are.
///
/// # Errors
/// [`Error::Range`] for dims outside 1 to 4 or sizes that overflow; [`Error::Memory`] if `u` is too short.
///
/// ```
/// use noisefloor::sampler::{Sampler, fill};
///
/// let sampler = Sampler::pixel(0, 0, 0, 0).domain(1);
/// let mut u = [0.0; 3 * 2 * 2]; // 3 columns, 2 rows, 2 numbers
/// fill(&[(sampler, 2)], 3, 2, 1, &mut u)?;
/// assert_eq!(u[4..6], sampler.moved(2, 0, 0).draw::<2>());
/// # Ok::<(), noisefloor::Error>(())
/// ```
pub fn fill(
    domains: &[(Sampler, usize)],
    width: usize,
    height: usize,
    samples: usize,
    u: &mut [f32],
) -> Result<(), Error> {
    pixels::fill(domains, [width, height, samples], u, |sampler, [x, y], dims, stride, u| {
        sampler.moved(x, y, 0).draw_samples(dims, stride, u);
    })
}
