//! Error against speed, measured in one run: `cargo bench --package noisefloor-bench --bench speed_error`.
//!
//! Every estimator sees the same samples in turn, a chunk of repetitions at a time, so that a busy machine slows all of
//! them alike; times are medians over the chunks. The report says what each figure means.

mod cells;
mod machine;
mod must_reach;
mod peer;
mod report;
mod run;
mod speed;

use anyhow::Result;
use cells::{Extent, Set};
use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use noisefloor_bench::{Door, c_abi};
use noisefloor_tests::integrands;
use run::Run;
use std::path::PathBuf;

/// Measures error against speed and writes a report.
#[derive(Parser)]
struct Options {
    /// Few repetitions: whether everything works, not the figures.
    #[arg(long)]
    quick: bool,
    /// Eight times the repetitions.
    #[arg(long, conflicts_with = "quick")]
    full: bool,
    /// Where report.md, must_reach.csv, cells.csv and speed.csv go.
    #[arg(long, default_value_os_t = noisefloor_bench::output("bench-report"))]
    output: PathBuf,
    /// What cargo adds.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> Result<()> {
    let options = Options::parse();
    let door = Door::shipped();
    println!("through the {}; libnoisefloor.a is {}", door.name(), c_abi::STATE);
    if !c_abi::LINKED {
        println!("the figures are the Rust API's: for those of what ships, run `cargo xtask library` first");
    }
    let mut machine = machine::Machine::now();
    let extent = match (options.quick, options.full) {
        (true, _) => Extent::Quick,
        (false, true) => Extent::Full,
        (false, false) => Extent::Normal,
    };
    let sets = [
        (Set::Nine, integrands::nine()),
        (Set::HeldOut, integrands::held_out()),
        (Set::Adversarial, integrands::adversarial()),
    ];
    let integrands: Vec<_> =
        sets.iter().flat_map(|(set, list)| list.iter().map(move |integrand| (*set, *integrand))).collect();
    let total =
        integrands.len() * cells::DEGREES.len() * cells::COUNTS.len() + speed::SIZES.len() * speed::COUNTS.len();
    let bar = ProgressBar::new(total as u64)
        .with_style(ProgressStyle::with_template("{elapsed_precise} {wide_bar} {pos}/{len} {msg}")?);
    let mut speeds = Vec::new();
    for (dims, order) in speed::SIZES {
        for n in speed::COUNTS {
            bar.set_message(format!("speed, {dims}D, n = {n}"));
            speeds.extend(speed::estimates(door, dims, order, n, extent));
            bar.inc(1);
        }
    }
    let solves = speed::solves(extent);
    let mut cells = Vec::new();
    for (index, (set, integrand)) in integrands.iter().enumerate() {
        for degree in cells::DEGREES {
            for n in cells::COUNTS {
                bar.set_message(format!("{}, order {degree}, n = {n}", integrand.name));
                cells::measure(&mut cells, door, *set, integrand, index as u64, degree, n, extent);
                bar.inc(1);
            }
        }
    }
    bar.finish_and_clear();
    machine.finish();
    let run = Run { extent, door, machine, cells, speeds, solves };
    report::write(&run, &options.output)?;
    print!("{}", must_reach::table(&run));
    println!("\nreport: {}", options.output.join("report.md").display());
    Ok(())
}
