//! Samplers beside each other: `cargo bench --package noisefloor-bench --bench samplers`.
//!
//! Errors of an image's pixels, raw and filtered, over those of independent samples; nanoseconds of a draw; images of
//! an error and its mean spectrum. What the report's chapter on samplers shows, as CSV and PFM.

mod quality;
mod sampler;
mod sheet;
mod speed;

use anyhow::Result;
use clap::Parser;
use noisefloor_bench::Options;

/// Samples per pixel.
const COUNTS: [usize; 4] = [1, 4, 16, 64];

fn main() -> Result<()> {
    let options = Options::parse();
    let extent = options.extent();
    let counts = &COUNTS[..extent.choose(2, 4, 4)];
    // Of the integrands.
    let share = extent.choose(0.125, 1.0, 4.0);
    let folder = options.output.clone().unwrap_or_else(|| noisefloor_bench::output("samplers"));
    let write = |name: &str, bytes: &[u8]| noisefloor_bench::write(&folder.join(name), bytes);
    write("draws.csv", speed::csv(counts, extent.choose(3, 15, 15))?.as_bytes())?;
    sheet::write(counts, extent.choose(8, 64, 64), write)?;
    write("energies.csv", quality::csv(counts, share)?.as_bytes())?;
    println!("in {}", folder.display());
    Ok(())
}
