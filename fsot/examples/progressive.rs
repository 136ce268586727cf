//! Integration error of the prefixes of progressive point sets (figure 5.17), as a table in Markdown.
//!
//! `cargo run --profile fsot -p noisefloor-fsot --example progressive -- [POINTS] [SETS] [INTEGRANDS]`: root mean
//! square errors over sets and Gaussian integrands, for sets of 1, 3 and as many levels as POINTS has doublings, fully
//! progressive ones, and random points. The defaults are 1024, 20 and 30.

use fsot::class::progressive;
use fsot::error::Result;
use fsot::optimize::{Problem, optimize};
use fsot::points::Points;
use fsot::random::stream;

/// A Gaussian and its mean over the unit square.
struct Integrand {
    center: [f64; 2],
    sigma: f64,
    mean: f64,
}

impl Integrand {
    fn new(number: u64) -> Integrand {
        let rng = &mut stream(17, number, 0);
        let center = [rng.uniform_f64(), rng.uniform_f64()];
        let sigma = 0.1 + 0.2 * rng.uniform_f64();
        let side = |c: f64| {
            let erf = |x: f64| libm::erf(x / (sigma * std::f64::consts::SQRT_2));
            sigma * (std::f64::consts::PI / 2.0).sqrt() * (erf(1.0 - c) + erf(c))
        };
        Integrand { center, sigma, mean: side(center[0]) * side(center[1]) }
    }

    fn value(&self, point: &[f32]) -> f64 {
        let [x, y] = [f64::from(point[0]) - self.center[0], f64::from(point[1]) - self.center[1]];
        libm::exp(-(x * x + y * y) / (2.0 * self.sigma * self.sigma))
    }
}

/// Adds the squared errors of the prefixes that end at `counts`.
fn add_errors(points: &Points, integrands: &[Integrand], counts: &[usize], sums: &mut [f64]) {
    for integrand in integrands {
        let (mut sum, mut done) = (0.0, 0);
        for (&count, error) in counts.iter().zip(&mut *sums) {
            sum += points.iter().take(count).skip(done).map(|point| integrand.value(point)).sum::<f64>();
            done = count;
            *error += (sum / count as f64 - integrand.mean).powi(2);
        }
    }
}

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1).map(|argument| argument.parse::<usize>().ok());
    let mut next = |default: usize| arguments.next().flatten().unwrap_or(default);
    let (points, sets, variations) = (next(1024), next(20) as u64, next(30) as u64);
    let integrands: Vec<Integrand> = (0..variations).map(Integrand::new).collect();
    let doublings = points.max(2).ilog2() as usize;

    // Four counts per doubling.
    let mut counts: Vec<usize> =
        (8..=4 * doublings).map(|k| libm::exp2(k as f64 / 4.0).round() as usize).filter(|&k| k <= points).collect();
    counts.push(points);
    counts.dedup();

    let levels = [1, 3, doublings, points];
    let mut columns = Vec::new();
    for levels in levels {
        let mut sums = vec![0.0; counts.len()];
        for seed in 0..sets {
            let problem = Problem { classes: progressive(2, levels, points), seed, ..Problem::new(points, 2) };
            add_errors(&optimize(problem)?, &integrands, &counts, &mut sums);
        }
        columns.push(sums);
    }
    let mut random = vec![0.0; counts.len()];
    for seed in 0..sets {
        let rng = &mut stream(seed, u64::MAX, 1);
        let points = Points::new(2, (0..2 * points).map(|_| rng.uniform_f32()).collect());
        add_errors(&points, &integrands, &counts, &mut random);
    }
    columns.push(random);

    println!("| points | 1 level | 3 levels | {doublings} levels | every prefix | random |");
    println!("|---|---|---|---|---|---|");
    for (k, count) in counts.iter().enumerate() {
        let errors = columns.iter().map(|sums| (sums[k] / (sets * variations) as f64).sqrt());
        let cells: Vec<String> = errors.map(|error| format!("{error:.2e}")).collect();
        println!("| {count} | {} |", cells.join(" | "));
    }
    Ok(())
}
