//! A sample that is more than stored values: scrambled, beyond the tile's samples, or of more dimensions than it has.

use super::sampler::Sampler;
use super::sequence;
use super::shape::Shape;
use super::site::Site;
use super::view::Tile;
use crate::hash::{child, scrambling};
use crate::matrix::chunk;

/// Keeps domains of further dimensions apart from those of keys.
const DIMENSIONS: u32 = 0x6469_6d73;

/// The coordinates in 32-bit fixed point: of as many domains as it takes, each with the tile's dims.
#[inline]
pub(super) fn point<const N: usize>(of: &Sampler<'_>) -> [u32; N] {
    if netted(of.tile.shape(), N) {
        return call(of, net_of);
    }
    let all = match of.tile.shape().dims {
        1 => {
            let one = |number| if number < N as u32 { call(&more(of, number), group_of) } else { [0] };
            let ([a], [b], [c], [d]) = (call(of, group_of), one(1), one(2), one(3));
            [a, b, c, d]
        }
        2 if N > 2 => {
            let ([a, b], [c, d]) = (call(of, group_of), call(&more(of, 1), group_of));
            [a, b, c, d]
        }
        3 if N > 3 => {
            let ([a, b, c], [d]) = (call(of, group_of), call(&more(of, 1), group_of));
            [a, b, c, d]
        }
        _ => return call(of, group_of),
    };
    chunk(&all)
}

/// Whether N coordinates are more than the tile's and those beyond are stratified.
#[inline]
pub(super) const fn netted(shape: Shape, n: usize) -> bool {
    shape.spp > 1 && !shape.progressive && shape.dims > 1 && n > shape.dims as usize
}

/// The domain that further coordinates come from, `number` 1 and up.
#[inline]
const fn more<'a>(of: &Sampler<'a>, number: u32) -> Sampler<'a> {
    Sampler { domain: child(of.domain ^ DIMENSIONS, number), ..*of }
}

/// Calls with all arguments in registers: structs just written, field by field, would be read in larger pieces, which
/// takes as long as the rest of the work.
#[inline]
fn call<const N: usize>(of: &Sampler<'_>, function: fn(&[u8], Rest, u32, u32, u32) -> [u32; N]) -> [u32; N] {
    let Sampler { tile, domain, index, x, y, .. } = *of;
    function(tile.payload(), Rest::pack(of), domain, index, u32::from(x) | u32::from(y) << 16)
}

/// Where a point is, but for domain, index and pixel: 4 bits each of log2 of size and spp, and of dims; 8 of the frame;
/// whether scrambled, progressive, of 16 bits.
#[derive(Clone, Copy)]
struct Rest(u32);

impl Rest {
    #[inline]
    fn pack(of: &Sampler<'_>) -> Rest {
        let Shape { size, spp, dims, bits, progressive, .. } = of.tile.shape();
        let numbers = (size.trailing_zeros() & 15) | (spp.trailing_zeros() & 15) << 4 | (dims & 15) << 8;
        let (scrambled, wide) = (of.scrambled != 0, bits == 16);
        let flags = u32::from(scrambled) << 20 | u32::from(progressive) << 21 | u32::from(wide) << 22;
        Rest(numbers | (u32::from(of.frame) & 255) << 12 | flags)
    }

    #[inline]
    fn shape(self) -> Shape {
        let power = |shift: u32| 1 << (self.0 >> shift & 15);
        let bits = if self.flag(22) { 16 } else { 8 };
        Shape { size: power(0), spp: power(4), dims: self.0 >> 8 & 15, frames: 1, bits, progressive: self.flag(21) }
    }

    #[inline]
    fn sampler<'a>(self, tile: &'a Tile<'a>, domain: u32, index: u32, xy: u32) -> Sampler<'a> {
        let (x, y, frame) = (xy as u16, (xy >> 16) as u16, (self.0 >> 12 & 255) as u16);
        Sampler { tile, domain, index, x, y, frame, scrambled: u16::from(self.flag(20)) }
    }

    #[inline]
    fn flag(self, bit: u32) -> bool {
        self.0 >> bit & 1 != 0
    }
}

/// At most as many coordinates as the tile has dimensions.
#[inline(never)]
fn group_of<const N: usize>(payload: &[u8], rest: Rest, domain: u32, index: u32, xy: u32) -> [u32; N] {
    let tile = Tile::resume(rest.shape(), payload);
    let of = rest.sampler(&tile, domain, index, xy);
    let site = Site::new(&of);
    let sample = site.sample(tile.shape(), domain, index);
    let mut fixed = tile.fixed(site.at(tile.shape(), sample));
    displaced(&of, &mut fixed);
    fixed
}

/// The coordinates of a tile of 2 or 3 dims whose samples are in the order that `net` needs, and one or two after them.
#[inline(never)]
fn net_of<const N: usize>(payload: &[u8], rest: Rest, domain: u32, index: u32, xy: u32) -> [u32; N] {
    let tile = Tile::resume(rest.shape(), payload);
    let of = rest.sampler(&tile, domain, index, xy);
    Net::new::<N>(&of).point(&of)
}

/// A domain of a pixel of such a tile: what all of its samples share.
#[derive(Clone, Copy)]
pub(super) struct Net {
    own: Site,
    /// Of the third coordinate, if the tile has two.
    third: Site,
    fourth: Site,
}

impl Net {
    /// For N coordinates, [`netted`].
    // Without, and without it in `net.rs`, a draw of further dimensions takes 21 % more instructions.
    #[inline(always)]
    pub(super) fn new<const N: usize>(of: &Sampler<'_>) -> Net {
        let (own, third) = (Site::new(of), Site::new(&more(of, 1)));
        let fourth = if N > 3 && of.tile.shape().dims == 2 { Site::new(&more(of, 2)) } else { third };
        Net { own, third, fourth }
    }

    #[inline(always)]
    pub(super) fn point<const N: usize>(&self, of: &Sampler<'_>) -> [u32; N] {
        let (tile, shape) = (of.tile, of.tile.shape());
        let sample = self.own.sample(shape, of.domain, of.index);
        let place = self.own.at(shape, sample);
        let [a, b] = tile.fixed(place);
        let c = match shape.dims {
            2 => self.third.further(tile, sample, 0),
            _ => {
                let [c] = tile.fixed(place.wrapping_add(2));
                c
            }
        };
        let d = if N > 3 { self.fourth.further(tile, sample, 3_u32.wrapping_sub(shape.dims)) } else { 0 };
        let mut fixed = chunk(&[a, b, c, d]);
        if let Some((own, further)) = fixed.split_at_mut_checked(shape.dims as usize) {
            displaced(of, own);
            displaced(&more(of, 1), further);
        }
        fixed
    }
}

/// Scrambled, and continued beyond the tile's samples, if the sampler says so.
#[inline(always)]
fn displaced(of: &Sampler<'_>, fixed: &mut [u32]) {
    if of.scrambled != 0 {
        fixed.iter_mut().zip(1..).for_each(|(u, dim)| *u = u.wrapping_add(scrambling(of.domain, dim)));
    }
    if of.index >= of.tile.shape().spp {
        sequence::shift(of.domain, of.index, fixed);
    }
}
