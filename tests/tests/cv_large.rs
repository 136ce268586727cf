//! Many samples, many pixels, many parts: where sums of logarithms and fold counts grow.

use noisefloor::basis::Family;
use noisefloor::control_variate::Regressor;
use noisefloor::control_variate::{Config, Estimate, Estimator, Samples};
use noisefloor::real::Real;
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::shared::block;
use noisefloor_tests::stream::Stream;

/// exp(-x - y) and its integral.
fn smooth(u: &[f32]) -> f32 {
    (-u[0] - u[1]).exp()
}

const EXACT: f64 = 0.399_576_400_893_728_1;

fn draw(n: usize, seed: u64) -> (Vec<f32>, Vec<f32>) {
    let mut rng = SplitMix64::new(seed);
    let u: Vec<f32> = (0..2 * n).map(|_| rng.uniform_f32()).collect();
    let f = u.chunks(2).map(smooth).collect();
    (u, f)
}

fn stream<R: Real>(config: &Config, parts: &[(Vec<f32>, Vec<f32>)]) -> Estimate {
    let fresh = || Stream::<R>::new(config).unwrap();
    let mut whole = fresh();
    for (u, f) in parts {
        let mut part = fresh();
        part.add(Samples::new(u, f)).unwrap();
        whole.merge(&part).unwrap();
    }
    whole.estimate(&mut whole.workspace()).unwrap()
}

/// With many samples the incremental estimate follows its fits, in both precisions: its error is below a third of the
/// mean's standard error, which over 4096 samples is .0026, and its gain below .05.
#[test]
fn incremental_with_many_samples() {
    fn check<R: Real>() {
        let config = Config { estimator: Estimator::Incremental, ..Config::new(2, 2, 1) };
        for seed in 0..4 {
            let estimate = stream::<R>(&config, &[draw(4096, seed)]);
            assert!((f64::from(estimate.mean[0]) - EXACT).abs() < 8.6e-4, "{estimate:?}");
            assert!(estimate.gain < 0.05, "{estimate:?}");
        }
    }
    check::<f64>();
    check::<f32>();
}

/// A block of 1024 pixels, all alike: finite, and its root mean square error below a third of the pixels' own means'.
#[test]
fn block_of_many_pixels() {
    for n in [1, 4] {
        const PIXELS: usize = 1024;
        let config = Config::new(2, 2, 1);
        let (u, f) = draw(PIXELS * n, 5);
        let estimates = block(&config, PIXELS, Samples::new(&u, &f)).unwrap();
        assert_eq!(estimates.len(), PIXELS);
        let square = |value: f64| (value - EXACT) * (value - EXACT);
        let plain: f64 = f.chunks(n).map(|f| square(f.iter().map(|&f| f64::from(f)).sum::<f64>() / n as f64)).sum();
        let shared: f64 = estimates.iter().map(|estimate| square(f64::from(estimate.mean[0]))).sum();
        assert!(estimates.iter().all(|estimate| estimate.gain.is_finite() && estimate.gain < 0.2));
        assert!(shared < plain / 9.0, "{shared} {plain}");
    }
}

/// Accumulators of a few samples each, merged, have folds as even as one that was given every sample: over 2,000 sets,
/// the errors are no more than a fifth larger. If all parts went to one fold, little would be left of the gain.
#[test]
fn many_small_parts() {
    for estimator in [Estimator::Robust, Estimator::KFold] {
        for folds in [2, 3, 4, 5] {
            let config = Config { estimator, folds, ..Config::new(2, 2, 1) };
            for size in [1, 2, 3, 7] {
                let (mut parted, mut whole) = (0.0, 0.0);
                for seed in 0..2000 {
                    let (u, f) = draw(63, seed);
                    let parts: Vec<_> =
                        u.chunks(2 * size).zip(f.chunks(size)).map(|(u, f)| (u.to_vec(), f.to_vec())).collect();
                    let error = |estimate: Estimate| (f64::from(estimate.mean[0]) - EXACT).abs();
                    parted += error(stream::<f64>(&config, &parts));
                    whole += error(stream::<f64>(&config, &[(u, f)]));
                }
                let ratio = parted / whole;
                println!("{estimator:?} {folds} {size}: {ratio:.3}");
                assert!(ratio < 1.2, "{estimator:?} {folds} {size}: {ratio}");
            }
        }
    }
}

/// The regressor's gain does not depend on the values' scale.
#[test]
fn regressor_at_any_scale() {
    let (u, f) = draw(64, 3);
    let gain = |scale: f32| {
        let mut regressor = Regressor::<2, 6, 1>::new(Family::Legendre, 2).unwrap();
        for (u, f) in u.as_chunks::<2>().0.iter().zip(&f) {
            regressor.add(u, &[f * scale]).unwrap();
        }
        regressor.estimate(1e-9).unwrap().gain
    };
    for scale in [1e-30, 1e25, 1e30] {
        assert!((gain(scale) / gain(1.0) - 1.0).abs() < 1e-3, "{scale}");
    }
}
