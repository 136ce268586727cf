//! The sampler, by value.

use super::view::{nf_tile, open};
use crate::convert;
use noisefloor_core::tile::{Sampler, State};

/// One sample of one pixel: a small struct, passed and copied by value. Drawing does not change it.
///
/// A sampler stands for a point of a cube with as many dimensions as are asked for. There are no dimension counters:
/// each decision of a path (lens, light, bounce, ...) has a domain, a child of the sampler by a key of its own. A domain's
/// numbers depend on nothing but tile, pixel, frame, index and the keys that led to it, so that any sample can be drawn
/// in any order, on any thread, and at any time. Made by nf_sampler_pixel; the fields are not to be written.
#[repr(C)]
#[allow(non_camel_case_types)]
#[derive(Clone, Copy)]
pub struct nf_sampler {
    /// The tile; it must outlive the sampler and stay where it is.
    pub tile: *const nf_tile,
    /// The domain: 0 is the root.
    pub domain: u32,
    /// The sample of the pixel.
    pub index: u32,
    /// The pixel's column, modulo the tile's size.
    pub x: u16,
    /// The pixel's row, modulo the tile's size.
    pub y: u16,
    /// The frame, modulo the tile's frames.
    pub frame: u16,
    /// 1 after nf_sampler_scramble, otherwise 0.
    pub scrambled: u16,
}

/// Sample `index` of pixel (x, y) in `frame`, any values of each: pixels repeat with the tile's size.
///
/// The first tile->spp samples are the tile's. Those that follow continue with a scrambled Sobol sequence in their place; none is
/// repeated. Frames 0 to tile->frames - 1 are the tile's; each later run of them is the tile at another place, unrelated to it.
/// For an image that is refined over time leave the frame and count the index.
///
/// tile: it must outlive the sampler and stay where it is. All draws of a sampler without a tile, NULL, are 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_sampler_pixel(tile: *const nf_tile, x: u32, y: u32, frame: u32, index: u32) -> nf_sampler {
    // SAFETY: the caller passes NULL or a tile that lives on.
    sampler(tile, State::pixel(&unsafe { open(tile) }, x, y, frame, index))
}

/// The child domain of a key, any value. Children of different keys are unrelated to each other and to their parent. Keys mean
/// something only among the children of one parent: a bounce's light may have the same key as the next bounce's.
#[unsafe(no_mangle)]
pub extern "C" fn nf_sampler_domain(sampler: nf_sampler, key: u32) -> nf_sampler {
    self::sampler(sampler.tile, state(&sampler).domain(key))
}

/// An independent version of the sampler for each seed but 0; seed 0 changes nothing.
///
/// It is the tile at another place, with all values of a dimension shifted, modulo 1, by a number that only seed and domain
/// decide. Over random seeds every value is uniform, so an estimate has no bias at all (the tile's own values are fixed, and an
/// estimate from them is what it is). Children of a scrambled sampler are scrambled.
#[unsafe(no_mangle)]
pub extern "C" fn nf_sampler_scramble(sampler: nf_sampler, seed: u32) -> nf_sampler {
    self::sampler(sampler.tile, state(&sampler).scramble(seed))
}

/// Writes the first `dims` coordinates, 1..4, of the sampler's point to u[dims]: each in [0, 1), a multiple of 2^-24.
///
/// Up to tile->dims they are optimised together, and more come from other places of the tile; fewer are the first of those.
/// Writes nothing if dims is out of range or u is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_sampler_draw(sampler: nf_sampler, dims: u32, u: *mut f32) {
    if !(1..=4).contains(&dims) {
        return;
    }
    // SAFETY: the caller passes NULL or room for `dims` numbers, and a sampler whose tile lives.
    let (u, tile) = unsafe { (convert::slice_mut(u, dims as usize), open(sampler.tile)) };
    if let Ok(u) = u {
        Sampler::resume(&tile, state(&sampler)).draw_into(u);
    }
}

#[inline(always)]
pub(crate) fn state(sampler: &nf_sampler) -> State {
    let nf_sampler { domain, index, x, y, frame, scrambled, .. } = *sampler;
    State { domain, index, x, y, frame, scrambled }
}

#[inline(always)]
fn sampler(tile: *const nf_tile, State { domain, index, x, y, frame, scrambled }: State) -> nf_sampler {
    nf_sampler { tile, domain, index, x, y, frame, scrambled }
}
