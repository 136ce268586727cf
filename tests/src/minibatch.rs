//! What the minibatch tests share: a discrete data set with several importance distributions, and minibatches of it.

use noisefloor::minibatch::{Batch, weights};
use noisefloor::mis::Solver;
use noisefloor::rng::Rng;

/// |z| beyond this has probability 1e-5 under the hypothesis (two-sided normal).
pub const Z_LIMIT: f64 = 4.417;

/// N items with their gradients and their probabilities to each technique.
pub struct Problem {
    pub techniques: usize,
    /// `[N][J]`.
    pub pdf: Vec<f32>,
    /// `[N][P]`.
    pub gradient: Vec<f32>,
    pub parameters: usize,
    /// Sums of probabilities up to each item, `[J][N]`.
    pub sums: Vec<Vec<f64>>,
}

impl Problem {
    /// From importances `[J][N]`, mixed with a uniform fraction.
    pub fn new(importance: &[Vec<f64>], uniform: f64, gradient: Vec<f32>, parameters: usize) -> Problem {
        let items = importance[0].len();
        assert_eq!(gradient.len(), items * parameters);
        let mut pdf = vec![0.0; items * importance.len()];
        for (j, q) in importance.iter().enumerate() {
            let total: f64 = q.iter().sum();
            for (i, q) in q.iter().enumerate() {
                let share = if total > 0.0 { q / total } else { 1.0 / items as f64 };
                pdf[i * importance.len() + j] = ((1.0 - uniform) * share + uniform / items as f64) as f32;
            }
        }
        let sums = (0..importance.len())
            .map(|j| {
                let column = pdf.iter().skip(j).step_by(importance.len());
                column.scan(0.0, |sum, &p| {
                    *sum += f64::from(p);
                    Some(*sum)
                })
            })
            .map(Iterator::collect)
            .collect();
        Problem { techniques: importance.len(), pdf, gradient, parameters, sums }
    }

    pub fn items(&self) -> usize {
        self.gradient.len() / self.parameters
    }

    /// The mean gradient.
    pub fn exact(&self) -> Vec<f64> {
        let mut mean = vec![0.0; self.parameters];
        for gradient in self.gradient.chunks(self.parameters) {
            mean.iter_mut().zip(gradient).for_each(|(mean, &g)| *mean += f64::from(g) / self.items() as f64);
        }
        mean
    }

    fn draw_item(&self, technique: usize, rng: &mut Rng) -> usize {
        let sums = &self.sums[technique];
        let u = rng.uniform_f64() * sums[sums.len() - 1];
        sums.partition_point(|&sum| sum <= u).min(sums.len() - 1)
    }

    /// `counts[j]` items of each technique.
    pub fn draw(&self, counts: &[usize], rng: &mut Rng) -> Drawn {
        let mut drawn = Drawn { items: self.items() as u32, techniques: self.techniques, ..Drawn::default() };
        for (technique, &count) in counts.iter().enumerate() {
            for _ in 0..count {
                let item = self.draw_item(technique, rng);
                drawn.technique.push(technique as u32);
                drawn.pdf.extend(&self.pdf[item * self.techniques..][..self.techniques]);
                drawn.gradient.extend(&self.gradient[item * self.parameters..][..self.parameters]);
            }
        }
        drawn
    }
}

/// A minibatch with its gradients.
#[derive(Clone, Debug, Default)]
pub struct Drawn {
    pub items: u32,
    pub techniques: usize,
    pub pdf: Vec<f32>,
    pub technique: Vec<u32>,
    pub gradient: Vec<f32>,
}

impl Drawn {
    pub fn batch(&self) -> Batch<'_> {
        Batch::new(self.items, self.techniques, &self.pdf, &self.technique).unwrap()
    }

    pub fn weights(&self, solver: Solver) -> Vec<f32> {
        let mut weight = vec![f32::NAN; self.technique.len()];
        weights(&self.batch(), solver, &mut weight).unwrap();
        weight
    }

    /// (1 / batch) sum weight gradient.
    pub fn apply(&self, weight: &[f32]) -> Vec<f64> {
        let parameters = self.gradient.len() / weight.len();
        let mut mean = vec![0.0; parameters];
        for (gradient, &weight) in self.gradient.chunks(parameters).zip(weight) {
            let weight = f64::from(weight) / self.technique.len() as f64;
            mean.iter_mut().zip(gradient).for_each(|(mean, &g)| *mean += weight * f64::from(g));
        }
        mean
    }

    pub fn estimate(&self, solver: Solver) -> Vec<f64> {
        self.apply(&self.weights(solver))
    }
}
