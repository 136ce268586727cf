//! The sampler: one sample of one pixel, and the domains below it.

use super::hash::{child, mix, permute, permute_octave};
use super::net;
use super::sequence;
use super::view::{Shape, Tile, unit};

/// A sample's place, without its tile. Any value of the fields is valid; [`Sampler`] says what they mean.
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

/// One sample of one pixel: 24 bytes, to be copied freely. Drawing does not change it.
///
/// A sampler stands for a point of a cube with as many dimensions as are asked for, by domain: each decision of a path has
/// its own, [`domain`](Sampler::domain) with a key of its own. A domain's numbers depend on nothing but tile, pixel, frame,
/// index and the keys, so samples can be had in any order and on any thread.
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
    tile: &'a Tile<'a>,
    state: State,
}

/// Keeps domains of frames, scrambles and further dimensions apart from those of keys.
const FRAMES: u32 = 0x6672_616d;
const SCRAMBLE: u32 = 0x7363_7261;
const DIMENSIONS: u32 = 0x6469_6d73;

impl<'a> Sampler<'a> {
    /// Sample `index` of pixel (x, y), any values: pixels repeat with the tile's size.
    ///
    /// The first `spp` samples are the tile's. Those that follow continue with a scrambled Sobol sequence in their place.
    ///
    /// Frames 0 to `frames - 1` are the tile's (a tile that is not temporal has one). Each later run of them is the tile at
    /// another place, unrelated to it.
    ///
    /// ```
    /// use noisefloor::tile::{Sampler, Shape, Tile};
    ///
    /// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
    /// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
    /// let tile = Tile::new(shape, &payload)?;
    /// assert_eq!(Sampler::pixel(&tile, 3, 2, 0, 0), Sampler::pixel(&tile, 1, 0, 0, 0)); // modulo 2 pixels
    /// # Ok::<(), noisefloor::Error>(())
    /// ```
    #[inline]
    pub const fn pixel(tile: &'a Tile<'a>, x: u32, y: u32, frame: u32, index: u32) -> Sampler<'a> {
        Sampler { tile, state: State::pixel(tile, x, y, frame, index) }
    }

    /// The sampler of a state that was kept: [`Sampler::state`].
    ///
    /// ```
    /// use noisefloor::tile::{Sampler, Shape, Tile};
    ///
    /// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
    /// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
    /// let tile = Tile::new(shape, &payload)?;
    /// let sampler = Sampler::pixel(&tile, 1, 0, 0, 0).domain(7);
    /// assert_eq!(Sampler::resume(&tile, sampler.state()), sampler);
    /// # Ok::<(), noisefloor::Error>(())
    /// ```
    #[inline]
    pub const fn resume(tile: &'a Tile<'a>, state: State) -> Sampler<'a> {
        Sampler { tile, state }
    }

    /// What remains when the tile is known.
    ///
    /// ```
    /// use noisefloor::tile::{Sampler, Shape, Tile};
    ///
    /// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
    /// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
    /// let tile = Tile::new(shape, &payload)?;
    /// let state = Sampler::pixel(&tile, 3, 2, 0, 5).state();
    /// assert_eq!((state.x, state.y, state.index), (1, 0, 5));
    /// # Ok::<(), noisefloor::Error>(())
    /// ```
    #[inline]
    pub const fn state(&self) -> State {
        self.state
    }

    /// The tile it draws from.
    ///
    /// ```
    /// use noisefloor::tile::{Sampler, Shape, Tile};
    ///
    /// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
    /// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
    /// let tile = Tile::new(shape, &payload)?;
    /// assert_eq!(Sampler::pixel(&tile, 1, 0, 0, 0).tile().shape(), shape);
    /// # Ok::<(), noisefloor::Error>(())
    /// ```
    #[inline]
    pub const fn tile(&self) -> &'a Tile<'a> {
        self.tile
    }

    /// The child domain of a key. Children of different keys are unrelated to each other and to their parent; keys mean
    /// something only among children of one parent.
    ///
    /// ```
    /// use noisefloor::tile::{Sampler, Shape, Tile};
    ///
    /// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
    /// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
    /// let tile = Tile::new(shape, &payload)?;
    /// let pixel = Sampler::pixel(&tile, 1, 0, 0, 0);
    /// assert_ne!(pixel.domain(1), pixel.domain(2));
    /// assert_ne!(pixel.domain(1).domain(2), pixel.domain(2).domain(1)); // a tree, not a set
    /// # Ok::<(), noisefloor::Error>(())
    /// ```
    #[inline]
    #[must_use]
    pub const fn domain(self, key: u32) -> Sampler<'a> {
        Sampler { state: self.state.domain(key), ..self }
    }

    /// An independent version for each seed but 0; seed 0 changes nothing.
    ///
    /// It is the tile at another place, with all values of each dimension shifted, modulo 1, by a hash of seed and domain.
    /// Over random seeds every value is uniform, so estimates are unbiased, as far as a hash of 32 bits is random. The shift costs
    /// quality: where good images are wanted, and not exact unbiasedness, take another frame instead. Children of a scrambled sampler are
    /// scrambled.
    ///
    /// ```
    /// use noisefloor::tile::{Sampler, Shape, Tile};
    ///
    /// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
    /// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
    /// let tile = Tile::new(shape, &payload)?;
    /// let pixel = Sampler::pixel(&tile, 1, 0, 0, 0);
    /// assert_eq!(pixel.scramble(0), pixel);
    /// assert_ne!(pixel.scramble(1).draw::<2>(), pixel.scramble(2).draw::<2>());
    /// # Ok::<(), noisefloor::Error>(())
    /// ```
    #[inline]
    #[must_use]
    pub const fn scramble(self, seed: u32) -> Sampler<'a> {
        Sampler { state: self.state.scramble(seed), ..self }
    }

    /// The same domain of the pixel `x` columns to the right and `y` rows down, and of the sample `index` further.
    ///
    /// ```
    /// use noisefloor::tile::{Sampler, Shape, Tile};
    ///
    /// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
    /// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
    /// let tile = Tile::new(shape, &payload)?;
    /// assert_eq!(Sampler::pixel(&tile, 0, 0, 0, 0).moved(1, 1, 0), Sampler::pixel(&tile, 1, 1, 0, 0));
    /// # Ok::<(), noisefloor::Error>(())
    /// ```
    #[inline]
    #[must_use]
    pub const fn moved(self, x: u32, y: u32, index: u32) -> Sampler<'a> {
        let mask = self.tile.shape().size.wrapping_sub(1);
        let State { x: from_x, y: from_y, index: from, .. } = self.state;
        let x = ((from_x as u32).wrapping_add(x) & mask) as u16;
        let y = ((from_y as u32).wrapping_add(y) & mask) as u16;
        Sampler { state: State { x, y, index: from.wrapping_add(index), ..self.state }, ..self }
    }

    /// The first N coordinates, 1 to 4, of this domain's point; each in [0, 1), a multiple of 2^-24.
    ///
    /// Up to the tile's dims they are optimised together; further ones come from other places of the tile. If it has at least two
    /// dimensions and samples, and is not progressive, each further coordinate of its samples is stratified, and the third of a tile of two
    /// dimensions with those two, as far as the samples are in the order in which `fsot` writes them.
    ///
    /// ```
    /// use noisefloor::tile::{Sampler, Shape, Tile};
    ///
    /// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
    /// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
    /// let tile = Tile::new(shape, &payload)?;
    /// let [x, y] = Sampler::pixel(&tile, 1, 1, 0, 0).draw();
    /// assert_eq!([x, y], [192.5 / 256.0, 128.5 / 256.0]);
    /// # Ok::<(), noisefloor::Error>(())
    /// ```
    #[inline(always)]
    pub fn draw<const N: usize>(&self) -> [f32; N] {
        let mut u = [0.0; N];
        if self.draw_stored(&mut u) { u } else { point(self.tile, &self.state).map(unit) }
    }

    /// [`draw`](Sampler::draw), if that needs nothing but to look up stored values: for indices below the tile's spp in
    /// unscrambled samplers, of the root or of any domain of a tile of 1 spp, with no more dimensions than the tile has.
    /// Otherwise returns false and writes nothing.
    ///
    /// ```
    /// use noisefloor::tile::{Sampler, Shape, Tile};
    ///
    /// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
    /// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
    /// let tile = Tile::new(shape, &payload)?;
    /// let mut u = [0.0; 2];
    /// assert!(Sampler::pixel(&tile, 1, 0, 0, 0).draw_stored(&mut u)); // the root, in the tile's own samples
    /// assert!(!Sampler::pixel(&tile, 1, 0, 0, 1).draw_stored(&mut u)); // continued by a sequence
    /// # Ok::<(), noisefloor::Error>(())
    /// ```
    #[inline(always)]
    pub fn draw_stored<const N: usize>(&self, u: &mut [f32; N]) -> bool {
        const { assert!(0 < N && N <= 4, "a domain has 1 to 4 dimensions") };
        let (Shape { size, spp, dims, .. }, state) = (self.tile.shape(), &self.state);
        let ordered = state.domain == 0 || spp == 1;
        if N > dims as usize || state.index >= spp || !ordered || state.scrambled != 0 {
            return false;
        }
        let (x, y) = place(state, size);
        self.tile.values(self.tile.place(u32::from(state.frame), y, x, state.index), u)
    }

    /// As [`draw`](Sampler::draw), as many coordinates as `u` has room for, at most 4; more stay as they are.
    ///
    /// ```
    /// use noisefloor::tile::{Sampler, Shape, Tile};
    ///
    /// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
    /// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
    /// let tile = Tile::new(shape, &payload)?;
    /// let (sampler, mut u) = (Sampler::pixel(&tile, 1, 0, 0, 0), [0.0; 2]);
    /// sampler.draw_into(&mut u);
    /// assert_eq!(u, sampler.draw());
    /// # Ok::<(), noisefloor::Error>(())
    /// ```
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

