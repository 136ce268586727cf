//! The numerical hard cases: what each gives, its error, and the plain mean's beside it.
//! `cargo bench --package noisefloor-bench --bench hard_cases`.
//!
//! The cases are those that the tests assert bounds for; here they are measured. Through the Rust API, whose errors
//! have names.

mod draws;
mod errors;
mod many;
mod mis;
mod table;

use anyhow::Result;
use clap::Parser;
use noisefloor_bench::Options;
use table::ErrorRow;

fn main() -> Result<()> {
    let options = Options::parse();
    let extent = options.extent();
    let repetitions = extent.choose(32, 4000, 32_000);
    let mut rows: Vec<ErrorRow> = Vec::new();
    errors::measure(&mut rows, repetitions);
    errors::shared(&mut rows, repetitions);
    many::measure(&mut rows, extent.choose(100_000, 1_000_000, 1_000_000), extent.choose(8, 8, 32));
    mis::measure(&mut rows, repetitions);
    println!("{} cases", rows.len());
    options.write("hard-cases", &[("errors.csv", table::csv(&rows))])
}
