//! Writes points of public samplers to a file that the path tracer's `--sampler table` reads:
//!
//! `cargo run --package noisefloor-bench --example points -- heitz 4 2 heitz.points`
//!
//! After a line `noisefloor-points WIDTH HEIGHT SAMPLES DIMS`, little-endian f32, [y][x][sample][dim].

use anyhow::{Context, Result, bail};
use openqmc::{LatticeBnSampler, PmjBnSampler, SobolBnSampler};
use std::path::Path;

/// Pixels on a side: the tables' own period is 128 (Heitz) or 64 (OpenQMC, whose pixels differ beyond).
const SIZE: u32 = 128;

const USAGE: &str = "usage: points heitz|openqmc-sobol-bn|openqmc-pmj-bn|openqmc-lattice-bn SAMPLES DIMS FILE";

/// A number of one of OpenQMC's samplers.
macro_rules! open_qmc {
    ($sampler:ident) => {
        |x, y, _, index, dim| {
            let domain = $sampler::new(x as i32, y as i32, 0, index as i32).new_domain((dim / 4) as i32);
            domain.draw_sample_f32::<4>()[dim as usize % 4]
        }
    };
}

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [sampler, samples, dims, file] = arguments.as_slice() else { bail!(USAGE) };
    let number =
        |text: &str| -> Result<u32> { text.parse().with_context(|| format!("`{text}` is no number. {USAGE}")) };
    let (samples, dims) = (number(samples)?, number(dims)?);
    if !(1..=256).contains(&samples) || !(1..=16).contains(&dims) {
        bail!("{samples} samples of {dims} numbers: 1 to 256 of 1 to 16 are possible");
    }
    let draw: fn(u32, u32, u32, u32, u32) -> f32 = match sampler.as_str() {
        "heitz" => heitz,
        "openqmc-sobol-bn" => open_qmc!(SobolBnSampler),
        "openqmc-pmj-bn" => open_qmc!(PmjBnSampler),
        "openqmc-lattice-bn" => open_qmc!(LatticeBnSampler),
        other => bail!("there is no sampler `{other}`. {USAGE}"),
    };
    let mut bytes = format!("noisefloor-points {SIZE} {SIZE} {samples} {dims}\n").into_bytes();
    for y in 0..SIZE {
        for x in 0..SIZE {
            for index in 0..samples {
                for dim in 0..dims {
                    let value = draw(x, y, samples, index, dim).min(1.0_f32.next_down());
                    bytes.extend(value.to_le_bytes());
                }
            }
        }
    }
    noisefloor_bench::write(Path::new(file), &bytes)
}

/// E. Heitz et al. 2019, with the tables that were optimised for so many samples or, of those, the next more.
fn heitz(x: u32, y: u32, samples: u32, index: u32, dim: u32) -> f32 {
    use blue_noise_sampler::{spp1, spp2, spp4, spp8, spp16, spp32, spp64, spp128, spp256};
    let (sobol, ranking, scrambling) = match samples {
        1 => (spp1::SOBOL, spp1::RANKING_TILE, spp1::SCRAMBLING_TILE),
        2 => (spp2::SOBOL, spp2::RANKING_TILE, spp2::SCRAMBLING_TILE),
        3..=4 => (spp4::SOBOL, spp4::RANKING_TILE, spp4::SCRAMBLING_TILE),
        5..=8 => (spp8::SOBOL, spp8::RANKING_TILE, spp8::SCRAMBLING_TILE),
        9..=16 => (spp16::SOBOL, spp16::RANKING_TILE, spp16::SCRAMBLING_TILE),
        17..=32 => (spp32::SOBOL, spp32::RANKING_TILE, spp32::SCRAMBLING_TILE),
        33..=64 => (spp64::SOBOL, spp64::RANKING_TILE, spp64::SCRAMBLING_TILE),
        65..=128 => (spp128::SOBOL, spp128::RANKING_TILE, spp128::SCRAMBLING_TILE),
        _ => (spp256::SOBOL, spp256::RANKING_TILE, spp256::SCRAMBLING_TILE),
    };
    let (dim, pixel) = (dim as usize, ((x & 127) + (y & 127) * 128) as usize);
    let ranked = index as usize ^ ranking.get(dim % 8 + pixel * 8).map_or(0, |&rank| rank as usize);
    let value = sobol[dim + ranked * 256] ^ scrambling[dim % 8 + pixel * 8];
    (0.5 + value as f32) / 256.0
}
