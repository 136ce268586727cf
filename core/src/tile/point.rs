//! A sample that is more than stored values: scrambled, beyond the tile's samples, or of more dimensions than it has.

use super::sequence;
use super::shape::Shape;
use super::site::Site;
use super::state::State;
use super::view::Tile;
use crate::hash::{GOLDEN, child, mix};
use crate::slices::chunk;

/// Keeps domains of further dimensions apart from those of keys.
const DIMENSIONS: u32 = 0x6469_6d73;

/// The coordinates in 32-bit fixed point: of as many domains as it takes, each with the tile's dims.
#[inline]
pub(super) fn point<const N: usize>(tile: &Tile<'_>, state: &State) -> [u32; N] {
    let Shape { dims, .. } = tile.shape();
    if netted(tile.shape(), N) {
        return call(tile, state, net_of);
    }
    let all = match dims {
        1 => {
            let one = |number| if number < N as u32 { call(tile, &more(state, number), group_of) } else { [0] };
            let ([a], [b], [c], [d]) = (call(tile, state, group_of), one(1), one(2), one(3));
            [a, b, c, d]
        }
        2 if N > 2 => {
            let ([a, b], [c, d]) = (call(tile, state, group_of), call(tile, &more(state, 1), group_of));
            [a, b, c, d]
        }
        3 if N > 3 => {
            let ([a, b, c], [d]) = (call(tile, state, group_of), call(tile, &more(state, 1), group_of));
            [a, b, c, d]
        }
        _ => return call(tile, state, group_of),
    };
    chunk(&all)
}

/// Whether N coordinates are more than the tile's and those beyond are stratified.
#[inline(always)]
pub(super) const fn netted(shape: Shape, n: usize) -> bool {
    shape.spp > 1 && !shape.progressive && shape.dims > 1 && n > shape.dims as usize
}

/// The domain that further coordinates come from, `number` 1 and up.
#[inline(always)]
const fn more(state: &State, number: u32) -> State {
    State { domain: child(state.domain ^ DIMENSIONS, number), ..*state }
}

/// Calls with all arguments in registers: structs just written, field by field, would be read in larger pieces, which
/// takes as long as the rest of the work.
#[inline(always)]
fn call<const N: usize>(
    tile: &Tile<'_>,
    state: &State,
    function: fn(&[u8], Rest, u32, u32, u32) -> [u32; N],
) -> [u32; N] {
    let State { domain, index, x, y, .. } = *state;
    function(tile.payload(), Rest::pack(tile.shape(), state), domain, index, u32::from(x) | u32::from(y) << 16)
}

/// Where a point is, but for domain, index and pixel: 4 bits each of log2 of size and spp, and of dims; 8 of the frame;
/// whether scrambled, progressive, of 16 bits.
#[derive(Clone, Copy)]
struct Rest(u32);

impl Rest {
    #[inline(always)]
    fn pack(shape: Shape, state: &State) -> Rest {
        let Shape { size, spp, dims, bits, progressive, .. } = shape;
        let numbers = (size.trailing_zeros() & 15) | (spp.trailing_zeros() & 15) << 4 | (dims & 15) << 8;
        let (scrambled, wide) = (state.scrambled != 0, bits == 16);
        let flags = u32::from(scrambled) << 20 | u32::from(progressive) << 21 | u32::from(wide) << 22;
        Rest(numbers | (u32::from(state.frame) & 255) << 12 | flags)
    }

    #[inline(always)]
    fn shape(self) -> Shape {
        let power = |shift: u32| 1 << (self.0 >> shift & 15);
        let bits = if self.flag(22) { 16 } else { 8 };
        Shape { size: power(0), spp: power(4), dims: self.0 >> 8 & 15, frames: 1, bits, progressive: self.flag(21) }
    }

    #[inline(always)]
    fn state(self, domain: u32, index: u32, xy: u32) -> State {
        let (x, y, frame) = (xy as u16, (xy >> 16) as u16, (self.0 >> 12 & 255) as u16);
        State { domain, index, x, y, frame, scrambled: u16::from(self.flag(20)) }
    }

    #[inline(always)]
    fn flag(self, bit: u32) -> bool {
        self.0 >> bit & 1 != 0
    }
}

/// At most as many coordinates as the tile has dimensions.
#[inline(never)]
fn group_of<const N: usize>(payload: &[u8], rest: Rest, domain: u32, index: u32, xy: u32) -> [u32; N] {
    let (tile, state) = (Tile::resume(rest.shape(), payload), rest.state(domain, index, xy));
    let site = Site::new(&tile, &state);
    let sample = site.sample(tile.shape(), domain, index);
    let mut fixed = tile.fixed(site.at(tile.shape(), sample));
    moved(tile.shape(), &state, &mut fixed);
    fixed
}

/// The coordinates of a tile of 2 or 3 dims whose samples are in the order that `net` needs, and one or two after them.
#[inline(never)]
fn net_of<const N: usize>(payload: &[u8], rest: Rest, domain: u32, index: u32, xy: u32) -> [u32; N] {
    let (tile, state) = (Tile::resume(rest.shape(), payload), rest.state(domain, index, xy));
    Net::new::<N>(&tile, &state).point(&tile, &state)
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
    #[inline(always)]
    pub(super) fn new<const N: usize>(tile: &Tile<'_>, state: &State) -> Net {
        let (own, third) = (Site::new(tile, state), Site::new(tile, &more(state, 1)));
        let fourth = if N > 3 && tile.shape().dims == 2 { Site::new(tile, &more(state, 2)) } else { third };
        Net { own, third, fourth }
    }

    #[inline(always)]
    pub(super) fn point<const N: usize>(&self, tile: &Tile<'_>, state: &State) -> [u32; N] {
        let shape = tile.shape();
        let sample = self.own.sample(shape, state.domain, state.index);
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
            moved(shape, state, own);
            moved(shape, &more(state, 1), further);
        }
        fixed
    }
}

/// Scrambled, and continued beyond the tile's samples, if the state says so.
#[inline(always)]
fn moved(shape: Shape, state: &State, fixed: &mut [u32]) {
    if state.scrambled != 0 {
        fixed.iter_mut().zip(1..).for_each(|(u, dim)| *u = u.wrapping_add(rotation(state.domain, dim)));
    }
    if state.index >= shape.spp {
        sequence::shift(state.domain, state.index, fixed);
    }
}

/// How far a scrambled domain's values are shifted; a bijection of the domain, so over all of them each shift occurs
/// once.
#[inline(always)]
const fn rotation(domain: u32, dim: u32) -> u32 {
    mix(domain.wrapping_add(dim.wrapping_mul(GOLDEN)))
}
