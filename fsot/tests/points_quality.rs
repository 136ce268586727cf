//! What the optimiser reaches. Seeds are fixed: these results are the same on every machine.

use fsot::class;
use fsot::optimize::{Domain, Problem, Quality, optimize};
use fsot::points::Points;
use fsot::random::stream;

/// The mean distance to the nearest neighbour, over that of a hexagonal lattice of the same density.
fn nearest(points: &[[f64; 2]], torus: bool) -> f64 {
    let apart = |a: f64, b: f64| {
        let d = (a - b).abs();
        if torus { d.min(1.0 - d) } else { d }
    };
    let mut sum = 0.0;
    for (i, a) in points.iter().enumerate() {
        let nearest = points
            .iter()
            .enumerate()
            .filter(|(j, _)| *j != i)
            .map(|(_, b)| apart(a[0], b[0]).powi(2) + apart(a[1], b[1]).powi(2))
            .fold(f64::INFINITY, f64::min);
        sum += nearest.sqrt();
    }
    sum / points.len() as f64 / (2.0 / 3.0f64.sqrt() / points.len() as f64).sqrt()
}

fn pairs(points: &Points) -> Vec<[f64; 2]> {
    points.iter().map(|p| [f64::from(p[0]), f64::from(p[1])]).collect()
}

/// The mean spectral power below half the principal frequency; 1 for random points.
fn low_power(points: &[[f64; 2]]) -> f64 {
    let half = 0.5 * (2.0 / 3.0f64.sqrt() * points.len() as f64).sqrt();
    let most = half as i32;
    let (mut sum, mut count) = (0.0, 0.0);
    for kx in 0..=most {
        for ky in -most..=most {
            let k = f64::from(kx).hypot(f64::from(ky));
            if k == 0.0 || k >= half || (kx == 0 && ky < 0) {
                continue;
            }
            let (mut re, mut im) = (0.0, 0.0);
            for p in points {
                let (sin, cos) = (std::f64::consts::TAU * (f64::from(kx) * p[0] + f64::from(ky) * p[1])).sin_cos();
                re += cos;
                im += sin;
            }
            sum += (re * re + im * im) / points.len() as f64;
            count += 1.0;
        }
    }
    sum / count
}

#[test]
fn a_thousand_points() {
    let points = optimize(Problem { seed: 1, ..Problem::new(1024, 2) }).unwrap();
    let nn = nearest(&pairs(&points), false);
    assert!(nn > 0.85, "{nn}");
    let low = low_power(&pairs(&points));
    assert!(low < 0.008, "{low}");
}

#[test]
fn a_thousand_points_on_a_torus() {
    let points = optimize(Problem { seed: 1, domain: Domain::Toroidal, ..Problem::new(1024, 2) }).unwrap();
    let nn = nearest(&pairs(&points), true);
    assert!(nn > 0.85, "{nn}");
    // Shifted, the spectrum stays as it is, and so do distances; walls leave no trace.
    let shifted: Vec<[f64; 2]> = pairs(&points).iter().map(|p| [(p[0] + 0.37) % 1.0, (p[1] + 0.81) % 1.0]).collect();
    assert!(nearest(&shifted, false) > 0.84);
}

#[test]
fn two_colors() {
    let problem = Problem { classes: class::two_colors(2), seed: 1, ..Problem::new(2048, 2) };
    let points = optimize(problem).unwrap();
    let report = fsot::metrics::quick(&points).unwrap();
    let all = pairs(&points);
    for color in [&all[..1024], &all[1024..]] {
        let nn = nearest(color, false);
        assert!(nn > 0.78, "{nn}");
    }
    let low = low_power(&all);
    assert!(low < 0.014 && report.spectra[0].summary.low <= 0.014, "{low}, {:?}", report.spectra);
}

