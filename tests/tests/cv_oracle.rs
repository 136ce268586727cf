//! Every solver and estimator against the slow oracle in `f64`.
//!
//! Estimates are `f32`. Unless a test says otherwise an `f64` path must agree within 4e-7 of the largest |f| (an
//! estimate's own rounding is 6e-8 of itself), an `f32` path within 1e-4 of it.

use crate::cv_support::*;
use noisefloor::Error;
use noisefloor::basis::Family;
use noisefloor::control_variate::{
    self, Color, Config, Estimate, Estimator, NonFinite, Optimizer, Regressor, Ridge, Samples, Solver,
};
use noisefloor_tests::ESTIMATORS;
use noisefloor_tests::oracle::{self, Design, Regression, RobustRule};
use noisefloor_tests::random::SplitMix64;

/// Samples with a smooth function and some noise.
fn noisy(n: usize, dims: usize, seed: u64) -> (Vec<f32>, Vec<f32>) {
    let mut rng = SplitMix64::new(seed);
    let u = points(n, dims, &mut rng);
    let mut f = values(&u, dims, smooth);
    f.iter_mut().for_each(|f| *f += 0.1 * rng.normal() as f32);
    (u, f)
}

const F64: f64 = 4e-7;
const F32: f64 = 1e-4;

#[track_caller]
fn close(estimate: &Estimate, expected: f64, f: &[f32], tolerance: f64, what: &str) {
    let error = (f64::from(estimate.mean[0]) - expected).abs() / largest(f);
    assert!(error < tolerance, "{what}: {} instead of {expected}, {error:e} of the largest value", estimate.mean[0]);
}

/// (dims, order, n): more and fewer samples than terms, one to fifteen dimensions, no multiple of eight and one.
const SHAPES: [(usize, usize, usize); 9] =
    [(1, 3, 9), (2, 2, 16), (2, 2, 64), (3, 3, 37), (5, 2, 64), (2, 7, 100), (3, 3, 12), (2, 2, 6), (8, 2, 20)];

#[test]
fn least_squares_by_every_solver() {
    for (index, (dims, order, n)) in SHAPES.into_iter().enumerate() {
        let (u, f) = noisy(n, dims, 200 + index as u64);
        let base = config(dims, order, Estimator::LeastSquares);
        let design = design(&base, &wide(&u));
        let oracle = |strength: f64| Regression::fit(&design, &wide(&f), strength * n as f64).intercept;
        // The default keeps a ridge of 1e-10 per sample, 1e-6 in `f32`; by square roots 1e-24 and 1e-12.
        let fixed = f64::from(0.01_f32);
        for (ridge, strength, narrow) in [(Ridge::Default, 1e-10, 1e-6), (Ridge::Fixed(0.01), fixed, fixed)] {
            for solver in [Solver::Auto, Solver::NormalEquations, Solver::SquareRoot, Solver::Dual] {
                let is_rooted = solver == Solver::SquareRoot && ridge == Ridge::Default;
                let expected = oracle(if is_rooted { 1e-24 } else { strength });
                let expected_f32 = oracle(if is_rooted { 1e-12 } else { narrow });
                let config = Config { solver, ridge, ..base };
                let what = format!("{dims} {order} {n} {solver:?} {ridge:?}");
                // Without a ridge to speak of, a system with about as many samples as terms magnifies rounding.
                let short = n < design.weights.len() + 8 && ridge == Ridge::Default;
                let tolerance = if short { 1e-4 } else { F64 };
                close(&batch::<f64>(&config, &u, &f).unwrap(), expected, &f, tolerance, &what);
                if !short {
                    // The dual's system is all but singular where samples outnumber terms and only a ridge of 1e-6
                    // helps.
                    let dual = solver == Solver::Dual && ridge == Ridge::Default;
                    let tolerance = if dual { 5e-3 } else { F32 };
                    close(&batch::<f32>(&config, &u, &f).unwrap(), expected_f32, &f, tolerance, &format!("{what} f32"));
                }
                if solver != Solver::Dual {
                    let streamed = streamed::<f64>(&config, &u, &f).unwrap();
                    close(&streamed, expected, &f, tolerance, &format!("{what} streaming"));
                }
            }
        }
    }
}

#[test]
fn regressor() {
    fn check<const DIMS: usize, const TERMS: usize>(order: usize, n: usize, strength: f32, tolerance: f64) {
        let (u, f) = noisy(n, DIMS, 300 + TERMS as u64);
        let base = config(DIMS, order, Estimator::LeastSquares);
        let expected = Regression::fit(&design(&base, &wide(&u)), &wide(&f), f64::from(strength) * n as f64).intercept;
        let mut whole = Regressor::<DIMS, TERMS, 1>::new(Family::Legendre, order).unwrap();
        let mut parts = [whole.clone(), whole.clone(), whole.clone()];
        for (index, (u, &f)) in u.as_chunks::<DIMS>().0.iter().zip(&f).enumerate() {
            whole.add(u, &[f]).unwrap();
            parts[index % 3].add(u, &[f]).unwrap();
        }
        let [mut merged, second, third] = parts;
        merged.merge(&second).unwrap();
        merged.merge(&third).unwrap();
        for regressor in [whole, merged] {
            assert_eq!(regressor.samples(), n as u64);
            close(&regressor.estimate(strength).unwrap(), expected, &f, tolerance, "regressor");
        }
    }
    check::<2, 6>(2, 50, 1e-9, F64);
    check::<2, 6>(2, 5, 0.01, F64);
    check::<3, 20>(3, 80, 1e-9, F64);
    check::<1, 8>(7, 40, 1e-3, F64);
    // Order 2 of 3 coordinates has 10 terms.
    assert!(Regressor::<3, 10, 1>::new(Family::Legendre, 2).is_ok());
    assert!(Regressor::<3, 9, 1>::new(Family::Legendre, 2).is_err());
    let mut regressor = Regressor::<1, 2, 1>::new(Family::Legendre, 1).unwrap();
    assert_eq!(regressor.add(&[1.5], &[2.0]), Err(Error::Range));
}

