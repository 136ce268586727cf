//! A sample's place, by frame, pixel, index and domain.

use super::view::Tile;
use crate::hash::child;

/// A sample's place, without its tile. Any value of the fields is valid; [`Sampler`](super::Sampler) says what they
/// mean.
///
/// ```
/// use noisefloor::tile::{Sampler, Shape, State, Tile};
///
/// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
/// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
/// let tile = Tile::new(shape, &payload)?;
/// let state = Sampler::pixel(&tile, 1, 0, 0, 0).domain(7).state();
/// assert_eq!(State::pixel(&tile, 1, 0, 0, 0).domain(7), state);
/// # Ok::<(), noisefloor::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct State {
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

/// Keeps domains of frames and scrambles apart from those of keys.
const FRAMES: u32 = 0x6672_616d;
const SCRAMBLE: u32 = 0x7363_7261;

impl State {
    /// [`Sampler::pixel`](super::Sampler::pixel).
    #[inline(always)]
    pub const fn pixel(tile: &Tile<'_>, x: u32, y: u32, frame: u32, index: u32) -> State {
        let shape = tile.shape();
        let mask = shape.size.wrapping_sub(1);
        let (frame, cycle) = if shape.frames > 1 { (frame % shape.frames, frame / shape.frames) } else { (0, frame) };
        let domain = if cycle == 0 { 0 } else { child(FRAMES, cycle) };
        State { domain, index, x: (x & mask) as u16, y: (y & mask) as u16, frame: frame as u16, scrambled: 0 }
    }

    /// [`Sampler::domain`](super::Sampler::domain).
    #[inline(always)]
    #[must_use]
    pub const fn domain(self, key: u32) -> State {
        State { domain: child(self.domain, key), ..self }
    }

    /// [`Sampler::scramble`](super::Sampler::scramble).
    #[inline(always)]
    #[must_use]
    pub const fn scramble(self, seed: u32) -> State {
        if seed == 0 {
            return self;
        }
        State { domain: child(self.domain ^ SCRAMBLE, seed), scrambled: 1, ..self }
    }
}