/// Half a minute of one core; the next one, two minutes.
#[test]
#[ignore = "long: run by cargo xtask tiles --check"]
fn four_thousand_points_of_high_quality() {
    let points = optimize(Problem { quality: Quality::High, seed: 1, ..Problem::new(4096, 2) }).unwrap();
    let report = fsot::metrics::measure(&points).unwrap();
    let (nn, low) = (report.neighbours.unwrap().mean, report.spectra[0].summary.low);
    println!("nearest neighbour {nn}, low power {low}, sliced W2 {}", report.transport.sliced_w2);
    assert!(nn >= 0.89, "{nn}");
    assert!(low <= 0.002, "{low}");
    assert!(report.transport.sliced_w2 <= 0.6e-3, "{}", report.transport.sliced_w2);
}

#[test]
#[ignore = "long: run by cargo xtask tiles --check"]
fn a_quarter_of_a_million_points() {
    let points = optimize(Problem { seed: 1, ..Problem::new(262_144, 2) }).unwrap();
    let nn = fsot::metrics::neighbours::neighbours(&points).unwrap().mean;
    println!("nearest neighbour {nn}");
    assert!(nn >= 0.85, "{nn}");
}

#[test]
fn windows_bring_points_into_order() {
    let quality = Quality::Iterations(120);
    let points = optimize(Problem { quality, seed: 1, ..Problem::new(20_000, 2) }).unwrap();
    // One in ten, against all, for the time it takes.
    let all = pairs(&points);
    let mut sum = 0.0;
    for a in all.iter().step_by(10) {
        let squared = |b: &[f64; 2]| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
        sum += all.iter().map(squared).filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min).sqrt();
    }
    let nn = sum / 2000.0 / (2.0 / 3.0f64.sqrt() / 20_000.0).sqrt();
    assert!(nn > 0.8, "{nn}");
}

/// Integration error of the first points, averaged over sets and Gaussians; [`errors`] of every prefix length asked
/// for.
fn errors(levels: usize, points: usize, prefixes: &[usize], sets: u64, integrands: u64) -> Vec<f64> {
    let mut sums = vec![0.0; prefixes.len()];
    for set in 0..sets {
        let classes = class::progressive(2, levels, points);
        let optimised = optimize(Problem { classes, seed: set, ..Problem::new(points, 2) }).unwrap();
        for integrand in 0..integrands {
            let rng = &mut stream(17, integrand, 0);
            let (cx, cy, sigma) = (rng.uniform_f64(), rng.uniform_f64(), 0.1 + 0.2 * rng.uniform_f64());
            let f = |x: f64, y: f64| (-((x - cx).powi(2) + (y - cy).powi(2)) / (2.0 * sigma * sigma)).exp();
            const GRID: usize = 200;
            let at = |i: usize| (i as f64 + 0.5) / GRID as f64;
            let exact = (0..GRID * GRID).map(|i| f(at(i % GRID), at(i / GRID))).sum::<f64>() / (GRID * GRID) as f64;
            for (sum, &prefix) in sums.iter_mut().zip(prefixes) {
                let mean =
                    optimised.iter().take(prefix).map(|p| f(p[0].into(), p[1].into())).sum::<f64>() / prefix as f64;
                *sum += (mean - exact).powi(2);
            }
        }
    }
    sums.iter().map(|sum| (sum / (sets * integrands) as f64).sqrt()).collect()
}

#[test]
fn errors_dip_at_every_level() {
    // 4 levels of 256 points: 4, 16, 64, 256. Between two levels the error is that of neither.
    let ends = class::progressive_prefixes(4, 256);
    assert_eq!(ends, [4, 16, 64, 256]);
    let errors = errors(4, 256, &[4, 16, 32, 64, 128, 256], 8, 20);
    // At a level, less than at half and at twice as many points, scaled as for random points.
    let scaled: Vec<f64> =
        errors.iter().zip([4.0f64, 16.0, 32.0, 64.0, 128.0, 256.0]).map(|(e, n)| e * n.sqrt()).collect();
    assert!(scaled[1] < 0.6 * scaled[2] && scaled[3] < 0.6 * scaled[2], "{scaled:?}");
    assert!(scaled[3] < 0.6 * scaled[4] && scaled[5] < 0.6 * scaled[4], "{scaled:?}");
}
