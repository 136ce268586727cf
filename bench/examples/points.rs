//! Writes points of public samplers to a file that the path tracer's `--sampler table` reads:
//!
//! `cargo run --package noisefloor-bench --example points -- heitz 4 2 heitz.points`
//!
//! After a line `noisefloor-points WIDTH HEIGHT SAMPLES DIMS`, little-endian f32, [y][x][sample][dim].

use anyhow::{Context, Result, bail};
use openqmc::{LatticeBnSampler, PmjBnSampler, SobolBnSampler};
use sampler::heitz;
use std::path::Path;

#[allow(dead_code, reason = "the bench `samplers` draws from more")]
#[path = "../benches/samplers/sampler.rs"]
mod sampler;

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
