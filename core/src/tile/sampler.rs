//! The sampler: one sample of one pixel, and the domains below it.

use super::point::point;
use super::site::Site;
use super::state::State;
use super::view::{Tile, unit};

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
    tile: &'a Tile<'a>,
    state: State,
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
        Sampler { tile, state: State::pixel(tile, x, y, frame, index) }
    }

    /// The sampler of a state that was kept: [`Sampler::state`].
    #[inline]
    pub const fn resume(tile: &'a Tile<'a>, state: State) -> Sampler<'a> {
        Sampler { tile, state }
    }

    /// What remains when the tile is known.
    #[inline]
    pub const fn state(&self) -> State {
        self.state
    }

    /// The tile it draws from.
    #[inline]
    pub const fn tile(&self) -> &'a Tile<'a> {
        self.tile
    }

    /// The child domain of a key. Children of different keys are unrelated to each other and to their parent; keys mean
    /// something only among children of one parent.
    #[inline]
    #[must_use]
    pub const fn domain(self, key: u32) -> Sampler<'a> {
        Sampler { state: self.state.domain(key), ..self }
    }

    /// An independent version for each seed but 0; seed 0 changes nothing.
    ///
    /// It is the tile at another place, with all values of each dimension shifted, modulo 1, by a hash of seed and
    /// domain. Over random seeds every value is uniform, so estimates are unbiased, as far as a hash of 32 bits is
    /// random. The shift costs quality: where good images are wanted, and not exact unbiasedness, take another frame
    /// instead. Children of a scrambled sampler are scrambled.
    #[inline]
    #[must_use]
    pub const fn scramble(self, seed: u32) -> Sampler<'a> {
        Sampler { state: self.state.scramble(seed), ..self }
    }

    /// The same domain of the pixel `x` columns to the right and `y` rows down, and of the sample `index` further.
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
    /// Up to the tile's dims they are optimised together; further ones come from other places of the tile. If it has at
    /// least two dimensions and samples, and is not progressive, each further coordinate of its samples is stratified,
    /// and the third of a tile of two dimensions with those two, as far as the samples are in the order in which `fsot`
    /// writes them.
    #[inline(always)]
    pub fn draw<const N: usize>(&self) -> [f32; N] {
        let mut u = [0.0; N];
        if self.draw_stored(&mut u) { u } else { point(self.tile, &self.state).map(unit) }
    }

    /// [`draw`](Sampler::draw), if that needs little but to look up stored values: for indices below the tile's spp, at
    /// most 16, in unscrambled samplers, with no more dimensions than the tile has. Otherwise returns false and writes
    /// nothing; the root's are stored at any spp.
    #[inline(always)]
    pub fn draw_stored<const N: usize>(&self, u: &mut [f32; N]) -> bool {
        const { assert!(0 < N && N <= 4, "a domain has 1 to 4 dimensions") };
        let (shape, state) = (self.tile.shape(), &self.state);
        if N > shape.dims as usize || state.index >= shape.spp || state.scrambled != 0 {
            return false;
        }
        let site = Site::new(self.tile, state);
        let Some(sample) = site.looked_up(shape, state.domain, state.index) else { return false };
        self.tile.values(site.at(shape, sample), u)
    }

    /// As [`draw`](Sampler::draw), as many coordinates as `u` has room for, at most 4; more stay as they are.
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