/// The closed form, through the normal equations and the dual, against refitting n times.
#[test]
fn leave_one_out() {
    for (index, (dims, order, n)) in SHAPES.into_iter().enumerate().filter(|(_, (_, _, n))| *n < 65) {
        let (u, f) = noisy(n, dims, 400 + index as u64);
        for strength in [1e-3_f32, 0.01, 1.0] {
            let base = config(dims, order, Estimator::LeaveOneOut);
            let design = design(&base, &wide(&u));
            let ridge = f64::from(strength) * n as f64;
            let brute = Regression::leave_one_out_by_refitting(&design, &wide(&f), ridge);
            let (_, freedom) = Regression::offset(&design, ridge);
            let variance = brute.variance(freedom);
            for solver in [Solver::Auto, Solver::NormalEquations, Solver::Dual] {
                let config = Config { solver, ridge: Ridge::Fixed(strength), ..base };
                let what = format!("{dims} {order} {n} {solver:?} {strength}");
                let estimate = batch::<f64>(&config, &u, &f).unwrap();
                close(&estimate, brute.mean(), &f, F64, &what);
                close(&batch::<f32>(&config, &u, &f).unwrap(), brute.mean(), &f, 10.0 * F32, &format!("{what} f32"));
                // The standard error is that of the leave-one-out residuals and of their weights.
                assert!((f64::from(estimate.std_error[0]) / variance.sqrt() - 1.0).abs() < 1e-5, "{what}");
            }
        }
    }
}

/// `Ridge::Auto` is the strength of the four with the smallest leave-one-out error.
#[test]
fn automatic_ridge() {
    let mut chosen = [0; 4];
    for (index, (dims, order, n)) in SHAPES.into_iter().enumerate() {
        let (u, mut f) = noisy(n, dims, 450 + index as u64);
        // Every second function is mostly noise, which wants a stronger ridge.
        if index % 2 == 1 {
            let mut rng = SplitMix64::new(index as u64);
            f.iter_mut().for_each(|f| *f = rng.normal() as f32);
        }
        let base = Config { ridge: Ridge::Auto, ..config(dims, order, Estimator::LeaveOneOut) };
        let design = design(&base, &wide(&u));
        let strengths = [2e-5, 1e-3, 0.02, 0.2].map(|strength| strength * n as f64);
        let fits = strengths.map(|ridge| Regression::leave_one_out(&design, &wide(&f), ridge));
        let best = (0..4).min_by(|&a, &b| fits[a].press().total_cmp(&fits[b].press())).unwrap();
        chosen[best] += 1;
        close(&batch::<f64>(&base, &u, &f).unwrap(), fits[best].mean(), &f, F64, "leave-one-out");
        let in_sample = Regression::fit(&design, &wide(&f), strengths[best]).intercept;
        let config = Config { estimator: Estimator::LeastSquares, ..base };
        close(&batch::<f64>(&config, &u, &f).unwrap(), in_sample, &f, F64, "least squares");
    }
    assert!(chosen.iter().filter(|&&count| count > 0).count() > 1, "{chosen:?}");
}

#[test]
fn robust_mixture() {
    let rule = RobustRule::standard();
    for (index, (dims, order, n)) in SHAPES.into_iter().enumerate() {
        let (u, f) = noisy(n, dims, 500 + index as u64);
        let expected = rule.estimate(&wide(&u), dims, &wide(&f), order);
        for solver in [Solver::Auto, Solver::NormalEquations, Solver::Dual] {
            let config = Config { solver, ..config(dims, order, Estimator::Robust) };
            let what = format!("{dims} {order} {n} {solver:?}");
            close(&batch::<f64>(&config, &u, &f).unwrap(), expected, &f, F64, &what);
            close(&batch::<f32>(&config, &u, &f).unwrap(), expected, &f, 10.0 * F32, &format!("{what} f32"));
        }
        let plain = wide(&f).iter().sum::<f64>() / n as f64;
        assert!(n < 16 || (plain - expected).abs() > 1e-4, "the mixture does something");
    }
}

