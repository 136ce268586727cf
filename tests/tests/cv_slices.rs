//! Discrete light choices: a fit that knows which coordinate picks a light beats one that takes it for a number
//! (section 4.3.5).
//!
//! Many lights as in figure 4.15: random intensities, each falling off with the distance to its own nearest point,
//! every fourth half hidden. The first two coordinates are a point on the light, the third picks one of the lights.

use crate::cv_support::*;
use noisefloor::Error;
use noisefloor::control_variate::{Config, Estimator, Samples, estimate, workspace_len};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::statistics::{Ratio, rmse_ratio};

/// One light: intensity, sharpness of its falloff, nearest point, whether an edge hides half of it.
struct Light {
    intensity: f64,
    sharpness: f64,
    nearest: [f64; 2],
    is_hidden: bool,
}

fn lights(count: usize) -> Vec<Light> {
    let mut rng = SplitMix64::new(77);
    let light = |index: usize, rng: &mut SplitMix64| Light {
        intensity: 0.2 + 3.0 * rng.uniform().powi(2),
        sharpness: 0.5 + 2.0 * rng.uniform(),
        nearest: [rng.uniform(), rng.uniform()],
        is_hidden: index % 4 == 3,
    };
    (0..count).map(|index| light(index, &mut rng)).collect()
}

fn radiance(lights: &[Light], u: &[f64]) -> f64 {
    let light = &lights[((u[2] * lights.len() as f64) as usize).min(lights.len() - 1)];
    if light.is_hidden && u[0] + u[1] < 1.0 {
        return 0.0;
    }
    let square = (u[0] - light.nearest[0]).powi(2) + (u[1] - light.nearest[1]).powi(2);
    light.intensity / (1.0 + light.sharpness * square).powi(2)
}

/// The integral by the midpoint rule, 400 x 400 points of each light: the edge costs most, 1e-3 of a hidden light.
fn integral(lights: &[Light]) -> f64 {
    let centre = |i: usize| (i as f64 + 0.5) / 400.0;
    let of_light = |k: usize| {
        let choice = (k as f64 + 0.5) / lights.len() as f64;
        let row = |i: usize| (0..400).map(|j| radiance(lights, &[centre(i), centre(j), choice])).sum::<f64>();
        (0..400).map(row).sum::<f64>() / 160_000.0
    };
    (0..lights.len()).map(of_light).sum::<f64>() / lights.len() as f64
}

/// RMSE ratios to the mean of estimates that know of slices and of those that do not.
fn ratios(count: usize, n: usize, repetitions: usize) -> [Ratio; 2] {
    let lights = lights(count);
    let integral = integral(&lights);
    let plain_basis = config(3, 2, Estimator::Robust);
    let configs = [Config { slices: count, ..plain_basis }, plain_basis];
    let mut workspaces = configs.map(|config| vec![0.0; workspace_len::<f64>(&config, n).unwrap()]);
    let mut rng = SplitMix64::new(9000 + count as u64);
    let (mut plain, mut errors) = (vec![], [vec![], vec![]]);
    for _ in 0..repetitions {
        let u = points(n, 3, &mut rng);
        let f = values(&u, 3, |u| radiance(&lights, u));
        plain.push(wide(&f).iter().sum::<f64>() / n as f64 - integral);
        for ((config, workspace), errors) in configs.iter().zip(&mut workspaces).zip(&mut errors) {
            let estimate = estimate(config, Samples::new(&u, &f), workspace).unwrap();
            errors.push(f64::from(estimate.mean[0]) - integral);
        }
    }
    errors.map(|errors| rmse_ratio(&errors, &plain))
}

/// At 1024 samples, upper ends of the 95 % intervals: .45, .55 and .95 of the mean's error with 4, 16 and 64 lights,
/// and below the lower end for the plain basis.
#[test]
fn slices_beat_the_plain_basis() {
    for (count, limit) in [(4, 0.45), (16, 0.55), (64, 0.95)] {
        let [sliced, plain] = ratios(count, 1024, 250);
        println!("{count} lights, 1024: sliced {sliced:?}, plain basis {plain:?}");
        assert!(sliced.upper() < limit, "{count}: {sliced:?}");
        assert!(sliced.upper() < plain.value - plain.half_width, "{count}: {sliced:?} {plain:?}");
    }
}

