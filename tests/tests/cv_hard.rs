//! Hard cases: few samples, badly placed samples, extreme values, values that are no numbers.
//!
//! Each is compared with the oracle or with its exact outcome. Tolerances are relative to the largest |f|: 4e-7 for
//! what is well conditioned, else as stated where it is used.

use crate::cv_support::*;
use noisefloor::Error;
use noisefloor::basis::Family;
use noisefloor::control_variate::{
    self, Config, Estimate, Estimator, NonFinite, Optimizer, Regressor, Ridge, Samples, Solver,
};
use noisefloor_tests::ESTIMATORS;
use noisefloor_tests::oracle::{Regression, RobustRule};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::shared;
use noisefloor_tests::statistics::rmse_ratio;

const F64: f64 = 4e-7;

#[track_caller]
fn close(estimate: &Estimate, expected: f64, f: &[f32], tolerance: f64, what: &str) {
    let error = (f64::from(estimate.mean[0]) - expected).abs() / largest(f);
    assert!(error < tolerance, "{what}: {} instead of {expected}, {error:e} of the largest value", estimate.mean[0]);
}

/// Every way to make an estimate of samples: batch and streaming, in both precisions. Errors are failures.
fn every_estimate(config: &Config, u: &[f32], f: &[f32]) -> Vec<(String, Estimate)> {
    let mut all = Vec::new();
    for estimator in ESTIMATORS {
        for solver in [Solver::Auto, Solver::NormalEquations, Solver::SquareRoot, Solver::Dual] {
            if solver == Solver::SquareRoot && estimator != Estimator::LeastSquares {
                continue;
            }
            let config = Config { estimator, solver, ..*config };
            let mut keep = |name: &str, estimate: Result<Estimate, Error>| {
                let what = format!("{name} {estimator:?} {solver:?} dims {} order {}", config.dims, config.order);
                all.push((what.clone(), estimate.unwrap_or_else(|error| panic!("{what}: {error}"))));
            };
            if estimator != Estimator::Incremental || solver != Solver::Dual {
                keep("batch f64", batch::<f64>(&config, u, f));
                keep("batch f32", batch::<f32>(&config, u, f));
            }
            if estimator != Estimator::LeaveOneOut && solver != Solver::Dual {
                keep("streaming f64", streamed::<f64>(&config, u, f));
                keep("streaming f32", streamed::<f32>(&config, u, f));
            }
        }
    }
    all
}

/// Estimates of a block of one row of pixels, of `n` samples each.
fn block(config: &Config, u: &[f32], f: &[f32], n: usize) -> Vec<Estimate> {
    shared::block(config, f.len() / n / config.channels, Samples::new(u, f)).unwrap()
}

/// Sets of positions that starve or mislead a fit.
fn placements(n: usize, dims: usize, rng: &mut SplitMix64) -> Vec<(&'static str, Vec<f32>)> {
    let spread = points(n, dims, rng);
    let two = points(2, dims, rng);
    let corner = points(1, dims, rng).iter().map(|x| 0.999 * x).collect::<Vec<f32>>();
    vec![
        ("spread", spread.clone()),
        ("equal", (0..n).flat_map(|_| two[..dims].to_vec()).collect()),
        ("two points", (0..n).flat_map(|i| two[i % 2 * dims..][..dims].to_vec()).collect()),
        ("box of 1e-3", spread.chunks(dims).flat_map(|u| u.iter().zip(&corner).map(|(u, c)| c + 1e-3 * u)).collect()),
        ("line", spread.chunks(dims).flat_map(|u| vec![u[0]; dims]).collect()),
        ("corners", spread.iter().map(|u| u.round()).collect()),
        ("zero", vec![0.0; n * dims]),
        ("one", vec![1.0; n * dims]),
    ]
}

/// No panic, no NaN, for every placement, size and shape.
#[test]
fn everything_is_finite() {
    let mut rng = SplitMix64::new(1);
    let shapes = [(1, 2), (2, 3), (1, 7), (5, 2), (2, 0)];
    for (dims, order) in shapes {
        for family in Family::ALL {
            for n in [1, 2, 3, 5, 10, 17] {
                for (name, u) in placements(n, dims, &mut rng) {
                    let noise: Vec<f32> = (0..n).map(|_| rng.normal() as f32).collect();
                    let mut firefly = noise.clone();
                    firefly[n / 2] = 1e20;
                    let huge = noise.iter().map(|x| if *x > 0.0 { f32::MAX } else { f32::MIN }).collect();
                    let tiny = noise.iter().map(|x| x * 1e-42).collect();
                    for f in [noise, firefly, huge, tiny, values(&u, dims, smooth)] {
                        let config = Config { basis: family, ..Config::new(dims, order, 1) };
                        for (what, estimate) in every_estimate(&config, &u, &f) {
                            assert!(is_sound(&estimate), "{what}, {n} {name} {family:?}: {estimate:?}");
                            assert_eq!(estimate.samples as usize, n);
                        }
                        for estimate in block(&config, &u, &f, 1) {
                            assert!(is_sound(&estimate), "block, {n} {name} {family:?}: {estimate:?}");
                        }
                    }
                }
            }
        }
    }
}