impl State {
    /// [`Sampler::pixel`].
    ///
    /// ```
    /// use noisefloor::tile::{Sampler, Shape, State, Tile};
    ///
    /// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
    /// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
    /// let tile = Tile::new(shape, &payload)?;
    /// assert_eq!(State::pixel(&tile, 1, 0, 0, 0), Sampler::pixel(&tile, 1, 0, 0, 0).state());
    /// # Ok::<(), noisefloor::Error>(())
    /// ```
    #[inline(always)]
    pub const fn pixel(tile: &Tile<'_>, x: u32, y: u32, frame: u32, index: u32) -> State {
        let shape = tile.shape();
        let mask = shape.size.wrapping_sub(1);
        let (frame, cycle) = if shape.frames > 1 { (frame % shape.frames, frame / shape.frames) } else { (0, frame) };
        let domain = if cycle == 0 { 0 } else { child(FRAMES, cycle) };
        State { domain, index, x: (x & mask) as u16, y: (y & mask) as u16, frame: frame as u16, scrambled: 0 }
    }

    /// [`Sampler::domain`].
    ///
    /// ```
    /// use noisefloor::tile::{Sampler, Shape, State, Tile};
    ///
    /// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
    /// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
    /// let tile = Tile::new(shape, &payload)?;
    /// assert_eq!(State::default().domain(7), Sampler::pixel(&tile, 0, 0, 0, 0).domain(7).state());
    /// # Ok::<(), noisefloor::Error>(())
    /// ```
    #[inline(always)]
    #[must_use]
    pub const fn domain(self, key: u32) -> State {
        State { domain: child(self.domain, key), ..self }
    }

