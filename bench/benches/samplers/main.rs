//! Samplers beside each other: `cargo bench --package noisefloor-bench --bench samplers`.
//!
//! Errors of an image's pixels, raw and filtered, over those of independent samples; nanoseconds of a draw; images of
//! an error and its mean spectrum. What the report's chapter on samplers shows, as CSV and PFM.

mod quality;
mod sampler;
mod sheet;
mod speed;

use anyhow::{Context, Result};
use clap::Parser;
use std::fs;
use std::path::PathBuf;

/// Samples per pixel.
const COUNTS: [usize; 4] = [1, 4, 16, 64];
/// Measures errors and times of samplers.
#[derive(Parser)]
struct Options {
    /// A few integrands, one and four samples: whether everything works.
    #[arg(long, conflicts_with = "full")]
    quick: bool,
    /// Four times the integrands.
    #[arg(long)]
    full: bool,
    /// Where energies.csv, draws.csv and the images go.
    #[arg(long, default_value_os_t = noisefloor_bench::output("samplers"))]
    output: PathBuf,
    /// What cargo adds.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> Result<()> {
    let options = Options::parse();
    fs::create_dir_all(&options.output).with_context(|| format!("cannot create {}", options.output.display()))?;
    let counts = if options.quick { &COUNTS[..2] } else { &COUNTS[..] };
    let share = if options.quick { 0.125 } else { f64::from(1 + 3 * u32::from(options.full)) };
    let write = |name: &str, bytes: &[u8]| {
        let path = options.output.join(name);
        let new = path.with_extension("new");
        fs::write(&new, bytes)
            .and_then(|()| fs::rename(&new, &path))
            .with_context(|| format!("cannot write {}", path.display()))
    };
    write("draws.csv", speed::csv(counts, if options.quick { 3 } else { 15 })?.as_bytes())?;
    sheet::write(counts, if options.quick { 8 } else { 64 }, write)?;
    write("energies.csv", quality::csv(counts, share)?.as_bytes())?;
    println!("in {}", options.output.display());
    Ok(())
}