/// The same where a fit is large: order 7 in 3 dimensions (120 terms), order 2 in 15 (136 terms).
#[test]
fn large_fits_are_finite() {
    let mut rng = SplitMix64::new(2);
    for (dims, order, n) in [(3, 7, 40), (3, 7, 130), (15, 2, 64), (15, 2, 136)] {
        for (name, u) in placements(n, dims, &mut rng).into_iter().take(4) {
            let mut f = values(&u, dims, smooth);
            for factor in [1.0, 1e20] {
                f[n / 3] *= factor;
                let config = Config { iterations: 16, ..Config::new(dims, order, 1) };
                for (what, estimate) in every_estimate(&config, &u, &f) {
                    assert!(is_sound(&estimate), "{what}, {n} {name}: {estimate:?}");
                }
            }
        }
    }
    // At the limits of dims, orders and channels.
    for (dims, order) in [1, 6, 11, 16].into_iter().flat_map(|dims| (0..=7).map(move |order| (dims, order))) {
        let config = Config { iterations: 16, ..Config::new(dims, order, 4) };
        if let Ok(terms) = config.terms() {
            let u = points(20, dims, &mut rng);
            let smooth = values(&u, dims, smooth);
            let f: Vec<f32> = smooth.iter().flat_map(|f| [1.0, 2.0, 3.0, 4.0].map(|c| c * f)).collect();
            for (what, estimate) in every_estimate(&config, &u, &f) {
                // Least squares of no more samples than terms does not know what it gains.
                let is_known = estimate.gain.is_finite() || terms >= 20 && what.contains("LeastSquares");
                assert!(is_sound(&estimate) && is_known, "{what}: {estimate:?}");
            }
        }
    }
}

/// 1 + x + y, which the basis holds, in one to four channels: least squares is exact by every solver, nobody is further
/// off than four standard errors of the mean, .051, and channels that are not there are 0.
#[test]
fn linear_functions() {
    let mut rng = SplitMix64::new(17);
    let u = points(64, 2, &mut rng);
    let linear = values(&u, 2, |u| 1.0 + u[0] + u[1]);
    for (channels, order) in [(1, 2), (2, 2), (3, 2), (4, 2), (2, 3)] {
        let f: Vec<f32> = linear.iter().flat_map(|f| (0..channels).map(move |c| (c + 1) as f32 * f)).collect();
        for (what, estimate) in every_estimate(&Config::new(2, order, channels), &u, &f) {
            for c in 0..4 {
                let (mean, error, scale) = (estimate.mean[c], estimate.std_error[c], (c + 1) as f32);
                if c >= channels {
                    assert_eq!((mean, error), (0.0, 0.0), "{what}");
                    continue;
                }
                let tolerance = match what.contains("LeastSquares") {
                    true if what.contains("f64") => 1e-4,
                    _ => 4.0 * 0.051,
                };
                assert!((mean - 2.0 * scale).abs() < tolerance * scale, "{what}: {estimate:?}");
                assert!((0.0..0.06 * scale).contains(&error), "{what}: {estimate:?}");
            }
            assert!((0.0..1.0).contains(&estimate.gain), "{what}: {estimate:?}");
        }
    }
}

/// The mean by hand, and a descent that finds the slope.
#[test]
fn few_samples_by_hand() {
    let plain = batch::<f64>(&Config::new(1, 0, 1), &[0.2, 0.6], &[1.0, 3.0]).unwrap();
    assert_eq!((plain.mean[0], plain.std_error[0], plain.gain, plain.samples), (2.0, 1.0, 1.0, 2));
    let config = Config { iterations: 200, ..config(1, 1, Estimator::GradientDescent) };
    let (samples, mut slope) = (Samples::new(&[0.1, 0.3, 0.9], &[1.1, 1.3, 1.9]), [0.0]);
    control_variate::gradient_descent(&config, samples, &mut slope, &mut workspace::<f64>(&config, 3)).unwrap();
    assert!((slope[0] - (1.0_f32 / 12.0).sqrt()).abs() < 0.01);
}

