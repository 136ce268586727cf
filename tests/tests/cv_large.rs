//! Many samples, many pixels, many parts: where sums of logarithms and fold counts grow; and streams in pieces.

use crate::cv_support::{accumulator, batch, config, finish, points, streamed, streaming_configs, values};
use noisefloor::Error;
use noisefloor::basis::Family;
use noisefloor::control_variate::{Accumulator, Config, Estimate, Estimator, Regressor, Ridge, Samples};
use noisefloor::real::Real;
use noisefloor_tests::ESTIMATORS;
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::shared::block;
use noisefloor_tests::statistics::Moments;
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

/// Fits of order 3 to 64 samples have less than half of the mean's error and say so, over 2,000 sets. Those of left-out
/// and of earlier samples are unbiased, at |z| < 4.5; the bias of others is below half of their error.
#[test]
fn every_estimator_gains() {
    for estimator in ESTIMATORS {
        let config = Config { estimator, ..Config::new(2, 3, 1) };
        let [mut plain, mut error, mut gain] = [(); 3].map(|()| Moments::default());
        for seed in 0..2000 {
            let (u, f) = draw(64, seed);
            let estimate = batch::<f64>(&config, &u, &f).unwrap();
            let mean = f.iter().map(|&f| f64::from(f)).sum::<f64>() / 64.0;
            plain.add((mean - EXACT).powi(2));
            error.add(f64::from(estimate.mean[0]) - EXACT);
            gain.add(f64::from(estimate.gain));
        }
        let root = (error.mean().powi(2) + error.variance()).sqrt();
        assert!(root < 0.5 * plain.mean().sqrt() && gain.mean() < 0.5, "{estimator:?}: {root} {}", gain.mean());
        match estimator {
            Estimator::LeaveOneOut | Estimator::KFold | Estimator::Incremental => {
                assert!(error.z(0.0).abs() < 4.5, "{estimator:?}: {}", error.z(0.0));
            }
            _ => assert!(error.mean().abs() < 0.5 * root, "{estimator:?}: {}", error.mean()),
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

/// Streams of a linear function, in two channels.
fn in_pieces<R: Real>(config: &Config) {
    let mut rng = SplitMix64::new(3);
    let u = points(96, 2, &mut rng);
    let f: Vec<f32> = values(&u, 2, |u| 1.0 + u[0] + u[1]).iter().flat_map(|&f| [f, 2.0 * f]).collect();
    let config = &Config { channels: 2, ..*config };
    let whole = streamed::<R>(config, &u, &f).unwrap();
    let is_near = |e: &Estimate| (e.mean[0] - 2.0).abs() < 0.15 && (e.mean[1] - 4.0).abs() < 0.3;
    assert!(is_near(&whole) && whole.samples == 96, "{config:?}: {whole:?}");
    assert_eq!((whole.mean[2], whole.std_error[3]), (0.0, 0.0));

    // One at a time the same bits, with an estimate after each.
    let mut pieces = accumulator::<R>(config);
    for (i, (u, own)) in u.chunks(2).zip(f.chunks(2)).enumerate() {
        pieces.add(Samples::new(u, own)).unwrap();
        let estimate = finish(&pieces).unwrap();
        assert!(estimate.samples as usize == i + 1 && estimate.mean[0].is_finite());
        assert!(i > 0 || (estimate.mean[0], estimate.std_error[0]) == (f[0], f32::INFINITY));
    }
    assert_eq!(finish(&pieces), Ok(whole));

    // Halves are as good as one, and what is empty changes nothing.
    let mut halves = [(); 2].map(|()| accumulator::<R>(config));
    for (half, (u, f)) in halves.iter_mut().zip(u.chunks(96).zip(f.chunks(96))) {
        half.add(Samples::new(u, f)).unwrap();
    }
    let [mut merged, second] = halves;
    merged.merge(&second).unwrap();
    let merged = finish(&merged).unwrap();
    assert!(is_near(&merged) && merged.samples == 96, "{config:?}: {merged:?}");
    let is_exact = config.estimator != Estimator::LeastSquares || (merged.mean[0] - whole.mean[0]).abs() < 1e-4;
    assert!(is_exact, "{config:?}: {merged:?} {whole:?}");
    let mut empty = accumulator::<R>(config);
    pieces.merge(&empty).unwrap();
    assert_eq!(finish(&pieces), Ok(whole));
    empty.merge(&pieces).unwrap();
    assert_eq!(finish(&empty), Ok(whole));
}

#[test]
fn streams_in_pieces() {
    for config in streaming_configs(2, 2) {
        in_pieces::<f64>(&config);
        in_pieces::<f32>(&config);
    }
}

/// Buffers of another length are refused; the state itself says what it needs.
#[test]
fn an_accumulator_and_its_buffer() {
    let config = Config::new(2, 2, 1);
    let mut state = Accumulator::<f64>::new(&config).unwrap();
    assert!(state.len() == 112 && *state.config() == config);
    assert_eq!(state.reset(&mut [0.0; 111]), Err(Error::Memory));
    let mut sums = vec![f64::NAN; 112];
    state.reset(&mut sums).unwrap();
    assert_eq!(state.add(&mut sums[1..], Samples::new(&[0.3, 0.7], &[1.3])), Err(Error::Memory));
    assert_eq!(state.samples(), 0);
    let config = Config { estimator: Estimator::LeaveOneOut, ..config };
    assert_eq!(Accumulator::<f64>::new(&config).err(), Some(Error::Unsupported));
    let config = Config { estimator: Estimator::LeastSquares, ridge: Ridge::Auto, ..config };
    assert_eq!(Accumulator::<f64>::new(&config).err(), Some(Error::Unsupported));
}

/// A merged incremental stream goes on with the fits and the trust of all parts: the next sample of a line, which the
/// fits know almost exactly, adds the integral 3 and not its own value 4, to a tenth of the difference.
#[test]
fn merged_incremental_streams_go_on() {
    let config = config(1, 1, Estimator::Incremental);
    let mut rng = SplitMix64::new(51);
    let mut merged = accumulator::<f64>(&config);
    for parts in 1..=3 {
        let mut part = accumulator::<f64>(&config);
        let u = points(400, 1, &mut rng);
        let f: Vec<f32> = u.iter().map(|u| 2.0 + 2.0 * u).collect();
        part.add(Samples::new(&u, &f)).unwrap();
        merged.merge(&part).unwrap();
        let mut next = merged.clone();
        next.add(Samples::new(&[1.0], &[4.0])).unwrap();
        let total = |stream: &Stream<f64>| {
            let estimate = finish(stream).unwrap();
            f64::from(estimate.mean[0]) * f64::from(estimate.samples)
        };
        let value = total(&next) - total(&merged);
        assert!((value - 3.0).abs() < 0.1, "{parts} parts: {value}");
    }
}

/// What lies behind an accumulator's numbers in a longer buffer is somebody else's.
#[test]
fn longer_buffers_keep_their_end() {
    for estimator in ESTIMATORS.into_iter().filter(|&estimator| estimator != Estimator::LeaveOneOut) {
        let mut all = Accumulator::<f32>::new(&config(2, 2, estimator)).unwrap();
        let mut other = all;
        let len = all.len();
        let [mut sums, mut other_sums] = [vec![7.0; len + 100], vec![7.0; len + 100]];
        all.reset(&mut sums).unwrap();
        other.reset(&mut other_sums).unwrap();
        // Of growing values, to which the sums' unit is fitted again and again.
        let (u, mut f) = draw(64, 1);
        f.iter_mut().enumerate().for_each(|(index, f)| *f *= (index as f32).exp2());
        all.add(&mut sums, Samples::new(&u[..64], &f[..32])).unwrap();
        other.add(&mut other_sums, Samples::new(&u[64..], &f[32..])).unwrap();
        all.merge(&mut sums, &other, &other_sums).unwrap();
        assert!(sums[len..].iter().chain(&other_sums[len..]).all(|&value| value == 7.0), "{estimator:?}");
    }
}
