//! Many samples and merged ones: single precision, memory, and how many are refused.

use crate::cv_support::*;
use noisefloor::Error;
use noisefloor::basis::Family;
use noisefloor::control_variate::{self, Config, Estimate, Estimator, Regressor, Samples, Solver};
use noisefloor::real::Real;
use noisefloor_tests::ESTIMATORS;
use noisefloor_tests::random::SplitMix64;

/// Few samples, each in an accumulator of its own, have a standard error above 0, also where rounding to `f32` is most
/// of what a fit to as few says of where they lie.
#[test]
fn few_merged_samples_have_an_error() {
    let mut rng = SplitMix64::new(13);
    for n in [2, 3, 4, 8, 16] {
        for _ in 0..500 {
            let u = points(n, 2, &mut rng);
            let f = values(&u, 2, smooth);
            for estimator in [Estimator::Robust, Estimator::KFold, Estimator::LeastSquares] {
                let config = config(2, 2, estimator);
                let mut parts = u.chunks(2).zip(f.chunks(1)).map(|(u, f)| {
                    let mut part = accumulator::<f32>(&config);
                    part.add(Samples::new(u, f)).unwrap();
                    part
                });
                let mut merged = parts.next().unwrap();
                parts.for_each(|part| merged.merge(&part).unwrap());
                let estimate = finish(&merged).unwrap();
                assert!(estimate.std_error[0] > 0.0, "{estimator:?}, {n}: {estimate:?} of {u:?}");
            }
        }
    }
}

/// What is merged into nothing is as it was, to the bit, also where values differ by little from what they have in
/// common.
#[test]
fn merging_into_nothing_is_copying() {
    let mut rng = SplitMix64::new(15);
    let u = points(40, 2, &mut rng);
    let f: Vec<f32> = values(&u, 2, smooth).iter().map(|f| 1e6 + f).collect();
    fn check<R: Real>(config: &Config, u: &[f32], f: &[f32]) {
        let (mut part, mut merged) = (accumulator::<R>(config), accumulator::<R>(config));
        part.add(Samples::new(u, f)).unwrap();
        merged.merge(&part).unwrap();
        assert_eq!(finish(&merged), finish(&part), "{config:?}");
    }
    for config in streaming_configs(2, 2) {
        check::<f64>(&config, &u, &f);
        check::<f32>(&config, &u, &f);
    }
    let mut part = Regressor::<2, 6, 1>::new(Family::Legendre, 2).unwrap();
    u.as_chunks().0.iter().zip(&f).for_each(|(u, &f)| part.add(u, &[f]).unwrap());
    let mut merged = Regressor::new(Family::Legendre, 2).unwrap();
    merged.merge(&part).unwrap();
    assert_eq!(merged.estimate(0.01), part.estimate(0.01));
    assert_eq!(merged.merge(&Regressor::new(Family::Sine, 2).unwrap()), Err(Error::Mismatch));
}

/// Parts whose values differ a thousand times merge in `f32` as in `f64`, to what sums in `f32` keep.
#[test]
fn merging_parts_of_other_sizes() {
    let u = points(40, 2, &mut SplitMix64::new(15));
    let config = Config { solver: Solver::SquareRoot, ..config(2, 1, Estimator::LeastSquares) };
    fn both<R: Real>(config: &Config, u: &[f32]) -> Estimate {
        let f = values(u, 2, smooth);
        let large: Vec<f32> = f.iter().map(|f| 1e3 * f).collect();
        let (mut merged, mut part) = (accumulator::<R>(config), accumulator::<R>(config));
        merged.add(Samples::new(u, &large)).unwrap();
        part.add(Samples::new(u, &f)).unwrap();
        merged.merge(&part).unwrap();
        finish(&merged).unwrap()
    }
    let errors = [both::<f32>(&config, &u).std_error[0], both::<f64>(&config, &u).std_error[0]];
    assert!((errors[0] / errors[1] - 1.0).abs() < 1e-3, "{errors:?}");
}

/// Values of a function with some noise, but for the first.
fn values_after(first: f32, u: &[f32], rng: &mut SplitMix64) -> Vec<f32> {
    let mut f: Vec<f32> = u.chunks(2).map(|u| 0.6 + 0.1 * u[0] + 0.01 * rng.uniform_f32()).collect();
    f[0] = first;
    f
}

/// In `f32` a stream whose first sample is an outlier or in shadow has, after 100,000 samples, added or merged one by
/// one, the mean of `f64` within a twentieth of the standard error, which is within a tenth of that of `f64`.
#[test]
fn narrow_streams_forget_their_first_sample() {
    let mut rng = SplitMix64::new(14);
    let u = points(100_000, 2, &mut rng);
    for first in [1e4, 0.0] {
        let f = values_after(first, &u, &mut rng);
        for config in streaming_configs(2, 1) {
            let wide = streamed::<f64>(&config, &u, &f).unwrap();
            let mut merged = accumulator::<f32>(&config);
            for (u, f) in u.chunks(2).zip(f.chunks(1)) {
                let mut part = accumulator::<f32>(&config);
                part.add(Samples::new(u, f)).unwrap();
                merged.merge(&part).unwrap();
            }
            let added = streamed::<f32>(&config, &u, &f).unwrap();
            for (how, narrow) in [("added", added), ("merged", finish(&merged).unwrap())] {
                // Samples that were merged one by one are their own past: nothing corrects them.
                if how == "merged" && config.estimator == Estimator::Incremental {
                    continue;
                }
                let what =
                    format!("{how} {:?} {:?}, {first} first: {narrow:?} for {wide:?}", config.estimator, config.solver);
                assert!((narrow.mean[0] - wide.mean[0]).abs() < 0.05 * wide.std_error[0], "{what}");
                assert!((narrow.std_error[0] / wide.std_error[0] - 1.0).abs() < 0.1, "{what}");
            }
        }
    }
}