/// The rule itself, in the sizes where its cap and its discount matter: all samples on one side of a line.
#[test]
fn robust_mixture_of_badly_centred_samples() {
    let rule = RobustRule::standard();
    let mut rng = SplitMix64::new(550);
    for n in [2, 3, 4, 5, 8, 11, 16] {
        for (low, width) in [(0.0, 0.5), (0.4, 0.2), (0.9, 0.1)] {
            let u: Vec<f32> = (0..n).map(|_| low + width * rng.uniform_f32()).collect();
            let f = values(&u, 1, |u| (3.0 * u[0]).exp() + (u[0] - 0.5).abs());
            for order in [1, 2, 4] {
                let expected = rule.estimate(&wide(&u), 1, &wide(&f), order);
                let estimate = batch::<f64>(&config(1, order, Estimator::Robust), &u, &f).unwrap();
                // Leave-one-out errors of such samples are differences of nearly equal numbers.
                close(&estimate, expected, &f, 2e-5, &format!("{n} samples in {low} + {width}, order {order}"));
            }
        }
    }
}

#[test]
fn k_fold_in_batch_and_streaming() {
    let rule = RobustRule::standard();
    for (index, (dims, order, n)) in
        [(1, 3, 24), (2, 2, 32), (2, 2, 13), (3, 2, 64), (2, 4, 20)].into_iter().enumerate()
    {
        let (u, f) = noisy(n, dims, 600 + index as u64);
        let (u64s, f64s) = (wide(&u), wide(&f));
        for folds in [3, 4, 7] {
            let what = format!("{dims} {order} {n}, {folds} folds");
            let config = Config { folds, ..config(dims, order, Estimator::KFold) };
            let split = rule.split(&u64s, dims, &f64s, order, folds);
            close(&batch::<f64>(&config, &u, &f).unwrap(), split, &f, F64, &what);
            close(&batch::<f32>(&config, &u, &f).unwrap(), split, &f, 10.0 * F32, &format!("{what} f32"));
            let nested = rule.nested(&u64s, dims, &f64s, order, folds);
            close(&streamed::<f64>(&config, &u, &f).unwrap(), nested, &f, F64, &format!("{what} nested"));
            let pooled = rule.pooled(&u64s, dims, &f64s, order, folds);
            let config = Config { estimator: Estimator::Robust, ..config };
            close(&streamed::<f64>(&config, &u, &f).unwrap(), pooled, &f, F64, &format!("{what} pooled"));
        }
    }
}

/// A fixed ridge: each fold meets one fit to the others.
#[test]
fn k_fold_with_a_fixed_ridge() {
    let (u, f) = noisy(30, 2, 650);
    for folds in [2, 4, 16] {
        let config = Config { folds, ridge: Ridge::Fixed(0.05), ..config(2, 2, Estimator::KFold) };
        let design = design(&config, &wide(&u));
        let expected = |fold_of: &[usize]| {
            let corrected = |fold: usize| {
                let others: Vec<usize> = (0..30).filter(|&i| fold_of[i] != fold).collect();
                let values: Vec<f64> = others.iter().map(|&i| f64::from(f[i])).collect();
                let fit = Regression::fit(&design.select(&others), &values, f64::from(0.05_f32) * others.len() as f64);
                let own = (0..30).filter(|&i| fold_of[i] == fold);
                own.map(|i| f64::from(f[i]) - fit.control(&design.rows[i])).sum::<f64>()
            };
            (0..folds).map(corrected).sum::<f64>() / 30.0
        };
        let runs = oracle::runs(30, folds);
        let batches: Vec<usize> = (0..30).map(|i| runs.iter().position(|run| run.contains(&i)).unwrap()).collect();
        close(&batch::<f64>(&config, &u, &f).unwrap(), expected(&batches), &f, F64, "batch");
        let stream = oracle::stream_folds(30, folds);
        close(&streamed::<f64>(&config, &u, &f).unwrap(), expected(&stream), &f, F64, "streaming");
    }
}

/// The other bases and slices, through designs made from definitions; controls count as columns of next to no penalty.
#[test]
fn every_basis_and_slices() {
    let rule = RobustRule::standard();
    let cases = [(2, 3, 0), (1, 7, 0), (5, 2, 0), (3, 2, 4), (2, 3, 6), (3, 1, 20)];
    for family in Family::ALL {
        for (index, (dims, order, slices)) in cases.into_iter().enumerate() {
            let (u, f) = noisy(60, dims, 700 + index as u64);
            let base = Config { basis: family, slices, ..config(dims, order, Estimator::Robust) };
            let design = design(&base, &wide(&u));
            assert_eq!(design.weights.len() + 1, base.terms().unwrap());
            let what = format!("{family:?} {dims} {order} {slices}");
            let expected = rule.estimate_design(&design, &wide(&f));
            close(&batch::<f64>(&base, &u, &f).unwrap(), expected, &f, F64, &what);
            let strength = 0.03_f32;
            let ridge = f64::from(strength) * 60.0;
            let expected = Regression::fit(&design, &wide(&f), ridge).intercept;
            let config = Config { estimator: Estimator::LeastSquares, ridge: Ridge::Fixed(strength), ..base };
            close(&batch::<f64>(&config, &u, &f).unwrap(), expected, &f, F64, &what);
            close(&streamed::<f64>(&config, &u, &f).unwrap(), expected, &f, F64, &what);
            close(&batch::<f32>(&config, &u, &f).unwrap(), expected, &f, F32, &what);
        }
    }
}

