//! Many pixels and samples at once, for renderers that work on whole images.

use super::Sampler;
use crate::error::Error;

/// Draws for `width x height` pixels, `samples` samples of each, in several domains: the same bits as single draws.
///
/// Each of `domains` is a sampler, for the first pixel and sample, and how many numbers to draw from it, 1 to
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
/// fill(|| [(sampler, 2)], 3, 2, 1, &mut u)?;
/// assert_eq!(u[4..6], sampler.moved(2, 0, 0).draw::<2>());
/// # Ok::<(), noisefloor::Error>(())
/// ```
#[inline(always)]
pub fn fill<D: IntoIterator<Item = (Sampler, usize)>>(
    domains: impl Fn() -> D,
    width: usize,
    height: usize,
    samples: usize,
    u: &mut [f32],
) -> Result<(), Error> {
    let mut sum = 0_usize;
    for (_, dims) in domains() {
        sum = if (1..=4).contains(&dims) {
            sum.checked_add(dims).ok_or(Error::Range)?
        } else {
            return Err(Error::Range);
        };
    }
    let len = [height, samples, sum].into_iter().try_fold(width, usize::checked_mul).ok_or(Error::Range)?;
    let mut rest = u.get_mut(..len).ok_or(Error::Memory)?;
    // Without domains or samples, as many places as there may be have nothing to draw.
    if len == 0 {
        return Ok(());
    }
    for y in 0..height {
        for x in 0..width {
            for sample in 0..samples {
                for (sampler, dims) in domains() {
                    let (own, others) = rest.split_at_mut_checked(dims).unwrap_or_default();
                    sampler.moved(x as u32, y as u32, sample as u32).draw_into(own);
                    rest = others;
                }
            }
        }
    }
    Ok(())
}
