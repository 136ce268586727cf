//! Many pixels and samples in one call.

use super::sampler::{nf_tile_sampler, state};
use super::view::core_view;
use crate::fill;
use crate::status::*;
use noisefloor_core::tile::Sampler;

/// As nf_sampler_fill(), of tiles' samplers. Those without a tile draw zeros.
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
    let draw = |sampler: &nf_tile_sampler, [x, y]: [u32; 2], dims, stride, u: &mut [f32]| {
        // SAFETY: the caller passes samplers whose tiles, checked by nf_tile_sampler_pixel, are NULL or live.
        unsafe { samples_of(sampler, x, y, dims, stride, u) }
    };
    // SAFETY: the caller's arrays, of the lengths that are stated.
    status(unsafe { fill::fill((samplers, dims, domains), [width, height, samples], (u, len), draw) })
}

/// One domain of one pixel: `dims` numbers of each sample, every `stride`.
///
/// # Safety
/// The sampler's tile must be NULL or live.
#[inline(always)]
unsafe fn samples_of(sampler: &nf_tile_sampler, x: u32, y: u32, dims: usize, stride: usize, u: &mut [f32]) {
    // SAFETY: passed on to the caller.
    match unsafe { core_view(sampler.tile) } {
        Some(tile) => Sampler::resume(&tile, state(sampler)).moved(x, y, 0).draw_samples(dims, stride, u),
        None => u.chunks_mut(stride.max(1)).filter_map(|u| u.get_mut(..dims)).for_each(|u| u.fill(0.0)),
    }
}
