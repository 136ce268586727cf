//! Samples that are even in an order: what estimators make of them, told of it or not.

use crate::cv_support::*;
use noisefloor::control_variate::{Config, Estimator};
use noisefloor::tile::Builtin;
use noisefloor_tests::integrands;
use noisefloor_tests::ordered::Order;

const TILES: [Order; 4] = [
    Order::Tile(Builtin::Size128Spp4Dims2),
    Order::Tile(Builtin::Size128Spp16Dims2Progressive),
    Order::Tile(Builtin::Size128Spp1Dims4),
    Order::Tile(Builtin::Size128Spp4Dims4),
];

/// Told that the samples are stratified, all that would correct some samples by fits to others is the mean, to the bit.
#[test]
fn declared_is_the_mean() {
    for integrand in integrands::nine() {
        for n in [16, 100, 1024] {
            for u in Order::Sobol.sets(n, integrand.dims, 2) {
                let f = values(&u, integrand.dims, integrand.evaluate);
                for estimator in [Estimator::Robust, Estimator::LeaveOneOut, Estimator::KFold, Estimator::Incremental] {
                    let order = limited(integrand.dims, 3);
                    let config = Config { stratified: true, ..config(integrand.dims, order, estimator) };
                    let plain = Config { order: 0, ..config };
                    let mean = batch::<f64>(&Config { estimator: Estimator::Robust, ..plain }, &u, &f).unwrap();
                    let found = batch::<f64>(&config, &u, &f).unwrap();
                    assert_eq!(found.mean, mean.mean, "{estimator:?} {n}");
                    assert!(estimator != Estimator::Robust || found == mean, "{n}: {found:?} {mean:?}");
                    if estimator != Estimator::LeaveOneOut {
                        let streamed = streamed::<f64>(&config, &u, &f).unwrap();
                        let error = (streamed.mean[0] - mean.mean[0]).abs();
                        assert!(error <= 2e-7 * mean.mean[0].abs(), "{estimator:?} {n}");
                        assert!(n > 16 || estimator != Estimator::Robust || streamed == mean, "{streamed:?} {mean:?}");
                    }
                }
                // What fits to all samples alike fits all the same.
                for estimator in [Estimator::LeastSquares, Estimator::GradientDescent] {
                    let config = config(integrand.dims, limited(integrand.dims, 2), estimator);
                    let declared = Config { stratified: true, ..config };
                    let found = [config, declared].map(|config| batch::<f64>(&config, &u, &f).unwrap());
                    assert_eq!(found[0], found[1], "{estimator:?} {n}");
                    let plain = batch::<f64>(&Config { order: 0, ..config }, &u, &f).unwrap();
                    assert!(found[0] != plain, "{estimator:?} {n}");
                }
            }
        }
    }
}

/// RMSE over that of the mean of the same samples, 256 sets, the worst of the nine in up to 5 dims and 16 to 256
/// samples.
fn worst(order: Order, estimator: Estimator, streaming: bool) -> (f64, String) {
    let mut worst = (0.0, String::new());
    for integrand in integrands::nine().iter().filter(|integrand| integrand.dims <= 5) {
        for n in [16, 64, 256] {
            let config = config(integrand.dims, 2, estimator);
            let (mut square, mut plain) = (0.0, 0.0);
            for u in order.sets(n, integrand.dims, 256) {
                let f = values(&u, integrand.dims, integrand.evaluate);
                let estimate = if streaming { streamed::<f64>(&config, &u, &f) } else { batch::<f64>(&config, &u, &f) };
                let mean = (wide(&f).iter().sum::<f64>() / n as f64) as f32;
                square += (f64::from(estimate.unwrap().mean[0]) - integrand.integral).powi(2);
                plain += (f64::from(mean) - integrand.integral).powi(2);
            }
            // Of a tile of fewer dimensions there are no points.
            let ratio = if plain > 0.0 { (square / plain).sqrt() } else { 0.0 };
            if ratio > worst.0 {
                worst = (ratio, format!("{} {n}", integrand.name));
            }
        }
    }
    println!("{order:?} {estimator:?} {streaming}: {worst:?}");
    worst
}

/// Not told, the robust fit of order 2 keeps most of what is even: at most 1.5 times the mean's error on Sobol points,
/// and next to never worse on tiles.
#[test]
fn undeclared_robust() {
    for streaming in [false, true] {
        for order in [Order::Sobol, Order::Gray] {
            assert!(worst(order, Estimator::Robust, streaming).0 < 1.5);
        }
        for order in TILES {
            assert!(worst(order, Estimator::Robust, streaming).0 < 1.06);
        }
    }
}

/// K-fold, whose fits do not know the fold that they correct, cannot keep it: with folds that are runs it is at most
/// 1.8 times as far off from arrays, 3.2 times from a stream. With every fourth sample in a fold it was 37 times.
#[test]
fn undeclared_k_fold() {
    for (streaming, limit) in [(false, 1.8), (true, 3.2)] {
        for order in [Order::Sobol, Order::Gray, TILES[2]] {
            assert!(worst(order, Estimator::KFold, streaming).0 < limit);
        }
    }
}
