//! Tiles: those that come with the library, and those of a file.

use crate::convert;
use crate::status::*;
use core::ffi::c_void;
use noisefloor_core::tile::{Builtin, Shape, Tile};

/// nf_tile_builtin: 128 x 128 pixels, 1 sample, 2 dims.
pub const NF_TILE_128_1SPP_2D: u32 = 1;
/// nf_tile_builtin: 128 x 128 pixels, 4 samples, 2 dims.
pub const NF_TILE_128_4SPP_2D: u32 = 2;
/// nf_tile_builtin: 128 x 128 pixels, 16 samples, 2 dims.
pub const NF_TILE_128_16SPP_2D: u32 = 3;
/// nf_tile_builtin: 128 x 128 pixels, 16 samples, 2 dims; the first 1, 2, 4 and 8 samples are well distributed too.
pub const NF_TILE_128_16SPP_2D_PROGRESSIVE: u32 = 4;
/// nf_tile_builtin: 128 x 128 pixels, 1 sample, 4 dims.
pub const NF_TILE_128_1SPP_4D: u32 = 5;
/// nf_tile_builtin: 128 x 128 pixels, 4 samples, 4 dims.
pub const NF_TILE_128_4SPP_4D: u32 = 6;
/// nf_tile_builtin: 128 x 128 pixels, 1 sample, 2 dims, for images reconstructed with a Gaussian filter (figures 5.21,
/// 5.22).
pub const NF_TILE_128_1SPP_2D_GAUSSIAN: u32 = 7;
/// nf_tile_builtin: 128 x 128 pixels, 4 samples, 2 dims, for images reconstructed with a Gaussian filter.
pub const NF_TILE_128_4SPP_2D_GAUSSIAN: u32 = 8;
/// nf_tile_builtin: 128 x 128 pixels, 1 sample, 2 dims, 16 frames.
pub const NF_TILE_128_1SPP_2D_TEMPORAL: u32 = 9;
/// nf_tile_builtin: 64 x 64 pixels, 1 sample, 2 dims.
pub const NF_TILE_64_1SPP_2D: u32 = 10;
/// nf_tile_builtin: 64 x 64 pixels, 4 samples, 2 dims.
pub const NF_TILE_64_4SPP_2D: u32 = 11;
/// nf_tile_builtin: 64 x 64 pixels, 4 samples, 2 dims, 16 frames.
pub const NF_TILE_64_4SPP_2D_TEMPORAL: u32 = 12;

const _: () = {
    assert!(NF_TILE_128_1SPP_2D == Builtin::Size128Spp1Dims2 as u32);
    assert!(NF_TILE_128_4SPP_2D == Builtin::Size128Spp4Dims2 as u32);
    assert!(NF_TILE_128_16SPP_2D == Builtin::Size128Spp16Dims2 as u32);
    assert!(NF_TILE_128_16SPP_2D_PROGRESSIVE == Builtin::Size128Spp16Dims2Progressive as u32);
    assert!(NF_TILE_128_1SPP_4D == Builtin::Size128Spp1Dims4 as u32);
    assert!(NF_TILE_128_4SPP_4D == Builtin::Size128Spp4Dims4 as u32);
    assert!(NF_TILE_128_1SPP_2D_GAUSSIAN == Builtin::Size128Spp1Dims2Gaussian as u32);
    assert!(NF_TILE_128_4SPP_2D_GAUSSIAN == Builtin::Size128Spp4Dims2Gaussian as u32);
    assert!(NF_TILE_128_1SPP_2D_TEMPORAL == Builtin::Size128Spp1Dims2Temporal as u32);
    assert!(NF_TILE_64_1SPP_2D == Builtin::Size64Spp1Dims2 as u32);
    assert!(NF_TILE_64_4SPP_2D == Builtin::Size64Spp4Dims2 as u32);
    assert!(NF_TILE_64_4SPP_2D_TEMPORAL == Builtin::Size64Spp4Dims2Temporal as u32);
};

/// A view of a tile: sample points for a square of pixels that repeats over the image (chapter 5; docs/tiles.md).
///
/// A complete struct, to be copied freely; it owns nothing. `nf_tile_128_1spp_2d` and its like come with the library,
/// and a program linked with `--gc-sections` carries those that it names; nf_tile_from_bytes makes others. The fields
/// are to be read, never written; all zero is a valid tile, whose samples are all 0.
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

/// One of the tiles that come with the library, by number: id is NF_TILE_*. A program that calls it carries all of
/// them.
///
/// NF_ERR_NULL; NF_ERR_RANGE: id; NF_ERR_UNSUPPORTED: this library was built without that tile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_tile_builtin(id: u32, out: *mut nf_tile) -> nf_status {
    status((|| {
        let tile = Builtin::from_id(id).ok_or(NF_ERR_RANGE)?.tile().map_err(status_of)?;
        // SAFETY: the caller passes NULL or room for a tile.
        unsafe { convert::write(out, view(tile)) }
    })())
}

/// The tile of an .nft file's bytes, all of them checked: about 3 ms for a megabyte. The bytes must outlive the tile,
/// unchanged; any alignment will do.
///
/// NF_ERR_NULL; NF_ERR_RANGE: len; NF_ERR_FOREIGN: the bytes are no tile; NF_ERR_VERSION: one of a newer format;
/// NF_ERR_LENGTH: truncated, or followed by other bytes; NF_ERR_CORRUPT: damaged.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_tile_from_bytes(bytes: *const c_void, len: usize, out: *mut nf_tile) -> nf_status {
    status((|| {
        if bytes.is_null() {
            return Err(NF_ERR_NULL);
        }
        // SAFETY: the caller passes `len` bytes that no one writes meanwhile.
        let bytes = unsafe { convert::slice(bytes.cast::<u8>(), len) }?;
        let tile = Tile::from_bytes(bytes).map_err(status_of)?;
        // SAFETY: the caller passes NULL or room for a tile.
        unsafe { convert::write(out, view(tile)) }
    })())
}

pub(super) const fn view(tile: Tile<'_>) -> nf_tile {
    let (Shape { size, spp, dims, frames, bits, progressive }, payload) = (tile.shape(), tile.payload());
    let (values, bytes) = (payload.as_ptr().cast(), payload.len());
    nf_tile { values, bytes, size, spp, dims, frames, bits, progressive: progressive as u32 }
}

/// The tile as the core sees it; `None` for one without samples, NULL among them, of which every draw is 0.
///
/// # Safety
/// A non-NULL `tile` must be aligned, and one that a function above made, or all zero, and its values be as they were.
#[inline(always)]
pub(crate) unsafe fn core_view<'a>(tile: *const nf_tile) -> Option<Tile<'a>> {
    // SAFETY: passed on to the caller.
    let nf_tile { values, bytes, size, spp, dims, frames, bits, progressive } = *unsafe { tile.as_ref() }?;
    if spp == 0 {
        return None;
    }
    // SAFETY: the values of a tile that has any were checked when it was made.
    let payload = unsafe { core::slice::from_raw_parts(values.cast::<u8>(), bytes) };
    Some(Tile::resume(Shape { size, spp, dims, frames, bits, progressive: progressive != 0 }, payload))
}
