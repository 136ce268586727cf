//! Regression on MIS-weighted samples (section 4.3.3): each technique's weighted samples are an integrand of their own
//! over primary sample space, fitted on its own, and the estimates are added.

use noisefloor::control_variate::{Config, Estimator, Samples, estimate, workspace_len};
use noisefloor::mis;
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::statistics::{Moments, rmse_ratio};

const COUNTS: [u32; 2] = [32, 32];
/// The combination of the two densities that is nearest to the integrand.
const ALPHA: [f32; 2] = [0.1, 0.45];
const EXACT: f64 = 0.55;
const RUNS: usize = 4000;
/// |z| that chance exceeds in one of 500,000 tests; there are two.
const LIMIT: f64 = 4.75;

fn integrand(x: f32) -> f32 {
    1.2 * x * x + 0.3 * (1.0 - x)
}

/// Uniform, and proportional to x: the point for u, and both densities there.
fn sample(technique: usize, u: f32) -> (f32, [f32; 2]) {
    let x = if technique == 0 { u } else { u.sqrt() };
    (x, [1.0, 2.0 * x])
}

/// w_j f / p_j with the balance heuristic (2.12), or with the optimal weights (2.15).
fn value(technique: usize, u: f32, optimal: bool) -> f32 {
    let (x, pdf) = sample(technique, u);
    if optimal {
        let term = mis::optimal_contribution(&pdf, &COUNTS, technique, &ALPHA, integrand(x)).unwrap();
        return COUNTS[technique] as f32 * term;
    }
    if pdf[technique] == 0.0 {
        return 0.0;
    }
    mis::balance(&pdf, &COUNTS, technique).unwrap() * integrand(x) / pdf[technique]
}

/// Errors of the plain and of the regressed estimates, run by run.
fn errors(optimal: bool) -> (Vec<f64>, Vec<f64>) {
    let config = Config { estimator: Estimator::LeaveOneOut, ..Config::new(1, 2, 1) };
    let mut rng = SplitMix64::new(11);
    let n = COUNTS[0] as usize;
    let mut workspace = vec![0.0_f64; workspace_len::<f64>(&config, n).unwrap()];
    let mut run = || {
        let (mut plain, mut regressed) = (-EXACT, -EXACT);
        for technique in 0..2 {
            let u: Vec<f32> = (0..n).map(|_| rng.uniform_f32()).collect();
            let f: Vec<f32> = u.iter().map(|&u| value(technique, u, optimal)).collect();
            plain += f.iter().map(|&f| f64::from(f)).sum::<f64>() / n as f64;
            regressed += f64::from(estimate(&config, Samples::new(&u, &f), &mut workspace).unwrap().mean[0]);
        }
        (plain, regressed)
    };
    (0..RUNS).map(|_| run()).unzip()
}

/// Unbiased with both weights, and at most half of the weighted mean's error.
#[test]
fn regression_on_weighted_samples() {
    for optimal in [false, true] {
        let (plain, regressed) = errors(optimal);
        let mut moments = Moments::default();
        regressed.iter().for_each(|&error| moments.add(error));
        assert!(moments.z(0.0).abs() < LIMIT, "optimal {optimal}: z = {}", moments.z(0.0));
        let ratio = rmse_ratio(&regressed, &plain);
        assert!(ratio.upper() < 0.5, "optimal {optimal}: {}", ratio.upper());
    }
}

/// Optimal weights with regression beat either set of weights without. (Whether they beat the balance heuristic with
/// regression depends on the integrand: here, where its weighted samples are the smoother ones, they do not.)
#[test]
fn optimal_weights_with_regression() {
    let (_, regressed) = errors(true);
    for optimal in [false, true] {
        let ratio = rmse_ratio(&regressed, &errors(optimal).0);
        assert!(ratio.upper() < 1.0, "optimal {optimal}: {}", ratio.upper());
    }
}
