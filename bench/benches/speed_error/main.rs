//! Error against speed, measured in one run: `cargo bench --package noisefloor-bench --bench speed_error`.
//!
//! Every estimator sees the same samples in turn, a chunk of repetitions at a time, so that a busy machine slows all of
//! them alike; times are medians over the chunks. bench/README.md says what each figure means.

mod cells;
mod must_reach;
mod peer;
mod report;
mod speed;

use anyhow::Result;
use cells::{Cell, Set};
use clap::Parser;
use noisefloor_bench::{Options, c_abi};
use noisefloor_tests::integrands;
use speed::Speed;

/// All that a run measures.
struct Run {
    cells: Vec<Cell>,
    speeds: Vec<Speed>,
    /// Nanoseconds of a solution.
    solves: Vec<(&'static str, f64)>,
}

fn main() -> Result<()> {
    let options = Options::parse();
    println!("libnoisefloor.a is {}", c_abi::STATE);
    let extent = options.extent();
    let sets = [
        (Set::Nine, integrands::nine()),
        (Set::HeldOut, integrands::held_out()),
        (Set::Adversarial, integrands::adversarial()),
    ];
    let integrands: Vec<_> =
        sets.iter().flat_map(|(set, list)| list.iter().map(move |integrand| (*set, *integrand))).collect();
    let total =
        integrands.len() * cells::DEGREES.len() * cells::COUNTS.len() + speed::SIZES.len() * speed::COUNTS.len();
    let bar = noisefloor_bench::bar(total)?;
    let mut speeds = Vec::new();
    for (dims, order) in speed::SIZES {
        for n in speed::COUNTS {
            bar.set_message(format!("speed, {dims}D, n = {n}"));
            speeds.extend(speed::estimates(dims, order, n, extent));
            bar.inc(1);
        }
    }
    let solves = speed::solves(extent);
    let mut cells = Vec::new();
    for (index, (set, integrand)) in integrands.iter().enumerate() {
        for degree in cells::DEGREES {
            for n in cells::COUNTS {
                bar.set_message(format!("{}, order {degree}, n = {n}", integrand.name));
                cells::measure(&mut cells, *set, integrand, index as u64, degree, n, extent);
                bar.inc(1);
            }
        }
    }
    bar.finish_and_clear();
    let run = Run { cells, speeds, solves };
    print!("{}", must_reach::table(&run));
    options.write("bench-report", &[("must_reach.csv", must_reach::csv(&run)), ("cells.csv", report::cells(&run)?)])
}
