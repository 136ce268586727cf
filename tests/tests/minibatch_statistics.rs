//! Optimal MIS gradients: which are unbiased, how biased the others are, and what they gain.
//!
//! Seeds are fixed. Each z-test, and each comparison of errors, is at significance 1e-5.
//! `cargo test --test noisefloor minibatch_statistics:: -- --nocapture` prints what is measured.

use noisefloor::minibatch::Gradient;
use noisefloor::minibatch::importance::{self, Split};
use noisefloor::mis::{DEFAULT_RIDGE, Solver};
use noisefloor::rng::Rng;
use noisefloor_tests::gradients::{Classifier, Compared, Moments, Regression, bias, compare, moments};
use noisefloor_tests::minibatch::{Problem, Z_LIMIT};

const RIDGE: Solver = Solver::Ridge(DEFAULT_RIDGE);

/// A data set whose gradients nothing explains well, and tables that know their sizes only roughly.
fn unstructured(techniques: usize) -> Problem {
    let mut rng = Rng::seed(77);
    let gradients: Vec<f32> = (0..300 * 5).map(|_| (2.0 * rng.uniform_f32() - 1.0).powi(3)).collect();
    let norm = |gradient| {
        let mut norm = [0.0];
        importance::nodes(gradient, Split::Norm, &mut norm).unwrap();
        f64::from(norm[0])
    };
    let table = |_| gradients.chunks(5).map(|g| norm(g) * rng.uniform_f64()).collect();
    let tables: Vec<Vec<f64>> = (0..techniques).map(table).collect();
    Problem::new(&tables, 0.2, gradients, 5)
}

#[test]
fn balance_is_unbiased() {
    for (k, techniques) in [1, 2, 4, 10].into_iter().enumerate() {
        let problem = unstructured(techniques);
        for counts in [vec![2; techniques], (1..=techniques).collect()] {
            let z = moments(&problem, &counts, Solver::Balance, 30_000, 10 + k as u64).largest_z();
            println!("balance, J = {techniques}, {counts:?}: largest z of 5 = {z:.2}");
            assert!(z < Z_LIMIT);
        }
    }
}

/// The others are biased, as A comes from the samples it is applied to, and less so the larger the batch: about as
/// 1 / batch.
#[test]
fn bias_of_ridge_and_plain_shrinks() {
    // Gradients i^2 and 1 / i over 50 items, with a uniform table and one in proportion to i: not in their span.
    let items = || (1..=50).map(f64::from);
    let gradients = items().flat_map(|i| [(i * i / 1000.0) as f32, (3.0 / i) as f32]).collect();
    let curved = Problem::new(&[vec![1.0; 50], items().collect()], 0.0, gradients, 2);
    let polynomial = Regression::new(3, 300).problem(Split::Sign, 4, 0.2);
    for (name, problem) in [("curved", &curved), ("polynomial", &polynomial)] {
        for (solver, label) in [(RIDGE, "ridge"), (Solver::Plain, "plain")] {
            let biases = [8, 32, 128].map(|batch| {
                let [bias, error] = bias(problem, batch, solver, 20_000);
                println!("{name}, {label}, batch {batch}: bias {bias:.4}, rms error {error:.4} of the gradient's norm");
                assert!(bias < 0.7 * error, "the bias is not what limits an estimate");
                bias
            });
            // A quarter each time, with room for noise in what is left of it.
            assert!(
                biases[0] > 0.005 && biases[1] < 0.4 * biases[0] && biases[2] < 0.15 * biases[0],
                "{name}, {label}: {biases:?}"
            );
        }
    }
}

/// Squared errors of batches of 32, over uniform sampling's: importance sampling gains, optimal MIS with signed tables
/// much more.
#[test]
fn polynomial_regression() {
    for steps in [0, 30, 300] {
        for seed in 0..3 {
            let regression = Regression::new(seed, steps);
            let uniform = Problem::new(&[vec![1.0; 2000]], 0.0, regression.gradients(), 7);
            let one = regression.problem(Split::Norm, 1, 0.2);
            for (techniques, margin) in [(2, 0.7), (4, 0.25)] {
                let signed = regression.problem(Split::Sign, techniques, 0.2);
                let Compared { uniform, one, signed: [balance, plain, ridge] } =
                    compare([&uniform, &one, &signed], 32, 4000);
                let [i, b, p, r] = [one, balance, plain, ridge].map(|error| error.value / uniform);
                println!(
                    "polynomial, {steps} steps, seed {seed}, over uniform: one table {i:.3}; \
                     J = {techniques} balance {b:.3}, plain {p:.4}, ridge {r:.4}"
                );
                assert!(ridge.is_below(margin, one) && ridge.is_below(0.8, balance), "J = {techniques}");
            }
        }
    }
}

/// A linear classifier of 5 classes: signed tables of every class gain over balance weights and over one table of
/// norms; so few samples that A is nearly singular ruin the plain solve and not the ridge.
#[test]
fn classification() {
    for steps in [20, 300] {
        let Classifier { uniform, one, signed } = Classifier::new(steps);
        for batch in [20, 60] {
            let Compared { uniform, one, signed: [balance, plain, ridge] } =
                compare([&uniform, &one, &signed], batch, 4000);
            let [i, b, p, r] = [one, balance, plain, ridge].map(|error| error.value / uniform);
            println!(
                "classifier, {steps} steps, batch {batch}, over uniform: one table {i:.3}; \
                 J = 10 balance {b:.3}, plain {p:.3}, ridge {r:.3}"
            );
            assert!(ridge.is_below(0.9, balance) && ridge.is_below(0.9, one), "{steps} steps, batch {batch}");
            // Two standard errors, significance .03: the plain solve's errors have heavy tails, so their mean is known
            // badly.
            assert!(batch > 20 || plain.value > ridge.value + 2.0 * plain.standard_error, "{steps} steps");
        }
    }
}

/// What averaging over steps buys where the gradient stands still, and that averaging unbiased estimates keeps them so.
#[test]
fn momentum() {
    let problem = Regression::new(1, 300).problem(Split::Sign, 4, 0.2);
    let exact = problem.exact();
    let counts = [2; 4];
    let mut memory = vec![0.0; noisefloor::minibatch::gradient_len(4, 7)];
    for (solver, name) in [(Solver::Balance, "balance"), (RIDGE, "ridge"), (Solver::Plain, "plain")] {
        let mut errors = Vec::new();
        for beta in [0.0, 0.7] {
            let mut rng = Rng::seed(9);
            let mut moments = Moments::new(7);
            for _ in 0..4000 {
                let mut state = Gradient::new(&mut memory[..], 4, 7).unwrap();
                let mut estimate = [0.0; 7];
                for _ in 0..6 {
                    let drawn = problem.draw(&counts, &mut rng);
                    state.estimate(&drawn.batch(), solver, beta, &drawn.gradient, &mut estimate).unwrap();
                }
                moments.add(&estimate.map(f64::from), &exact);
            }
            assert!(solver != Solver::Balance || moments.largest_z() < Z_LIMIT);
            errors.push(moments.squared());
        }
        println!(
            "{name}: 6 steps of 8 samples with beta .7 have {:.4} of the squared error of one",
            errors[1].value / errors[0].value
        );
        assert!(errors[1].is_below(0.4, errors[0]), "{name}");
    }
}
