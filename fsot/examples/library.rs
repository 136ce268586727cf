//! Spreads points by a density, a function; a run that was interrupted is continued.
//!
//! `cargo run --profile fsot --package noisefloor-fsot --example library > points.txt`

use fsot::checkpoint;
use fsot::class::{Class, ClassFunction};
use fsot::error::Result;
use fsot::optimize::{Optimizer, Problem};
use fsot::run::Optimization;
use fsot::target::Function;
use std::path::Path;
use std::sync::Arc;

const POINTS: usize = 1024;
const SEED: u64 = 1;

fn main() -> Result<()> {
    let target = Function::new(2, POINTS, |x| x[0] * (1.0 - x[1]))?;
    let all =
        Class { function: ClassFunction::Constant, target: Arc::new(target), weight: 1.0, name: "all".to_owned() };
    let mut optimizer = Optimizer::new(Problem { classes: vec![all], seed: SEED, ..Problem::new(POINTS, 2) })?;

    // What a checkpoint is of: whatever changes the points, in words or numbers. A function has none of its own.
    let problem = checkpoint::Problem::new(&("x (1 - y)", POINTS, SEED))?;
    let path = Path::new("library.checkpoint");
    if checkpoint::resume(path, &problem, &mut optimizer)? {
        eprintln!("continuing at step {}", optimizer.iteration());
    }
    while optimizer.iteration() < optimizer.iterations() {
        let energy = optimizer.step();
        if optimizer.iteration() % 100 == 0 {
            eprintln!("step {} of {}, energy {energy:.2e}", optimizer.iteration(), optimizer.iterations());
            checkpoint::save(path, &problem, &optimizer)?;
        }
    }
    for point in optimizer.points().iter() {
        println!("{} {}", point[0], point[1]);
    }
    checkpoint::remove(path, &problem);
    Ok(())
}
