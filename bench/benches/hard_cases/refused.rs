//! Inputs that are no numbers, out of range, damaged or at the end of the range: the answer of single calls.

use crate::table::{Tables, status};
use glam::Vec2;
use noisefloor::control_variate::{self as cv, Config, Estimate, Estimator, NonFinite, Optimizer, Samples};
use noisefloor::tile::{Builtin, Tile};
use noisefloor::{Error, mis, warp};
use noisefloor_tests::ESTIMATORS;
use noisefloor_tests::random::SplitMix64;

const GROUP: &str = "control variates";

fn estimate(config: &Config, u: &[f32], f: &[f32]) -> Result<Estimate, Error> {
    let mut workspace = vec![0.0_f64; cv::workspace_len::<f64>(config, f.len())?];
    cv::estimate(config, Samples::new(u, f), &mut workspace)
}

/// The one answer of every estimator, or all of them.
fn of_all(config: &Config, u: &[f32], f: &[f32]) -> String {
    let mut answers: Vec<String> =
        ESTIMATORS.iter().map(|&estimator| status(estimate(&Config { estimator, ..*config }, u, f))).collect();
    answers.dedup();
    answers.join("; ")
}

pub(crate) fn measure(tables: &mut Tables) {
    let mut rng = SplitMix64::new(9);
    let u: Vec<f32> = (0..24).map(|_| rng.uniform_f32()).collect();
    let f: Vec<f32> = (0..12).map(|_| rng.uniform_f32()).collect();
    let config = Config::new(2, 2, 1);
    let with = |values: &[f32], at: usize, bad: f32| {
        let mut values = values.to_vec();
        values[at] = bad;
        values
    };
    let mut answer = |case: &str, outcome: String| {
        tables.outcome(GROUP, case, outcome, None, None);
    };
    answer("a value is NaN", of_all(&config, &u, &with(&f, 5, f32::NAN)));
    answer("a value is infinite", of_all(&config, &u, &with(&f, 5, f32::INFINITY)));
    answer("a coordinate is NaN", of_all(&config, &with(&u, 7, f32::NAN), &f));
    answer("a coordinate is 1, another -0", of_all(&config, &with(&with(&u, 7, 1.0), 8, -0.0), &f));
    answer("a coordinate is the next number above 1", of_all(&config, &with(&u, 7, 1.0_f32.next_up()), &f));
    answer("a coordinate is -1e-45", of_all(&config, &with(&u, 7, -1e-45), &f));
    answer("no samples", of_all(&config, &[], &[]));
    answer("order 8", of_all(&Config::new(2, 8, 1), &u, &f));
    answer("17 dims", of_all(&Config::new(17, 1, 1), &u, &f));
    answer("15 dims, order 3: 816 terms", of_all(&Config::new(15, 3, 1), &u, &f));
    let result = cv::estimate(&config, Samples::new(&u, &f), &mut [0.0_f64; 3]);
    answer("a workspace of three numbers", status(result));
    let skip = Config { non_finite: NonFinite::Skip, ..config };
    answer("all values NaN, to be skipped", of_all(&skip, &u, &[f32::NAN; 12]));
    let wide: Vec<f64> = f.iter().map(|&f| f.into()).collect();
    exact(tables, "all values NaN but one, to be skipped", &skip, &u, &with(&[f32::NAN; 12], 4, 3.0), 3.0);
    for constant in [0.1, 16_777_217.0, 1e30, 3e-42, f32::MAX] {
        exact(tables, &format!("all values {constant:e}"), &config, &u, &[constant; 12], constant);
    }
    let mean = (wide.iter().sum::<f64>() / 12.0) as f32;
    exact(tables, "all coordinates 0", &config, &[0.0; 24], &f, mean);
    exact(tables, "all coordinates 1", &config, &[1.0; 24], &f, mean);
    descent(tables, &config, &u, &f);
    damaged(tables);
    edges(tables);
}

