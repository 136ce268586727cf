//! The functions that are regressed: their values, their integrals, their products, their number.

use crate::cv_support::*;
use noisefloor::Error;
use noisefloor::basis::Family;
use noisefloor::control_variate::{Color, Config, Estimator, Optimizer, Ridge, Solver};
use noisefloor_tests::legendre::gauss_legendre;
use noisefloor_tests::random::SplitMix64;

fn with_basis(family: Family, dims: usize, order: usize, slices: usize) -> Config {
    Config { basis: family, slices, ..Config::new(dims, order, 1) }
}

/// C(dims + order, order).
fn binomial(dims: usize, order: usize) -> usize {
    (1..=order).fold(1, |count, k| count * (dims + k) / k)
}

/// Every function at random points and at the cube's corners: within 4e-6 of its definition in `f64`, as the estimate
/// that shows it is `f32` and sums four products, and within 2e-5 in `f32`.
#[test]
fn values_are_those_of_the_definition() {
    let mut rng = SplitMix64::new(101);
    let shapes = [(1, 7, 0), (2, 7, 0), (3, 4, 0), (5, 2, 0), (16, 1, 0), (3, 2, 4), (2, 3, 5), (1, 2, 6), (3, 1, 9)];
    for family in Family::ALL {
        for (dims, order, slices) in shapes {
            let config = with_basis(family, dims, order, slices);
            let mut places: Vec<Vec<f32>> = (0..6).map(|_| points(1, dims, &mut rng)).collect();
            places.extend([vec![0.0; dims], vec![1.0; dims]]);
            for u in &places {
                let mut expected = design(&config, &wide(u)).rows.remove(0);
                expected.sort_by(f64::total_cmp);
                for (mut values, tolerance) in [(probe::<f64>(&config, u), 4e-6), (probe::<f32>(&config, u), 2e-5)] {
                    values.sort_by(f64::total_cmp);
                    assert_eq!(values.len(), expected.len());
                    for (value, expected) in values.iter().zip(&expected) {
                        let error = (value - expected).abs() / (1.0 + expected.abs());
                        assert!(error < tolerance, "{family:?} {dims} {order} {slices}: {value} {expected}");
                    }
                }
            }
        }
    }
}

/// Points and weights that integrate products of two functions of a family: Gauss-Legendre for polynomials, on four
/// parts for Gaussians, and midpoints of equal parts, which are exact for steps and half-waves.
fn quadrature(family: Family) -> Vec<(f32, f64)> {
    let parts = match family {
        Family::Legendre => 1,
        Family::Gaussian => 4,
        Family::Step => 8,
        Family::Sine => 32,
    };
    let rule: Vec<(f64, f64)> = match family {
        Family::Step | Family::Sine => vec![(0.5, 1.0)],
        Family::Legendre | Family::Gaussian => gauss_legendre(),
    };
    let count = f64::from(parts);
    let part = |i: i32| rule.iter().map(move |(x, w)| (((f64::from(i) + x) / count) as f32, w / count));
    (0..parts).flat_map(part).collect()
}

/// In 1 and 2 dimensions, with and without slices: all integrals are 0 and, but for Gaussians and per-slice copies, all
/// products have integral 0 or 1; Gaussians and copies have unit variance. Within 3e-6.
#[test]
fn integrals_and_products_by_quadrature() {
    for family in Family::ALL {
        for (dims, order, slices) in [(1, 7, 0), (2, 7, 0), (2, 4, 3), (3, 2, 4)] {
            let config = with_basis(family, dims, order, slices);
            let columns = config.terms().unwrap() - 1;
            let line = quadrature(family);
            let last = |i: usize| {
                let choice: Vec<_> =
                    (0..slices).map(|s| ((s as f32 + 0.5) / slices as f32, 1.0 / slices as f64)).collect();
                if slices > 0 && i + 1 == dims { choice } else { line.clone() }
            };
            let mut grid = vec![(vec![], 1.0)];
            for i in 0..dims {
                let step = |(u, weight): &(Vec<f32>, f64)| {
                    let extend = |(x, w): (f32, f64)| ([&u[..], &[x]].concat(), weight * w);
                    last(i).into_iter().map(extend).collect::<Vec<_>>()
                };
                grid = grid.iter().flat_map(step).collect();
            }
            let mut means = vec![0.0; columns];
            let mut products = vec![vec![0.0; columns]; columns];
            for (u, weight) in &grid {
                let row = probe::<f64>(&config, u);
                for (j, a) in row.iter().enumerate() {
                    means[j] += weight * a;
                    row.iter().zip(&mut products[j]).for_each(|(b, sum)| *sum += weight * a * b);
                }
            }
            let tolerance = 3e-6;
            let orthonormal = family != Family::Gaussian && slices == 0;
            for j in 0..columns {
                assert!(means[j].abs() < tolerance, "{family:?} {dims} {order} {slices}: mean {j} is {}", means[j]);
                for (k, product) in products[j].iter().enumerate() {
                    let expected = if j == k { 1.0 } else { 0.0 };
                    let error = (product - expected).abs();
                    let matters = j == k || orthonormal;
                    assert!(!matters || error < tolerance, "{family:?} {dims} {order} {slices}: {j} {k} {error}");
                }
            }
        }
    }
}

/// Every number of coordinates and order: C(dims + order, order) terms, refused beyond 136.
#[test]
fn term_counts() {
    for family in Family::ALL {
        for dims in 1..=16 {
            for order in 0..=7 {
                let count = binomial(dims, order);
                let expected = if count <= 136 { Ok(count) } else { Err(Error::Range) };
                assert_eq!(with_basis(family, dims, order, 0).terms(), expected, "{family:?} {dims} {order}");
            }
        }
    }
    // Whatever is estimated of it, and how.
    let base = Config::new(2, 2, 3);
    for config in [
        Config { estimator: Estimator::KFold, ..base },
        Config { estimator: Estimator::LeastSquares, solver: Solver::SquareRoot, ..base },
        Config { color: Color::LuminanceRatio, ..base },
        Config { estimator: Estimator::GradientDescent, optimizer: Optimizer::Adam, ..base },
        Config { estimator: Estimator::LeaveOneOut, ridge: Ridge::Fixed(0.02), ..base },
    ] {
        assert_eq!(config.terms(), Ok(6));
    }
    for (dims, order) in [(0, 1), (17, 1), (1, 8), (usize::MAX, 2), (2, usize::MAX)] {
        assert_eq!(Config::new(dims, order, 1).terms(), Err(Error::Range));
    }
}

/// With S slices: shared terms, S indicators, and as many whole degrees of S copies as 136 terms can hold.
#[test]
fn term_counts_with_slices() {
    for slices in 2..=140 {
        for dims in 1..=6 {
            for order in 0..=4 {
                let shared = binomial(dims - 1, order);
                let expected = if order == 0 {
                    (slices < 136).then_some(1)
                } else {
                    let base = shared + slices;
                    let all = |degree| base + slices * (binomial(dims - 1, degree) - 1);
                    (base <= 136).then(|| (0..=order).rev().map(all).find(|&count| count <= 136).unwrap())
                };
                let config = with_basis(Family::Legendre, dims, order, slices);
                assert_eq!(config.terms().ok(), expected, "{dims} {order} {slices}");
            }
        }
    }
}
