//! Optimal MIS gradients: which are unbiased, how biased the others are, and what they gain.
//!
//! Seeds are fixed. Each z-test, and each comparison of errors, is at significance 1e-5. `cargo test --test minibatch_statistics -- --nocapture` prints
//! what is measured.

mod minibatch_support;

use minibatch_support::{Problem, Z_LIMIT};
use noisefloor::minibatch::Gradient;
use noisefloor::minibatch::importance::{self, Split};
use noisefloor::mis::{DEFAULT_RIDGE, Solver};
use noisefloor::rng::Rng;

const RIDGE: Solver = Solver::Ridge(DEFAULT_RIDGE);

/// Sums of the estimates of every parameter.
struct Moments {
    count: f64,
    sum: Vec<f64>,
    squares: Vec<f64>,
    /// The sum of each estimate's squared error, squared.
    fourths: f64,
}

/// A mean squared error, with its standard error.
#[derive(Clone, Copy)]
struct Squared {
    value: f64,
    standard_error: f64,
}

impl Squared {
    /// Whether this is below `factor` times the other, at significance 1e-5.
    fn is_below(self, factor: f64, other: Squared) -> bool {
        let z = (factor * other.value - self.value) / self.standard_error.hypot(factor * other.standard_error);
        z > Z_LIMIT
    }
}

impl Moments {
    fn new(parameters: usize) -> Moments {
        Moments { count: 0.0, sum: vec![0.0; parameters], squares: vec![0.0; parameters], fourths: 0.0 }
    }

    fn add(&mut self, estimate: &[f64], exact: &[f64]) {
        self.count += 1.0;
        for (p, (estimate, exact)) in estimate.iter().zip(exact).enumerate() {
            self.sum[p] += estimate - exact;
            self.squares[p] += (estimate - exact).powi(2);
        }
        self.fourths += estimate.iter().zip(exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>().powi(2);
    }

    /// Mean squared error, summed over the parameters.
    fn error(&self) -> f64 {
        self.squares.iter().sum::<f64>() / self.count
    }

    fn squared(&self) -> Squared {
        let value = self.error();
        Squared { value, standard_error: ((self.fourths / self.count - value * value) / self.count).sqrt() }
    }

    /// The squared length of the bias, less what noise adds to it.
    fn squared_bias(&self) -> f64 {
        let n = self.count;
        let terms = self.sum.iter().zip(&self.squares);
        terms.map(|(sum, squares)| (sum / n).powi(2) - (squares / n - (sum / n).powi(2)) / n).sum()
    }

    fn largest_z(&self) -> f64 {
        let n = self.count;
        let z = |(sum, squares): (&f64, &f64)| sum / n / ((squares / n - (sum / n).powi(2)) / n).sqrt();
        self.sum.iter().zip(&self.squares).map(z).fold(0.0, |largest, z| f64::max(largest, z.abs()))
    }
}

fn moments(problem: &Problem, counts: &[usize], solver: Solver, batches: usize, seed: u64) -> Moments {
    let exact = problem.exact();
    let mut rng = Rng::seed(seed);
    let mut moments = Moments::new(problem.parameters);
    for _ in 0..batches {
        moments.add(&problem.draw(counts, &mut rng).estimate(solver), &exact);
    }
    moments
}

/// Regression by a polynomial of order 6 on [-2, 2] (6.2.4): the loss sum (f(x) - y)^2 over 2,000 points, and the state
/// that a trainer reaches after some steps of gradient descent.
struct Regression {
    /// Powers 0..=6 of x / 2, and the target, of each point.
    points: Vec<([f64; 7], f64)>,
    theta: [f64; 7],
}

impl Regression {
    fn new(seed: u64, steps: usize) -> Regression {
        let mut rng = Rng::seed(seed);
        let mut coefficient = || 2.0 * rng.uniform_f64() - 1.0;
        let target = [(); 7].map(|()| coefficient());
        let mut theta = [(); 7].map(|()| coefficient());
        let points: Vec<_> = (0..2000)
            .map(|_| {
                let x = 2.0 * rng.uniform_f64() - 1.0;
                let powers: [f64; 7] = std::array::from_fn(|k| x.powi(k as i32));
                (powers, powers.iter().zip(&target).map(|(x, t)| x * t).sum())
            })
            .collect();
        for _ in 0..steps {
            let mut mean = [0.0; 7];
            for (x, y) in &points {
                let residual: f64 = x.iter().zip(&theta).map(|(x, t)| x * t).sum::<f64>() - y;
                mean.iter_mut().zip(x).for_each(|(mean, x)| *mean += 2.0 * residual * x / points.len() as f64);
            }
            theta.iter_mut().zip(mean).for_each(|(theta, g)| *theta -= 0.2 * g);
        }
        Regression { points, theta }
    }

