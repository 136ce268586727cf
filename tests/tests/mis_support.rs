//! What the MIS tests share: one-dimensional techniques and integrands with known integrals, and z-tests.

use noisefloor::rng::Rng;
use noisefloor_tests::oracle::least_squares;
use noisefloor_tests::statistics::Moments;

/// |z| beyond this has probability 1e-5 under the hypothesis (two-sided normal).
pub const Z_LIMIT: f64 = 4.417;

/// A density on [0, 1] that can be drawn from.
#[derive(Clone, Copy)]
pub enum Technique {
    /// 1.
    Uniform,
    /// 2x.
    Rising,
    /// 2 (1 - x).
    Falling,
    /// 1 / (b - a) on [a, b].
    Box(f64, f64),
}

impl Technique {
    pub fn pdf(self, x: f64) -> f64 {
        match self {
            Technique::Uniform => 1.0,
            Technique::Rising => 2.0 * x,
            Technique::Falling => 2.0 * (1.0 - x),
            Technique::Box(a, b) => {
                if (a..b).contains(&x) {
                    1.0 / (b - a)
                } else {
                    0.0
                }
            }
        }
    }

    pub fn draw(self, rng: &mut Rng) -> f64 {
        let u = rng.uniform_f64();
        match self {
            Technique::Uniform => u,
            // 1 - u is never 0: the density is positive at every point drawn.
            Technique::Rising => (1.0 - u).sqrt(),
            Technique::Falling => 1.0 - (1.0 - u).sqrt(),
            Technique::Box(a, b) => a + (b - a) * u,
        }
    }
}

/// Techniques with their counts, and an integrand with its integral.
pub struct Problem {
    pub name: &'static str,
    /// Whether the densities are linearly independent; otherwise A is singular.
    pub independent: bool,
    pub techniques: Vec<Technique>,
    pub counts: Vec<u32>,
    pub f: fn(f64) -> f64,
    pub integral: f64,
}

/// One sample: which technique drew it, every density there, and f.
pub struct Sample {
    pub technique: usize,
    pub pdf: Vec<f32>,
    pub value: f32,
}

impl Problem {
    /// `counts[j]` samples of each technique.
    pub fn round(&self, rng: &mut Rng) -> Vec<Sample> {
        let mut samples = Vec::new();
        for (technique, (&drawn, &count)) in self.techniques.iter().zip(&self.counts).enumerate() {
            for _ in 0..count {
                let x = drawn.draw(rng);
                let pdf = self.techniques.iter().map(|t| t.pdf(x) as f32).collect();
                samples.push(Sample { technique, pdf, value: (self.f)(x) as f32 });
            }
        }
        samples
    }

    /// sum_k n_k p_k(x).
    pub fn sum(&self, x: f64) -> f64 {
        self.techniques.iter().zip(&self.counts).map(|(t, &n)| t.pdf(x) * f64::from(n)).sum()
    }

    /// The exact A and b, by the midpoint rule.
    pub fn system(&self) -> (Vec<Vec<f64>>, Vec<f64>) {
        let pdf = |k: usize, x: f64| self.techniques[k].pdf(x);
        let j = 0..self.techniques.len();
        let a = j.clone().map(|i| j.clone().map(|k| integrate(|x| pdf(i, x) * pdf(k, x) / self.sum(x))).collect());
        let b = j.clone().map(|k| integrate(|x| (self.f)(x) * pdf(k, x) / self.sum(x)));
        (a.collect(), b.collect())
    }

    /// The alpha of least variance; of several the shortest.
    pub fn alpha(&self) -> Vec<f64> {
        let (a, b) = self.system();
        least_squares(&a, &b)
    }

    /// The variance of one round with coefficients alpha, from (2.11) and (2.15):
    /// int (f - alpha p)^2 / S - sum_j n_j (int p_j (f - alpha p) / S)^2.
    pub fn variance(&self, alpha: &[f64]) -> f64 {
        let rest = |x: f64| (self.f)(x) - alpha.iter().zip(&self.techniques).map(|(a, t)| a * t.pdf(x)).sum::<f64>();
        let first = integrate(|x| rest(x).powi(2) / self.sum(x));
        let means = self.techniques.iter().zip(&self.counts);
        first - means.map(|(t, &n)| f64::from(n) * integrate(|x| t.pdf(x) * rest(x) / self.sum(x)).powi(2)).sum::<f64>()
    }
}

/// The midpoint rule; integrands may be 0/0 where nothing is sampled.
pub fn integrate(f: impl Fn(f64) -> f64) -> f64 {
    let n = 20_000;
    let values = (0..n).map(|i| f((f64::from(i) + 0.5) / f64::from(n)));
    values.filter(|v| v.is_finite()).sum::<f64>() / f64::from(n)
}

/// Like figure 2.4: two or three densities that each match a part of the integrand; some integrands have zeros.
pub fn problems() -> Vec<Problem> {
    use Technique::*;
    vec![
        Problem {
            name: "a slope and its mirror image",
            independent: true,
            techniques: vec![Rising, Falling],
            counts: vec![1, 1],
            f: |x| 1.0 + 3.0 * x * x,
            integral: 2.0,
        },
        Problem {
            name: "unequal counts",
            independent: true,
            techniques: vec![Uniform, Rising],
            counts: vec![3, 1],
            f: |x| x * x * x + 0.2,
            integral: 0.45,
        },
        Problem {
            name: "zero on the left third",
            independent: true,
            techniques: vec![Uniform, Box(0.2, 0.9)],
            counts: vec![2, 3],
            f: |x| if x < 1.0 / 3.0 { 0.0 } else { 2.0 + x },
            integral: 4.0 / 3.0 + 4.0 / 9.0,
        },
        Problem {
            name: "three techniques, two bumps, zero between",
            independent: true,
            techniques: vec![Uniform, Box(0.1, 0.4), Box(0.6, 0.8)],
            counts: vec![1, 2, 2],
            f: |x| {
                if (0.15..0.4).contains(&x) {
                    4.0 * x
                } else if (0.6..0.8).contains(&x) {
                    3.0
                } else {
                    0.0
                }
            },
            integral: 2.0 * (0.16 - 0.0225) + 0.6,
        },
        Problem {
            name: "a change of sign; densities that depend on each other",
            independent: false,
            techniques: vec![Rising, Falling, Uniform],
            counts: vec![2, 1, 1],
            f: |x| 5.0 * x * x - 1.0,
            integral: 5.0 / 3.0 - 1.0,
        },
    ]
}

/// How many standard errors the mean is above `truth`. Estimators that are exact up to the rounding of their f32 output
/// have no variance to speak of.
pub fn z(moments: &Moments, truth: f64) -> f64 {
    if (moments.mean() - truth).abs() < 1e-6 * truth.abs() { 0.0 } else { moments.z(truth) }
}
