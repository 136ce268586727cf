//! Where a domain finds a pixel in the tile: what all samples of the pixel share.

use super::hash::{permute, permute_few, permute_octave, permute_octave_few};
use super::net;
use super::sampler::Sampler;
use super::shape::Shape;
use super::view::Tile;
use crate::hash::mix;

/// A pixel's place in a domain. Its samples cost little once it is known.
#[derive(Clone, Copy)]
pub(super) struct Site {
    /// Where in the payload, counted in coordinates, the pixel's first sample begins.
    start: usize,
    /// Random bits of the domain there.
    random: u32,
}

impl Site {
    // Without, a draw of stored values takes 44 % more instructions, a filled pixel 28 %.
    #[inline(always)]
    pub(super) const fn new(of: &Sampler<'_>) -> Site {
        let (x, y) = place(of);
        let pixel = x | y << 10 | (of.frame as u32) << 20;
        let random = mix(of.domain ^ pixel.wrapping_mul(0x9e37_79b1));
        Site { start: of.tile.place(of.frame as u32, y, x, 0), random }
    }

    /// Where one of the tile's samples begins.
    #[inline]
    pub(super) const fn at(self, shape: Shape, sample: u32) -> usize {
        self.start.wrapping_add((sample as usize).wrapping_mul(shape.dims as usize))
    }

    /// Which of the tile's samples stands for `index`.
    #[inline(always)]
    pub(super) fn sample(self, shape: Shape, domain: u32, index: u32) -> u32 {
        let Shape { spp, progressive, .. } = shape;
        if index >= spp {
            return 0;
        }
        if domain == 0 || spp == 1 {
            return index;
        }
        // Samples of two domains must not meet in the same order in every pixel.
        if progressive { permute_octave(index, self.random) } else { permute(index, spp, self.random) }
    }

    /// The same where it takes a look-up at most, for an index below spp.
    #[inline]
    pub(super) fn looked_up(self, shape: Shape, domain: u32, index: u32) -> Option<u32> {
        let Shape { spp, progressive, .. } = shape;
        if domain == 0 || spp == 1 {
            return Some(index);
        }
        if progressive { permute_octave_few(index, self.random) } else { permute_few(index, spp, self.random) }
    }

    /// Coordinate `number`, 0 or 1, after those of the tile, for the tile's sample that has those: this is the site of
    /// `number`.
    ///
    /// Each is in a stratum of its own, of spp, and where in it comes from another sample of the tile for each stratum,
    /// so that the sum over the pixel is as even as the tile's.
    #[inline(always)]
    pub(super) fn further(self, tile: &Tile<'_>, sample: u32, number: u32) -> u32 {
        let shape = tile.shape();
        let bits = shape.spp.trailing_zeros();
        let stratum = net::stratum(sample, bits, number, self.random);
        let within = (stratum ^ self.random >> 8) & shape.spp.wrapping_sub(1);
        let [within] = tile.fixed(self.at(shape, within));
        stratum << ((32 - bits) & 31) | within >> (bits & 31)
    }
}

/// Where in the tile a domain finds the pixel: a shift and one of the eight symmetries of the square; for the root
/// neither.
#[inline(always)]
const fn place(of: &Sampler<'_>) -> (u32, u32) {
    let Sampler { tile, domain, x, y, .. } = *of;
    let (x, y, mask) = (x as u32, y as u32, tile.shape().size.wrapping_sub(1));
    if domain == 0 {
        return (x, y);
    }
    let (x, y) = (x ^ mask & (domain >> 20 & 1).wrapping_neg(), y ^ mask & (domain >> 21 & 1).wrapping_neg());
    // Exchanged or not without a branch, which would be taken at random.
    let exchanged = (x ^ y) & (domain >> 22 & 1).wrapping_neg();
    let (x, y) = (x ^ exchanged, y ^ exchanged);
    (x.wrapping_add(domain) & mask, y.wrapping_add(domain >> 10) & mask)
}