    /// [`Sampler::scramble`].
    ///
    /// ```
    /// use noisefloor::tile::{Sampler, Shape, State, Tile};
    ///
    /// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
    /// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
    /// let tile = Tile::new(shape, &payload)?;
    /// assert_eq!(State::default().scramble(7), Sampler::pixel(&tile, 0, 0, 0, 0).scramble(7).state());
    /// # Ok::<(), noisefloor::Error>(())
    /// ```
    #[inline(always)]
    #[must_use]
    pub const fn scramble(self, seed: u32) -> State {
        if seed == 0 {
            return self;
        }
        State { domain: child(self.domain ^ SCRAMBLE, seed), scrambled: 1, ..self }
    }
}

/// The coordinates in 32-bit fixed point: of as many domains as it takes, each with the tile's dims.
#[inline]
fn point<const N: usize>(tile: &Tile<'_>, state: &State) -> [u32; N] {
    let more = |number| State { domain: child(state.domain ^ DIMENSIONS, number), ..*state };
    let Shape { spp, dims, progressive, .. } = tile.shape();
    let netted = spp > 1 && !progressive;
    let all = match dims {
        1 => {
            let one = |number| if number < N as u32 { group(tile, &more(number)) } else { [0] };
            let ([a], [b], [c], [d]) = (group(tile, state), one(1), one(2), one(3));
            [a, b, c, d]
        }
        2 if N > 2 && netted => {
            let [a, b] = group(tile, state);
            let [c, d] = if N > 3 { further(tile, state) } else { [further::<1>(tile, state)[0], 0] };
            [a, b, c, d]
        }
        2 if N > 2 => {
            let ([a, b], [c, d]) = (group(tile, state), group(tile, &more(1)));
            [a, b, c, d]
        }
        3 if N > 3 && netted => {
            let ([a, b, c], [d]) = (group(tile, state), further(tile, state));
            [a, b, c, d]
        }
        3 if N > 3 => {
            let ([a, b, c], [d]) = (group(tile, state), group(tile, &more(1)));
            [a, b, c, d]
        }
        _ => return group(tile, state),
    };
    all.first_chunk().copied().unwrap_or([0; N])
}

