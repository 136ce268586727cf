//! Minibatches' gradients: optimal MIS beside importance sampling.

use noisefloor::minibatch::importance::Split;
use noisefloor::mis::{DEFAULT_RIDGE, Solver};
use noisefloor_bench::Extent;
use noisefloor_tests::gradients::{self, Classifier, Compared, Regression, compare};
use noisefloor_tests::minibatch::Problem;
use std::fmt::Write;

/// Uniform part of every table.
const UNIFORM: f64 = 0.2;
const SEEDS: u64 = 3;
const BATCHES: usize = 4000;

/// Squared errors over uniform sampling's, a row for each problem.
pub(crate) fn polynomial(size: Extent) -> String {
    let mut text = "steps;tables;error\n".to_owned();
    for steps in [0, 30, 300] {
        for seed in 0..SEEDS {
            let regression = Regression::new(seed, steps);
            let uniform = Problem::new(&[vec![1.0; 2000]], 0.0, regression.gradients(), 7);
            let one = regression.problem(Split::Norm, 1, UNIFORM);
            for techniques in [2, 4] {
                let signed = regression.problem(Split::Sign, techniques, UNIFORM);
                let compared = compare([&uniform, &one, &signed], 32, size.of(BATCHES));
                // The one table is the same beside two and beside four.
                let all = ratios(&compared, techniques).into_iter().skip(usize::from(techniques > 2));
                all.for_each(|(tables, error)| _ = writeln!(text, "{steps};{tables};{error}"));
            }
        }
    }
    text
}

/// The same of a classifier of 5 classes.
pub(crate) fn classifier(size: Extent) -> String {
    let mut text = "steps;batch;tables;error\n".to_owned();
    for steps in [20, 300] {
        let Classifier { uniform, one, signed } = Classifier::new(steps);
        for batch in [20, 60] {
            for (tables, error) in ratios(&compare([&uniform, &one, &signed], batch, size.of(BATCHES)), 10) {
                let _ = writeln!(text, "{steps};{batch};{tables};{error}");
            }
        }
    }
    text
}

/// By tables: one, and so many with each solver.
fn ratios(Compared { uniform, one, signed }: &Compared, count: usize) -> Vec<(String, f64)> {
    let solvers = ["balance", "plain", "ridge"].map(|solver| format!("{count} signed tables, {solver}"));
    let all = ["one table of norms".to_owned()].into_iter().chain(solvers);
    all.zip([one].into_iter().chain(signed)).map(|(tables, error)| (tables, error.value / uniform)).collect()
}

/// Bias and root mean squared error over the gradient's norm, where the gradient is nearly 0.
pub(crate) fn bias(size: Extent) -> String {
    let problem = Regression::new(3, 300).problem(Split::Sign, 4, UNIFORM);
    let mut text = "batch;solver;bias;error\n".to_owned();
    for batch in [8, 32, 128] {
        for (solver, name) in [(Solver::Ridge(DEFAULT_RIDGE), "ridge"), (Solver::Plain, "plain")] {
            let [bias, error] = gradients::bias(&problem, batch, solver, size.of(20_000));
            let _ = writeln!(text, "batch {batch};{name};{bias};{error}");
        }
    }
    text
}
