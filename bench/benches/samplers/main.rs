//! Samplers beside each other: `cargo bench --package noisefloor-bench --bench samplers`.
//!
//! Errors of an image's pixels, raw and filtered, over those of independent samples, and nanoseconds of a draw: what
//! the report's chapter on samplers shows.

mod quality;
mod sampler;
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
    let draws = speed::csv(counts, extent.choose(3, 15, 15))?;
    options.write("samplers", &[("draws.csv", draws), ("energies.csv", quality::csv(counts, share)?)])
}
