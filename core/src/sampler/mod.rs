//! The default sampler: numbers for any pixel, sample and decision of a path, whose error is the least visible.
//!
//! One table serves any number of samples. Each pixel has a sequence of its own, of which the first 1, 2, 4, ... points
//! are (0, m, 2)-nets; neighbours' sequences are so arranged that a filter, a denoiser or the eye removes most of the
//! error that remains. That is the aim of chapter 5, not its method, which makes [tiles](crate::tile). There is nothing
//! to choose and no state to keep: any sample can be had in any order.
//!
//! - [`Sampler`]: one sample of one pixel. Each decision of a path (lens, light, bounce) has a *domain*, a child of the
//!   sampler by a key of its own.
//! - [`fill()`]: many pixels and samples at once, the same bits.
//! - [`table`]: the table, for ports to GPUs.
//!
//! `docs/sampling.md` has a renderer's loop, animation and denoisers. To estimates these samples are
//! [`stratified`](crate::control_variate::Config::stratified).
//!
//! ```
//! use noisefloor::sampler::Sampler;
//!
//! let sampler = Sampler::pixel(10, 20, 0, 0);
//! let [x, y] = sampler.draw();                 // where in the pixel
//! let [a, b] = sampler.domain(1).draw();       // where on the lens
//! let bounce = sampler.domain(2).domain(0);    // the first bounce, and below it its own decisions
//! let [c, d, e] = bounce.domain(7).draw();
//! assert!([x, y, a, b, c, d, e].iter().all(|u| (0.0..1.0).contains(u)));
//! ```

mod net;
pub mod table;

pub use crate::pixels::{PixelSampler, fill, fill_len};

use crate::hash::{FRAMES, SCRAMBLE, child, scrambling};
use crate::matrix::first_mut;
use crate::rng::unit;

/// One sample of one pixel: 16 bytes, to be copied freely. Drawing does not change it. Any value of the fields is
/// valid.
///
/// A sampler stands for a point of a cube with as many dimensions as are asked for, by domain: each decision of a path
/// has its own, [`domain`](Sampler::domain) with a key of its own. A domain's numbers depend on nothing but pixel,
/// frame, index and the keys, so samples can be had in any order and on any thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Sampler {
    /// The domain: 0 is the root, others are hashes of the keys that led there.
    pub domain: u32,
    /// The sample of the pixel.
    pub index: u32,
    /// The pixel's column, its last 16 bits.
    pub x: u16,
    /// The pixel's row, likewise.
    pub y: u16,
    /// 1 if scrambled, 2 if white; other bits mean nothing.
    pub flags: u32,
}

/// Values are exclusive-or hashes of the domain.
const SCRAMBLED: u32 = 1;
/// Pixels are anywhere in the table, so that the error is white.
const WHITE: u32 = 2;

impl Sampler {
    /// Sample `index` of pixel (x, y) in `frame`, any values of each. The root's numbers in frame 0 repeat every
    /// [`table::SIZE`] pixels; elsewhere samples are then in another order, from index 2 on, in each domain and 8 x 8
    /// pixels. Indices 0 and 1 have no other: all numbers of a pixel, of every domain, follow from x and y modulo 32,
    /// and an image has 1,024 different vectors. What is seeded from numbers needs the pixel, too.
    ///
    /// The samples of a pixel are one sequence, best at powers of two; take any number, and stop where you like. Each
    /// frame is the table at another place, and otherwise unrelated to the others. Where frames are averaged, count the
    /// index on, by a viewer in frame 0, by TAA 16 samples per frame number: of the k-th sample so far frame k / 16 and
    /// index k % 16.
    #[inline]
    pub const fn pixel(x: u32, y: u32, frame: u32, index: u32) -> Sampler {
        let domain = if frame == 0 { 0 } else { child(FRAMES, frame) };
        Sampler { domain, index, x: x as u16, y: y as u16, flags: 0 }
    }

    /// The same, but neighbours know nothing of each other: the error is that of each pixel, white over the image. For
    /// denoisers that were made for white noise. At indices 0 and 1 a pixel has one of 1,024 vectors at random.
    #[inline]
    pub const fn white(x: u32, y: u32, frame: u32, index: u32) -> Sampler {
        Sampler { flags: WHITE, ..Sampler::pixel(x, y, frame, index) }
    }

    /// The child domain of a key. Children of different keys are unrelated to each other and to their parent, at
    /// indices 0 and 1 as far as [`pixel`](Sampler::pixel) says; keys mean something only among children of one parent.
    #[inline]
    #[must_use]
    pub const fn domain(self, key: u32) -> Sampler {
        Sampler { domain: child(self.domain, key), ..self }
    }

    /// An independent version for each seed but 0; seed 0 changes nothing.
    ///
    /// It is the table at another place, with all values of each dimension exclusive-or a hash of seed and domain. Over
    /// random seeds every value is uniform, so estimates are unbiased, as far as a hash of 32 bits is random. Nets stay
    /// nets, but neighbours' errors vanish less through a filter: where good images are wanted, and not exact
    /// unbiasedness, take another frame instead. Children of a scrambled sampler are scrambled.
    #[inline]
    #[must_use]
    pub const fn scramble(self, seed: u32) -> Sampler {
        if seed == 0 {
            return self;
        }
        Sampler { domain: child(self.domain ^ SCRAMBLE, seed), flags: self.flags | SCRAMBLED, ..self }
    }

    /// The same domain of the pixel `x` columns to the right and `y` rows down, and of the sample `index` further.
    #[inline]
    #[must_use]
    pub const fn moved(self, x: u32, y: u32, index: u32) -> Sampler {
        let (x, y) = ((self.x as u32).wrapping_add(x) as u16, (self.y as u32).wrapping_add(y) as u16);
        Sampler { x, y, index: self.index.wrapping_add(index), ..self }
    }

    /// N numbers, 1 to 4, of this domain; each in [0, 1), a multiple of 2^-24.
    ///
    /// The first two are optimised together. All four are stratified together, as a net is, as far as that is possible;
    /// across pixels the last two are as good as the first, but with these they are not arranged.
    // As `net::point`: without, draws take 6 to 9 % more instructions.
    #[inline(always)]
    pub fn draw<const N: usize>(&self) -> [f32; N] {
        const { assert!(0 < N && N <= 4, "a domain has 1 to 4 numbers") };
        let mut fixed = net::point::<N>(self);
        if self.flags & SCRAMBLED != 0 {
            for (dim, value) in (1..).zip(&mut fixed) {
                *value ^= scrambling(self.domain, dim);
            }
        }
        fixed.map(unit)
    }

    /// Draws `dims` numbers, 1 to 4, of this sample and of those that follow it: sample k's to `u[k * stride..]`, for
    /// as many samples as `u` has room for. Draws nothing for other `dims`; a stride of less than `dims` is `dims`.
    #[inline]
    pub fn draw_samples(&self, dims: usize, stride: usize, u: &mut [f32]) {
        if (1..=4).contains(&dims) {
            let mut sample = *self;
            for u in u.chunks_mut(stride.max(dims)) {
                sample.draw_into(first_mut(u, dims));
                sample = sample.moved(0, 0, 1);
            }
        }
    }
}

crate::pixels::draws!(Sampler);