    fn gradients(&self) -> Vec<f32> {
        let gradient = |(x, y): &([f64; 7], f64)| {
            let residual: f64 = x.iter().zip(&self.theta).map(|(x, t)| x * t).sum::<f64>() - y;
            x.map(|x| (2.0 * residual * x) as f32)
        };
        self.points.iter().flat_map(gradient).collect()
    }

    /// Tables of what [`importance::nodes`] makes of each point's gradient by the coefficients.
    fn problem(&self, split: Split, techniques: usize, uniform: f64) -> Problem {
        let gradients = self.gradients();
        let mut tables = vec![Vec::new(); techniques];
        for gradient in gradients.chunks(7) {
            let mut q = vec![0.0; techniques];
            importance::nodes(gradient, split, &mut q).unwrap();
            tables.iter_mut().zip(q).for_each(|(table, q)| table.push(f64::from(q)));
        }
        Problem::new(&tables, uniform, gradients, 7)
    }
}

/// A data set whose gradients nothing explains well, and tables that know their sizes only roughly.
fn unstructured(techniques: usize) -> Problem {
    let mut rng = Rng::seed(77);
    let gradients: Vec<f32> = (0..300 * 5).map(|_| (2.0 * rng.uniform_f32() - 1.0).powi(3)).collect();
    let table = |_| gradients.chunks(5).map(|g| f64::from(importance::gradient(g)) * rng.uniform_f64()).collect();
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
        let size: f64 = problem.exact().iter().map(|g| g * g).sum();
        for (solver, label) in [(RIDGE, "ridge"), (Solver::Plain, "plain")] {
            let bias = [8, 32, 128].map(|batch| {
                let counts = vec![batch / problem.techniques; problem.techniques];
                let m = moments(problem, &counts, solver, 20_000, 20);
                let bias = (m.squared_bias().max(0.0) / size).sqrt();
                let error = (m.error() / size).sqrt();
                println!("{name}, {label}, batch {batch}: bias {bias:.4}, rms error {error:.4} of the gradient's norm");
                assert!(bias < 0.7 * error, "the bias is not what limits an estimate");
                bias
            });
            // A quarter each time, with room for noise in what is left of it.
            assert!(
                bias[0] > 0.005 && bias[1] < 0.4 * bias[0] && bias[2] < 0.15 * bias[0],
                "{name}, {label}: {bias:?}"
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
            let base = moments(&uniform, &[32], Solver::Balance, 4000, 1).error();
            let one = regression.problem(Split::Norm, 1, 0.2);
            let importance = moments(&one, &[32], Solver::Balance, 4000, 2).squared();
            print!("polynomial, {steps} steps, seed {seed}, over uniform: one table {:.3}", importance.value / base);
            for (techniques, margin) in [(2, 0.7), (4, 0.25)] {
                let problem = regression.problem(Split::Sign, techniques, 0.2);
                let counts = vec![32 / techniques; techniques];
                let error = |solver| moments(&problem, &counts, solver, 4000, 3).squared();
                let (balance, plain, ridge) = (error(Solver::Balance), error(Solver::Plain), error(RIDGE));
                let [b, p, r] = [balance, plain, ridge].map(|error| error.value / base);
                print!("; J = {techniques} balance {b:.3}, plain {p:.4}, ridge {r:.4}");
                assert!(ridge.is_below(margin, importance) && ridge.is_below(0.8, balance), "J = {techniques}");
            }
            println!();
        }
    }
}

/// A linear classifier of 5 classes: signed tables of every class gain over balance weights and over one table of
/// norms; so few samples that A is nearly singular ruin the plain solve and not the ridge.
#[test]
fn classification() {
    for steps in [20, 300] {
        let (classes, gradients) = classifier(5, steps);
        let problem = |split, techniques| {
            let mut tables = vec![Vec::new(); techniques];
            for nodes in classes.chunks(5) {
                let mut q = vec![0.0; techniques];
                importance::nodes(nodes, split, &mut q).unwrap();
                tables.iter_mut().zip(q).for_each(|(table, q)| table.push(f64::from(q)));
            }
            Problem::new(&tables, 0.2, gradients.clone(), 30)
        };
        let uniform = Problem::new(&[vec![1.0; 1000]], 0.0, gradients.clone(), 30);
        let (one, signed) = (problem(Split::Norm, 1), problem(Split::Sign, 10));
        for batch in [20, 60] {
            let base = moments(&uniform, &[batch], Solver::Balance, 4000, 1).error();
            let importance = moments(&one, &[batch], Solver::Balance, 4000, 2).squared();
            let error = |solver| moments(&signed, &[batch / 10; 10], solver, 4000, 3).squared();
            let (balance, plain, ridge) = (error(Solver::Balance), error(Solver::Plain), error(RIDGE));
            let [i, b, p, r] = [importance, balance, plain, ridge].map(|error| error.value / base);
            println!(
                "classifier, {steps} steps, batch {batch}, over uniform: one table {i:.3}; \
                 J = 10 balance {b:.3}, plain {p:.3}, ridge {r:.3}"
            );
            assert!(ridge.is_below(0.9, balance) && ridge.is_below(0.9, importance), "{steps} steps, batch {batch}");
            // Two standard errors, significance .03: the plain solve's errors have heavy tails, so their mean is known badly.
            assert!(batch > 20 || plain.value > ridge.value + 2.0 * plain.standard_error, "{steps} steps");
        }
    }
}

/// The derivatives by the 5 output nodes, and by the 30 weights, of 1,000 items after some steps of gradient descent.
fn classifier(seed: u64, steps: usize) -> (Vec<f32>, Vec<f32>) {
    let mut rng = Rng::seed(seed);
    let mut normal = || (0..12).map(|_| rng.uniform_f64()).sum::<f64>() - 6.0;
    let centers = [(); 30].map(|()| normal());
    let points: Vec<[f64; 6]> = (0..1000).map(|i| std::array::from_fn(|k| centers[i % 5 * 6 + k] + normal())).collect();
    let mut weights = [0.0; 30];
    let nodes = |weights: &[f64; 30]| {
        let mut out = vec![0.0; 5000];
        for (i, (x, out)) in points.iter().zip(out.chunks_mut(5)).enumerate() {
            let logit = |w: &[f64]| w.iter().zip(x).map(|(w, x)| w * x).sum::<f64>() as f32;
            let logits: Vec<f32> = weights.chunks(6).map(logit).collect();
            importance::cross_entropy_gradient(&logits, i % 5, out).unwrap();
        }
        out
    };
    let gradients = |nodes: &[f32]| {
        let pairs = nodes.chunks(5).zip(&points);
        pairs.flat_map(|(g, x)| g.iter().flat_map(|&g| x.map(|x| (f64::from(g) * x) as f32))).collect::<Vec<_>>()
    };
    for _ in 0..steps {
        for gradient in gradients(&nodes(&weights)).chunks(30) {
            weights.iter_mut().zip(gradient).for_each(|(w, &g)| *w -= 0.3e-3 * f64::from(g));
        }
    }
    let nodes = nodes(&weights);
    let gradients = gradients(&nodes);
    (nodes, gradients)
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
