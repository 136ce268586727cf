//! What the optimiser reaches. Seeds are fixed: these results are the same on every machine.

use fsot::class;
use fsot::metrics::neighbours::{Neighbours, neighbours};
use fsot::metrics::{PrefixError, prefix_errors, quick, select};
use fsot::optimize::{Domain, Problem, Quality, optimize};
use fsot::points::Points;
use std::ops::Range;

/// Of the points of these numbers.
fn nearest(points: &Points, range: Range<usize>) -> Neighbours {
    neighbours(&select(points, |i| range.contains(&i))).unwrap()
}

#[test]
fn a_thousand_points() {
    let points = optimize(Problem { seed: 1, ..Problem::new(1024, 2) }).unwrap();
    let report = quick(&points).unwrap();
    let (nn, low) = (report.neighbours.unwrap().mean, report.spectra[0].summary.low);
    assert!(nn > 0.85, "{nn}");
    assert!(low < 0.008, "{low}");
}

/// Walls leave no trace: without the torus the smallest distance, across them, is .65.
#[test]
fn a_thousand_points_on_a_torus() {
    let points = optimize(Problem { seed: 1, domain: Domain::Toroidal, ..Problem::new(1024, 2) }).unwrap();
    let nn = neighbours(&points).unwrap();
    assert!(nn.mean_toroidal > 0.85 && nn.min_toroidal > 0.72, "{nn:?}");
}

#[test]
fn two_colors() {
    let problem = Problem { classes: class::two_colors(2), seed: 1, ..Problem::new(2048, 2) };
    let points = optimize(problem).unwrap();
    for color in [0..1024, 1024..2048] {
        let nn = nearest(&points, color).mean;
        assert!(nn > 0.78, "{nn}");
    }
    let low = quick(&points).unwrap().spectra[0].summary.low;
    assert!(low < 0.014, "{low}");
}

/// Points of one class, cut in two, have .67 at most in one of the parts.
#[test]
fn a_ramp_is_even_on_both_sides_of_any_index() {
    let problem = Problem { classes: class::ramp(2), seed: 1, ..Problem::new(1024, 2) };
    let points = optimize(problem).unwrap();
    for split in [128, 256, 512, 768, 896] {
        let nn = [0..split, split..1024].map(|range| nearest(&points, range).mean);
        assert!(nn.iter().all(|nn| *nn > 0.72), "{split}: {nn:?}");
    }
    let all = nearest(&points, 0..1024).mean;
    assert!(all > 0.7, "{all}");
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
    let nn = neighbours(&points).unwrap().mean;
    println!("nearest neighbour {nn}");
    assert!(nn >= 0.85, "{nn}");
}

/// Squared errors of functions of one coordinate, steps and bumps: .05 and .13 of those of five times as many steps.
#[test]
fn axis_priority_gains_more_than_a_longer_run() {
    let errors = |axis_priority, quality| {
        let points = optimize(Problem { axis_priority, quality, seed: 1, ..Problem::new(256, 2) }).unwrap();
        let axes = [0, 1].map(|axis| Points::new(1, points.iter().map(|point| point[axis]).collect()));
        prefix_errors(&axes, &[256], 256).unwrap()[0]
    };
    let (short, long) = (errors(0.3, Quality::Draft), errors(0.0, Quality::Standard));
    assert!(short.half_spaces_relative < 0.1 * long.half_spaces_relative, "{short:?} {long:?}");
    assert!(short.gaussians_relative < 0.2 * long.gaussians_relative, "{short:?} {long:?}");
}

#[test]
fn windows_bring_points_into_order() {
    let quality = Quality::Iterations(120);
    let points = optimize(Problem { quality, seed: 1, ..Problem::new(20_000, 2) }).unwrap();
    let nn = neighbours(&points).unwrap().mean;
    assert!(nn > 0.8, "{nn}");
}

/// The errors of the first 16, 32, ... 256 points of sets with so many levels.
fn errors(levels: usize, sets: u64) -> Vec<PrefixError> {
    let classes = class::progressive(2, levels, 256);
    let set = |seed| optimize(Problem { classes: classes.clone(), seed, ..Problem::new(256, 2) }).unwrap();
    prefix_errors(&(0..sets).map(set).collect::<Vec<Points>>(), &[16, 32, 64, 128, 256], 256).unwrap()
}

/// Squared errors, relative to those of as many random points: at a level, a fraction of those at half and at twice as
/// many. Without levels the first three fractions are .78 and more.
#[test]
fn errors_dip_at_every_level() {
    assert_eq!(class::progressive_prefixes(4, 256), [4, 16, 64, 256]);
    let few = errors(4, 8);
    for (level, between) in [(0, 1), (2, 1), (2, 3), (4, 3)] {
        let (level, between) = (&few[level], &few[between]);
        assert!(level.half_spaces_relative < 0.3 * between.half_spaces_relative, "{level:?} {between:?}");
        assert!(level.gaussians_relative < 0.06 * between.gaussians_relative, "{level:?} {between:?}");
    }
    // More levels make shallower dips: with one at every point there are none.
    let all = errors(256, 2);
    for (number, (few, all)) in few.iter().zip(&all).enumerate() {
        let (few, all, factor) = if number % 2 == 0 { (few, all, 1.2) } else { (all, few, 2.0) };
        assert!(all.half_spaces_relative > factor * few.half_spaces_relative, "{few:?} {all:?}");
        assert!(all.gaussians_relative > 4.0 * few.gaussians_relative, "{few:?} {all:?}");
    }
}
