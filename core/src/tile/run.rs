//! Samples of one pixel that follow each other: what they share is computed once.

use super::point::{Net, netted};
use super::sampler::{Sampler, State};
use super::site::Site;
use super::view::unit;

impl Sampler<'_> {
    /// Draws `dims` coordinates, 1 to 4, of this sample and of those that follow it: sample k's to `u[k * stride..]`, for as many
    /// samples as `u` has room for. The same bits as [`draw`](Sampler::draw) of each, at less cost: hashes are computed once.
    /// Draws nothing for other `dims`, or if `stride` is less.
    ///
    /// ```
    /// use noisefloor::tile::{Sampler, Shape, Tile};
    ///
    /// let shape = Shape { size: 2, spp: 4, dims: 1, frames: 1, bits: 8, progressive: false };
    /// let tile = Tile::new(shape, &[0, 64, 128, 192, 32, 96, 160, 224, 16, 80, 144, 208, 48, 112, 176, 240])?;
    /// let sampler = Sampler::pixel(&tile, 1, 0, 0, 0).domain(7);
    /// let mut u = [[0.0; 3]; 4]; // three numbers of each of four samples: two of this domain
    /// sampler.draw_samples(2, 3, u.as_flattened_mut());
    /// assert_eq!(u[3][..2], sampler.moved(0, 0, 3).draw::<2>());
    /// # Ok::<(), noisefloor::Error>(())
    /// ```
    pub fn draw_samples(&self, dims: usize, stride: usize, u: &mut [f32]) {
        match dims {
            1 => self.run::<1>(stride, u),
            2 => self.run::<2>(stride, u),
            3 => self.run::<3>(stride, u),
            4 => self.run::<4>(stride, u),
            _ => {}
        }
    }

    #[inline]
    fn run<const N: usize>(&self, stride: usize, u: &mut [f32]) {
        let (tile, state, shape) = (self.tile(), self.state(), self.tile().shape());
        let at = |k: usize| State { index: state.index.wrapping_add(k as u32), ..state };
        let mut samples = u.chunks_mut(stride.max(1)).filter_map(<[f32]>::first_chunk_mut::<N>).zip(0_usize..);
        let own = if state.scrambled == 0 { shape.spp.saturating_sub(state.index) as usize } else { 0 };
        if N <= shape.dims as usize {
            let site = Site::new(tile, &state);
            for (u, k) in samples.by_ref().take(own) {
                if !tile.values(site.at(shape, site.sample(shape, state.domain, at(k).index)), u) {
                    *u = [0.0; N];
                }
            }
        } else if netted(shape, N) {
            let net = Net::new::<N>(tile, &state);
            for (u, k) in samples.by_ref().take(own) {
                *u = net.point(tile, &at(k)).map(unit);
            }
        }
        for (u, k) in samples {
            *u = Sampler::resume(tile, at(k)).draw();
        }
    }
}
