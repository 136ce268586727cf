//! Which sampler and which estimator, and of which order: `cargo bench --package noisefloor-bench --bench guidance`.
//!
//! Small images of many integrands, whose parameters change slowly from pixel to pixel or jump at edges, are estimated
//! from each kind of samples by each estimator. Errors are mean squares over those of the plain mean of as many
//! independent samples, which are known exactly. The report's chapter on samplers has the tables;
//! `core/src/recommend.rs` holds decisions from them.

mod decisions;
mod integrands;
mod report;
mod samplers;
mod study;

use anyhow::Result;
use clap::Parser;
use noisefloor_bench::Extent;
use study::{COUNTS, DIMS};

#[derive(Parser)]
struct Arguments {
    /// Only these dims
    #[arg(long, value_delimiter = ',', default_values_t = DIMS)]
    dims: Vec<usize>,
    #[command(flatten)]
    common: noisefloor_bench::Options,
}

fn main() -> Result<()> {
    let Arguments { dims, common } = Arguments::parse();
    let bar = noisefloor_bench::bar(dims.len() * COUNTS.len())?;
    let mut cells = Vec::new();
    let extent = common.extent();
    let counts = if extent == Extent::Quick { &COUNTS[..2] } else { &COUNTS[..] };
    for dims in dims {
        for &n in counts {
            bar.set_message(format!("{dims} dims, {n} samples"));
            study::measure(&mut cells, dims, n, extent)?;
            bar.inc(1);
            // Where no one sees the bar.
            if bar.is_hidden() {
                eprintln!("{dims} dims, {n} samples");
            }
        }
    }
    bar.finish_and_clear();
    let decisions = decisions::csv(&decisions::all(&cells)?)?;
    common.write("guidance", &[("cells.csv", report::csv(&cells)?), ("decisions.csv", decisions)])
}