/// (4.18): with f = 3 h the estimate is 3 H, whatever the samples; a sum of two control functions likewise.
#[test]
fn control_functions_are_integrated_exactly() {
    let mut rng = SplitMix64::new(800);
    let u = points(40, 2, &mut rng);
    let first = values(&u, 2, |u| (-(3.0 * u[0] - u[1]).powi(2)).exp());
    let second = values(&u, 2, |u| f64::from(u8::from(u[0] > u[1])));
    let both: Vec<f32> = first.iter().zip(&second).flat_map(|(&a, &b)| [a, b]).collect();
    // The integrals need not be true: what counts is that they are taken for it.
    let integrals = [0.1875, 0.5];
    for estimator in ESTIMATORS {
        for order in [0, 2] {
            let base = Config { iterations: 3000, ..config(2, order, estimator) };
            let single = Config { controls: 1, ..base };
            let f: Vec<f32> = first.iter().map(|h| 3.0 * h).collect();
            let samples = Samples { u: &u, f: &f, controls: &first, control_integrals: &integrals[..1] };
            let pair = Config { controls: 2, ..base };
            let g: Vec<f32> = first.iter().zip(&second).map(|(a, b)| 3.0 * a - 0.5 * b).collect();
            let more = Samples { u: &u, f: &g, controls: &both, control_integrals: &integrals };
            // An incremental estimate starts with samples that no fit has seen; with few samples its mixture, and the
            // cap of a robust one's trust, still show.
            let tolerance = match estimator {
                Estimator::Incremental => 0.2,
                Estimator::GradientDescent if order > 0 => 2e-3,
                _ => 2e-6,
            };
            let what = format!("{estimator:?} {order}");
            close(&batch_of::<f64>(&single, samples).unwrap(), 0.5625, &f, tolerance, &what);
            close(&batch_of::<f64>(&pair, more).unwrap(), 0.3125, &g, tolerance, &what);
            if matches!(estimator, Estimator::Robust | Estimator::LeastSquares | Estimator::KFold) {
                let mut accumulator = accumulator::<f64>(&pair);
                accumulator.add(more).unwrap();
                close(&finish(&accumulator).unwrap(), 0.3125, &g, tolerance, &what);
                close(&batch_of::<f32>(&pair, more).unwrap(), 0.3125, &g, F32, &what);
            }
        }
    }
    // Of an incremental estimate with one fit at a time, whose first is to the first two, all samples but these.
    let alone = Config { controls: 1, ridge: Ridge::Fixed(0.01), ..config(2, 0, Estimator::Incremental) };
    let f: Vec<f32> = first.iter().map(|h| 3.0 * h).collect();
    let samples = Samples { u: &u, f: &f, controls: &first, control_integrals: &integrals[..1] };
    let expected = (f64::from(f[0] + f[1]) + 38.0 * 0.5625) / 40.0;
    close(&batch_of::<f64>(&alone, samples).unwrap(), expected, &f, 2e-6, "incremental");
}

/// Rows of a longer path: what lies between a row's first coordinates and the next row has no influence, and the last
/// row may end early.
#[test]
fn stride() {
    let (u, f) = noisy(33, 2, 850);
    let mut longer = vec![f32::NAN; 32 * 5 + 2];
    for (row, u) in longer.chunks_mut(5).zip(u.chunks(2)) {
        row[..2].copy_from_slice(u);
    }
    for estimator in ESTIMATORS {
        let tight = config(2, 2, estimator);
        let wide = Config { stride: 5, ..tight };
        let len = |config| control_variate::workspace_len::<f64>(config, 33);
        assert_eq!(len(&wide), len(&tight));
        assert_eq!(batch::<f64>(&wide, &longer, &f), batch::<f64>(&tight, &u, &f), "{estimator:?}");
        if estimator != Estimator::LeaveOneOut {
            assert_eq!(streamed::<f32>(&wide, &longer, &f), streamed::<f32>(&tight, &u, &f), "{estimator:?}");
        }
    }
}

/// The channels of a vector integrand: as if each were estimated alone, to 1e-6 of the value.
#[test]
fn channels_are_separate() {
    let (u, first) = noisy(40, 2, 900);
    let scales = [1.0, -30.0, 0.0, 1e-3];
    for channels in 1..=4 {
        let mut rng = SplitMix64::new(901);
        let f: Vec<f32> = first
            .iter()
            .flat_map(|&f| (0..channels).map(|c| scales[c] * (f + c as f32 * rng.uniform_f32())).collect::<Vec<_>>())
            .collect();
        for estimator in ESTIMATORS {
            // With channels of one ridge each and one for all, an automatic choice would differ by design.
            let together = Config { channels, ..config(2, 2, estimator) };
            let all = batch::<f64>(&together, &u, &f).unwrap();
            let all_streamed =
                (estimator != Estimator::LeaveOneOut).then(|| streamed::<f64>(&together, &u, &f).unwrap());
            for (channel, &scale) in scales.iter().enumerate() {
                let own: Vec<f32> = f.iter().skip(channel).step_by(channels).copied().collect();
                if channel >= channels {
                    assert_eq!((all.mean[channel], all.std_error[channel]), (0.0, 0.0));
                    continue;
                }
                let alone = batch::<f64>(&config(2, 2, estimator), &u, &own).unwrap();
                let what = format!("{estimator:?}, channel {channel} of {channels}");
                let same = |a: f32, b: f32| (a - b).abs() <= 1e-6 * scale.abs();
                assert!(same(all.mean[channel], alone.mean[0]), "{what}");
                assert!(same(all.std_error[channel], alone.std_error[0]), "{what}");
                if let Some(all) = &all_streamed {
                    let alone = streamed::<f64>(&config(2, 2, estimator), &u, &own).unwrap();
                    assert!(same(all.mean[channel], alone.mean[0]), "{what} streaming");
                }
            }
        }
    }
}

