//! The sampler: one sample of one pixel, and the domains below it.
//!
//! | | |
//! |---|---|
//! | pixel | x and y modulo `size` |
//! | root, index < spp | the tile's sample `index`: the value v of b bits is (v + 1/2) / 2^b |
//! | frame | `frame % frames` is the tile's; every later run of `frames` frames is a domain of its own |
//! | domain | a hash of parent and key: the tile shifted, flipped, transposed, its samples in another order |
//! | domain of a progressive tile | the same, but the order changes within octaves only |
//! | further dims | stratified; of progressive tiles, and those of 1 dim or sample, those of one more domain |
//! | index ≥ spp | sample 0 ⊕ o(index), o an Owen-scrambled Sobol sequence of the domain's own, o(0) = 0 |
//! | scramble(seed) | the domain of that seed, its values shifted modulo 1 by a hash of domain and dimension |

use super::view::Tile;
use crate::hash::{FRAMES, SCRAMBLE, child};

/// One sample of one pixel: 24 bytes, to be copied freely. Drawing does not change it.
///
/// A sampler stands for a point of a cube with as many dimensions as are asked for, by domain: each decision of a path
/// has its own, [`domain`](Sampler::domain) with a key of its own. A domain's numbers depend on nothing but tile,
/// pixel, frame, index and the keys, so samples can be had in any order and on any thread.
///
/// ```
/// use noisefloor::tile::{Sampler, Shape, Tile};
///
/// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
/// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
/// let tile = Tile::new(shape, &payload)?;
/// let sampler = Sampler::pixel(&tile, 1, 0, 0, 0);
/// assert_eq!(sampler.draw::<2>(), [128.5 / 256.0, 192.5 / 256.0]);
/// let [a, b, c] = sampler.domain(7).draw(); // another decision, as many numbers as it needs
/// assert!([a, b, c].iter().all(|u| (0.0..1.0).contains(u)));
/// # Ok::<(), noisefloor::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampler<'a> {
    /// The tile it draws from.
    pub tile: &'a Tile<'a>,
    /// The domain: 0 is the root, others are hashes of the keys that led there.
    pub domain: u32,
    /// The sample of the pixel.
    pub index: u32,
    /// The pixel's column, modulo the tile's size.
    pub x: u16,
    /// The pixel's row, modulo the tile's size.
    pub y: u16,
    /// The frame, modulo the tile's frames.
    pub frame: u16,
    /// 1 if scrambled, otherwise 0.
    pub scrambled: u16,
}

impl<'a> Sampler<'a> {
    /// Sample `index` of pixel (x, y), any values: pixels repeat with the tile's size.
    ///
    /// The first `spp` samples are the tile's. Those that follow continue with a scrambled Sobol sequence in their
    /// place.
    ///
    /// Frames 0 to `frames - 1` are the tile's (a tile that is not temporal has one). Each later run of them is the
    /// tile at another place, unrelated to it.
    #[inline]
    pub const fn pixel(tile: &'a Tile<'a>, x: u32, y: u32, frame: u32, index: u32) -> Sampler<'a> {
        let shape = tile.shape();
        let mask = shape.size.wrapping_sub(1);
        let (frame, cycle) = if shape.frames > 1 { (frame % shape.frames, frame / shape.frames) } else { (0, frame) };
        let domain = if cycle == 0 { 0 } else { child(FRAMES, cycle) };
        let (x, y, frame) = ((x & mask) as u16, (y & mask) as u16, frame as u16);
        Sampler { tile, domain, index, x, y, frame, scrambled: 0 }
    }

    /// The child domain of a key, as the default sampler's.
    #[inline]
    #[must_use]
    pub const fn domain(self, key: u32) -> Sampler<'a> {
        Sampler { domain: child(self.domain, key), ..self }
    }

    /// An independent version for each seed but 0, which changes nothing: the tile at another place, all values of each
    /// dimension shifted, modulo 1, by a hash of seed and domain. Tiles' points are seldom nets, and the shift keeps
    /// their distances.
    #[inline]
    #[must_use]
    pub const fn scramble(self, seed: u32) -> Sampler<'a> {
        if seed == 0 {
            return self;
        }
        Sampler { domain: child(self.domain ^ SCRAMBLE, seed), scrambled: 1, ..self }
    }

    /// The same domain of the pixel `x` columns to the right and `y` rows down, and of the sample `index` further.
    #[inline]
    #[must_use]
    pub const fn moved(self, x: u32, y: u32, index: u32) -> Sampler<'a> {
        let mask = self.tile.shape().size.wrapping_sub(1);
        let x = ((self.x as u32).wrapping_add(x) & mask) as u16;
        let y = ((self.y as u32).wrapping_add(y) & mask) as u16;
        Sampler { x, y, index: self.index.wrapping_add(index), ..self }
    }
}
