//! Problems of minibatch gradients, and errors of the gradient's estimates. Seeds are fixed.

use crate::minibatch::{Problem, Z_LIMIT};
use crate::statistics::maximum;
use noisefloor::minibatch::importance::{self, Softmax, Split};
use noisefloor::mis::{DEFAULT_RIDGE, Solver};
use noisefloor::rng::Rng;

/// Sums of the estimates of every parameter.
pub struct Moments {
    count: f64,
    sum: Vec<f64>,
    squares: Vec<f64>,
    /// The sum of each estimate's squared error, squared.
    fourths: f64,
}

/// A mean squared error, with its standard error.
#[derive(Clone, Copy)]
pub struct Squared {
    /// The mean.
    pub value: f64,
    /// Of it.
    pub standard_error: f64,
}

impl Squared {
    /// Whether this is below `factor` times the other, at significance 1e-5.
    pub fn is_below(self, factor: f64, other: Squared) -> bool {
        let z = (factor * other.value - self.value) / self.standard_error.hypot(factor * other.standard_error);
        z > Z_LIMIT
    }
}

impl Moments {
    /// Of none yet.
    pub fn new(parameters: usize) -> Moments {
        Moments { count: 0.0, sum: vec![0.0; parameters], squares: vec![0.0; parameters], fourths: 0.0 }
    }

    /// An estimate beside the exact gradient.
    pub fn add(&mut self, estimate: &[f64], exact: &[f64]) {
        self.count += 1.0;
        for (p, (estimate, exact)) in estimate.iter().zip(exact).enumerate() {
            self.sum[p] += estimate - exact;
            self.squares[p] += (estimate - exact).powi(2);
        }
        self.fourths += estimate.iter().zip(exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>().powi(2);
    }

    /// Mean squared error, summed over the parameters.
    pub fn error(&self) -> f64 {
        self.squares.iter().sum::<f64>() / self.count
    }

    /// The same with its standard error.
    pub fn squared(&self) -> Squared {
        let value = self.error();
        Squared { value, standard_error: ((self.fourths / self.count - value * value) / self.count).sqrt() }
    }

    /// The squared length of the bias, less what noise adds to it.
    pub fn squared_bias(&self) -> f64 {
        let n = self.count;
        let terms = self.sum.iter().zip(&self.squares);
        terms.map(|(sum, squares)| (sum / n).powi(2) - (squares / n - (sum / n).powi(2)) / n).sum()
    }

    /// Of the means of all parameters.
    pub fn largest_z(&self) -> f64 {
        let n = self.count;
        let z = |(sum, squares): (&f64, &f64)| sum / n / ((squares / n - (sum / n).powi(2)) / n).sqrt();
        maximum(self.sum.iter().zip(&self.squares).map(z).map(f64::abs))
    }
}

/// The estimates of `batches` minibatches with so many samples of each technique.
pub fn moments(problem: &Problem, counts: &[usize], solver: Solver, batches: usize, seed: u64) -> Moments {
    let exact = problem.exact();
    let mut rng = Rng::seed(seed);
    let mut moments = Moments::new(problem.parameters);
    for _ in 0..batches {
        moments.add(&problem.draw(counts, &mut rng).estimate(solver), &exact);
    }
    moments
}

/// Regression by a polynomial of order 6 on [-2, 2] (section 6.2.4): the loss sum (f(x) - y)^2 over 2,000 points, and
/// the state that a trainer reaches after some steps of gradient descent.
pub struct Regression {
    /// Powers 0..=6 of x / 2, and the target, of each point.
    points: Vec<([f64; 7], f64)>,
    theta: [f64; 7],
}

impl Regression {
    /// The problem of a seed, after some steps.
    pub fn new(seed: u64, steps: usize) -> Regression {
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

    /// Of each point's loss.
    pub fn gradients(&self) -> Vec<f32> {
        let gradient = |(x, y): &([f64; 7], f64)| {
            let residual: f64 = x.iter().zip(&self.theta).map(|(x, t)| x * t).sum::<f64>() - y;
            x.map(|x| (2.0 * residual * x) as f32)
        };
        self.points.iter().flat_map(gradient).collect()
    }

    /// Tables from each point's gradient by the coefficients.
    pub fn problem(&self, split: Split, techniques: usize, uniform: f64) -> Problem {
        let gradients = self.gradients();
        Problem::new(&tables(&gradients, 7, split, techniques), uniform, gradients, 7)
    }
}

/// Importances `[J][N]`: what [`importance::nodes`] makes of each item's `width` derivatives.
fn tables(derivatives: &[f32], width: usize, split: Split, techniques: usize) -> Vec<Vec<f64>> {
    let mut tables = vec![Vec::new(); techniques];
    for item in derivatives.chunks(width) {
        let mut q = vec![0.0; techniques];
        importance::nodes(item, split, &mut q).unwrap();
        tables.iter_mut().zip(q).for_each(|(table, q)| table.push(f64::from(q)));
    }
    tables
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
            out.iter_mut().zip(Softmax::new(&logits, i % 5).unwrap().gradient()).for_each(|(out, g)| *out = g);
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

/// One table of norms and one of each sign of each derivative, for a classifier of 5 classes; uniform sampling.
pub struct Classifier {
    /// 1,000 items, all alike.
    pub uniform: Problem,
    /// The importance is the gradient's norm.
    pub one: Problem,
    /// 10 tables.
    pub signed: Problem,
}

impl Classifier {
    /// After some steps of gradient descent.
    pub fn new(steps: usize) -> Classifier {
        let (classes, gradients) = classifier(5, steps);
        let problem =
            |split, techniques| Problem::new(&tables(&classes, 5, split, techniques), 0.2, gradients.clone(), 30);
        Classifier {
            uniform: Problem::new(&[vec![1.0; 1000]], 0.0, gradients.clone(), 30),
            one: problem(Split::Norm, 1),
            signed: problem(Split::Sign, 10),
        }
    }
}

/// Squared errors of minibatches.
pub struct Compared {
    /// Of uniform sampling.
    pub uniform: f64,
    /// Of importance sampling by one table.
    pub one: Squared,
    /// Of several tables: balance heuristic, plain and ridge solve.
    pub signed: [Squared; 3],
}

/// The errors of `batch` samples, the same number of each technique, over `batches` minibatches.
pub fn compare([uniform, one, signed]: [&Problem; 3], batch: usize, batches: usize) -> Compared {
    let counts = vec![batch / signed.techniques; signed.techniques];
    Compared {
        uniform: moments(uniform, &[batch], Solver::Balance, batches, 1).error(),
        one: moments(one, &[batch], Solver::Balance, batches, 2).squared(),
        signed: [Solver::Balance, Solver::Plain, Solver::Ridge(DEFAULT_RIDGE)]
            .map(|solver| moments(signed, &counts, solver, batches, 3).squared()),
    }
}

/// The length of an estimate's bias, and its root mean square error, over that of the gradient.
pub fn bias(problem: &Problem, batch: usize, solver: Solver, batches: usize) -> [f64; 2] {
    let size: f64 = problem.exact().iter().map(|g| g * g).sum();
    let counts = vec![batch / problem.techniques; problem.techniques];
    let all = moments(problem, &counts, solver, batches, 20);
    [maximum([all.squared_bias()]), all.error()].map(|square| (square / size).sqrt())
}
