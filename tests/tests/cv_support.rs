//! What the control-variate tests share: calls with fresh buffers, slow bases, random samples.
//!
//! Workspaces are handed over full of NaN: an estimator that relied on their content would show it.

use noisefloor::Error;
use noisefloor::basis::Family;
use noisefloor::control_variate::{self, Config, Estimate, Estimator, Optimizer, Samples, Solver};
use noisefloor::real::Real;
use noisefloor_tests::ESTIMATORS;
use noisefloor_tests::legendre;
use noisefloor_tests::oracle::Design;
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::stream::Stream;

/// The batch estimators' workspace for `n` samples, full of NaN.
pub fn workspace<R: Real>(config: &Config, n: usize) -> Vec<R> {
    vec![R::from_f64(f64::NAN); control_variate::workspace_len::<R>(config, n).unwrap()]
}

/// A batch estimate.
pub fn batch<R: Real>(config: &Config, u: &[f32], f: &[f32]) -> Result<Estimate, Error> {
    batch_of::<R>(config, Samples::new(u, f))
}

/// A batch estimate of samples that may have control functions.
pub fn batch_of<R: Real>(config: &Config, samples: Samples<'_>) -> Result<Estimate, Error> {
    control_variate::estimate(config, samples, &mut workspace::<R>(config, samples.f.len() / config.channels))
}

/// An empty accumulator.
pub fn accumulator<R: Real>(config: &Config) -> Stream<R> {
    Stream::new(config).unwrap()
}

/// What an accumulator estimates.
pub fn finish<R: Real>(accumulator: &Stream<R>) -> Result<Estimate, Error> {
    accumulator.estimate(&mut accumulator.workspace())
}

/// A streaming estimate, all samples added at once.
pub fn streamed<R: Real>(config: &Config, u: &[f32], f: &[f32]) -> Result<Estimate, Error> {
    let mut accumulator = accumulator::<R>(config);
    accumulator.add(Samples::new(u, f))?;
    finish(&accumulator)
}

/// The default configuration with another estimator.
pub fn config(dims: usize, order: usize, estimator: Estimator) -> Config {
    Config { estimator, ..Config::new(dims, order, 1) }
}

/// Whatever can be streamed: estimators, and least squares by the square root, too.
pub fn streaming_configs(dims: usize, order: usize) -> Vec<Config> {
    let mut configs = ESTIMATORS.map(|estimator| config(dims, order, estimator)).to_vec();
    configs.retain(|config| config.estimator != Estimator::LeaveOneOut);
    configs.push(Config { solver: Solver::SquareRoot, ..config(dims, order, Estimator::LeastSquares) });
    configs
}

/// The largest order up to `order` that has at most 136 terms.
pub fn limited(dims: usize, order: usize) -> usize {
    (0..=order).rev().find(|&order| Config::new(dims, order, 1).terms().is_ok()).unwrap()
}

/// `n` independent uniform points.
pub fn points(n: usize, dims: usize, rng: &mut SplitMix64) -> Vec<f32> {
    (0..n * dims).map(|_| rng.uniform_f32()).collect()
}

/// One point in each of n = k x k cells of the unit square, for every pixel.
pub fn jittered(pixels: usize, n: usize, rng: &mut SplitMix64) -> Vec<f32> {
    let side = n.isqrt();
    let mut at = |cell: usize| ((cell as f64 + rng.uniform()) / side as f64).min(0.999_999) as f32;
    (0..pixels * n).flat_map(|i| [at(i % n % side), at(i % n / side)]).collect()
}

/// A function's values at points.
pub fn values(u: &[f32], dims: usize, f: impl Fn(&[f64]) -> f64) -> Vec<f32> {
    wide(u).chunks(dims).map(|u| f(u) as f32).collect()
}

/// A smooth function of any number of coordinates that no basis holds, of size about one.
pub fn smooth(u: &[f64]) -> f64 {
    let sum: f64 = u.iter().enumerate().map(|(i, x)| x / (1.0 + 0.3 * i as f64)).sum();
    (1.7 * sum).sin() + 0.4 * (-2.0 * u[0]).exp()
}

pub fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().map(|&value| f64::from(value)).collect()
}

pub fn largest(values: &[f32]) -> f64 {
    values.iter().map(|value| f64::from(value.abs())).fold(0.0, f64::max)
}

/// Every number of an estimate is finite, but for a standard error that few samples cannot tell.
pub fn is_sound(estimate: &Estimate) -> bool {
    let finite_or_unknown = |error: f32| error >= 0.0 && (error.is_finite() || error == f32::INFINITY);
    estimate.mean.iter().all(|mean| mean.is_finite())
        && estimate.std_error.iter().all(|&error| finite_or_unknown(error))
        && !estimate.gain.is_nan()
}

/// The functions at a point as the library evaluates them. A descent that starts at the j-th unit vector, for one
/// sample of value 0, and cannot move estimates minus the j-th function at that sample.
pub fn probe<R: Real>(config: &Config, u: &[f32]) -> Vec<f64> {
    let config = Config {
        estimator: Estimator::GradientDescent,
        optimizer: Optimizer::Plain,
        iterations: 1,
        channels: 4,
        ..*config
    };
    let columns = config.terms().unwrap() - 1;
    let mut workspace = workspace::<R>(&config, 1);
    let mut out = Vec::new();
    for first in (0..columns).step_by(4) {
        let mut start = vec![0.0; 4 * columns];
        for (channel, column) in (first..columns.min(first + 4)).enumerate() {
            start[channel * columns + column] = 1.0;
        }
        let samples = Samples::new(u, &[0.0; 4]);
        let estimate = control_variate::gradient_descent(&config, samples, &mut start, &mut workspace).unwrap();
        out.extend(estimate.mean.iter().take(columns - first).map(|&mean| -f64::from(mean)));
    }
    out
}

