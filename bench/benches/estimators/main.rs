//! Every estimator, basis and order on every integrand:
//! `cargo bench --package noisefloor-bench --bench estimators`.
//!
//! Settings take turns on the same samples, eight estimates at a time, so that a busy machine slows all alike. Seeds
//! are fixed: errors are the same in every run, times are not. Where errors do not tell whether a setting is safe, they
//! are measured again, longer.

mod again;
mod functions;
mod grid;
mod race;
mod table;

use anyhow::Result;
use clap::Parser;
use grid::Row;
use noisefloor_bench::{Extent, Options, c_abi};
use race::Effort;
use std::time::Instant;

/// Seeds of what is measured again begin here.
const AGAIN: u64 = 1000;

fn main() -> Result<()> {
    let options = Options::parse();
    println!("libnoisefloor.a is {}", c_abi::STATE);
    let functions = grid::functions();
    let extent = options.extent();
    let counts = &grid::COUNTS[..extent.choose(1, grid::COUNTS.len(), grid::COUNTS.len())];
    let bar = noisefloor_bench::bar(functions.len() * counts.len())?;
    // Without this two thirds of the time were the incremental estimator's.
    let by_estimator = extent != Extent::Full;
    let (budget, repetitions) = extent.choose((8e3, [8, 16]), (8e5, [16, 512]), (6.4e6, [128, 4096]));
    let first_look = Effort { budget, repetitions, by_estimator };
    let start = Instant::now();
    let mut cells = Vec::new();
    for (seed, function) in functions.iter().enumerate() {
        for &n in counts {
            bar.set_message(format!("{}, n = {n}", function.name));
            cells.extend(grid::rows(function, seed as u64, n, first_look));
            bar.inc(1);
        }
    }
    let first = start.elapsed().as_secs_f64();
    let open = again::open(&cells);
    bar.inc_length(open.len() as u64);
    let times = again::TIMES;
    let second_look = Effort {
        budget: first_look.budget * times as f64,
        repetitions: first_look.repetitions.map(|bound| bound * times),
        ..first_look
    };
    // Rows of a function and sample count follow each other.
    let same = |&a: &usize, &b: &usize| (&cells[a].integrand, cells[a].n) == (&cells[b].integrand, cells[b].n);
    let groups: Vec<Vec<usize>> = open.chunk_by(same).map(<[usize]>::to_vec).collect();
    for group in groups {
        let Row { integrand, n, .. } = &cells[group[0]];
        bar.set_message(format!("{integrand}, n = {n}, again"));
        let (seed, function) = (0..).zip(&functions).find(|(_, f)| &f.name == integrand).expect("a function");
        again::measure_again(&mut cells, &group, function, AGAIN + seed, second_look);
        bar.inc(group.len() as u64);
    }
    bar.finish_and_clear();
    let again = start.elapsed().as_secs_f64() - first;
    println!("{} settings {first:.0} s, {} of them again {again:.0} s", cells.len(), open.len());
    options.write("estimators", &table::all(&cells))
}
