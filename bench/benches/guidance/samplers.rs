//! Where the samples come from.

use anyhow::{Result, anyhow};
use noisefloor::tile::{Builtin, Sampler, Shape, Tile};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::tile::noise;

/// A kind of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// Independent.
    Independent,
    /// Owen-scrambled Sobol points, each pixel's scrambled on their own; groups of four coordinates are padded.
    Sobol,
    /// The tile of two dims with n samples, or of 16, continued; each pair of coordinates is a domain.
    Tile,
    /// The same with a frame for each 16 samples instead.
    TileFrames,
    /// The tile of four dims with at most n samples, continued; each four coordinates are a domain.
    Tile4,
    /// A tile of 1 sample, continued: a Sobol sequence that all pixels share. Of four dims, if there are more than two.
    TileSobol,
}

impl Source {
    pub(crate) const ALL: [Self; 6] =
        [Self::Independent, Self::Sobol, Self::Tile, Self::TileFrames, Self::Tile4, Self::TileSobol];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::Sobol => "Sobol per pixel",
            Self::Tile => "tile",
            Self::TileFrames => "tile, a frame for each 16",
            Self::Tile4 => "tile of 4 dims",
            Self::TileSobol => "tile of 1 sample, continued",
        }
    }

    /// Whether it differs from the others there.
    pub(crate) fn applies(self, dims: usize, n: usize) -> bool {
        match self {
            Self::Independent | Self::Tile => true,
            Self::Sobol | Self::TileSobol => n > 1,
            Self::TileFrames => n > 16,
            Self::Tile4 => dims > 2,
        }
    }

    /// Whether all estimators are measured on it, instead of the plain mean alone.
    pub(crate) fn is_main(self, dims: usize, n: usize) -> bool {
        matches!(self, Self::Independent | Self::Sobol | Self::Tile) || (self == Self::Tile4 && dims == 4 && n <= 4)
    }

    /// The points of a square image: pixel after pixel, sample after sample.
    pub(crate) fn points(self, dims: usize, n: usize, side: usize, seed: u64) -> Result<Vec<f32>> {
        let mut rng = SplitMix64::new(seed);
        let mut u = vec![0.0; side * side * n * dims];
        let built_in = |tile: Builtin| tile.tile().map_err(|error| anyhow!("tile {}: {error}", tile.name()));
        // Of a domain of its own in each pixel, the continuation is a scrambled sequence, whatever the tile.
        let bytes = noise(Shape { size: 64, spp: 1, dims: 4, frames: 1, bits: 16, progressive: false }, seed);
        let tile = match self {
            Self::Independent => {
                u.iter_mut().for_each(|u| *u = rng.uniform_f32());
                return Ok(u);
            }
            Self::Sobol => Tile::from_bytes(&bytes).map_err(|error| anyhow!("{error}"))?,
            Self::Tile | Self::TileFrames => built_in(match n {
                ..4 => Builtin::Size128Spp1Dims2,
                4..16 => Builtin::Size128Spp4Dims2,
                _ => Builtin::Size128Spp16Dims2,
            })?,
            Self::Tile4 if n < 4 => built_in(Builtin::Size128Spp1Dims4)?,
            Self::Tile4 => built_in(Builtin::Size128Spp4Dims4)?,
            Self::TileSobol if dims == 2 => built_in(Builtin::Size128Spp1Dims2)?,
            Self::TileSobol => built_in(Builtin::Size128Spp1Dims4)?,
        };
        let spp = tile.shape().spp;
        let key = rng.next_u64() as u32;
        for (place, u) in u.chunks_exact_mut(dims).enumerate() {
            let (pixel, index) = ((place / n) as u32, (place % n) as u32);
            let (x, y) = (pixel % side as u32, pixel / side as u32);
            let (frame, index) = if self == Self::TileFrames { (index / spp, index % spp) } else { (0, index) };
            let mut sampler = Sampler::pixel(&tile, x, y, frame, index).domain(key);
            if self == Self::Sobol {
                sampler = sampler.domain(pixel);
            }
            for (u, group) in u.chunks_mut(tile.shape().dims as usize).zip(0..) {
                sampler.domain(group).draw_into(u);
            }
        }
        Ok(u)
    }
}