/// Robust and leave-one-out estimates and least squares with a ridge agree with the oracle on every placement. In `f32`
/// least squares within 2e-4, the robust mixture, whose trust goes by powers of differences, within 2e-2, and where
/// the dual is forced on more samples than terms, whose system only the ridge keeps from being singular, within 5e-2.
#[test]
fn badly_placed_samples_against_the_oracle() {
    let rule = RobustRule::standard();
    let mut rng = SplitMix64::new(3);
    for (dims, order, n) in [(2, 2, 4), (2, 2, 6), (2, 2, 16), (2, 3, 16), (1, 3, 4), (1, 3, 20), (3, 2, 30)] {
        for (name, u) in placements(n, dims, &mut rng) {
            let f: Vec<f32> = (0..n).map(|_| 1.0 + 0.5 * rng.normal() as f32).collect();
            let (u_wide, f_wide) = (wide(&u), wide(&f));
            let base = config(dims, order, Estimator::Robust);
            let design = design(&base, &u_wide);
            let expected = rule.estimate(&u_wide, dims, &f_wide, order);
            for solver in [Solver::Auto, Solver::NormalEquations, Solver::Dual] {
                let what = format!("{dims} {order} {n} {name} {solver:?}");
                let robust = Config { solver, ..base };
                let tolerance = if solver == Solver::Dual { 5e-2 } else { 2e-2 };
                close(&batch::<f64>(&robust, &u, &f).unwrap(), expected, &f, F64, &what);
                close(&batch::<f32>(&robust, &u, &f).unwrap(), expected, &f, tolerance, &format!("{what} f32"));
                for strength in [1e-3_f32, 0.1] {
                    let ridge = f64::from(strength) * n as f64;
                    let config = Config { estimator: Estimator::LeaveOneOut, ridge: Ridge::Fixed(strength), ..robust };
                    let expected = Regression::leave_one_out_by_refitting(&design, &f_wide, ridge).mean();
                    close(&batch::<f64>(&config, &u, &f).unwrap(), expected, &f, F64, &what);
                    let config = Config { estimator: Estimator::LeastSquares, ..config };
                    let expected = Regression::fit(&design, &f_wide, ridge).intercept;
                    close(&batch::<f64>(&config, &u, &f).unwrap(), expected, &f, F64, &what);
                    close(&batch::<f32>(&config, &u, &f).unwrap(), expected, &f, 2e-4, &format!("{what} f32"));
                    if solver == Solver::NormalEquations {
                        close(&streamed::<f64>(&config, &u, &f).unwrap(), expected, &f, F64, &what);
                        let config = Config { solver: Solver::SquareRoot, ..config };
                        close(&batch::<f64>(&config, &u, &f).unwrap(), expected, &f, F64, &what);
                        close(&streamed::<f64>(&config, &u, &f).unwrap(), expected, &f, F64, &what);
                    }
                }
            }
        }
    }
}

/// Where all samples coincide there is nothing to fit: every estimator gives the mean, least squares without a ridge
/// too. Within 1e-6 of the largest value, `f32` 1e-3.
#[test]
fn equal_positions_give_the_mean() {
    let mut rng = SplitMix64::new(4);
    for (dims, order, n) in [(2, 2, 12), (3, 3, 7), (1, 7, 30), (2, 7, 50)] {
        let place = points(1, dims, &mut rng);
        let u: Vec<f32> = (0..n).flat_map(|_| place.clone()).collect();
        let f: Vec<f32> = (0..n).map(|_| rng.normal() as f32).collect();
        let mean = wide(&f).iter().sum::<f64>() / n as f64;
        for (what, estimate) in every_estimate(&Config::new(dims, order, 1), &u, &f) {
            let tolerance = if what.contains("f32") { 1e-3 } else { 1e-6 };
            close(&estimate, mean, &f, tolerance, &what);
        }
    }
}

/// Fewer distinct positions than terms, many times each, and one coordinate that repeats the other: least squares of
/// noise is what the oracle makes of it with next to no ridge, by Givens rotations too, whose error is that of the
/// normal equations.
#[test]
fn columns_that_depend_on_each_other() {
    let mut rng = SplitMix64::new(40);
    let mut check = |dims, order, u: &[f32], basis| {
        let f: Vec<f32> = (0..u.len() / dims).map(|_| rng.normal() as f32).collect();
        for ridge in [Ridge::Default, Ridge::Fixed(1e-5), Ridge::Fixed(1e-3)] {
            let base = Config { basis, ridge, ..config(dims, order, Estimator::LeastSquares) };
            let strength = if let Ridge::Fixed(strength) = ridge { f64::from(strength) } else { 1e-8 };
            let expected = Regression::fit(&design(&base, &wide(u)), &wide(&f), strength * f.len() as f64).intercept;
            // With less the normal equations lose digits.
            let ridge = if ridge == Ridge::Default { Ridge::Fixed(1e-7) } else { ridge };
            let normal = streamed::<f64>(&Config { solver: Solver::NormalEquations, ridge, ..base }, u, &f).unwrap();
            let config = Config { solver: Solver::SquareRoot, ..base };
            for (estimate, tolerance) in [
                (batch::<f64>(&config, u, &f), 2e-4),
                (streamed::<f64>(&config, u, &f), 2e-4),
                // The rounding of more samples, in float, is no random walk.
                (if f.len() < 5000 { streamed::<f32> } else { streamed::<f64> }(&config, u, &f), 1e-3),
            ] {
                let (estimate, what) = (estimate.unwrap(), format!("{dims} {order} {} {ridge:?} {basis:?}", f.len()));
                close(&estimate, expected, &f, tolerance, &what);
                let ratio = f64::from(estimate.std_error[0] / normal.std_error[0]);
                assert!((ratio - 1.0).abs() < 0.02, "{what}: {estimate:?} beside {normal:?}");
            }
        }
    };
    for (dims, order, distinct) in [(2, 2, 2), (2, 2, 3), (2, 2, 4), (2, 2, 5), (3, 2, 2), (3, 2, 7), (1, 7, 5)] {
        let place = points(distinct, dims, &mut SplitMix64::new(41));
        // Gaussians are nearly dependent even where positions are not.
        for basis in Family::ALL.into_iter().filter(|&family| family != Family::Gaussian) {
            check(dims, order, &place.repeat(8), basis);
        }
    }
    for n in [40, 4000, 50_000] {
        let line: Vec<f32> = points(n, 1, &mut SplitMix64::new(42)).iter().flat_map(|&u| [u; 2]).collect();
        check(2, 2, &line, Family::Legendre);
    }
}

