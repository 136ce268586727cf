//! The sampler, by value.

use super::view::{check_tile, core_view, live, nf_tile};
use crate::convert;
use crate::status::*;
use crate::wrong::{Wrong, rule};
use noisefloor_core::tile::{Sampler, Shape, Tile};

/// One sample of one pixel, as nf_sampler is, drawn from a tile. Made by nf_tile_sampler_pixel.
#[repr(C)]
#[allow(non_camel_case_types)]
#[derive(Clone, Copy)]
pub struct nf_tile_sampler {
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
    /// 1 after nf_tile_sampler_scramble, otherwise 0.
    pub scrambled: u16,
}

/// Sample `index` of pixel (x, y) in `frame`, any values of each. Samples beyond tile->spp continue with a scrambled
/// Sobol sequence; frames beyond tile->frames are the tile at other places. For an image that is refined over time
/// leave the frame and count the index. The tile must outlive the sampler and stay where it is; of NULL draws are 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_tile_sampler_pixel(
    tile: *const nf_tile,
    x: u32,
    y: u32,
    frame: u32,
    index: u32,
) -> nf_tile_sampler {
    // Draws trust the pointer: one that they cannot use is none.
    let tile = if tile.is_aligned() { tile } else { core::ptr::null() };
    if frame != 0 {
        return later(tile, x, y, frame, index);
    }
    // SAFETY: the caller passes NULL or a tile that lives on; it is aligned, as just checked.
    unsafe { pixel(tile, x, y, 0, index) }
}

/// nf_tile_sampler_pixel of a frame other than the first: apart, so that the first is fast.
#[inline(never)]
fn later(tile: *const nf_tile, x: u32, y: u32, frame: u32, index: u32) -> nf_tile_sampler {
    // SAFETY: as in nf_tile_sampler_pixel.
    unsafe { pixel(tile, x, y, frame, index) }
}

/// # Safety
/// `tile` must be NULL or live.
#[inline(always)]
unsafe fn pixel(tile: *const nf_tile, x: u32, y: u32, frame: u32, index: u32) -> nf_tile_sampler {
    // SAFETY: passed on to the caller.
    match unsafe { core_view(tile) } {
        Some(view) => put(tile, Sampler::pixel(&view, x, y, frame, index)),
        None => put(tile, Sampler::pixel(&NO_TILE, 0, 0, 0, 0)),
    }
}

/// What stands in for a tile that is not looked at.
static NO_TILE: Tile<'static> =
    Tile::resume(Shape { size: 1, spp: 1, dims: 1, frames: 1, bits: 8, progressive: false }, &[]);

/// What is wrong with a sampler, or its tile.
///
/// # Safety
/// The tile must be NULL or live.
pub(crate) unsafe fn check_sampler(sampler: &nf_tile_sampler) -> Result<(), Wrong> {
    rule(sampler.scrambled <= 1, c"scrambled must be 0 or 1")?;
    ensure(sampler.tile.is_aligned(), Wrong(NF_ERR_ALIGNMENT, c"tile must be aligned"))?;
    // SAFETY: passed on to the caller; it is aligned.
    let Some(tile) = (unsafe { live(sampler.tile) }) else { return Ok(()) };
    check_tile(tile)?;
    let side = tile.size.max(1);
    rule(u32::from(sampler.x) < side && u32::from(sampler.y) < side, c"x and y must be below the tile's size")?;
    rule(u32::from(sampler.frame) < tile.frames.max(1), c"frame must be below the tile's frames")
}

/// As nf_sampler_domain().
#[unsafe(no_mangle)]
pub extern "C" fn nf_tile_sampler_domain(sampler: nf_tile_sampler, key: u32) -> nf_tile_sampler {
    put(sampler.tile, of(&NO_TILE, &sampler).domain(key))
}

/// As nf_sampler_scramble(), but the values are shifted, modulo 1.
#[unsafe(no_mangle)]
pub extern "C" fn nf_tile_sampler_scramble(sampler: nf_tile_sampler, seed: u32) -> nf_tile_sampler {
    put(sampler.tile, of(&NO_TILE, &sampler).scramble(seed))
}

/// Writes the first `dims` coordinates, 1..4, as nf_sampler_draw() does. Up to tile->dims are optimised together, more
/// come from other places of the tile. Of a tile that is not progressive, with at least two dims and spp, each further
/// number is stratified, the third with the first two: draw a choice, or a time, after the two numbers beside it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_tile_sampler_draw(sampler: nf_tile_sampler, dims: u32, u: *mut f32) {
    // SAFETY: passed on to the caller.
    unsafe {
        // What is drawn most often, and fast: two stored values of the root's first frame. Apart from all else, so that
        // it needs few registers.
        if dims == 2 {
            let root = (sampler.domain, sampler.frame, sampler.scrambled) == (0, 0, 0);
            if !root || !stored::<2>(&nf_tile_sampler { domain: 0, frame: 0, scrambled: 0, ..sampler }, u) {
                draw::<2>(&sampler, u);
            }
            return;
        }
        match dims {
            1 => draw::<1>(&sampler, u),
            3 => draw::<3>(&sampler, u),
            4 => draw::<4>(&sampler, u),
            _ => {}
        }
    }
}

