//! So many samples that sums lose digits: streams, in both precisions.

use crate::errors::{DEFAULT, ratio};
use crate::table::ErrorRow;
use noisefloor::control_variate::{Config, Estimator};
use noisefloor_bench::method::Stream;
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::statistics::root_mean_square;

/// Added at once.
const PART: usize = 1000;

pub(crate) fn measure(rows: &mut Vec<ErrorRow>, samples: usize, repetitions: usize) {
    let exact = (1.0 - (-1.0_f64).exp()).powi(2);
    for offset in [0.0, 1e4] {
        let (mut plain, mut naive, mut errors) = (vec![], vec![], [const { vec![] }; 4]);
        let config = Config::new(2, 2, 1);
        let least_squares = Config { estimator: Estimator::LeastSquares, ..config };
        for seed in 0..repetitions {
            let mut rng = SplitMix64::new(seed as u64);
            let mut wide = [config, least_squares].map(|config| Stream::<f64>::new(&config));
            let mut narrow = [config, least_squares].map(|config| Stream::<f32>::new(&config));
            let (mut sum, mut narrow_sum) = (0.0_f64, 0.0_f32);
            for _ in 0..samples / PART {
                let u: Vec<f32> = (0..2 * PART).map(|_| rng.uniform_f32()).collect();
                let f: Vec<f32> = u.chunks(2).map(|u| (offset + f64::from(-u[0] - u[1]).exp()) as f32).collect();
                sum += f.iter().map(|&f| f64::from(f)).sum::<f64>();
                f.iter().for_each(|f| narrow_sum += f);
                wide.iter_mut().for_each(|stream| stream.add(&u, &f));
                narrow.iter_mut().for_each(|stream| stream.add(&u, &f));
            }
            let expected = offset + exact;
            // An `f32`, as estimates are.
            plain.push(f64::from((sum / samples as f64) as f32) - expected);
            naive.push(f64::from(narrow_sum) / samples as f64 - expected);
            let [a, b] = wide.each_mut().map(Stream::estimate);
            let [c, d] = narrow.each_mut().map(Stream::estimate);
            for (errors, estimate) in errors.iter_mut().zip([a, c, b, d]) {
                errors.push(f64::from(estimate) - expected);
            }
        }
        let names = [DEFAULT, "default, f32", "least squares", "least squares, f32"];
        let mut ratios: Vec<_> = names.into_iter().zip(errors.iter().map(|errors| ratio(errors, &plain))).collect();
        ratios.push(("mean, f32", ratio(&naive, &plain)));
        rows.push(ErrorRow {
            group: "streams",
            case: if offset == 0.0 { "exp 2D".to_owned() } else { format!("exp 2D plus {offset:e}") },
            n: samples,
            terms: config.terms().expect("a valid configuration"),
            repetitions,
            failed: errors.iter().flatten().filter(|error| !error.is_finite()).count(),
            plain_rmse: root_mean_square(&plain),
            ratios,
        });
    }
}