/// One-dimensional functions from their definitions; degree 0 is the constant 1.
pub fn function(family: Family, degree: usize, x: f64) -> f64 {
    use core::f64::consts::{PI, SQRT_2};
    match family {
        Family::Legendre => legendre::legendre(degree, x),
        Family::Step => walsh(degree, x),
        Family::Sine if degree == 0 => 1.0,
        Family::Sine => SQRT_2 * (PI * degree as f64 * x + PI / 2.0).sin(),
        Family::Gaussian => unreachable!("Gaussians are no products of one-dimensional functions of a degree"),
    }
}

/// The row of the 8 x 8 Hadamard matrix with `changes` sign changes, at the eighth that holds x.
fn walsh(changes: usize, x: f64) -> f64 {
    let entry = |row: usize, column: usize| if (row & column).count_ones().is_multiple_of(2) { 1.0 } else { -1.0 };
    let count = |row: usize| (1..8).filter(|&column| entry(row, column) != entry(row, column - 1)).count();
    let row = (0..8).find(|&row| count(row) == changes).unwrap();
    entry(row, ((x * 8.0) as usize).min(7))
}

/// Exponents in total degree; of no coordinate, the constant alone.
fn terms(dims: usize, order: usize) -> Vec<Vec<usize>> {
    if dims == 0 { vec![vec![]] } else { legendre::terms(dims, order) }
}

/// The functions of a configuration, unsliced, at a point; sorted by degree.
pub fn functions(config: &Config, dims: usize, u: &[f64]) -> Vec<f64> {
    let terms = terms(dims, config.order);
    if config.basis == Family::Gaussian {
        return gaussians(dims, terms.len() - 1, u);
    }
    let product = |term: &Vec<usize>| term.iter().zip(u).map(|(&k, &x)| function(config.basis, k, x)).product();
    terms[1..].iter().map(product).collect()
}

/// Gaussians on the Kronecker sequence of the generalised golden ratio, centred and scaled by Simpson's rule.
fn gaussians(dims: usize, count: usize, u: &[f64]) -> Vec<f64> {
    let golden = (0..200).fold(1.5_f64, |root, _| (1.0 + root).powf(1.0 / (dims as f64 + 1.0)));
    let sigma = 0.5 * (dims as f64).sqrt() * (count as f64).powf(-1.0 / dims as f64);
    let bell = |x: f64, c: f64| (-(x - c).powi(2) / (2.0 * sigma * sigma)).exp();
    let simpson = |f: &dyn Fn(f64) -> f64| {
        let weight = |i: usize| {
            if i == 0 || i == 400 {
                1.0
            } else if i % 2 == 1 {
                4.0
            } else {
                2.0
            }
        };
        (0..=400).map(|i| weight(i) * f(i as f64 / 400.0)).sum::<f64>() / 1200.0
    };
    let component = |index: usize| {
        let (mut value, mut mean, mut square) = (1.0, 1.0, 1.0);
        for (k, &x) in u.iter().enumerate() {
            let c = (0.5 + (index + 1) as f64 * golden.powi(-(k as i32 + 1))).fract();
            value *= bell(x, c);
            mean *= simpson(&|x| bell(x, c));
            square *= simpson(&|x| bell(x, c).powi(2));
        }
        (value - mean) / (square - mean * mean).sqrt()
    };
    (0..count).map(component).collect()
}

/// The design matrix of a configuration, slices included, and its penalties: 4^(degree - 1) times the number of columns
/// of that degree, from their definitions.
pub fn design(config: &Config, u: &[f64]) -> Design {
    let sliced = config.slices > 1;
    let dims = config.dims - usize::from(sliced);
    let terms = terms(dims, config.order);
    let shared: Vec<usize> = terms[1..].iter().map(|term| legendre::degree(term)).collect();
    let slices = if sliced { config.slices } else { 0 };
    let up_to = |degree: usize| shared.iter().filter(|&&other| other <= degree).count();
    let fits = |&degree: &usize| 1 + shared.len() + slices + slices * up_to(degree) <= 136;
    let copied = (1..=config.order).rev().find(fits).map_or(0, up_to);
    let mut degrees = shared.clone();
    degrees.extend(vec![1; slices]);
    for _ in 0..slices {
        degrees.extend(&shared[..copied]);
    }
    let rows = u.chunks(config.dims).map(|u| {
        let mut row = functions(config, dims, &u[..dims]);
        let own = row.clone();
        let picked = u.get(dims).map_or(0, |&choice| ((choice * slices as f64) as usize).min(slices - 1));
        let count = slices as f64;
        row.extend((0..slices).map(|s| (if s == picked { count - 1.0 } else { -1.0 }) / (count - 1.0).sqrt()));
        for s in 0..slices {
            row.extend(own[..copied].iter().map(|value| if s == picked { count.sqrt() * value } else { 0.0 }));
        }
        row
    });
    let alike = |degree: usize| degrees.iter().filter(|&&other| other == degree).count() as f64;
    let weight = |&degree: &usize| 4.0_f64.powi(degree as i32 - 1) * alike(degree);
    Design { rows: rows.collect(), weights: degrees.iter().map(weight).collect() }
}
