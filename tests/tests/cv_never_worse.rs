//! The robust estimator's promises: never noticeably worse than the mean, usually far better.
//!
//! Errors are paired: both estimates see the same samples. Seeds are fixed. The interval of a ratio is the 95 % one of
//! `statistics::rmse_ratio`; what is asserted is its upper end. Among the 75 ratios of a set a few intervals miss their
//! ratio, but no ratio's true value is near enough to 1.03 for that to decide.

use crate::cv_support::*;
use noisefloor::control_variate::{Config, Estimator, Samples, estimate, workspace_len};
use noisefloor_tests::genz::Family;
use noisefloor_tests::integrands::{self, Integrand};
use noisefloor_tests::random::{SplitMix64, mix};
use noisefloor_tests::statistics::{Ratio, geometric_mean, rmse_ratio};

/// RMSE ratios to the mean of `N` configurations, batch or streaming, on the same samples.
fn ratios<const N: usize, F: Fn(&[f64]) -> f64>(
    integrand: &Integrand<F>,
    configs: [(Config, bool); N],
    n: usize,
    repetitions: usize,
    seed: u64,
) -> [Ratio; N] {
    let mut rng = SplitMix64::new(mix(seed ^ (n as u64) << 32));
    let mut plain = Vec::with_capacity(repetitions);
    let mut errors: [Vec<f64>; N] = core::array::from_fn(|_| Vec::with_capacity(repetitions));
    let mut accumulators = configs.map(|(config, streaming)| streaming.then(|| accumulator::<f64>(&config)));
    let len = |(config, streaming): (Config, bool)| {
        if streaming {
            accumulator::<f64>(&config).workspace().len()
        } else {
            workspace_len::<f64>(&config, n).unwrap()
        }
    };
    let mut workspace = vec![0.0; configs.into_iter().map(len).max().unwrap()];
    for _ in 0..repetitions {
        let u = points(n, integrand.dims, &mut rng);
        let f = values(&u, integrand.dims, &integrand.evaluate);
        // An `f32` as estimates are: for one integrand its rounding shows.
        let mean = wide(&f).iter().sum::<f64>() / n as f64;
        plain.push(f64::from(mean as f32) - integrand.integral);
        for (((config, _), accumulator), errors) in configs.iter().zip(&mut accumulators).zip(&mut errors) {
            let samples = Samples::new(&u, &f);
            let estimate = match accumulator {
                Some(accumulator) => {
                    accumulator.reset();
                    accumulator.add(samples).unwrap();
                    accumulator.estimate(&mut workspace).unwrap()
                }
                None => estimate(config, samples, &mut workspace).unwrap(),
            };
            errors.push(f64::from(estimate.mean[0]) - integrand.integral);
        }
    }
    errors.map(|errors| rmse_ratio(&errors, &plain))
}

/// Repetitions that keep an integrand's cost alike.
fn repetitions(dims: usize, n: usize, streaming: bool) -> usize {
    let base = if n <= 16 { 24_000 } else { 3000 };
    base / match (dims, streaming) {
        (1..=3, _) => 1,
        (_, false) => 6,
        (4..=7, true) => 8,
        (_, true) => 60,
    }
}

/// The upper end of the robust estimator's ratio to the mean, and what it is of.
fn judged<F: Fn(&[f64]) -> f64>(
    integrand: &Integrand<F>,
    order: usize,
    streaming: bool,
    n: usize,
    seed: u64,
) -> (f64, String) {
    let Integrand { name, dims, .. } = *integrand;
    let base = config(dims, limited(dims, order), Estimator::Robust);
    let [ratio] = ratios(integrand, [(base, streaming)], n, repetitions(dims, n, streaming), seed);
    (ratio.upper(), format!("{name} {dims}D, {n}: {:.4} +- {:.4}", ratio.value, ratio.half_width))
}

/// The worst ratio to the mean on all 25 integrands at 8, 16 and 64 samples, for an order.
fn never_worse(order: usize, streaming: bool, limit: f64) {
    let mut worst = (0.0, String::new());
    let mut failures = vec![];
    for n in [8, 16, 64] {
        for (index, integrand) in integrands::all().iter().enumerate() {
            let (upper, what) = judged(integrand, order, streaming, n, 5000 + index as u64);
            if upper > limit {
                failures.push(what.clone());
            }
            if upper > worst.0 {
                worst = (upper, what);
            }
        }
    }
    println!("order {order}, streaming {streaming}: worst {worst:?}");
    assert!(failures.is_empty(), "order {order}, streaming {streaming}: {failures:?}");
}

