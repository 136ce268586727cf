//! Tiles: those that come with the library, and those of a file.

use crate::convert;
use crate::status::*;
use crate::wrong::{Wrong, pick, rule};
use core::ffi::c_void;
use noisefloor_core::tile::{Shape, Tile};

/// A view of a tile: sample points for a square of pixels that repeats over the image (chapter 5; docs/tiles.md). To be
/// copied freely, never written; it owns nothing. All zero is a valid tile, whose samples are all 0.
#[repr(C)]
#[allow(non_camel_case_types)]
#[derive(Clone, Copy)]
pub struct nf_tile {
    /// The stored values, in the memory that the tile was made from.
    pub values: *const c_void,
    /// How many bytes they are.
    pub bytes: usize,
    /// Pixels on a side: a power of two, 1..1024.
    pub size: u32,
    /// Samples of each pixel: a power of two, 1..256.
    pub spp: u32,
    /// Dimensions of each sample that were optimised together: 1..8.
    pub dims: u32,
    /// Frames that follow each other in time: 1..256.
    pub frames: u32,
    /// Bits of each stored coordinate: 8 or 16.
    pub bits: u32,
    /// 1 if the first 1, 2, 4, ... samples of a pixel are well distributed too, otherwise 0.
    pub progressive: u32,
}

// SAFETY: nobody writes what `values` points to.
unsafe impl Sync for nf_tile {}

/// The tile of an .nft file's bytes, all of them checked: about 3 ms for a megabyte. They must outlive it unchanged.
///
/// NF_ERR_RANGE: a len that no memory has; NF_ERR_FOREIGN; NF_ERR_VERSION; NF_ERR_LENGTH; NF_ERR_CORRUPT.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_tile_from_bytes(bytes: *const c_void, len: usize, out: *mut nf_tile) -> nf_status {
    status((|| {
        convert::usable(bytes)?;
        // SAFETY: the caller passes `len` bytes that no one writes meanwhile.
        let bytes = unsafe { convert::slice(bytes.cast::<u8>(), len) }?;
        let tile = Tile::from_bytes(bytes)?;
        // SAFETY: the caller passes NULL or room for a tile.
        unsafe { convert::write(out, view(tile)) }
    })())
}

pub(super) const fn view(tile: Tile<'_>) -> nf_tile {
    let (Shape { size, spp, dims, frames, bits, progressive }, payload) = (tile.shape(), tile.payload());
    let (values, bytes) = (payload.as_ptr().cast(), payload.len());
    nf_tile { values, bytes, size, spp, dims, frames, bits, progressive: progressive as u32 }
}

/// What is wrong with a tile.
pub(crate) fn check_tile(tile: &nf_tile) -> Result<(), Wrong> {
    let &nf_tile { values, bytes, size, spp, dims, frames, bits, progressive } = tile;
    if (values.is_null(), bytes, size, spp, dims, frames, bits, progressive) == (true, 0, 0, 0, 0, 0, 0, 0) {
        return Ok(());
    }
    let progressive = pick(progressive, &[false, true], c"progressive must be 0 or 1")?;
    let shape = Shape { size, spp, dims, frames, bits, progressive };
    shape.check()?;
    ensure(!values.is_null(), Wrong(NF_ERR_NULL, c"values must not be NULL"))?;
    rule(bytes as u64 == shape.payload_bytes(), c"bytes must be size * size * spp * dims * frames * bits / 8")
}

/// The tile that a caller's pointer, or a sampler's, is to.
///
/// # Safety
/// A non-NULL `tile` must be aligned and live.
#[inline(always)]
pub(super) unsafe fn live<'a>(tile: *const nf_tile) -> Option<&'a nf_tile> {
    // A sampler's has been stored as a number, which says where the tile is but not that it may be read: see `put`.
    let tile = core::ptr::with_exposed_provenance::<nf_tile>(tile.expose_provenance());
    // SAFETY: passed on to the caller.
    unsafe { tile.as_ref() }
}

/// The tile as the core sees it; `None` for one without samples, NULL among them, of which every draw is 0.
///
/// # Safety
/// A non-NULL `tile` must be aligned, and one that a function above made, or all zero, and its values be as they were.
#[inline(always)]
pub(crate) unsafe fn core_view<'a>(tile: *const nf_tile) -> Option<Tile<'a>> {
    // SAFETY: passed on to the caller.
    let nf_tile { values, bytes, size, spp, dims, frames, bits, progressive } = *unsafe { live(tile) }?;
    if spp == 0 {
        return None;
    }
    // SAFETY: the values of a tile that has any were checked when it was made.
    let payload = unsafe { core::slice::from_raw_parts(values.cast::<u8>(), bytes) };
    Some(Tile::resume(Shape { size, spp, dims, frames, bits, progressive: progressive != 0 }, payload))
}