/// Of no more samples than terms least squares leaves no residual that could tell its error, whatever the solver.
#[test]
fn errors_of_no_residual_are_unknown() {
    let mut rng = SplitMix64::new(43);
    for n in 2..9 {
        let u = points(n, 2, &mut rng);
        let f: Vec<f32> = (0..n).map(|_| rng.normal() as f32).collect();
        let mut all = every_estimate(&Config::new(2, 2, 1), &u, &f);
        all.retain(|(what, _)| what.contains("LeastSquares"));
        let mut regressor = Regressor::<2, 6, 1>::new(Family::Legendre, 2).unwrap();
        u.as_chunks().0.iter().zip(&f).for_each(|(u, &f)| regressor.add(u, &[f]).unwrap());
        all.push(("regressor".into(), regressor.estimate(1e-9).unwrap()));
        for (what, estimate) in all {
            let is_known = estimate.std_error[0].is_finite() && estimate.gain.is_finite();
            let is_unknown = estimate.std_error[0] == f32::INFINITY && estimate.gain == f32::INFINITY;
            assert!(if n > 6 { is_known } else { is_unknown }, "{what}, {n}: {estimate:?}");
        }
    }
}

/// 120 terms from 130 samples and 136 from 64, against the oracle. The first is nearly as many terms as samples.
#[test]
fn large_fits_against_the_oracle() {
    let mut rng = SplitMix64::new(5);
    for (dims, order, n) in [(3, 7, 200), (15, 2, 64)] {
        let u = points(n, dims, &mut rng);
        let f = values(&u, dims, smooth);
        let base = config(dims, order, Estimator::LeastSquares);
        let design = design(&base, &wide(&u));
        for strength in [2e-5_f32, 0.02] {
            let expected = Regression::fit(&design, &wide(&f), f64::from(strength) * n as f64).intercept;
            let config = Config { ridge: Ridge::Fixed(strength), ..base };
            for solver in [Solver::Auto, Solver::NormalEquations, Solver::SquareRoot, Solver::Dual] {
                let config = Config { solver, ..config };
                let what = format!("{dims} {order} {solver:?} {strength}");
                close(&batch::<f64>(&config, &u, &f).unwrap(), expected, &f, F64, &what);
                close(&batch::<f32>(&config, &u, &f).unwrap(), expected, &f, 1e-3, &format!("{what} f32"));
                if solver != Solver::Dual {
                    close(&streamed::<f64>(&config, &u, &f).unwrap(), expected, &f, F64, &what);
                }
            }
        }
        // Leave-one-out of the first samples, refitting each time.
        let (u, f) = (&u[..24 * dims], &f[..24]);
        let config = Config { estimator: Estimator::LeaveOneOut, ridge: Ridge::Fixed(0.02), ..base };
        let ridge = f64::from(0.02_f32) * 24.0;
        let few = design.select(&(0..24).collect::<Vec<_>>());
        let expected = Regression::leave_one_out_by_refitting(&few, &wide(f), ridge).mean();
        close(&batch::<f64>(&config, u, f).unwrap(), expected, f, F64, "leave-one-out");
    }
    let u = points(16, 15, &mut rng);
    let f = values(&u, 15, smooth);
    let expected = RobustRule::standard().estimate(&wide(&u), 15, &wide(&f), 2);
    close(&batch::<f64>(&config(15, 2, Estimator::Robust), &u, &f).unwrap(), expected, &f, F64, "robust");
}

/// A constant comes back to the bit, with no error and no gain, from every estimator.
#[test]
fn constants_are_exact() {
    let mut rng = SplitMix64::new(6);
    let constants =
        [0.0, 1.0, -0.1, 16_777_217.0, 16_777_215.0, 1e30, -1e-30, 3e-42, f32::MAX, f32::MIN_POSITIVE, 1.0 / 3.0];
    for constant in constants {
        for n in [1, 2, 7, 8, 23, 64] {
            for channels in [1, 3] {
                let u = points(n, 2, &mut rng);
                let f = vec![constant; n * channels];
                for order in [0, 2, 5] {
                    let config = Config::new(2, order, channels);
                    let mut all = every_estimate(&config, &u, &f);
                    for basis in Family::ALL.into_iter().filter(|_| n == 64 && order == 2) {
                        all.extend(every_estimate(&Config { basis, ..config }, &u, &f));
                    }
                    all.extend(block(&config, &u, &f, 1).into_iter().map(|e| ("block".into(), e)));
                    all.extend(block(&config, &u, &f, n).into_iter().map(|e| ("block of one".into(), e)));
                    for (what, estimate) in all {
                        for channel in 0..channels {
                            let is_exact = estimate.mean[channel].to_bits() == constant.to_bits();
                            assert!(is_exact, "{what}, {n}: {} of {constant}", estimate.mean[channel]);
                            let error = estimate.std_error[channel];
                            let too_few = estimate.samples == 1;
                            assert!(error == 0.0 || (too_few && error.is_infinite()), "{what}, {n}: {error}");
                        }
                        assert_eq!(estimate.gain, 1.0, "{what}");
                    }
                }
            }
        }
    }
    let mut regressor = Regressor::<1, 4, 1>::new(Family::Legendre, 3).unwrap();
    for i in 0..20 {
        regressor.add(&[i as f32 / 20.0], &[1e30]).unwrap();
    }
    assert_eq!(regressor.estimate(1e-6).unwrap().mean[0], 1e30);
}