/// Genz's families in 1 to 5 dims, with parameters that were drawn after the rules were frozen: never looked at.
#[test]
fn batch_of_unseen_integrands() {
    let mut rng = SplitMix64::new(20_261_128);
    let mut failures = vec![];
    for family in Family::ALL {
        for dims in [1, 2, 3, 5] {
            let [a, w] = family.draw(dims, &mut rng);
            // It ends along two axes.
            if family == Family::Discontinuous && dims == 1 {
                continue;
            }
            let evaluate = |u: &[f64]| family.evaluate(u, &a, &w);
            let integrand = Integrand { name: family.name(), dims, integral: family.integral(&a, &w), evaluate };
            for (order, n) in [(2, 8), (3, 16), (3, 64)] {
                let (upper, what) = judged(&integrand, order, false, n, 5100 + dims as u64);
                println!("{what}");
                if upper > 1.03 {
                    failures.push(what);
                }
            }
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

#[test]
fn batch_of_order_2() {
    never_worse(2, false, 1.03);
}

#[test]
fn batch_of_order_3() {
    never_worse(3, false, 1.03);
}

#[test]
fn streaming_of_order_2() {
    never_worse(2, true, 1.03);
}

#[test]
fn streaming_of_order_3() {
    never_worse(3, true, 1.03);
}

/// What a search found hardest, in 1 to 7 dims and where samples are about as many as terms: at most 1.03 at order 1,
/// which 12,000 sets know within .008. Of stripes most sets of samples see one or none; no rule that uses the samples
/// alone tells them from a slope, and up to 1.06 is what this one costs.
#[test]
fn hardest() {
    let mut failures = vec![];
    let mut check = |integrand: &Integrand, order, n, limit: f64, repetitions| {
        let base = config(integrand.dims, order, Estimator::Robust);
        let [ratio] = ratios(integrand, [(base, false)], n, repetitions, 7200 + n as u64);
        let what = format!("{} {}D order {order}, {n}: {:.4}", integrand.name, integrand.dims, ratio.value);
        println!("{what} +- {:.4}", ratio.half_width);
        if ratio.upper() > limit {
            failures.push(what);
        }
    };
    for dims in [1, 2, 4, 7] {
        for integrand in &integrands::hardest(dims)[..4] {
            for n in [5, 7, 9, 12] {
                check(integrand, 1, n, 1.04, 12_000);
            }
        }
    }
    for (dims, order, n) in [(2, 3, 48), (3, 2, 34), (3, 3, 34)] {
        for integrand in integrands::hardest(dims).get(4..).unwrap() {
            check(integrand, order, n, 1.075, 12_000);
        }
    }
    check(&integrands::searched(), 3, 4, 1.075, 200_000);
    assert!(failures.is_empty(), "{failures:?}");
}

/// Geometric means of the RMSE ratio over the nine integrands, order 3 (2 in 15 dimensions), 16 / 32 / 64 / 256
/// samples: at most .52 / .31 / .22 / .16. Asserted is the lower end of the 95 % interval, whose half width is below
/// .005.
#[test]
fn gains_on_the_nine() {
    let mut failures = vec![];
    for (n, target) in [(16, 0.52), (32, 0.31), (64, 0.22), (256, 0.16)] {
        let all: Vec<Ratio> = integrands::nine()
            .iter()
            .enumerate()
            .map(|(index, integrand)| {
                let base = config(integrand.dims, limited(integrand.dims, 3), Estimator::Robust);
                // Where a fit is nearly exact, its error comes from the few sets of samples that mislead it.
                let repetitions = if integrand.dims > 4 { 20_000 } else { 200_000 } * 16 / n;
                ratios(integrand, [(base, false)], n, repetitions, 6000 + index as u64)[0]
            })
            .collect();
        let mean = geometric_mean(&all.iter().map(|ratio| ratio.value).collect::<Vec<_>>());
        let spread = all.iter().map(|ratio| (ratio.half_width / ratio.value / 9.0).powi(2)).sum::<f64>().sqrt() * mean;
        println!("{n}: {mean:.4} +- {spread:.4} for {target}");
        assert!(spread < 0.005, "{n}: +- {spread}");
        if mean - spread > target {
            failures.push(format!("{n}: {mean:.4} +- {spread:.4} for {target}"));
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

/// The tests above can fail: least squares on its own samples is far worse than the mean where samples are few.
#[test]
fn least_squares_is_worse() {
    let integrand = integrands::nine()[6];
    let least_squares = config(integrand.dims, 3, Estimator::LeastSquares);
    let [ratio] = ratios(&integrand, [(least_squares, false)], 16, 4000, 7000);
    assert!(ratio.value - ratio.half_width > 1.1, "{ratio:?}");
}
