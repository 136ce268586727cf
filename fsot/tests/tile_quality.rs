//! What optimised tiles reach: energies of the error image relative to white noise, as docs/metrics.md defines them.

use fsot::metrics::{TileOptions, TileReport, TileView, measure_tile};
use fsot::run::Optimization;
use fsot::tile::{Projections, TemporalKernel, TileOptimizer, TileProblem, TileSamples};

fn measure(tile: &TileSamples) -> TileReport {
    measure_tile(&TileView::of(tile).unwrap(), &TileOptions { integrands: 128, alphas: vec![0.3] }).unwrap()
}

fn optimised(problem: TileProblem) -> TileReport {
    let mut optimizer = TileOptimizer::new(problem).unwrap();
    optimizer.run();
    measure(&optimizer.samples())
}

/// Seed and integrands are fixed, so the figures are too: each limit is what was measured, rounded up by some percent
/// so that it survives a change of the random numbers. White noise has 1.
#[test]
fn small_tiles_reach_their_figures() {
    for (spp, filtered, gaussians, raw) in [(1, 0.11, 0.032, 1.05), (4, 0.055, 0.006, 0.38)] {
        let report = optimised(TileProblem { iterations: 512, ..TileProblem::new(32, spp, 2) });
        let energies = report.prefixes.last().unwrap().energies;
        let found = (energies.half_spaces.wide, energies.gaussians.wide, energies.half_spaces.raw);
        assert!(found.0 < filtered && found.1 < gaussians && found.2 < raw, "{spp} samples per pixel: {found:?}");
    }
}

/// Without prefix classes the first sample of each pixel is almost white noise; with them it is a tile.
#[test]
fn every_prefix_of_a_progressive_tile_is_one() {
    let problem = |progressive| TileProblem { iterations: 384, progressive, ..TileProblem::new(32, 4, 2) };
    let first = |report: TileReport| report.prefixes[0].energies.half_spaces.wide;
    let last = |report: TileReport| report.prefixes.last().unwrap().energies.half_spaces.wide;
    assert!(first(optimised(problem(false))) > 0.5);
    assert!(first(optimised(problem(true))) < 0.16);
    assert!(last(optimised(problem(true))) < 0.075);
}

#[test]
fn four_dimensions_and_their_planes() {
    let problem = TileProblem {
        iterations: 512,
        projections: Projections { axis: 0.0, plane: 0.4 },
        ..TileProblem::new(32, 1, 4)
    };
    let report = optimised(problem);
    assert!(report.prefixes[0].energies.half_spaces.wide < 0.24, "{report}");
    assert_eq!(report.marginals.len(), 6);
    assert!(report.marginals.iter().all(|plane| plane.prefixes[0].energies.half_spaces.wide < 0.19), "{report}");
}

/// Frames that are optimised together, against frames that are each a tile: what an exponential moving average leaves
/// of the error.
#[test]
fn frames_optimised_together_are_better_over_time() {
    let alone = TileProblem { frames: 12, iterations: 256, ..TileProblem::new(16, 1, 2) };
    let together = TileProblem { temporal: Some(TemporalKernel::Ema(0.3)), ..alone.clone() };
    let wide = |report: &TileReport| report.temporal[0].energies.half_spaces.wide;
    let (alone, together) = (optimised(alone), optimised(together));
    assert!(wide(&together) < 0.8 * wide(&alone), "{} together, {} alone", wide(&together), wide(&alone));
}