/// At most as many coordinates as the tile has dimensions.
#[inline(always)]
fn group<const N: usize>(tile: &Tile<'_>, state: &State) -> [u32; N] {
    let State { domain, index, x, y, .. } = *state;
    let rest = Rest::pack(tile.shape(), state);
    group_of(tile.payload(), rest, domain, index, u32::from(x) | u32::from(y) << 16)
}

/// Where a group is, but for domain, index and pixel: 4 bits each of log2 of size and spp, and of dims; 8 of the frame; whether
/// scrambled, progressive, of 16 bits.
///
/// With it all arguments of [`group_of`] travel in registers. Structs just written, field by field, would be read in larger
/// pieces, which takes as long as the rest of the work.
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
    fn frame(self) -> u16 {
        (self.0 >> 12 & 255) as u16
    }

    #[inline(always)]
    fn flag(self, bit: u32) -> bool {
        self.0 >> bit & 1 != 0
    }
}

/// [`group`].
#[inline(never)]
fn group_of<const N: usize>(payload: &[u8], rest: Rest, domain: u32, index: u32, xy: u32) -> [u32; N] {
    let tile = Tile::resume(rest.shape(), payload);
    let Shape { size, spp, .. } = tile.shape();
    let (frame, scrambled) = (rest.frame(), rest.flag(20));
    let (x, y) = place(&State { domain, x: xy as u16, y: (xy >> 16) as u16, ..State::default() }, size);
    let continued = index >= spp;
    let sample = sample_of(tile.shape(), domain, index, hash_of(domain, x, y, frame));
    let mut fixed = tile.fixed(tile.place(u32::from(frame), y, x, sample)).unwrap_or([0; N]);
    if scrambled {
        fixed.iter_mut().zip(1..).for_each(|(u, dim)| *u = u.wrapping_add(rotation(domain, dim)));
    }
    if continued {
        sequence::shift(domain, index, &mut fixed);
    }
    fixed
}