/// nf_tile_sampler_draw of N numbers.
///
/// # Safety
/// As for [`stored`].
#[inline(never)]
unsafe fn draw<const N: usize>(sampler: &nf_tile_sampler, u: *mut f32) {
    // SAFETY: passed on to the caller.
    unsafe {
        if !stored::<N>(sampler, u) {
            computed::<N>(sampler, u);
        }
    }
}

/// Draws if that needs little but to look up; otherwise returns false.
///
/// # Safety
/// `u` must be NULL or have room for N numbers; the sampler's tile must be NULL or live.
#[inline(always)]
unsafe fn stored<const N: usize>(sampler: &nf_tile_sampler, u: *mut f32) -> bool {
    // SAFETY: passed on to the caller.
    let Some(tile) = (unsafe { core_view(sampler.tile) }) else { return false };
    // SAFETY: passed on to the caller.
    let Ok(u) = (unsafe { convert::room(u.cast::<[f32; N]>()) }) else { return false };
    let mut drawn = [0.0; N];
    of(&tile, sampler).draw_stored(&mut drawn) && write(u, drawn)
}

/// Writes the numbers, four at once: a caller that reads them as one vector would have to wait for four writes to reach
/// the cache.
#[inline(always)]
fn write<const N: usize>(u: &mut convert::Room<[f32; N]>, drawn: [f32; N]) -> bool {
    match drawn[..] {
        #[cfg(target_arch = "x86_64")]
        [a, b, c, d] => {
            use core::arch::x86_64::{_mm_set_ps, _mm_storeu_ps};
            // SAFETY: every x86-64 has SSE. N is 4, and no alignment is needed.
            unsafe { _mm_storeu_ps(u.as_mut_ptr().cast(), _mm_set_ps(d, c, b, a)) }
        }
        _ => _ = u.write(drawn),
    }
    true
}

/// nf_tile_sampler_draw of all others: apart, so that those need few registers.
///
/// # Safety
/// As for [`stored`].
#[inline(never)]
unsafe fn computed<const N: usize>(sampler: &nf_tile_sampler, u: *mut f32) {
    // SAFETY: passed on to the caller.
    let Ok(u) = (unsafe { convert::room(u.cast::<[f32; N]>()) }) else { return };
    // SAFETY: passed on to the caller.
    u.write(match unsafe { core_view(sampler.tile) } {
        Some(tile) => of(&tile, sampler).draw(),
        None => [0.0; N],
    });
}

/// As the core sees it, of a tile.
#[inline(always)]
pub(crate) fn of<'a>(tile: &'a Tile<'a>, sampler: &nf_tile_sampler) -> Sampler<'a> {
    let nf_tile_sampler { domain, index, x, y, frame, scrambled, .. } = *sampler;
    Sampler { tile, domain, index, x, y, frame, scrambled }
}

/// The struct, written so that a caller's copy of it is fast.
///
/// Compilers copy the 24 bytes as 16 and 8. A load can take what was just stored from the store that wrote all of it,
/// but has to wait for several to reach the cache: 15 ns where the struct was written field by field.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn put(tile: *const nf_tile, sampler: Sampler<'_>) -> nf_tile_sampler {
    let Sampler { domain, index, x, y, frame, scrambled, .. } = sampler;
    use core::arch::x86_64::{_mm_set_epi64x, _mm_storeu_si128};
    const _: () = assert!(size_of::<nf_tile_sampler>() == 24 && core::mem::offset_of!(nf_tile_sampler, x) == 16);
    let first = u64::from(domain) | u64::from(index) << 32;
    let last = u64::from(x) | u64::from(y) << 16 | u64::from(frame) << 32 | u64::from(scrambled) << 48;
    let mut out = core::mem::MaybeUninit::<nf_tile_sampler>::uninit();
    // SAFETY: every x86-64 has SSE2. The two stores write all 24 bytes: pointer, domain and index, then four 16-bit
    // numbers.
    unsafe {
        _mm_storeu_si128(out.as_mut_ptr().cast(), _mm_set_epi64x(first as i64, tile.expose_provenance() as i64));
        out.as_mut_ptr().cast::<u64>().add(2).write(last);
        out.assume_init()
    }
}

/// The struct.
#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
fn put(tile: *const nf_tile, sampler: Sampler<'_>) -> nf_tile_sampler {
    let Sampler { domain, index, x, y, frame, scrambled, .. } = sampler;
    nf_tile_sampler { tile, domain, index, x, y, frame, scrambled }
}
