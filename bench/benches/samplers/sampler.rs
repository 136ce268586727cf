//! The samplers that are compared: the library's, and those that registries carry under permissive licences.

use anyhow::{Result, anyhow};
use noisefloor::recommend::{Sampling, recommend};
use noisefloor::rng::Rng;
use noisefloor::sampler;
use noisefloor::tile::{Builtin, Sampler as Draw, Tile};
use openqmc::{LatticeBnSampler, PmjBnSampler, SobolBnSampler};

/// Pixels on a side of every image: the tiles' period.
pub(crate) const SIDE: usize = 128;
/// Numbers of a sample.
pub(crate) const DIMS: [usize; 2] = [2, 4];

/// A sampler. Each seed is another realisation, where there are any.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sampler {
    /// Independent numbers: the library's PCG.
    Random,
    /// Owen-scrambled Sobol points, each pixel's scrambled on their own: the crate `sobol_burley`.
    Sobol,
    /// E. Heitz et al. 2019, the tables for as many samples: the crate `blue-noise-sampler`.
    Heitz,
    /// OpenQMC's three, from the crate `openqmc-rs`.
    OpenQmcSobol,
    OpenQmcPmj,
    OpenQmcLattice,
    /// The library's default sampler; each seed is a frame.
    Default,
    /// The tile that `recommend()` names for as many samples and dims.
    Tile,
    /// The progressive tile of 16 samples of two dims.
    Progressive,
}

impl Sampler {
    pub(crate) const ALL: [Self; 9] = [
        Self::Random,
        Self::Sobol,
        Self::Heitz,
        Self::OpenQmcSobol,
        Self::OpenQmcPmj,
        Self::OpenQmcLattice,
        Self::Default,
        Self::Tile,
        Self::Progressive,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Sobol => "Owen-Sobol",
            Self::Heitz => "Heitz",
            Self::OpenQmcSobol => "OpenQMC sobol-bn",
            Self::OpenQmcPmj => "OpenQMC pmj-bn",
            Self::OpenQmcLattice => "OpenQMC lattice-bn",
            Self::Default => "default",
            Self::Tile => "tile",
            Self::Progressive => "progressive tile",
        }
    }

    pub(crate) fn applies(self, dims: usize) -> bool {
        self != Self::Progressive || dims == 2
    }

    /// The built-in tile that it draws from, if it does.
    pub(crate) fn builtin(self, dims: usize, spp: usize) -> Result<Option<Builtin>> {
        match self {
            Self::Tile => {}
            Self::Progressive => return Ok(Some(Builtin::Size128Spp16Dims2Progressive)),
            _ => return Ok(None),
        }
        let best =
            recommend(dims, spp, Sampling::Stratified, false, f32::INFINITY).map_err(|error| anyhow!("{error}"))?;
        let is_it = |builtin: &Builtin| {
            builtin.tile().is_ok_and(|tile| {
                let shape = tile.shape();
                let of = (shape.spp as usize, shape.dims as usize);
                shape.size as usize == SIDE && of == (best.tile_samples, best.tile_dims) && shape.frames == 1
            })
        };
        // The first of this shape is the plain one.
        let found = Builtin::ALL.into_iter().find(is_it);
        found.map(Some).ok_or_else(|| anyhow!("no built-in tile of {SIDE} pixels for {spp} samples of {dims} dims"))
    }

    /// The same, to draw from.
    pub(crate) fn tile(self, dims: usize, spp: usize) -> Result<Option<Tile<'static>>> {
        let Some(builtin) = self.builtin(dims, spp)? else { return Ok(None) };
        builtin.tile().map(Some).map_err(|error| anyhow!("tile {}: {error}", builtin.name()))
    }

    /// The points of an image: [y][x][sample][dim].
    pub(crate) fn points(self, dims: usize, spp: usize, seed: u32) -> Result<Vec<f32>> {
        let mut u = vec![0.0; SIDE * SIDE * spp * dims];
        let tile = self.tile(dims, spp)?;
        let mut rng = Rng::seed(u64::from(seed) + 1);
        for (place, u) in u.chunks_exact_mut(dims).enumerate() {
            let (pixel, index) = ((place / spp) as u32, (place % spp) as u32);
            let (x, y) = (pixel % SIDE as u32, pixel / SIDE as u32);
            let (column, row, frame, i) = (x as i32, y as i32, seed as i32, index as i32);
            let four: [f32; 4] = match (self, &tile) {
                (_, Some(tile)) => of_tile(tile, x, y, index, seed, dims),
                (Self::Sobol, _) => sobol(x, y, index, seed),
                (Self::Heitz, _) => [0, 1, 2, 3].map(|dim| heitz(x, y, spp as u32, index, dim)),
                (Self::OpenQmcSobol, _) => SobolBnSampler::new(column, row, frame, i).draw_sample_f32(),
                (Self::OpenQmcPmj, _) => PmjBnSampler::new(column, row, frame, i).draw_sample_f32(),
                (Self::OpenQmcLattice, _) => LatticeBnSampler::new(column, row, frame, i).draw_sample_f32(),
                (Self::Default, _) => sampler::Sampler::pixel(x, y, seed, index).draw(),
                _ => [(); 4].map(|()| rng.uniform_f32()),
            };
            u.copy_from_slice(&four[..dims]);
            // One crate's rounding reaches 1.
            u.iter_mut().for_each(|u| *u = u.min(1.0_f32.next_down()));
        }
        Ok(u)
    }
}