/// The same of samples in arrays, by every estimator. Givens rotations are those of a stream.
#[test]
fn narrow_batches_forget_their_first_sample() {
    let mut rng = SplitMix64::new(15);
    let u = points(100_000, 2, &mut rng);
    for first in [1e4, 0.0] {
        let f = values_after(first, &u, &mut rng);
        for estimator in ESTIMATORS {
            let config = config(2, 1, estimator);
            let (wide, narrow) = (batch::<f64>(&config, &u, &f).unwrap(), batch::<f32>(&config, &u, &f).unwrap());
            let what = format!("{estimator:?}, {first} first: {narrow:?} for {wide:?}");
            assert!((narrow.mean[0] - wide.mean[0]).abs() < 0.05 * wide.std_error[0], "{what}");
            assert!((narrow.std_error[0] / wide.std_error[0] - 1.0).abs() < 0.1, "{what}");
        }
    }
}

/// An incremental estimate of arrays takes the memory of its stream, and no more.
#[test]
fn memory_of_incremental_estimates() {
    let config = config(2, 2, Estimator::Incremental);
    let len = control_variate::workspace_len::<f64>(&config, 9).unwrap();
    let estimate = |len| {
        control_variate::estimate(&config, Samples::new(&[0.5; 18], &[1.0; 9]), &mut vec![f64::NAN; len]).map(drop)
    };
    assert_eq!((estimate(len), estimate(len - 1)), (Ok(()), Err(Error::Memory)));
}

/// More samples than sums or counts hold are refused, before any is read, and so are merging and asking for the
/// workspace.
#[test]
fn too_many_samples() {
    let config = config(1, 0, Estimator::Robust);
    let most = 1 << 25;
    assert!(control_variate::workspace_len::<f32>(&config, most).is_ok());
    assert_eq!(control_variate::workspace_len::<f32>(&config, most + 1), Err(Error::Range));
    assert!(control_variate::workspace_len::<f64>(&config, most + 1).is_ok());
    let stream = Config { order: 1, estimator: Estimator::Incremental, ..config };
    assert!(control_variate::workspace_len::<f32>(&stream, 1 << 22).is_ok());
    assert_eq!(control_variate::workspace_len::<f32>(&stream, (1 << 22) + 1), Err(Error::Range));
    let mut doubled = accumulator::<f32>(&stream);
    doubled.add(Samples::new(&[0.5], &[1.0])).unwrap();
    let one = doubled.clone();
    for _ in 0..22 {
        doubled.merge(&doubled.clone()).unwrap();
    }
    assert_eq!((doubled.samples(), doubled.merge(&one)), (1 << 22, Err(Error::Range)));
    let zeros = vec![0.0; most + 1];
    let samples = Samples::new(&zeros, &zeros);
    assert_eq!(control_variate::estimate::<f32>(&config, samples, &mut []), Err(Error::Range));
    assert_eq!(control_variate::estimate::<f64>(&config, samples, &mut []), Err(Error::Memory));
    let descent = Config { estimator: Estimator::GradientDescent, ..config };
    assert_eq!(control_variate::gradient_descent::<f32>(&descent, samples, &mut [], &mut []), Err(Error::Range));
    if let Ok(many) = usize::try_from(1_u64 << 32) {
        assert_eq!(control_variate::workspace_len::<f64>(&config, many), Err(Error::Range));
    }
}

/// A count beyond 64 bits stays at the largest, also when one more sample is added.
#[test]
fn counts_end_at_the_largest() {
    let sample = Samples::new(&[0.5], &[1.0]);
    for config in streaming_configs(1, 1) {
        let mut doubled = accumulator::<f64>(&config);
        doubled.add(sample).unwrap();
        for _ in 0..64 {
            doubled.merge(&doubled.clone()).unwrap();
        }
        doubled.add(sample).unwrap();
        assert_eq!((doubled.samples(), finish(&doubled).unwrap().mean[0]), (u64::MAX, 1.0), "{config:?}");
    }
    let mut doubled = Regressor::<1, 2, 1>::new(Family::Legendre, 1).unwrap();
    doubled.add(&[0.5], &[1.0]).unwrap();
    for _ in 0..64 {
        doubled.merge(&doubled.clone()).unwrap();
    }
    doubled.add(&[0.5], &[1.0]).unwrap();
    assert_eq!((doubled.samples(), doubled.estimate(0.01).unwrap().mean[0]), (u64::MAX, 1.0));
}
