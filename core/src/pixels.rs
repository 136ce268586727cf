//! Many pixels and samples at once, for renderers that work on whole images.

use crate::error::Error;
use crate::matrix::from_mut;
use core::borrow::Borrow;

/// A sampler of which [`fill`] draws.
pub trait PixelSampler {
    /// Writes what the sampler, moved by x columns and y rows, draws from the samples of a pixel: `dims` numbers, 1 to
    /// 4, of each, every `stride`.
    fn draw_pixel(&self, place: [u32; 2], dims: usize, stride: usize, u: &mut [f32]);
}

/// What samplers do by their `draw`, `draw_samples` and `moved`.
macro_rules! draws {
    ($sampler:ty) => {
        impl $sampler {
            /// As [`draw`](Self::draw), as many numbers as `u` has room for, at most 4; more stay as they are.
            #[inline]
            pub fn draw_into(&self, u: &mut [f32]) {
                match u {
                    [a] => [*a] = self.draw(),
                    [a, b] => [*a, *b] = self.draw(),
                    [a, b, c] => [*a, *b, *c] = self.draw(),
                    [a, b, c, d, ..] => [*a, *b, *c, *d] = self.draw(),
                    [] => {}
                }
            }
        }

        impl $crate::pixels::PixelSampler for $sampler {
            #[inline]
            fn draw_pixel(&self, [x, y]: [u32; 2], dims: usize, stride: usize, u: &mut [f32]) {
                self.moved(x, y, 0).draw_samples(dims, stride, u);
            }
        }
    };
}
pub(crate) use draws;

/// How many numbers [`fill`] writes; `None` for dims outside 1 to 4, or for more than memory holds.
pub fn fill_len<S>(
    domains: impl IntoIterator<Item = impl Borrow<(S, usize)>>,
    width: usize,
    height: usize,
    samples: usize,
) -> Option<usize> {
    let mut sum = 0_usize;
    for domain in domains {
        let (_, dims) = domain.borrow();
        sum = if (1..=4).contains(dims) { sum.checked_add(*dims)? } else { return None };
    }
    let len = width.checked_mul(height)?.checked_mul(samples)?.checked_mul(sum)?;
    (len <= isize::MAX as usize / size_of::<f32>()).then_some(len)
}

/// Draws for `width x height` pixels, `samples` samples of each, in several domains: the same bits as single draws.
///
/// Each of `domains` is a sampler, for the first pixel and sample, and how many numbers to draw from it, 1 to 4.
/// `u[y][x][sample][..]` is what those samplers, moved by y rows, x columns and `sample` samples, draw, one after the
/// other: [`fill_len`] numbers; more stay as they are.
///
/// # Errors
/// [`Error::Range`] for dims outside 1 to 4 or sizes that overflow; [`Error::Memory`] if `u` is too short.
///
/// ```
/// # #[cfg(feature = "sampler")] {
/// use noisefloor::sampler::{Sampler, fill};
///
/// let sampler = Sampler::pixel(0, 0, 0, 0).domain(1);
/// let mut u = [0.0; 3 * 2 * 2]; // 3 columns, 2 rows, 2 numbers
/// fill([(sampler, 2)], 3, 2, 1, &mut u)?;
/// assert_eq!(u[4..6], sampler.moved(2, 0, 0).draw::<2>());
/// # }
/// # Ok::<(), noisefloor::Error>(())
/// ```
#[inline]
pub fn fill<S: PixelSampler>(
    domains: impl IntoIterator<Item = impl Borrow<(S, usize)>, IntoIter: Clone>,
    width: usize,
    height: usize,
    samples: usize,
    u: &mut [f32],
) -> Result<(), Error> {
    let domains = domains.into_iter();
    let len = fill_len(domains.clone(), width, height, samples).ok_or(Error::Range)?;
    let u = u.get_mut(..len).ok_or(Error::Memory)?;
    let sample = domains.clone().map(|domain| domain.borrow().1).fold(0, usize::wrapping_add);
    let pixels = u.chunks_exact_mut(sample.wrapping_mul(samples).max(1));
    let places = (0..height).flat_map(|y| (0..width).map(move |x| [x as u32, y as u32]));
    for (mut pixel, place) in pixels.zip(places) {
        for domain in domains.clone() {
            let (sampler, dims) = domain.borrow();
            sampler.draw_pixel(place, *dims, sample, pixel);
            pixel = from_mut(pixel, *dims);
        }
    }
    Ok(())
}
