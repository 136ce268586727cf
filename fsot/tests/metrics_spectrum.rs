//! Power spectra against sums by definition.

use crate::metrics_common::{assert_mean, assert_near, grid, random};
use fsot::metrics::exponential_sums::power;
use fsot::metrics::spectrum::{Spectrum, principal_frequency};
use fsot::points::Points;

/// The squared magnitude of the exponential sum, term by term.
fn slow(points: &Points, kx: f64, ky: f64) -> f64 {
    let phase = |p: &[f32]| std::f64::consts::TAU * (kx * f64::from(p[0]) + ky * f64::from(p[1]));
    let (re, im) = points.iter().map(phase).fold((0.0, 0.0), |(re, im), a| (re + libm::cos(a), im + libm::sin(a)));
    re * re + im * im
}

fn plane(points: &Points) -> Vec<[f64; 2]> {
    points.iter().map(|p| [f64::from(p[0]), f64::from(p[1])]).collect()
}

#[test]
fn exponential_sums_are_those_of_the_definition() {
    let borders = Points::new(2, vec![0.0, 0.0, 1.0, 0.5, 0.999_999_94, 1e-30, 0.25, 0.0, 0.0, 1.0]);
    for (points, extent) in [(random(1, 2, 1), 3), (random(40, 2, 2), 0), (random(300, 2, 3), 37), (borders, 20)] {
        let fast = power(&plane(&points), extent);
        let side = 2 * extent + 1;
        assert_eq!(fast.len(), side * side);
        for (i, value) in fast.iter().enumerate() {
            let (kx, ky) = ((i % side) as f64 - extent as f64, (i / side) as f64 - extent as f64);
            // A sum's error of 1e-10 n is one of 2e-10 n^2 of its square at most.
            let n = points.len() as f64;
            assert_near(*value, slow(&points, kx, ky), 2e-10 * n * n, &format!("({kx}, {ky}), {n} points"));
        }
    }
}

#[test]
fn sums_of_low_power_are_not_lost_beside_large_ones() {
    let points = grid(32);
    let n = points.len() as f64;
    for (i, value) in power(&plane(&points), 40).iter().enumerate() {
        let (kx, ky) = ((i % 81) as i64 - 40, (i / 81) as i64 - 40);
        let expected = if kx % 32 == 0 && ky % 32 == 0 { n * n } else { 0.0 };
        assert_near(value.sqrt(), expected.sqrt(), 1e-10 * n, &format!("({kx}, {ky})"));
    }
}

#[test]
fn figures_of_a_grid_of_a_point_and_of_equal_points() {
    let summary = Spectrum::of_points(&grid(32), [0, 1]).unwrap().summary();
    assert_near(summary.low, 0.0, 1e-12, "P_low of a grid");
    assert!(summary.peak > 10.0 && summary.anisotropy > 10.0, "{summary:?}");
    // n equal points have n times the power of one at every frequency.
    let equal = Points::new(2, [0.3, 0.7].repeat(100));
    let spectrum = Spectrum::of_points(&equal, [0, 1]).unwrap();
    spectrum.power.iter().for_each(|p| assert_near(*p, 100.0, 1e-7, "equal points"));
    assert_near(spectrum.summary().low, 100.0, 1e-7, "P_low of equal points");
    assert!(spectrum.summary().anisotropy.is_nan(), "{:?}", spectrum.summary());
    let one = Spectrum::of_points(&random(1, 2, 1), [0, 1]).unwrap();
    one.power.iter().for_each(|p| assert_near(*p, 1.0, 1e-9, "one point"));
    assert!(one.summary().anisotropy.is_nan(), "{:?}", one.summary());
    assert!(one.summary().low.is_nan(), "there is no frequency below half the principal one");
}

#[test]
fn random_points_are_white_and_isotropic() {
    let summaries: Vec<_> =
        (0..40).map(|seed| Spectrum::of_points(&random(500, 2, seed), [0, 1]).unwrap().summary()).collect();
    assert_mean(&summaries.iter().map(|s| s.low).collect::<Vec<_>>(), 1.0, "P_low");
    let mean = summaries.iter().map(|s| s.anisotropy).sum::<f64>() / 40.0;
    // The logarithm's curvature and the finite rings lower the mean by some tenths of a dB.
    assert!((-0.5..0.1).contains(&mean), "anisotropy {mean}");
}

#[test]
fn an_average_is_that_of_the_power() {
    let both: Vec<Spectrum> = (0..2).map(|s| Spectrum::of_points(&random(64, 2, s), [0, 1]).unwrap()).collect();
    let average = Spectrum::average(&both).unwrap();
    assert_eq!(average.realisations, 2);
    for ((a, b), mean) in both[0].power.iter().zip(&both[1].power).zip(&average.power) {
        assert_near(*mean, (a + b) / 2.0, 1e-12 * (a + b), "average");
    }
    assert!(Spectrum::average(&[]).is_err());
    let other = Spectrum::of_points(&random(65, 2, 1), [0, 1]).unwrap();
    assert!(Spectrum::average(&[both[0].clone(), other]).is_err());
}

#[test]
fn rings_and_low_frequencies_are_those_of_the_definition() {
    let points = random(200, 2, 9);
    let spectrum = Spectrum::of_points(&points, [0, 1]).unwrap();
    let unit = principal_frequency(200);
    let extent = (2.0 * unit).ceil() as i64;
    let all: Vec<(f64, f64)> = (-extent..=extent)
        .flat_map(|ky| (-extent..=extent).map(move |kx| (kx as f64, ky as f64)))
        .map(|(kx, ky)| (kx.hypot(ky), slow(&points, kx, ky) / 200.0))
        .collect();
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let low: Vec<f64> = all.iter().filter(|p| p.0 > 0.0 && p.0 < unit / 2.0).map(|p| p.1).collect();
    assert_near(spectrum.summary().low, mean(&low), 1e-9, "P_low");
    assert_eq!(spectrum.rings.len(), (2.0 * unit) as usize - 1);
    for (i, ring) in spectrum.rings.iter().enumerate() {
        let values: Vec<f64> = all.iter().filter(|p| p.0.round() as usize == i + 1).map(|p| p.1).collect();
        let power = mean(&values);
        let variance = values.iter().map(|v| (v - power) * (v - power)).sum::<f64>() / (values.len() as f64 - 1.0);
        assert_near(ring.power, power, 1e-9, "ring");
        assert_near(ring.anisotropy, 10.0 * (variance / power / power).log10(), 1e-7, "anisotropy");
        assert_near(ring.frequency, (i + 1) as f64 / unit, 1e-12, "frequency");
    }
}

#[test]
fn axes_choose_the_coordinates() {
    let points = random(50, 3, 4);
    let swapped = Points::new(2, points.iter().flat_map(|p| [p[2], p[0]]).collect());
    let a = Spectrum::of_points(&points, [2, 0]).unwrap();
    assert_eq!(a.power, Spectrum::of_points(&swapped, [0, 1]).unwrap().power);
    assert!(Spectrum::of_points(&points, [0, 3]).is_err());
}
