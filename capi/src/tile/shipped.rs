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

/// The tile NF_TILE_128_1SPP_2D.
#[unsafe(no_mangle)]
pub static nf_tile_128_1spp_2d: nf_tile = builtin(Builtin::Size128Spp1Dims2);
/// The tile NF_TILE_128_4SPP_2D.
#[unsafe(no_mangle)]
pub static nf_tile_128_4spp_2d: nf_tile = builtin(Builtin::Size128Spp4Dims2);
/// The tile NF_TILE_128_16SPP_2D.
#[unsafe(no_mangle)]
pub static nf_tile_128_16spp_2d: nf_tile = builtin(Builtin::Size128Spp16Dims2);
/// The tile NF_TILE_128_16SPP_2D_PROGRESSIVE.
#[unsafe(no_mangle)]
pub static nf_tile_128_16spp_2d_progressive: nf_tile = builtin(Builtin::Size128Spp16Dims2Progressive);
/// The tile NF_TILE_128_1SPP_4D.
#[unsafe(no_mangle)]
pub static nf_tile_128_1spp_4d: nf_tile = builtin(Builtin::Size128Spp1Dims4);
/// The tile NF_TILE_128_4SPP_4D.
#[unsafe(no_mangle)]
pub static nf_tile_128_4spp_4d: nf_tile = builtin(Builtin::Size128Spp4Dims4);
/// The tile NF_TILE_128_1SPP_2D_GAUSSIAN.
#[unsafe(no_mangle)]
pub static nf_tile_128_1spp_2d_gaussian: nf_tile = builtin(Builtin::Size128Spp1Dims2Gaussian);
/// The tile NF_TILE_128_4SPP_2D_GAUSSIAN.
#[unsafe(no_mangle)]
pub static nf_tile_128_4spp_2d_gaussian: nf_tile = builtin(Builtin::Size128Spp4Dims2Gaussian);
/// The tile NF_TILE_128_1SPP_2D_TEMPORAL.
#[unsafe(no_mangle)]
pub static nf_tile_128_1spp_2d_temporal: nf_tile = builtin(Builtin::Size128Spp1Dims2Temporal);
/// The tile NF_TILE_64_1SPP_2D.
#[unsafe(no_mangle)]
pub static nf_tile_64_1spp_2d: nf_tile = builtin(Builtin::Size64Spp1Dims2);
/// The tile NF_TILE_64_4SPP_2D.
#[unsafe(no_mangle)]
pub static nf_tile_64_4spp_2d: nf_tile = builtin(Builtin::Size64Spp4Dims2);
/// The tile NF_TILE_64_4SPP_2D_TEMPORAL.
#[unsafe(no_mangle)]
pub static nf_tile_64_4spp_2d_temporal: nf_tile = builtin(Builtin::Size64Spp4Dims2Temporal);
