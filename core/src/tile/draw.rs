//! What a sampler draws: one sample, and samples of one pixel that follow each other, which share what can be.

use super::point::{Net, netted, point};
use super::sampler::Sampler;
use super::site::Site;
use crate::matrix::{first_mut, from_mut};
use crate::rng::unit;

impl Sampler<'_> {
    /// The first N coordinates, 1 to 4, of this domain's point; each in [0, 1), a multiple of 2^-24.
    ///
    /// Up to the tile's dims they are optimised together; further ones come from other places of the tile. If it has at
    /// least two dimensions and samples, and is not progressive, each further coordinate of its samples is stratified,
    /// and the third of a tile of two dimensions with those two, as far as the samples are in the order in which `fsot`
    /// writes them.
    // Without, a draw of stored values takes 53 % more instructions.
    #[inline(always)]
    pub fn draw<const N: usize>(&self) -> [f32; N] {
        let mut u = [0.0; N];
        if self.draw_stored(&mut u) { u } else { point(self).map(unit) }
    }

    /// [`draw`](Sampler::draw), if that needs little but to look up stored values: for indices below the tile's spp, at
    /// most 16, in unscrambled samplers, with no more dimensions than the tile has. Otherwise returns false and writes
    /// nothing; the root's are stored at any spp.
    #[inline(always)]
    pub fn draw_stored<const N: usize>(&self, u: &mut [f32; N]) -> bool {
        const { assert!(0 < N && N <= 4, "a domain has 1 to 4 dimensions") };
        let shape = self.tile.shape();
        if N > shape.dims as usize || self.index >= shape.spp || self.scrambled != 0 {
            return false;
        }
        let site = Site::new(self);
        let Some(sample) = site.looked_up(shape, self.domain, self.index) else { return false };
        self.tile.values(site.at(shape, sample), u)
    }

    /// Draws `dims` coordinates, 1 to 4, of this sample and of those that follow it: sample k's to `u[k * stride..]`,
    /// for as many samples as `u` has room for. The same bits as [`draw`](Sampler::draw) of each, at less cost: hashes
    /// are computed once. Draws nothing for other `dims`; a stride of less than `dims` is `dims`.
    #[inline]
    pub fn draw_samples(&self, dims: usize, stride: usize, u: &mut [f32]) {
        match dims {
            // One sample has nothing to share.
            1..=4 if u.len() <= stride => self.draw_into(first_mut(u, dims)),
            1 => self.run::<1>(stride, u),
            2 => self.run::<2>(stride, u),
            3 => self.run::<3>(stride, u),
            4 => self.run::<4>(stride, u),
            _ => {}
        }
    }

    #[inline(never)]
    fn run<const N: usize>(&self, stride: usize, u: &mut [f32]) {
        let Sampler { tile, domain, index, scrambled, .. } = *self;
        let shape = tile.shape();
        let own = if scrambled == 0 { shape.spp.saturating_sub(index) } else { 0 };
        let (stride, mut rest, mut k) = (stride.max(N), u, 0_u32);
        if N <= shape.dims as usize {
            let site = Site::new(self);
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
            let net = Net::new::<N>(self);
            while k < own
                && let Some((u, _)) = rest.split_first_chunk_mut::<N>()
            {
                *u = net.point(&self.moved(0, 0, k)).map(unit);
                (rest, k) = (from_mut(rest, stride), k.wrapping_add(1));
            }
        }
        while let Some((u, _)) = rest.split_first_chunk_mut::<N>() {
            *u = self.moved(0, 0, k).draw();
            (rest, k) = (from_mut(rest, stride), k.wrapping_add(1));
        }
    }
}

crate::pixels::draws!(Sampler<'_>);
