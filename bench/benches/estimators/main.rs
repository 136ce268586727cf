//! Every estimator, basis and order on every integrand, and the convergence plots of chapter 4:
//! `cargo bench --package noisefloor-bench --bench estimators`.
//!
//! Settings take turns on the same samples, eight estimates at a time, so that a busy machine slows all alike. Seeds
//! are fixed: errors are the same in every run, times are not. Where errors do not tell whether a setting is safe, they
//! are measured again, longer.

mod again;
mod convergence;
mod fits;
mod functions;
mod grid;
mod race;
mod table;

use anyhow::Result;
use clap::Parser;
use grid::Row;
use indicatif::{ProgressBar, ProgressStyle};
use noisefloor_bench::{Door, c_abi};
use race::Effort;
use std::path::PathBuf;
use std::time::Instant;

/// Seeds of what is measured again begin here.
const AGAIN: u64 = 1000;

/// Measures error and time of every setting and writes tables.
#[derive(Parser)]
struct Options {
    /// Few repetitions and one sample count: whether everything works, not the figures.
    #[arg(long)]
    quick: bool,
    /// Eight times the repetitions.
    #[arg(long, conflicts_with = "quick")]
    full: bool,
    /// Where grid.csv, convergence.csv, fits.csv and recommended.csv go.
    #[arg(long, default_value_os_t = noisefloor_bench::output("estimators"))]
    output: PathBuf,
    /// What cargo adds.
    #[arg(long, hide = true)]
    bench: bool,
}

impl Options {
    fn effort(&self, budget: f64, repetitions: [usize; 2]) -> Effort {
        let factor = if self.full { 8 } else { 1 };
        match self.quick {
            true => Effort { budget: budget / 100.0, repetitions: [8, 16], by_estimator: false },
            false => {
                let repetitions = repetitions.map(|bound| bound * factor);
                Effort { budget: budget * factor as f64, repetitions, by_estimator: false }
            }
        }
    }
}

fn main() -> Result<()> {
    let options = Options::parse();
    println!("through the {}; libnoisefloor.a is {}", Door::shipped().name(), c_abi::STATE);
    let functions = grid::functions();
    let counts = if options.quick { &grid::COUNTS[..1] } else { &grid::COUNTS[..] };
    let total = functions.len() * counts.len() + convergence::steps();
    let bar = ProgressBar::new(total as u64)
        .with_style(ProgressStyle::with_template("{elapsed_precise} {wide_bar} {pos}/{len} {msg}")?);
    // Without this two thirds of the time were the incremental estimator's.
    let effort = Effort { by_estimator: !options.full, ..options.effort(8e5, [16, 512]) };
    let start = Instant::now();
    let mut cells = Vec::new();
    for (seed, (set, function)) in functions.iter().enumerate() {
        for &n in counts {
            bar.set_message(format!("{}, n = {n}", function.name));
            cells.extend(grid::rows(set, function, seed as u64, n, effort));
            bar.inc(1);
        }
    }
    let first = start.elapsed().as_secs_f64();
    let open = again::open(&cells);
    bar.inc_length(open.len() as u64);
    let times = again::TIMES;
    let effort = Effort {
        budget: effort.budget * times as f64,
        repetitions: effort.repetitions.map(|bound| bound * times),
        ..effort
    };
    // Rows of a function and sample count follow each other.
    let same = |&a: &usize, &b: &usize| (&cells[a].integrand, cells[a].n) == (&cells[b].integrand, cells[b].n);
    let groups: Vec<Vec<usize>> = open.chunk_by(same).map(<[usize]>::to_vec).collect();
    for group in groups {
        let Row { integrand, n, .. } = &cells[group[0]];
        bar.set_message(format!("{integrand}, n = {n}, again"));
        let (seed, (_, function)) = (0..).zip(&functions).find(|(_, (_, f))| &f.name == integrand).expect("a function");
        again::measure_again(&mut cells, &group, function, AGAIN + seed, effort);
        bar.inc(group.len() as u64);
    }
    let grid = start.elapsed().as_secs_f64();
    let effort = options.effort(1e7, [24, 1024]);
    let points = convergence::rows(effort, |figure| {
        bar.set_message(format!("figure {figure}"));
        bar.inc(1);
    });
    bar.finish_and_clear();
    table::write(&options.output, &cells, &points, &fits::rows())?;
    let all = start.elapsed().as_secs_f64();
    println!(
        "{} settings {first:.0} s, {} of them again {:.0} s, {} points of plots {:.0} s",
        cells.len(),
        open.len(),
        grid - first,
        points.len(),
        all - grid
    );
    println!("tables: {}", options.output.display());
    Ok(())
}