/// A channel that is constant has no part in the gain.
#[test]
fn constant_channels() {
    let (u, own) = noisy(40, 2, 900);
    let with: Vec<f32> = own.iter().flat_map(|&f| [f, 7.0]).collect();
    for estimator in ESTIMATORS {
        let alone = batch::<f64>(&config(2, 2, estimator), &u, &own).unwrap();
        let with = batch::<f64>(&Config { channels: 2, ..config(2, 2, estimator) }, &u, &with).unwrap();
        assert!((with.gain - alone.gain).abs() <= 1e-6, "{estimator:?}: {} {}", with.gain, alone.gain);
    }
}

/// Section 4.3: the estimate of the luminance, spread over the channels as the plain mean is.
#[test]
fn luminance_ratio() {
    let (u, red) = noisy(48, 2, 950);
    let rgb: Vec<f32> = red.iter().enumerate().flat_map(|(i, &f)| [2.0 + f, 1.0, 0.1 * (i % 5) as f32]).collect();
    let luminance: Vec<f32> = rgb.chunks(3).map(|c| 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]).collect();
    for estimator in ESTIMATORS {
        let grey = config(2, 2, estimator);
        let config = Config { channels: 3, color: Color::LuminanceRatio, ..grey };
        let mut pairs = vec![(batch::<f64>(&config, &u, &rgb).unwrap(), batch::<f64>(&grey, &u, &luminance).unwrap())];
        if estimator != Estimator::LeaveOneOut {
            let colour = streamed::<f64>(&config, &u, &rgb).unwrap();
            pairs.push((colour, streamed::<f64>(&grey, &u, &luminance).unwrap()));
        }
        for (colour, grey) in pairs {
            let mean_luminance = wide(&luminance).iter().sum::<f64>() / 48.0;
            for channel in 0..3 {
                let plain = wide(&rgb).iter().skip(channel).step_by(3).sum::<f64>() / 48.0;
                let expected = plain * f64::from(grey.mean[0]) / mean_luminance;
                assert!((f64::from(colour.mean[channel]) / expected - 1.0).abs() < 1e-6, "{estimator:?}");
                let error = f64::from(grey.std_error[0]) * plain / mean_luminance;
                assert!((f64::from(colour.std_error[channel]) / error - 1.0).abs() < 1e-5, "{estimator:?}");
            }
        }
    }
}

/// The ratio of merged streams, and of arrays with samples to skip, is that of the used samples in one array.
#[test]
fn luminance_ratio_of_parts() {
    let (u, red) = noisy(48, 2, 951);
    let rgb: Vec<f32> = red.iter().enumerate().flat_map(|(i, &f)| [2.0 + f, 1.0, (i / 12) as f32]).collect();
    let base = config(2, 2, Estimator::LeastSquares);
    let config = Config { channels: 3, color: Color::LuminanceRatio, non_finite: NonFinite::Skip, ..base };
    let expected = batch::<f64>(&config, &u, &rgb).unwrap();
    let check = |estimate: Estimate| {
        for channel in 0..3 {
            let error = (estimate.mean[channel] - expected.mean[channel]).abs();
            assert!(error < 1e-5 * expected.mean[0], "{estimate:?}, not {expected:?}");
        }
    };
    let mut parts = [accumulator::<f64>(&config), accumulator(&config)];
    parts[0].add(Samples::new(&u[..40], &rgb[..60])).unwrap();
    parts[1].add(Samples::new(&u[40..], &rgb[60..])).unwrap();
    let [mut merged, rest] = parts;
    merged.merge(&rest).unwrap();
    check(finish(&merged).unwrap());
    let (mut bad_u, mut bad_rgb) = (u.clone(), rgb.clone());
    bad_u.splice(20..20, [0.5; 20]);
    bad_rgb.splice(30..30, [9.0, f32::NAN, 9.0].into_iter().cycle().take(30));
    check(batch::<f64>(&config, &bad_u, &bad_rgb).unwrap());
    check(streamed::<f64>(&config, &bad_u, &bad_rgb).unwrap());
}

/// The error that one sample leaves unknown is so in a channel of value 0, too.
#[test]
fn luminance_ratio_of_one_sample() {
    let config = Config { channels: 3, color: Color::LuminanceRatio, ..config(2, 2, Estimator::Robust) };
    for colour in [[2.0, 1.0, 0.0], [0.0; 3]] {
        let estimate = batch::<f64>(&config, &[0.25, 0.5], &colour).unwrap();
        assert_eq!(estimate.mean[..3], colour);
        assert_eq!(estimate.std_error[..3], [f32::INFINITY; 3], "{colour:?}");
    }
}