/// The first `wanted` of four numbers. Seed 0 is the tile as it is, others are domains: the tile at other places.
fn of_tile(tile: &Tile<'_>, x: u32, y: u32, index: u32, seed: u32, wanted: usize) -> [f32; 4] {
    let root = Draw::pixel(tile, x, y, 0, index);
    let root = if seed == 0 { root } else { root.domain(seed) };
    let dims = tile.shape().dims as usize;
    let mut u = [0.0; 4];
    if dims >= wanted {
        root.draw_into(&mut u[..wanted]);
    } else {
        // More numbers than the tile has: a domain for each group, of keys that are no seeds.
        for (u, key) in u.chunks_mut(dims).zip(1000..) {
            root.domain(key).draw_into(u);
        }
    }
    u
}

/// Four numbers, with a seed for each pixel.
#[inline]
pub(crate) fn sobol(x: u32, y: u32, index: u32, seed: u32) -> [f32; 4] {
    let mut key = (y << 16 | x).wrapping_add(seed.wrapping_mul(0x9e37_79b9));
    key = (key ^ key >> 16).wrapping_mul(0x21f0_aaad);
    key = (key ^ key >> 15).wrapping_mul(0x735a_2d97);
    sobol_burley::sample_4d(index, 0, key ^ key >> 15)
}

/// A number of the tables that were optimised for so many samples or, of those, the next more.
#[inline]
pub(crate) fn heitz(x: u32, y: u32, samples: u32, index: u32, dim: u32) -> f32 {
    use blue_noise_sampler::{spp1, spp4, spp16, spp64};
    let (sobol, ranking, scrambling) = match samples {
        0..=1 => (spp1::SOBOL, spp1::RANKING_TILE, spp1::SCRAMBLING_TILE),
        2..=4 => (spp4::SOBOL, spp4::RANKING_TILE, spp4::SCRAMBLING_TILE),
        5..=16 => (spp16::SOBOL, spp16::RANKING_TILE, spp16::SCRAMBLING_TILE),
        _ => (spp64::SOBOL, spp64::RANKING_TILE, spp64::SCRAMBLING_TILE),
    };
    let (dim, pixel) = (dim as usize, ((x & 127) + (y & 127) * 128) as usize);
    let ranked = index as usize ^ ranking.get(dim % 8 + pixel * 8).map_or(0, |&rank| rank as usize);
    let value = sobol[dim + ranked * 256] ^ scrambling[dim % 8 + pixel * 8];
    (0.5 + value as f32) / 256.0
}
