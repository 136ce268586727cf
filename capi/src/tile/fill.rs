//! Many pixels and samples in one call.

use super::sampler::{check_sampler, nf_tile_sampler, of};
use super::view::core_view;
use crate::fill;
use crate::status::*;
use noisefloor_core::tile::PixelSampler;

/// As nf_sampler_fill(), of tiles' samplers, which nf_check() must not refuse. Those without a tile draw zeros.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_tile_sampler_fill(
    samplers: *const nf_tile_sampler,
    dims: *const u32,
    domains: usize,
    width: u32,
    height: u32,
    samples: u32,
    u: *mut f32,
    len: usize,
) -> nf_status {
    // SAFETY: the caller's arrays, of the lengths that are stated, and samplers of live tiles, if of any.
    unsafe {
        let check = |sampler| check_sampler(sampler);
        fill::fill((samplers, dims, domains), [width, height, samples], (u, len), check, Live)
    }
}

/// A sampler whose tile, as nf_tile_sampler_pixel checked, is NULL or live.
struct Live<'a>(&'a nf_tile_sampler);

impl PixelSampler for Live<'_> {
    #[inline(always)]
    fn draw_pixel(&self, [x, y]: [u32; 2], dims: usize, stride: usize, u: &mut [f32]) {
        // SAFETY: what makes a `Live` says so.
        match unsafe { core_view(self.0.tile) } {
            Some(tile) => of(&tile, self.0).moved(x, y, 0).draw_samples(dims, stride, u),
            None => u.chunks_mut(stride.max(1)).filter_map(|u| u.get_mut(..dims)).for_each(|u| u.fill(0.0)),
        }
    }
}