/// Random bits of a domain at a place of the tile.
#[inline(always)]
fn hash_of(domain: u32, x: u32, y: u32, frame: u16) -> u32 {
    let pixel = x | y << 10 | u32::from(frame) << 20;
    mix(domain ^ pixel.wrapping_mul(0x9e37_79b1))
}

/// Which of the tile's samples of a pixel stands for `index`.
#[inline(always)]
fn sample_of(shape: Shape, domain: u32, index: u32, random: u32) -> u32 {
    let Shape { spp, progressive, .. } = shape;
    if index >= spp {
        return 0;
    }
    if domain == 0 || spp == 1 {
        return index;
    }
    // Samples of two domains must not meet in the same order in every pixel.
    if progressive { permute_octave(index, random) } else { permute(index, spp.trailing_zeros(), random) }
}

/// The M coordinates, 1 or 2, after those of the tile, whose samples are in the order that [`net`] needs.
///
/// Each is in a stratum of its own, of spp, and where in it comes from another place of the tile: from another sample of it for each
/// stratum, so that the sum over the pixel is as even as the tile's.
#[inline(never)]
fn further<const M: usize>(tile: &Tile<'_>, state: &State) -> [u32; M] {
    let Shape { size, spp, .. } = tile.shape();
    let (x, y) = place(state, size);
    let sample = sample_of(tile.shape(), state.domain, state.index, hash_of(state.domain, x, y, state.frame));
    let bits = spp.trailing_zeros();
    let mut number = 0;
    let mut fixed = [(); M].map(|()| {
        let more = State { domain: child(state.domain ^ DIMENSIONS, number + 1), ..*state };
        let (x, y) = place(&more, size);
        let random = hash_of(more.domain, x, y, more.frame);
        let stratum = net::stratum(sample, bits, number, random);
        number += 1;
        let within = (stratum ^ random >> 8) & spp.wrapping_sub(1);
        let [within] = tile.fixed(tile.place(u32::from(more.frame), y, x, within)).unwrap_or([0]);
        stratum << ((32 - bits) & 31) | within >> (bits & 31)
    });
    let domain = child(state.domain ^ DIMENSIONS, 1);
    if state.scrambled != 0 {
        fixed.iter_mut().zip(1..).for_each(|(u, dim)| *u = u.wrapping_add(rotation(domain, dim)));
    }
    if state.index >= spp {
        sequence::shift(domain, state.index, &mut fixed);
    }
    fixed
}

/// Where in the tile a domain finds the pixel: a shift and one of the eight symmetries of the square; for the root neither.
#[inline(always)]
fn place(state: &State, size: u32) -> (u32, u32) {
    let mask = size.wrapping_sub(1);
    let flip = |coordinate: u16, bit: u32| u32::from(coordinate) ^ (mask & (state.domain >> bit & 1).wrapping_neg());
    if state.domain == 0 {
        return (u32::from(state.x), u32::from(state.y));
    }
    let (x, y) = (flip(state.x, 20), flip(state.y, 21));
    let (x, y) = if state.domain >> 22 & 1 == 0 { (x, y) } else { (y, x) };
    (x.wrapping_add(state.domain) & mask, y.wrapping_add(state.domain >> 10) & mask)
}

/// How far a scrambled domain's values are shifted; a bijection of the domain, so over all of them each shift occurs once.
#[inline(always)]
const fn rotation(domain: u32, dim: u32) -> u32 {
    mix(domain.wrapping_add(dim.wrapping_mul(super::hash::GOLDEN)))
}
