//! Test integrands and integration errors against quadrature and plain sums.

use crate::metrics_common::{assert_mean, assert_near, random};
use fsot::metrics::integrands::{Family, Integrand};
use fsot::metrics::integration::integration;
use fsot::metrics::{log_spaced, prefix_errors, tile};
use fsot::points::Points;

const FAMILIES: [Family; 2] = [Family::HalfSpace, Family::Gaussian];

#[test]
fn integrals_and_variances_are_those_of_quadrature() {
    for (dims, cells) in [(1, 30_000_usize), (2, 500), (3, 70), (4, 24)] {
        for family in FAMILIES {
            for index in 0..6 {
                let integrand = Integrand::random(family, dims, 1e-3, 11, index);
                let count = cells.pow(dims as u32);
                let place = |cell: usize, axis: u32| ((cell / cells.pow(axis) % cells) as f32 + 0.5) / cells as f32;
                let (mut sum, mut squares) = (0.0, 0.0);
                for cell in 0..count {
                    let point: Vec<f32> = (0..dims as u32).map(|axis| place(cell, axis)).collect();
                    let value = integrand.value(&point);
                    sum += value;
                    squares += value * value;
                }
                let mean = sum / count as f64;
                // The midpoint rule: second order for bumps; a plane crosses at most `dims` sheets of cells, wrong by
                // half a cell each.
                let tolerance = match family {
                    Family::Gaussian => 60.0 * dims as f64 / (cells * cells) as f64 + 1e-6,
                    Family::HalfSpace => dims as f64 / cells as f64,
                };
                let what = format!("{family:?} {index} in {dims} dimensions");
                assert_near(integrand.integral, mean, tolerance, &what);
                assert_near(integrand.variance, squares / count as f64 - mean * mean, 3.0 * tolerance, &what);
            }
        }
    }
}

#[test]
fn integrals_in_many_dimensions_are_those_of_random_sampling() {
    for dims in [5, 8] {
        let points = random(100_000, dims, 3);
        for family in FAMILIES {
            for index in 0..4 {
                let integrand = Integrand::random(family, dims, 1e-3, 12, index);
                let values: Vec<f64> = points.iter().map(|p| integrand.value(p)).collect();
                assert_mean(&values, integrand.integral, &format!("{family:?} {index} in {dims} dimensions"));
                let squares: Vec<f64> = values.iter().map(|v| (v - integrand.integral).powi(2)).collect();
                assert_mean(
                    &squares,
                    integrand.variance,
                    &format!("variance of {family:?} {index}, {dims} dimensions"),
                );
            }
        }
    }
}

#[test]
fn random_points_have_the_error_of_random_points() {
    for dims in [1, 2, 3, 8] {
        let errors: Vec<_> = (0..30).map(|seed| integration(&random(64, dims, seed))).collect();
        assert_mean(&errors.iter().map(|e| e.half_spaces).collect::<Vec<_>>(), 1.0, "half-spaces");
        assert_mean(&errors.iter().map(|e| e.gaussians).collect::<Vec<_>>(), 1.0, "Gaussians");
    }
}

#[test]
fn even_points_have_less() {
    let line = Points::new(1, (0..64).map(|i| (i as f32 + 0.5) / 64.0).collect());
    let errors = integration(&line);
    // A step's error is uniform within half an interval: 1 / (12 n^2) over variance / n = 1 / (6 n).
    assert_near(errors.half_spaces, 1.0 / (12.0 * 64.0) * 6.0, 0.05 / 64.0, "steps");
    assert!(errors.gaussians < 1e-5, "{errors:?}");
}

#[test]
fn errors_of_prefixes_are_those_of_shorter_sets() {
    let sets = [random(100, 2, 1), random(100, 2, 2)];
    let errors = prefix_errors(&sets, &[1, 37, 100], 300).unwrap();
    for error in &errors {
        let cut: Vec<Points> =
            sets.iter().map(|s| Points::new(2, s.coordinates()[..2 * error.points].to_vec())).collect();
        let one = |points: &Points| prefix_errors(std::slice::from_ref(points), &[error.points], 300).unwrap()[0];
        let (a, b) = (one(&cut[0]), one(&cut[1]));
        assert_near(error.half_spaces.powi(2), (a.half_spaces.powi(2) + b.half_spaces.powi(2)) / 2.0, 1e-12, "mean");
        assert_near(error.gaussians_relative, (a.gaussians_relative + b.gaussians_relative) / 2.0, 1e-9, "mean");
    }
    // With as many integrands, the last is the error of the whole set.
    let all = prefix_errors(&sets[..1], &[100], 4096).unwrap()[0];
    let whole = integration(&sets[0]);
    assert_near(all.half_spaces_relative, whole.half_spaces, 1e-9, "half-spaces");
    assert_near(all.gaussians_relative, whole.gaussians, 1e-9, "Gaussians");
}

#[test]
fn prefixes_that_make_no_sense_are_refused() {
    let points = random(10, 2, 1);
    let of = |counts: &[usize]| prefix_errors(std::slice::from_ref(&points), counts, 8);
    for counts in [&[0, 5][..], &[5, 5], &[7, 3], &[11]] {
        assert!(of(counts).unwrap_err().to_string().contains("increasing numbers from 1 to the 10 points"));
    }
    assert!(prefix_errors(&[], &[1], 8).is_err());
    assert!(prefix_errors(&[points.clone(), random(11, 2, 1)], &[1], 8).is_err());
    assert!(prefix_errors(&[points.clone(), random(10, 3, 1)], &[1], 8).is_err());
    assert!(prefix_errors(std::slice::from_ref(&points), &[1], 0).is_err());
}

#[test]
fn logarithmic_spacing() {
    assert_eq!(log_spaced(1, 4), [1]);
    assert_eq!(log_spaced(20, 1), [1, 2, 4, 8, 16, 20]);
    assert_eq!(log_spaced(16, 2), [1, 2, 3, 4, 6, 8, 11, 16]);
    let many = log_spaced(262_144, 8);
    assert!(many.is_sorted_by(|a, b| a < b));
    assert!((0..=18).all(|p| many.contains(&(1 << p))));
}

#[test]
fn half_planes_of_tiles_lie_through_uniform_points() {
    assert_eq!(tile::integrands(Family::Gaussian, 2, 0, 5).len(), 5);
    // Integrals of half-spaces through uniform points are spread over all of (0, 1).
    let integrals: Vec<f64> = tile::integrands(Family::HalfSpace, 2, 0, 500).iter().map(|i| i.integral).collect();
    assert_mean(&integrals, 0.5, "half-planes through uniform points");
}