/// Where values cancel so that their luminance is 0, its error says nothing of the channels'.
#[test]
fn luminance_ratio_of_values_that_cancel() {
    let config = Config { channels: 3, color: Color::LuminanceRatio, ..config(1, 0, Estimator::Robust) };
    let u: Vec<f32> = (0..8).map(|i| i as f32 / 8.0).collect();
    for (size, error) in [(1.0, f32::INFINITY), (0.0, 0.0)] {
        let f: Vec<f32> = (0..8 * 3).map(|i| if i / 3 % 2 == 0 { size } else { -size }).collect();
        let estimate = batch::<f64>(&config, &u, &f).unwrap();
        assert_eq!((estimate.mean[..3].to_vec(), estimate.std_error[..3].to_vec()), (vec![0.0; 3], vec![error; 3]));
    }
    // The luminances cancel, the colours do not: their mean is all that is known.
    let f: Vec<f32> = (0..8).flat_map(|i| if i % 2 == 0 { [7.152, 0.0, 0.0] } else { [0.0, -2.126, 0.0] }).collect();
    let estimate = batch::<f64>(&config, &u, &f).unwrap();
    assert_eq!(estimate.mean[..3], [3.576, -1.063, 0.0]);
}

/// Skipping leaves the estimate of the others, to rounding, wherever the bad samples are.
#[test]
fn skipped_samples_were_never_there() {
    let (u, f) = noisy(35, 2, 1000);
    let (mut bad_u, mut bad_f) = (u.clone(), f.clone());
    for (index, (at, value)) in
        [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.5].into_iter().zip([0.0, 1.0, 2.0, f32::NAN]).enumerate()
    {
        let place = [0, 9, 20, 35][index];
        bad_u.splice(2 * place..2 * place, [at, 0.5]);
        bad_f.insert(place, value);
    }
    for estimator in ESTIMATORS.into_iter().filter(|&estimator| estimator != Estimator::KFold) {
        for order in [2, 7] {
            let config = Config { non_finite: NonFinite::Skip, ..config(2, order, estimator) };
            let (kept, bad) = (batch::<f64>(&config, &u, &f).unwrap(), batch::<f64>(&config, &bad_u, &bad_f).unwrap());
            assert_eq!(bad.samples, 35);
            assert!((kept.mean[0] - bad.mean[0]).abs() < 4e-6, "{estimator:?} {order}: {kept:?} {bad:?}");
            if estimator != Estimator::LeaveOneOut {
                let kept = streamed::<f64>(&config, &u, &f).unwrap();
                assert_eq!(kept, streamed::<f64>(&config, &bad_u, &bad_f).unwrap());
            }
        }
    }
    // Folds go by place in the array, so that a skipped sample moves the others between folds.
    let config = Config { non_finite: NonFinite::Skip, ..config(2, 2, Estimator::KFold) };
    let bad = batch::<f64>(&config, &bad_u, &bad_f).unwrap();
    assert_eq!(bad.samples, 35);
    let kept = batch::<f64>(&config, &u, &f).unwrap();
    assert!((kept.mean[0] - bad.mean[0]).abs() < kept.std_error[0]);
}

/// 20,000 steps of each rule end where least squares is.
#[test]
fn gradient_descent_converges() {
    let (u, f) = noisy(60, 2, 1100);
    let expected = Regression::fit(&design(&config(2, 3, Estimator::Robust), &wide(&u)), &wide(&f), 0.0).intercept;
    for (optimizer, rate) in [(Optimizer::Momentum, 0.0), (Optimizer::Plain, 0.0), (Optimizer::Adam, 1e-3)] {
        let config =
            Config { optimizer, iterations: 20_000, learning_rate: rate, ..config(2, 3, Estimator::GradientDescent) };
        let what = format!("{optimizer:?}");
        // Adam's steps have a fixed length: it ends within one of them.
        let tolerance = if optimizer == Optimizer::Adam { 1e-4 } else { F64 };
        close(&batch::<f64>(&config, &u, &f).unwrap(), expected, &f, tolerance, &what);
        close(&streamed::<f64>(&config, &u, &f).unwrap(), expected, &f, tolerance, &what);
        close(&batch::<f32>(&config, &u, &f).unwrap(), expected, &f, 10.0 * F32, &what);
    }
}