/// Samples of any scale: powers of two scale the result to the bit, other factors within 2e-6 of the largest value.
#[test]
fn scales() {
    let mut rng = SplitMix64::new(7);
    for n in [5, 32] {
        let u = points(n, 2, &mut rng);
        let f = values(&u, 2, smooth);
        let config = Config::new(2, 2, 1);
        let base = every_estimate(&config, &u, &f);
        for factor in [2.0_f32.powi(100), 2.0_f32.powi(-100), 1e30, 1e-30] {
            let scaled: Vec<f32> = f.iter().map(|f| f * factor).collect();
            let is_power = factor.log2().fract() == 0.0;
            for ((what, base), (_, scaled)) in base.iter().zip(every_estimate(&config, &u, &scaled)) {
                if is_power {
                    assert_eq!(scaled.mean[0], base.mean[0] * factor, "{what} {factor}");
                    assert_eq!(scaled.std_error[0], base.std_error[0] * factor, "{what} {factor}");
                    assert_eq!(scaled.gain, base.gain, "{what} {factor}");
                } else {
                    // What is scaled is `f32` again: n roundings of 6e-8, magnified by the fit at 5 samples of 6 terms.
                    let error = f64::from(scaled.mean[0] / factor - base.mean[0]).abs() / largest(&f);
                    let tolerance = if what.contains("f32") || n < 6 { 1e-3 } else { 2e-6 };
                    assert!(error < tolerance, "{what} {factor}: {error:e}");
                }
            }
        }
    }
}

/// Values at the end of `f32`: results stay in range and agree with the oracle, which has room.
#[test]
fn largest_values() {
    let mut rng = SplitMix64::new(8);
    let u = points(20, 2, &mut rng);
    let f: Vec<f32> = (0..20).map(|_| if rng.uniform() < 0.5 { f32::MAX } else { f32::MIN }).collect();
    let expected = RobustRule::standard().estimate(&wide(&u), 2, &wide(&f), 2);
    close(&batch::<f64>(&config(2, 2, Estimator::Robust), &u, &f).unwrap(), expected, &f, F64, "f64");
    close(&batch::<f32>(&config(2, 2, Estimator::Robust), &u, &f).unwrap(), expected, &f, 1e-4, "f32");
    // A fit that reaches beyond the type ends at its largest value: a steep line through the far side.
    let u: Vec<f32> = (0..9).map(|i| 0.9 + 0.01 * i as f32).collect();
    let f: Vec<f32> = u.iter().map(|u| (f64::from(u - 0.94) / 0.05 * f64::from(f32::MAX)) as f32).collect();
    let estimate = batch::<f64>(&config(1, 1, Estimator::LeastSquares), &u, &f).unwrap();
    assert_eq!(estimate.mean[0], f32::MIN);
}

/// RMSE of the robust estimate over the plain mean's, batch and streaming, where fits are useless: at most 1.05 (upper
/// end of the 95 % interval). Seeds 20..; 4,000 repetitions.
#[test]
fn robust_on_hopeless_data() {
    let integral = {
        let side = 2000;
        let centre = |i: usize| (i as f64 + 0.5) / f64::from(side);
        let rows = (0..side as usize).map(|i| (0..side as usize).map(|j| smooth(&[centre(i), centre(j)])).sum::<f64>());
        rows.sum::<f64>() / f64::from(side * side)
    };
    let cases = ["firefly", "twins", "fours", "two points", "box of 1e-3", "one point"];
    for (index, case) in cases.into_iter().enumerate() {
        for order in [2, 3] {
            for n in [8_usize, 16, 64] {
                let mut rng = SplitMix64::new(20 + index as u64);
                let (mut plain, mut robust, mut streaming) = (vec![], vec![], vec![]);
                let config = config(2, order, Estimator::Robust);
                for _ in 0..4000 / (n / 8) {
                    let mut u = points(n, 2, &mut rng);
                    let copies = |u: &[f32], distinct: usize| {
                        (0..n).flat_map(|i| u[i % distinct * 2..][..2].to_vec()).collect::<Vec<f32>>()
                    };
                    match case {
                        "twins" => u = copies(&u, n / 2),
                        "fours" => u = copies(&u, n / 4),
                        "two points" => u = copies(&u, 2),
                        "one point" => u = copies(&u, 1),
                        "box of 1e-3" => {
                            let corner = [rng.uniform_f32(), rng.uniform_f32()].map(|x| 0.999 * x);
                            u.chunks_mut(2).for_each(|u| (0..2).for_each(|k| u[k] = corner[k] + 1e-3 * u[k]));
                        }
                        _ => {}
                    }
                    let mut f = values(&u, 2, smooth);
                    let mut expected = integral;
                    if case == "firefly" {
                        f.iter_mut().filter(|_| rng.uniform() < 0.01).for_each(|f| *f = 1e20);
                        expected = 0.99 * integral + 1e18;
                    }
                    plain.push(wide(&f).iter().sum::<f64>() / n as f64 - expected);
                    robust.push(f64::from(batch::<f64>(&config, &u, &f).unwrap().mean[0]) - expected);
                    streaming.push(f64::from(streamed::<f64>(&config, &u, &f).unwrap().mean[0]) - expected);
                }
                for (what, errors) in [("batch", robust), ("streaming", streaming)] {
                    let ratio = rmse_ratio(&errors, &plain);
                    println!("{case}, {what}, order {order}, {n}: {:.4} +- {:.4}", ratio.value, ratio.half_width);
                    assert!(ratio.upper() <= 1.05, "{case}, {what}, order {order}, {n}: {ratio:?}");
                }
            }
        }
    }
}