/// At 64 samples: no worse than the mean by more than .03, better than the plain basis with 4 and 16 lights.
#[test]
fn slices_with_few_samples() {
    for count in [4, 16, 64] {
        let [sliced, plain] = ratios(count, 64, 3000);
        println!("{count} lights, 64: sliced {sliced:?}, plain basis {plain:?}");
        assert!(sliced.upper() < 1.03, "{count}: {sliced:?}");
        if count < 64 {
            assert!(sliced.upper() < plain.value - plain.half_width, "{count}: {sliced:?} {plain:?}");
        }
    }
}

/// A light's own constant and slope are in the basis: what is linear on each light is integrated exactly.
#[test]
fn linear_lights_are_exact() {
    let mut rng = SplitMix64::new(78);
    let u = points(100, 3, &mut rng);
    let f = values(&u, 3, |u| {
        let k = (u[2] * 5.0).floor();
        1.0 + k * k + (k - 2.0) * u[0] - 3.0 * u[1]
    });
    let expected = 1.0 + 6.0 - 1.5;
    for estimator in [Estimator::Robust, Estimator::LeastSquares, Estimator::LeaveOneOut] {
        let config =
            Config { slices: 5, ridge: noisefloor::control_variate::Ridge::Fixed(1e-9), ..config(3, 1, estimator) };
        let estimate = batch::<f64>(&config, &u, &f).unwrap();
        let tolerance = if estimator == Estimator::Robust { 2e-2 } else { 1e-5 };
        assert!((f64::from(estimate.mean[0]) - expected).abs() < tolerance, "{estimator:?}: {}", estimate.mean[0]);
    }
}

/// One slice is none, and the last coordinate then counts as a number.
#[test]
fn one_slice_is_none() {
    let mut rng = SplitMix64::new(79);
    let u = points(30, 2, &mut rng);
    let f = values(&u, 2, smooth);
    let none = config(2, 2, Estimator::Robust);
    let one = Config { slices: 1, ..none };
    assert_eq!(batch::<f64>(&none, &u, &f), batch::<f64>(&one, &u, &f));
}

/// The most slices there can be, and the most that have their own functions of each degree: as docs/control_variates.md
/// has them.
#[test]
fn most_slices() {
    let terms = |dims, order, slices| Config { slices, ..Config::new(dims, order, 1) }.terms();
    // dims, order; the most; up to degree 1, 2, ...
    let expected: [(usize, usize, usize, &[usize]); 12] = [
        (1, 2, 135, &[]),
        (2, 1, 134, &[]),
        (2, 2, 133, &[66, 44]),
        (2, 7, 128, &[]),
        (3, 1, 133, &[44]),
        (3, 2, 130, &[43, 21]),
        (3, 3, 126, &[42, 21, 12]),
        (3, 7, 100, &[]),
        (4, 2, 126, &[31, 12]),
        (5, 2, 121, &[24, 8]),
        (7, 3, 52, &[7, 1]),
        (15, 2, 16, &[]),
    ];
    for (dims, order, most, with_own) in expected {
        let others = if dims == 1 { 1 } else { Config::new(dims - 1, order, 1).terms().unwrap() };
        assert_eq!(most, 136 - others);
        assert_eq!(terms(dims, order, most), Ok(136), "{dims} dims, order {order}");
        for more in [most + 1, 256] {
            assert_eq!(terms(dims, order, more), Err(Error::Range), "{dims} dims, order {order}");
        }
        for (degree, &slices) in (1..).zip(with_own) {
            let own = Config::new(dims - 1, degree, 1).terms().unwrap();
            assert_eq!(slices, (136 - others) / own, "{dims} dims, order {order}");
            // One slice is none.
            if slices > 1 {
                assert_eq!(terms(dims, order, slices), Ok(others + slices * own), "{dims} dims, order {order}");
            }
            assert!(terms(dims, order, slices + 1).unwrap() < others + (slices + 1) * own);
        }
    }
    // Control functions take a term each.
    let controlled = |slices, controls| Config { slices, controls, ..Config::new(3, 2, 1) }.terms();
    assert_eq!((controlled(129, 1), controlled(130, 1)), (Ok(136), Err(Error::Range)));
    // 43 slices have functions of their own beside one of them: more take these functions' room.
    assert_eq!([0, 1, 2, 4].map(|controls| controlled(43, controls)), [135, 136, 51, 53].map(Ok));
    for (controls, slices) in (0..=4).flat_map(|controls| (0..=130 - controls).map(move |slices| (controls, slices))) {
        assert!(controlled(slices, controls).is_ok(), "{slices} slices, {controls} control functions");
    }
    // Of order 0 nothing is regressed.
    assert_eq!(terms(3, 0, 135), Ok(1));
}