/// The oracle's descent, step by step, by each rule with the documented constants and with others: columns of degree k
/// scaled by 2^(1 - k) are the oracle's on a scaled design. With 0 iterations there are as many as documented.
#[test]
fn gradient_descent_takes_the_documented_steps() {
    let cases = [
        (50, Optimizer::Plain, 0.0, 0.0, &[1, 2, 5, 20][..]),
        (50, Optimizer::Plain, 0.4, 0.9, &[2, 5]),
        (50, Optimizer::Momentum, 0.0, 0.0, &[2, 3, 5]),
        (50, Optimizer::Momentum, 0.3, 0.8, &[2, 3, 5]),
        (50, Optimizer::Adam, 0.0, 0.0, &[1, 2, 5, 20]),
        (50, Optimizer::Adam, 0.2, 0.6, &[1, 2, 5, 20]),
        (10, Optimizer::Plain, 0.03, 0.0, &[0]),
        (50, Optimizer::Plain, 0.03, 0.0, &[0]),
        (300, Optimizer::Plain, 0.01, 0.0, &[0]),
    ];
    for (n, optimizer, learning_rate, momentum, all_steps) in cases {
        let (u, f) = noisy(n, 2, 1150);
        let mut scaled = design(&config(2, 2, Estimator::Robust), &wide(&u));
        scaled.rows.iter_mut().for_each(|row| row[2..].iter_mut().for_each(|value| *value *= 0.5));
        let or = |value: f32, default: f64| if value > 0.0 { f64::from(value) } else { default };
        let mean = wide(&f).iter().sum::<f64>() / n as f64;
        let deviation = (wide(&f).iter().map(|f| (f - mean).powi(2)).sum::<f64>() / n as f64).sqrt();
        let rate = match optimizer {
            Optimizer::Adam => or(learning_rate, 0.05) * deviation,
            Optimizer::Momentum | Optimizer::Plain => or(learning_rate, 1.0) / largest_curvature(&scaled),
        };
        let kept = match optimizer {
            Optimizer::Momentum => or(momentum, 0.5),
            Optimizer::Adam => or(momentum, 0.9),
            Optimizer::Plain => 0.0,
        };
        let expected = |steps: usize| {
            let (mut first, mut second, mut times) = ([0.0; 5], [0.0; 5], [0; 5]);
            let step = |j: usize, g: f64| {
                times[j] += 1;
                if optimizer != Optimizer::Adam {
                    first[j] = kept * first[j] + rate * g;
                    return first[j];
                }
                first[j] = kept * first[j] + (1.0 - kept) * g;
                second[j] = 0.999 * second[j] + 0.001 * g * g;
                let unbiased = second[j] / (1.0 - 0.999_f64.powi(times[j]));
                rate * first[j] / (1.0 - kept.powi(times[j])) / unbiased.sqrt()
            };
            oracle::gradient_descent(&scaled, &wide(&f), &[0.0; 5], steps, step).intercept
        };
        // The largest curvature takes the library 12 rounds of power iteration.
        let tolerance = match (optimizer, learning_rate > 0.1 || learning_rate == 0.0) {
            (Optimizer::Adam, _) => 1e-5,
            (_, true) => 1e-3,
            (_, false) => 1e-4,
        };
        for &iterations in all_steps {
            let base = config(2, 2, Estimator::GradientDescent);
            let config = Config { optimizer, iterations, learning_rate, momentum, ..base };
            let steps = if iterations == 0 { (n / 2).clamp(8, 128) } else { iterations };
            let what = format!("{n} samples, {optimizer:?}, {learning_rate}, {momentum}, {steps} steps");
            close(&batch::<f64>(&config, &u, &f).unwrap(), expected(steps), &f, tolerance, &what);
            let fewer = if iterations == 0 { steps - steps / 8 } else { steps - 1 };
            let shows = (expected(steps) - expected(fewer)).abs() / largest(&f);
            println!("{what}: a step shows by {shows:.1e}");
            assert!(shows > tolerance || steps == 20, "{what}");
        }
    }
}

/// Of the centred columns of a design, by 2000 rounds of power iteration.
fn largest_curvature(design: &Design) -> f64 {
    let means = design.means();
    let mut vector = vec![1.0; means.len()];
    let mut curvature = 0.0;
    for _ in 0..2000 {
        let mut image = vec![0.0; means.len()];
        for row in &design.rows {
            let centred: Vec<f64> = row.iter().zip(&means).map(|(p, m)| p - m).collect();
            let product: f64 = centred.iter().zip(&vector).map(|(p, v)| p * v).sum();
            image.iter_mut().zip(&centred).for_each(|(out, p)| *out += product * p / design.rows.len() as f64);
        }
        curvature = image.iter().map(|x| x * x).sum::<f64>().sqrt();
        vector = image.iter().map(|x| x / curvature).collect();
    }
    curvature
}

/// A start from the last frame's solution ends nearer to the new frame's least squares than one from zero does.
#[test]
fn warm_start_beats_cold() {
    let (u, f) = noisy(64, 2, 1200);
    let next: Vec<f32> = f.iter().map(|f| 1.03 * f + 0.01).collect();
    let config = Config { iterations: 4, ..config(2, 3, Estimator::GradientDescent) };
    let columns = config.terms().unwrap() - 1;
    let goal = Regression::fit(&design(&config, &wide(&u)), &wide(&next), 0.0);
    let mut workspace = workspace::<f64>(&config, 64);
    let mut solution = vec![0.0; columns];
    let settled = Config { iterations: 5000, ..config };
    control_variate::gradient_descent(&settled, Samples::new(&u, &f), &mut solution, &mut workspace).unwrap();
    let mut run = |mut start: Vec<f32>| {
        let estimate = control_variate::gradient_descent(&config, Samples::new(&u, &next), &mut start, &mut workspace);
        (f64::from(estimate.unwrap().mean[0]) - goal.intercept).abs()
    };
    let (cold, warm) = (run(vec![0.0; columns]), run(solution.clone()));
    assert!(warm < 0.2 * cold, "{warm} {cold}");
    // Without a start it is the batch estimate.
    let mut zero = vec![0.0; columns];
    let started = control_variate::gradient_descent(&config, Samples::new(&u, &f), &mut zero, &mut workspace).unwrap();
    assert_eq!(started, batch::<f64>(&config, &u, &f).unwrap());
}