/// NaN and infinity, in positions and values, are an error that leaves everything as it was.
#[test]
fn not_finite_is_an_error() {
    let mut rng = SplitMix64::new(9);
    let (u, f) = (points(12, 2, &mut rng), points(12, 1, &mut rng));
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for place in [0, 5, 11] {
            let (mut bad_u, mut bad_f) = (u.clone(), f.clone());
            bad_u[2 * place + 1] = bad;
            bad_f[place] = bad;
            for estimator in ESTIMATORS {
                let config = config(2, 2, estimator);
                for (u, f) in [(&bad_u, &f), (&u, &bad_f)] {
                    assert_eq!(batch::<f64>(&config, u, f), Err(Error::NotFinite));
                    assert_eq!(batch::<f32>(&config, u, f), Err(Error::NotFinite));
                    if estimator == Estimator::LeaveOneOut {
                        continue;
                    }
                    let mut accumulator = accumulator::<f32>(&config);
                    assert_eq!(accumulator.add(Samples::new(u, f)), Err(Error::NotFinite));
                    assert_eq!(finish(&accumulator), Err(Error::NoSamples));
                    accumulator.add(Samples::new(&bad_u[..2 * place.max(1)], &f[..place.max(1)])).ok();
                    let before = finish(&accumulator);
                    assert_eq!(accumulator.add(Samples::new(u, f)), Err(Error::NotFinite));
                    assert_eq!(finish(&accumulator), before);
                }
            }
            let config = Config::new(2, 2, 1);
            assert_eq!(shared::block(&config, 3, Samples::new(&u, &bad_f)), Err(Error::NotFinite));
            let mut start = [0.25; 5];
            let samples = Samples::new(&bad_u, &f);
            let result = control_variate::gradient_descent(&config, samples, &mut start, &mut [0.0; 4096]);
            assert_eq!((result, start), (Err(Error::NotFinite), [0.25; 5]));
            let mut regressor = Regressor::<2, 6, 1>::new(Family::Legendre, 2).unwrap();
            assert_eq!(regressor.add(&[0.5, bad], &[1.0]), Err(Error::NotFinite));
            assert_eq!(regressor.add(&[0.5, 0.5], &[bad]), Err(Error::NotFinite));
            assert_eq!(regressor.samples(), 0);
        }
    }
}

/// All samples bad, to be skipped: there is nothing left. One left: that one.
#[test]
fn skipping_all_or_all_but_one() {
    for estimator in ESTIMATORS {
        let config = Config { non_finite: NonFinite::Skip, ..config(1, 2, estimator) };
        let bad = [f32::NAN; 9];
        assert_eq!(batch::<f64>(&config, &[0.5; 9], &bad), Err(Error::NoSamples), "{estimator:?}");
        let mut one = bad;
        one[4] = 3.0;
        let estimate = batch::<f64>(&config, &[0.5; 9], &one).unwrap();
        assert_eq!((estimate.mean[0], estimate.std_error[0], estimate.samples), (3.0, f32::INFINITY, 1));
    }
}

/// Control functions and integrals that are missing, too many or not finite are refused, and so are too many
/// coordinates.
#[test]
fn control_functions_must_match() {
    let mut rng = SplitMix64::new(33);
    let (u, h) = (points(12, 2, &mut rng), points(24, 1, &mut rng));
    let f = values(&u, 2, smooth);
    for estimator in ESTIMATORS {
        let config = Config { controls: 2, ..config(2, 1, estimator) };
        let run = |config: &Config, u: &[f32], controls: &[f32], control_integrals: &[f32]| {
            batch_of::<f64>(config, Samples { u, f: &f, controls, control_integrals }).map(|estimate| estimate.samples)
        };
        let integrals = [0.5; 2];
        assert_eq!(run(&config, &u, &h, &integrals), Ok(12));
        let longer = [&h[..], &[0.5]].concat();
        for h in [&[], &h[..23], &h[..12], &longer] {
            assert_eq!(run(&config, &u, h, &integrals), Err(Error::Length), "{}", h.len());
        }
        for integrals in [&[][..], &[0.5], &[0.5; 3]] {
            assert_eq!(run(&config, &u, &h, integrals), Err(Error::Length));
        }
        assert_eq!(run(&config, &[&u[..], &[0.5]].concat(), &h, &integrals), Err(Error::Length));
        let skip = Config { non_finite: NonFinite::Skip, ..config };
        for bad in [f32::NAN, f32::INFINITY] {
            assert_eq!(run(&config, &u, &h, &[0.5, bad]), Err(Error::NotFinite));
            assert_eq!(run(&skip, &u, &h, &[0.5, bad]), Err(Error::NotFinite));
            let mut h = h.clone();
            h[7] = bad;
            assert_eq!(run(&config, &u, &h, &integrals), Err(Error::NotFinite));
            assert_eq!(run(&skip, &u, &h, &integrals), Ok(11));
        }
    }
}

