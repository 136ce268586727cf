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
use noisefloor_bench::Options;
use table::Tables;

fn main() -> Result<()> {
    let options = Options::parse();
    let extent = options.extent();
    let repetitions = extent.choose(32, 4000, 32_000);
    let mut tables = Tables::default();
    errors::measure(&mut tables, repetitions);
    errors::shared(&mut tables, repetitions);
    many::measure(&mut tables, extent.choose(100_000, 1_000_000, 1_000_000), extent.choose(8, 8, 32));
    mis::measure(&mut tables, repetitions);
    refused::measure(&mut tables);
    minibatch::measure(&mut tables, extent.choose(20_000, 1_000_000, 1_000_000));
    println!("{} cases", tables.len());
    options.write("hard-cases", &[("errors.csv", tables.errors()), ("outcomes.csv", tables.outcomes())])
}