/// Of which the answer is known: the largest relative error of all estimators.
fn exact(tables: &mut Tables, case: &str, config: &Config, u: &[f32], f: &[f32], expected: f32) {
    let estimates: Vec<f64> = ESTIMATORS
        .iter()
        .map(|&estimator| estimate(&Config { estimator, ..*config }, u, f).map_or(f64::NAN, |e| e.mean[0].into()))
        .collect();
    let expected = f64::from(expected);
    let error = estimates.iter().map(|value| ((value - expected) / expected).abs()).fold(0.0, f64::max);
    let finite: Vec<f64> = f.iter().filter(|f| f.is_finite()).map(|&f| f.into()).collect();
    let naive = finite.iter().fold(0.0_f32, |sum, &f| sum + f as f32) / finite.len() as f32;
    let plain = ((f64::from(naive) - expected) / expected).abs();
    let finite = estimates.iter().all(|value| value.is_finite());
    let outcome = if finite { "accepted" } else { "NOT FINITE" };
    tables.outcome(GROUP, case, outcome, Some(error), Some(("mean in f32", plain)));
}

/// Steps far too long, of any rule.
fn descent(tables: &mut Tables, config: &Config, u: &[f32], f: &[f32]) {
    let mut rows = Vec::new();
    for optimizer in [Optimizer::Momentum, Optimizer::Adam, Optimizer::Plain] {
        for learning_rate in [3.0, 1e10, f32::MAX] {
            let config = Config { estimator: Estimator::GradientDescent, optimizer, learning_rate, ..*config };
            rows.push(estimate(&config, u, f).is_ok_and(|estimate| estimate.mean[0].is_finite()));
        }
    }
    let finite = rows.iter().filter(|&&finite| finite).count();
    let case = "gradient descent, steps of 3, 1e10 and 3.4e38, three rules";
    tables.outcome(GROUP, case, format!("finite in {finite} of {}", rows.len()), None, None);
}

/// A tile's bytes, cut or changed.
fn damaged(tables: &mut Tables) {
    const PLACES: usize = 1000;
    let Some(bytes) = Builtin::Size64Spp1Dims2.bytes() else { return };
    let read = |bytes: &[u8]| Tile::from_bytes(bytes).map(|_| ());
    tables.refused("tile", "no bytes", read(&[]));
    tables.refused("tile", "a PNG's first bytes", read(b"\x89PNG\r\n\x1a\n"));
    tables.refused("tile", "the last byte is missing", read(&bytes[..bytes.len() - 1]));
    // Places all over the file, another bit at each.
    let refused = (0..PLACES)
        .filter(|place| {
            let mut bytes = bytes.to_vec();
            let at = place * (bytes.len() / PLACES);
            bytes[at] ^= 1 << (place % 8);
            read(&bytes).is_err()
        })
        .count();
    tables.outcome("tile", "one bit is another", format!("refused in {refused} of {PLACES}"), None, None);
}

/// Warps of what is no coordinate; weights of a point that no technique can draw.
fn edges(tables: &mut Tables) {
    let length = |u: Vec2| f64::from(warp::cosine_hemisphere(u).length());
    for (case, u) in [
        ("cosine hemisphere at (NaN, NaN)", Vec2::NAN),
        ("cosine hemisphere at (inf, -inf)", Vec2::new(f32::INFINITY, f32::NEG_INFINITY)),
        ("cosine hemisphere at (1, 1)", Vec2::ONE),
    ] {
        let outcome = if length(u).is_finite() { "a unit vector" } else { "NOT FINITE" };
        tables.outcome("warp", case, outcome, Some((length(u) - 1.0).abs()), None);
    }
    tables.refused("MIS weights", "a density is NaN", mis::balance(&[1.0, f32::NAN], &[1, 1], 0));
    tables.refused("MIS weights", "a density is negative", mis::balance(&[1.0, -1.0], &[1, 1], 0));
    let weight = mis::balance(&[0.0, 0.0], &[1, 1], 0);
    let outcome = weight.map_or_else(|error| status::<f32>(Err(error)), |weight| format!("weight {weight}"));
    tables.outcome("MIS weights", "all densities 0", outcome, None, None);
}