/// Coordinates: 0, -0 and 1 are in range, the next numbers outside are not.
#[test]
fn borders() {
    for estimator in ESTIMATORS {
        let config = config(1, 2, estimator);
        let at = |u: f32| batch::<f64>(&config, &[0.3, u, 0.8], &[1.0, 2.0, 4.0]);
        assert!(at(0.0).is_ok() && at(1.0).is_ok());
        assert_eq!(at(-0.0), at(0.0));
        assert_eq!(at(1.0_f32.next_up()), Err(Error::Range));
        assert_eq!(at(-f32::from_bits(1)), Err(Error::Range));
    }
}

/// What `f32` costs: over 200 pixels of n samples, the largest difference to `f64` relative to the largest value.
#[test]
fn narrow_precision() {
    for (n, tolerance) in [(8, 2e-3), (64, 2e-5), (1024, 2e-5)] {
        let mut rng = SplitMix64::new(10);
        let mut worst = [(0.0_f64, String::new()), (0.0, String::new())];
        for _ in 0..if n < 1000 { 200 } else { 20 } {
            let u = points(n, 2, &mut rng);
            let f = values(&u, 2, smooth);
            for estimator in ESTIMATORS {
                if estimator == Estimator::LeastSquares && n < 16 {
                    continue;
                }
                let config = config(2, 2, estimator);
                let difference = |a: Estimate, b: Estimate| f64::from(a.mean[0] - b.mean[0]).abs() / largest(&f);
                let wide = batch::<f64>(&config, &u, &f).unwrap();
                let mut keep = |k: usize, d: f64| {
                    if d > worst[k].0 {
                        worst[k] = (d, format!("{estimator:?}"))
                    }
                };
                keep(0, difference(wide, batch::<f32>(&config, &u, &f).unwrap()));
                if estimator != Estimator::LeaveOneOut {
                    let wide = streamed::<f64>(&config, &u, &f).unwrap();
                    keep(1, difference(wide, streamed::<f32>(&config, &u, &f).unwrap()));
                }
            }
        }
        println!("{n}: {worst:?}");
        assert!(worst[0].0 < tolerance && worst[1].0 < 10.0 * tolerance, "{n}: {worst:?}");
    }
}

/// The dual takes 4096 samples of what solves it, and any number of what does not.
#[test]
fn most_samples_of_the_dual() {
    let (n, mut rng) = (5000, SplitMix64::new(16));
    let u = points(n, 1, &mut rng);
    let f = values(&u, 1, smooth);
    for estimator in ESTIMATORS.into_iter().filter(|&estimator| estimator != Estimator::Incremental) {
        for stratified in [false, true] {
            let auto = Config { stratified, ..config(1, 2, estimator) };
            let dual = Config { solver: Solver::Dual, ..auto };
            let is_mean = stratified && estimator != Estimator::LeastSquares;
            if is_mean || estimator == Estimator::GradientDescent {
                assert_eq!(batch::<f64>(&dual, &u, &f), batch::<f64>(&auto, &u, &f), "{estimator:?}");
            } else {
                assert_eq!(control_variate::workspace_len::<f64>(&dual, n), Err(Error::Range), "{estimator:?}");
            }
        }
    }
}

/// The robust estimate goes by no ridge, of control functions neither.
#[test]
fn robust_takes_no_ridge() {
    // One sample alone moves the control function.
    let u: Vec<f32> = (0..16).map(|i| (i as f32 + 0.3) / 16.0).collect();
    let h: Vec<f32> = u.iter().map(|u| if *u < 0.06 { 1.0 } else { 0.0 }).collect();
    let f: Vec<f32> = u.iter().zip(&h).map(|(u, h)| 1.0 + u * u + 1000.0 * h).collect();
    let samples = Samples { u: &u, f: &f, controls: &h, control_integrals: &[0.06] };
    let config = Config { controls: 1, ..config(1, 1, Estimator::Robust) };
    for ridge in [Ridge::Auto, Ridge::Fixed(1e-9), Ridge::Fixed(1.0), Ridge::Fixed(1e3), Ridge::Fixed(1e8)] {
        let other = Config { ridge, ..config };
        assert_eq!(batch_of::<f64>(&other, samples), batch_of::<f64>(&config, samples), "{ridge:?}");
        let streamed = [config, other].map(|config| {
            let mut accumulator = accumulator::<f64>(&config);
            accumulator.add(samples).unwrap();
            finish(&accumulator).unwrap()
        });
        assert_eq!(streamed[0], streamed[1], "{ridge:?}");
    }
}