/// A start far from the solution, of which few short steps leave the values farther than the mean is, gives the mean
/// and is not lost: frame after frame ends where least squares is. What diverges is.
#[test]
fn far_starts_come_nearer() {
    let u: Vec<f32> = (0..16).map(|i| (i as f32 + 0.3) / 16.0).collect();
    let base = config(1, 1, Estimator::GradientDescent);
    let plain = batch::<f64>(&Config { order: 0, ..base }, &u, &u).unwrap();
    let config = Config { optimizer: Optimizer::Plain, learning_rate: 0.01, iterations: 64, ..base };
    let mut workspace = workspace::<f64>(&config, 16);
    let mut slope = [100.0];
    let mut frame = |config: &Config, slope: &mut [f32]| {
        control_variate::gradient_descent(config, Samples::new(&u, &u), slope, &mut workspace).unwrap()
    };
    assert_eq!(frame(&config, &mut slope), plain);
    assert!(slope[0] > 40.0 && slope[0] < 60.0, "{slope:?}");
    for _ in 0..40 {
        frame(&config, &mut slope);
    }
    assert!((slope[0] - (1.0_f32 / 12.0).sqrt()).abs() < 1e-4, "{slope:?}");
    let mut slope = [100.0];
    assert_eq!((frame(&Config { learning_rate: 3.0, ..config }, &mut slope), slope), (plain, [0.0]));
}

/// (4.30) by a loop that keeps all samples: fits of total ridge .1 and 1 to the samples before, mixed by their errors
/// so far, renewed at the documented times.
fn incremental_by_loop(u: &[f32], dims: usize, f: &[f32], order: usize, fixed: Option<f64>) -> f64 {
    let design = design(&config(dims, order, Estimator::Robust), &wide(u));
    let f = wide(f);
    let (mut sum, mut due) = (0.0, 0);
    let mut fits: Vec<Regression> = vec![];
    let mut mean = 0.0;
    let (mut errors, mut plain, mut predictions) = ([0.0; 2], 0.0, 0.0);
    for i in 0..f.len() {
        let mut value = f[i];
        if !fits.is_empty() {
            let mut weights = [1.0, 0.0];
            if fixed.is_none() {
                let n: f64 = predictions;
                let logs = errors.map(|error| -n / 4.0 * f64::ln(error / plain));
                let caution = (logs[0].max(logs[1]).max(0.0) - n * n / 14.0).max(0.0);
                let total = logs.iter().map(|log| log.exp()).sum::<f64>() + 16.0 * caution.exp();
                weights = if plain > 0.0 { logs.map(|log| log.exp() / total) } else { [0.0; 2] };
            }
            for (k, fit) in fits.iter().enumerate() {
                value -= weights[k] * fit.control(&design.rows[i]);
                errors[k] += (f[i] - fit.intercept - fit.control(&design.rows[i])).powi(2);
            }
            plain += (f[i] - mean).powi(2);
            predictions += 1.0;
        }
        sum += value;
        let samples = i + 1;
        if samples >= due.max(2) {
            let before: Vec<usize> = (0..samples).collect();
            let ridges = fixed.map_or([0.1, 1.0], |strength| [strength * samples as f64; 2]);
            fits = ridges.map(|ridge| Regression::fit(&design.select(&before), &f[..samples], ridge)).to_vec();
            mean = f[..samples].iter().sum::<f64>() / samples as f64;
            due = samples + (samples / 16).max(1);
        }
    }
    sum / f.len() as f64
}

#[test]
fn incremental_is_the_loop() {
    for (index, (dims, order, n)) in
        [(1, 2, 40), (2, 2, 5), (2, 2, 100), (3, 3, 60), (2, 2, 1), (2, 2, 2)].into_iter().enumerate()
    {
        let (u, f) = noisy(n, dims, 1300 + index as u64);
        for fixed in [None, Some(0.05_f32)] {
            let ridge = fixed.map_or(Ridge::Default, Ridge::Fixed);
            let config = Config { ridge, ..config(dims, order, Estimator::Incremental) };
            let expected = incremental_by_loop(&u, dims, &f, order, fixed.map(f64::from));
            let what = format!("{dims} {order} {n} {ridge:?}");
            close(&batch::<f64>(&config, &u, &f).unwrap(), expected, &f, F64, &what);
            close(&batch::<f32>(&config, &u, &f).unwrap(), expected, &f, 10.0 * F32, &what);
            // One sample at a time is the same stream.
            let mut accumulator = accumulator::<f64>(&config);
            for (u, f) in u.chunks(dims).zip(f.chunks(1)) {
                accumulator.add(Samples::new(u, f)).unwrap();
            }
            assert_eq!(finish(&accumulator), batch::<f64>(&config, &u, &f));
        }
    }
    // With a fixed ridge and few samples, fits are renewed every time: the oracle's own form.
    let (u, f) = noisy(30, 2, 1399);
    let design = design(&config(2, 2, Estimator::Robust), &wide(&u));
    let expected = oracle::incremental(&design, &wide(&f), f64::from(0.05_f32));
    let config = Config { ridge: Ridge::Fixed(0.05), ..config(2, 2, Estimator::Incremental) };
    close(&batch::<f64>(&config, &u, &f).unwrap(), expected, &f, F64, "every sample");
}
