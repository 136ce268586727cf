//! The numerical hard cases: what each gives, its error, and the plain mean's beside it.
//! `cargo bench --package noisefloor-bench --bench hard_cases`.
//!
//! The cases are those that the tests assert bounds for; here they are measured. Through the Rust API, whose errors
//! have names.

mod draws;
mod errors;
mod many;
mod minibatch;
mod mis;
mod refused;
mod table;

use anyhow::Result;
use clap::Parser;
use std::path::PathBuf;
use table::Tables;

/// Measures every hard case and writes tables.
#[derive(Parser)]
struct Options {
    /// Few repetitions: whether everything works, not the figures.
    #[arg(long)]
    quick: bool,
    /// Eight times the repetitions.
    #[arg(long, conflicts_with = "quick")]
    full: bool,
    /// Where errors.csv and outcomes.csv go; columns are divided by semicolons.
    #[arg(long, default_value_os_t = noisefloor_bench::output("hard-cases"))]
    output: PathBuf,
    /// What cargo adds.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> Result<()> {
    let options = Options::parse();
    let repetitions = match (options.quick, options.full) {
        (true, _) => 32,
        (_, true) => 32_000,
        _ => 4000,
    };
    let mut tables = Tables::default();
    errors::measure(&mut tables, repetitions);
    errors::shared(&mut tables, repetitions);
    many::measure(&mut tables, if options.quick { 100_000 } else { 1_000_000 }, if options.full { 32 } else { 8 });
    mis::measure(&mut tables, repetitions);
    refused::measure(&mut tables);
    minibatch::measure(&mut tables, if options.quick { 20_000 } else { 1_000_000 });
    tables.write(&options.output)?;
    println!("{} cases: {}", tables.len(), options.output.display());
    Ok(())
}