/// Steps far too long, of any rule, end at a finite estimate.
#[test]
fn divergent_descent() {
    let mut rng = SplitMix64::new(11);
    let u = points(20, 2, &mut rng);
    let f = values(&u, 2, smooth);
    for optimizer in [Optimizer::Momentum, Optimizer::Adam, Optimizer::Plain] {
        for learning_rate in [3.0, 1e3, 1e10, 1e20, 1e30, f32::MAX] {
            for iterations in [1, 2, 3, 5, 20, 300] {
                let base = config(2, 3, Estimator::GradientDescent);
                let config = Config { optimizer, learning_rate, iterations, momentum: 0.99, ..base };
                for scale in [1.0, 1e30] {
                    let f: Vec<f32> = f.iter().map(|f| f * scale).collect();
                    let all = [
                        batch::<f64>(&config, &u, &f),
                        batch::<f32>(&config, &u, &f),
                        streamed::<f64>(&config, &u, &f),
                        streamed::<f32>(&config, &u, &f),
                    ];
                    for estimate in all {
                        assert!(
                            is_sound(&estimate.unwrap()),
                            "{optimizer:?} {learning_rate} {iterations} {estimate:?}"
                        );
                    }
                }
            }
        }
    }
}

/// Control functions of any size, right or wrong integrals: finite estimates.
#[test]
fn extreme_control_functions() {
    let mut rng = SplitMix64::new(12);
    let u = points(12, 1, &mut rng);
    let f = values(&u, 1, smooth);
    for size in [0.0, 1e-42, 1e-30, 1e-10, 1e10, 1e20, 1e30, f32::MAX] {
        for integral in [0.0, 1.0, -size, f32::MAX, f32::MIN] {
            let h: Vec<f32> = (0..12).map(|_| size * (2.0 * rng.uniform_f32() - 1.0)).collect();
            let samples = Samples { u: &u, f: &f, controls: &h, control_integrals: &[integral] };
            for estimator in ESTIMATORS {
                let config = Config { controls: 1, ..config(1, 2, estimator) };
                let mut all = vec![batch_of::<f64>(&config, samples), batch_of::<f32>(&config, samples)];
                if estimator != Estimator::LeaveOneOut {
                    let mut wide = accumulator::<f64>(&config);
                    let mut narrow = accumulator::<f32>(&config);
                    wide.add(samples).unwrap();
                    narrow.add(samples).unwrap();
                    all.extend([finish(&wide), finish(&narrow)]);
                }
                for (index, estimate) in all.into_iter().enumerate() {
                    assert!(is_sound(&estimate.unwrap()), "{estimator:?} {index} {size} {integral} {estimate:?}");
                }
            }
        }
    }
}

/// The unit of a control function is its maker's: estimates and errors do not depend on it.
#[test]
fn units_of_control_functions_do_not_matter() {
    let mut rng = SplitMix64::new(29);
    let u = points(40, 2, &mut rng);
    let f: Vec<f32> = u.chunks(2).map(|u| 3.0 * u[0] * u[0] * u[0] + u[1] + 0.2 * (9.0 * u[0] * u[1]).sin()).collect();
    let estimates = |size: f32, config: &Config| {
        let h: Vec<f32> = u.chunks(2).map(|u| size * u[0] * u[0] * u[0]).collect();
        let samples = Samples { u: &u, f: &f, controls: &h, control_integrals: &[0.25 * size] };
        let mut all = vec![batch_of::<f64>(config, samples).unwrap()];
        if config.estimator != Estimator::LeaveOneOut {
            let mut accumulator = accumulator::<f64>(config);
            accumulator.add(samples).unwrap();
            all.push(finish(&accumulator).unwrap());
        }
        all
    };
    for estimator in ESTIMATORS {
        for optimizer in [Optimizer::Adam, Optimizer::Momentum, Optimizer::Plain] {
            let config = Config { controls: 1, optimizer, ..config(2, 1, estimator) };
            let expected = estimates(1.0, &config);
            for size in [1e-6, 1e-3, 1e3, 1e6] {
                for (estimate, expected) in estimates(size, &config).iter().zip(&expected) {
                    let what = format!("{estimator:?} {optimizer:?} {size}: {estimate:?} instead of {expected:?}");
                    assert!((estimate.mean[0] - expected.mean[0]).abs() < 1e-3 * expected.std_error[0], "{what}");
                    assert!((estimate.std_error[0] / expected.std_error[0] - 1.0).abs() < 1e-3, "{what}");
                }
            }
        }
    }
}

/// A control function that does not move says nothing, whatever its unit.
#[test]
fn control_functions_that_never_move_change_nothing() {
    let mut rng = SplitMix64::new(31);
    let u = points(16, 1, &mut rng);
    let f = values(&u, 1, smooth);
    let config = Config { controls: 1, ..config(1, 1, Estimator::GradientDescent) };
    let of = |size: f32| {
        let (h, integral) = (vec![0.0; 16], [0.01 * size]);
        batch_of::<f64>(&config, Samples { u: &u, f: &f, controls: &h, control_integrals: &integral }).unwrap()
    };
    let without = batch::<f64>(&Config { controls: 0, ..config }, &u, &f).unwrap();
    // But for the degree of freedom that it takes.
    assert_eq!((of(1.0), of(1.0).mean), (of(1e6), without.mean));
}
