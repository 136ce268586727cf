//! Errors of control variates over many repetitions, beside the plain mean's of the same samples.

use crate::draws::{Case, cases};
use crate::table::ErrorRow;
use noisefloor::Error;
use noisefloor::control_variate::{self as cv, Config, Estimator, Samples};
use noisefloor::real::Real;
use noisefloor_tests::random::{SplitMix64, mix};
use noisefloor_tests::shared::block;
use noisefloor_tests::statistics::{Ratio, rmse_ratio, root_mean_square};

/// As the columns are called.
pub(crate) const DEFAULT: &str = "default";
const NARROW: &str = "default, f32";
const LEAST_SQUARES: &str = "least squares";
const K_FOLD: &str = "4-fold";

pub(crate) fn measure(rows: &mut Vec<ErrorRow>, repetitions: usize) {
    for (index, case) in cases().iter().enumerate() {
        for &n in &case.counts {
            rows.push(row(case, n, repetitions, index as u64));
        }
    }
}

fn row(case: &Case, n: usize, repetitions: usize, seed: u64) -> ErrorRow {
    let config = Config::new(case.dims, case.order, 1);
    let terms = config.terms().expect("a valid configuration");
    // About as long for every case.
    let repetitions = (repetitions * 160 / (n * terms).max(160)).max(repetitions.min(32));
    let mut default = Batch::<f64>::new(config, n);
    let mut narrow = Batch::<f32>::new(config, n);
    let mut least_squares = Batch::<f64>::new(Config { estimator: Estimator::LeastSquares, ..config }, n);
    let mut k_fold = Batch::<f64>::new(Config { estimator: Estimator::KFold, ..config }, n);
    let mut rng = SplitMix64::new(mix(seed << 16 | n as u64));
    let (mut u, mut f) = (vec![0.0; n * case.dims], vec![0.0; n]);
    let (mut plain, mut errors, mut failed) = (vec![], [const { vec![] }; 4], 0);
    for _ in 0..repetitions {
        (case.draw)(&mut rng, &mut u, &mut f);
        // An `f32`, as estimates are.
        let mean = (f.iter().map(|&f| f64::from(f)).sum::<f64>() / n as f64) as f32;
        plain.push(f64::from(mean) - case.integral);
        let estimates = [
            default.estimate(&u, &f),
            narrow.estimate(&u, &f),
            least_squares.estimate(&u, &f),
            k_fold.estimate(&u, &f),
        ];
        for (estimate, errors) in estimates.into_iter().zip(&mut errors) {
            match estimate {
                Ok(value) if value.is_finite() => errors.push(f64::from(value) - case.integral),
                _ => failed += 1,
            }
        }
    }
    let names = [DEFAULT, NARROW, LEAST_SQUARES, K_FOLD];
    ErrorRow {
        group: case.group,
        case: case.name.clone(),
        n,
        terms,
        repetitions,
        failed,
        plain_rmse: root_mean_square(&plain),
        ratios: names.into_iter().zip(errors.iter().map(|errors| ratio(errors, &plain))).collect(),
    }
}

/// None if some estimates failed; infinite if the plain mean alone is exact.
pub(crate) fn ratio(errors: &[f64], plain: &[f64]) -> Option<Ratio> {
    // Squares of the largest values would leave the range of `f64` in no case, those of the smallest ones do no harm.
    let usable = errors.len() == plain.len() && errors.iter().chain(plain).all(|error| error.is_finite());
    usable.then(|| rmse_ratio(errors, plain))
}

/// A configuration with its workspace.
struct Batch<R> {
    config: Config,
    workspace: Vec<R>,
}

impl<R: Real> Batch<R> {
    fn new(config: Config, n: usize) -> Self {
        Self { config, workspace: vec![R::ZERO; cv::workspace_len::<R>(&config, n).expect("a valid configuration")] }
    }

    fn estimate(&mut self, u: &[f32], f: &[f32]) -> Result<f32, Error> {
        cv::estimate(&self.config, Samples::new(u, f), &mut self.workspace).map(|estimate| estimate.mean[0])
    }
}

/// Fits that the 64 pixels of a block share, where there is nothing to share.
pub(crate) fn shared(rows: &mut Vec<ErrorRow>, repetitions: usize) {
    const PIXELS: usize = 64;
    const BRIGHT: usize = 27;
    type Value = fn(usize, &[f32], &mut SplitMix64) -> [f64; 2];
    let bright: Value = |pixel, u, _| {
        let light = if pixel == BRIGHT { 1000.0 } else { 1.0 };
        [light * f64::from(u[0]), light * 0.5]
    };
    // A value, and what it is on average; and whether the bright pixel's own error counts.
    let cases: [(&str, Value, bool); 4] = [
        ("noise", |_, _, rng| [rng.normal(), 0.0], true),
        (
            "every other pixel is dark",
            |pixel, u, _| {
                let light = f64::from(u8::from(pixel % 2 == 0));
                [light * f64::from(u[0]), light * 0.5]
            },
            true,
        ),
        ("one of 64 pixels is a thousand times as bright", bright, true),
        ("the same, its 63 neighbours alone", bright, false),
    ];
    let config = Config::new(2, 3, 1);
    for (name, value, counts_bright) in cases {
        for n in [1, 4] {
            let mut rng = SplitMix64::new(mix(n as u64));
            let (mut plain, mut errors) = (vec![], vec![]);
            let repetitions = (repetitions / 40).max(2);
            for _ in 0..repetitions {
                let u: Vec<f32> = (0..2 * n * PIXELS).map(|_| rng.uniform_f32()).collect();
                let drawn: Vec<[f64; 2]> = u.chunks(2).enumerate().map(|(i, u)| value(i / n, u, &mut rng)).collect();
                let f: Vec<f32> = drawn.iter().map(|[value, _]| *value as f32).collect();
                let estimates = block(&config, PIXELS, Samples::new(&u, &f)).expect("valid samples");
                // Pixels that share a fit err together: one value for each block.
                let (mut own, mut shared) = (vec![], vec![]);
                let pixels = estimates.iter().zip(f.chunks(n)).zip(drawn.chunks(n)).enumerate();
                for (_, ((estimate, f), drawn)) in pixels.filter(|(pixel, _)| counts_bright || *pixel != BRIGHT) {
                    let [_, expected] = drawn[0];
                    own.push(f.iter().map(|&f| f64::from(f)).sum::<f64>() / n as f64 - expected);
                    shared.push(f64::from(estimate.mean[0]) - expected);
                }
                plain.push(root_mean_square(&own));
                errors.push(root_mean_square(&shared));
            }
            rows.push(ErrorRow {
                group: "shared fits",
                case: name.to_owned(),
                n,
                terms: config.terms().expect("a valid configuration"),
                repetitions,
                failed: errors.iter().filter(|error| !error.is_finite()).count(),
                plain_rmse: root_mean_square(&plain),
                ratios: vec![(DEFAULT, ratio(&errors, &plain))],
            });
        }
    }
}
