//! Which sampler and which estimator, and of which order: `cargo bench --package noisefloor-bench --bench guidance`.
//!
//! Small images of many integrands, whose parameters change slowly from pixel to pixel or jump at edges, are estimated from
//! each kind of samples by each estimator. Errors are mean squares over those of the plain mean of as many independent
//! samples, which are known exactly. `docs/choosing.md` is made of the tables; `core/src/recommend.rs` of the same figures.

mod integrands;
mod report;
mod samplers;
mod study;

use anyhow::{Context, Result};
use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use std::fs;
use std::path::PathBuf;
use study::{COUNTS, DIMS};

/// Measures errors and times of samplers and estimators, and prints tables.
#[derive(Parser)]
struct Options {
    /// Four times the integrands, and the cells that take longest.
    #[arg(long)]
    full: bool,
    /// Only these dims.
    #[arg(long, value_delimiter = ',', default_values_t = DIMS)]
    dims: Vec<usize>,
    /// Where tables.md and cells.csv go.
    #[arg(long, default_value_os_t = noisefloor_bench::output("guidance"))]
    output: PathBuf,
    /// What cargo adds.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> Result<()> {
    let options = Options::parse();
    fs::create_dir_all(&options.output).with_context(|| format!("cannot create {}", options.output.display()))?;
    let bar = ProgressBar::new((options.dims.len() * COUNTS.len()) as u64)
        .with_style(ProgressStyle::with_template("{elapsed_precise} {wide_bar} {pos}/{len} {msg}")?);
    let mut cells = Vec::new();
    for dims in options.dims {
        for n in COUNTS {
            bar.set_message(format!("{dims} dims, {n} samples"));
            study::measure(&mut cells, dims, n, options.full)?;
            bar.inc(1);
            // Where no one sees the bar.
            if bar.is_hidden() {
                eprintln!("{dims} dims, {n} samples");
            }
        }
    }
    bar.finish_and_clear();
    let tables = report::markdown(&cells)?;
    for (name, text) in [("tables.md", &tables), ("cells.csv", &report::csv(&cells)?)] {
        let path = options.output.join(name);
        fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))?;
    }
    print!("{tables}");
    println!("\nin {}", options.output.display());
    Ok(())
}
