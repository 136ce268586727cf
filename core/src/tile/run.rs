//! Samples of one pixel that follow each other: what they share is computed once.

use super::point::{Net, netted};
use super::sampler::Sampler;
use super::site::Site;
use super::state::State;
use super::view::unit;
use crate::pixels::PixelSampler;
use crate::slices::from_mut;

impl Sampler<'_> {
    /// Draws `dims` coordinates, 1 to 4, of this sample and of those that follow it: sample k's to `u[k * stride..]`,
    /// for as many samples as `u` has room for. The same bits as [`draw`](Sampler::draw) of each, at less cost: hashes
    /// are computed once. Draws nothing for other `dims`; a stride of less than `dims` is `dims`.
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
    #[inline(always)]
    pub fn draw_samples(&self, dims: usize, stride: usize, u: &mut [f32]) {
        match dims {
            // One sample has nothing to share.
            1..=4 if u.len() <= stride => {
                if let Some(u) = u.get_mut(..dims) {
                    self.draw_into(u);
                }
            }
            1 => self.run::<1>(stride, u),
            2 => self.run::<2>(stride, u),
            3 => self.run::<3>(stride, u),
            4 => self.run::<4>(stride, u),
            _ => {}
        }
    }

    #[inline(never)]
    fn run<const N: usize>(&self, stride: usize, u: &mut [f32]) {
        let (tile, shape) = (self.tile(), self.tile().shape());
        let State { domain, index, scrambled, .. } = self.state();
        let own = if scrambled == 0 { shape.spp.saturating_sub(index) } else { 0 };
        let (stride, mut rest, mut k) = (stride.max(N), u, 0_u32);
        if N <= shape.dims as usize {
            let site = Site::new(tile, &self.state());
            while k < own
                && let Some((u, _)) = rest.split_first_chunk_mut::<N>()
            {
                let sample = site.sample(shape, domain, index.wrapping_add(k));
                if !tile.values(site.at(shape, sample), u) {
                    *u = [0.0; N];
                }
                (rest, k) = (from_mut(rest, stride), k.wrapping_add(1));
            }
        } else if netted(shape, N) {
            let net = Net::new::<N>(tile, &self.state());
            while k < own
                && let Some((u, _)) = rest.split_first_chunk_mut::<N>()
            {
                *u = net.point(tile, &self.moved(0, 0, k).state()).map(unit);
                (rest, k) = (from_mut(rest, stride), k.wrapping_add(1));
            }
        }
        while let Some((u, _)) = rest.split_first_chunk_mut::<N>() {
            *u = self.moved(0, 0, k).draw();
            (rest, k) = (from_mut(rest, stride), k.wrapping_add(1));
        }
    }
}

impl PixelSampler for Sampler<'_> {
    #[inline]
    fn draw_pixel(&self, [x, y]: [u32; 2], dims: usize, stride: usize, u: &mut [f32]) {
        self.moved(x, y, 0).draw_samples(dims, stride, u);
    }
}
