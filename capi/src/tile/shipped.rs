//! The tiles that come with the library, each a symbol of its own: a program carries those that it names.

#![allow(non_upper_case_globals)]

use super::view::{nf_tile, view};
use noisefloor_core::tile::Builtin;

const fn builtin(tile: Builtin) -> nf_tile {
    match tile.tile() {
        Ok(tile) => view(tile),
        Err(_) => panic!("the C library is built with all tiles"),
    }
}

/// 128 x 128 pixels, 1 sample, 2 dims.
#[unsafe(no_mangle)]
pub static nf_tile_128_1spp_2d: nf_tile = builtin(Builtin::Size128Spp1Dims2);
/// The same, 4 samples.
#[unsafe(no_mangle)]
pub static nf_tile_128_4spp_2d: nf_tile = builtin(Builtin::Size128Spp4Dims2);
/// The same, 16 samples.
#[unsafe(no_mangle)]
pub static nf_tile_128_16spp_2d: nf_tile = builtin(Builtin::Size128Spp16Dims2);
/// The same, 16 samples, of which the first 1, 2, 4 and 8 are well distributed too.
#[unsafe(no_mangle)]
pub static nf_tile_128_16spp_2d_progressive: nf_tile = builtin(Builtin::Size128Spp16Dims2Progressive);
/// 128 x 128 pixels, 1 sample, 4 dims.
#[unsafe(no_mangle)]
pub static nf_tile_128_1spp_4d: nf_tile = builtin(Builtin::Size128Spp1Dims4);
/// The same, 4 samples.
#[unsafe(no_mangle)]
pub static nf_tile_128_4spp_4d: nf_tile = builtin(Builtin::Size128Spp4Dims4);
/// 128 x 128 pixels, 1 sample, 2 dims, for films that splat samples by a Gaussian filter (figures 5.21, 5.22).
#[unsafe(no_mangle)]
pub static nf_tile_128_1spp_2d_gaussian: nf_tile = builtin(Builtin::Size128Spp1Dims2Gaussian);
/// The same, 4 samples.
#[unsafe(no_mangle)]
pub static nf_tile_128_4spp_2d_gaussian: nf_tile = builtin(Builtin::Size128Spp4Dims2Gaussian);
/// 128 x 128 pixels, 1 sample, 2 dims, 16 frames.
#[unsafe(no_mangle)]
pub static nf_tile_128_1spp_2d_temporal: nf_tile = builtin(Builtin::Size128Spp1Dims2Temporal);
/// 64 x 64 pixels, 1 sample, 2 dims.
#[unsafe(no_mangle)]
pub static nf_tile_64_1spp_2d: nf_tile = builtin(Builtin::Size64Spp1Dims2);
/// The same, 4 samples.
#[unsafe(no_mangle)]
pub static nf_tile_64_4spp_2d: nf_tile = builtin(Builtin::Size64Spp4Dims2);
/// The same, 4 samples, 16 frames.
#[unsafe(no_mangle)]
pub static nf_tile_64_4spp_2d_temporal: nf_tile = builtin(Builtin::Size64Spp4Dims2Temporal);
