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

use anyhow::{Context, Result};
use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use std::fs;
use std::path::PathBuf;
use study::{COUNTS, DIMS, Extent};

/// Measures errors and times of samplers and estimators, and prints tables.
#[derive(Parser)]
struct Options {
    /// A quarter of the integrands, and at most 4 samples: whether everything works.
    #[arg(long, conflicts_with = "full")]
    quick: bool,
    /// Four times the integrands, and the cells that take longest.
    #[arg(long)]
    full: bool,
    /// Only these dims.
    #[arg(long, value_delimiter = ',', default_values_t = DIMS)]
    dims: Vec<usize>,
    /// Where tables.md, cells.csv and decisions.csv go.
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
    let (extent, counts) = match (options.quick, options.full) {
        (true, _) => (Extent::Quick, &COUNTS[..2]),
        (_, true) => (Extent::Full, &COUNTS[..]),
        _ => (Extent::Default, &COUNTS[..]),
    };
    for dims in options.dims {
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
    let all = decisions::all(&cells)?;
    let tables = report::markdown(&cells)? + &decisions::markdown(&all)?;
    for (name, text) in
        [("tables.md", &tables), ("cells.csv", &report::csv(&cells)?), ("decisions.csv", &decisions::csv(&all)?)]
    {
        let path = options.output.join(name);
        let new = path.with_extension("new");
        fs::write(&new, text)
            .and_then(|()| fs::rename(&new, &path))
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    print!("{tables}");
    println!("\nin {}", options.output.display());
    Ok(())
}
