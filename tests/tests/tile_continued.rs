//! Beyond the tile's samples: the error of a pixel's estimate, against random samples and Owen-scrambled Sobol points.
//!
//! The figures are the report's (chapter `analytic`);
//! `cargo test -p noisefloor-tests --test noisefloor tile_continued:: -- --nocapture` prints them too.

use noisefloor::tile::Tile;
use noisefloor_tests::continued::{Errors, TIMES, counts, kinds, measure, tiles};
use noisefloor_tests::random::SplitMix64;

#[test]
fn continued_samples_converge_as_sobol_points_do() {
    let mut rng = SplitMix64::new(41);
    let kinds = kinds(48, &mut rng);
    for (name, bytes) in &tiles() {
        let tile = Tile::from_bytes(bytes).unwrap();
        let spp = tile.shape().spp;
        let counts = counts(spp);
        println!("{spp} spp, {name}: n = {counts:?}");
        for kind in &kinds {
            let Errors { random, owen, tile: own, domain } = measure(&tile, kind, &counts, &mut rng);
            for (of, row) in [("random", &random), ("Owen-Sobol", &owen), ("tile", &own), ("domain", &domain)] {
                let row: Vec<String> = row.iter().map(|error| format!("{error:.5}")).collect();
                println!("  {:12} {of:10} {}", kind.name, row.join(" "));
            }
            for (place, &times) in TIMES.iter().enumerate().take(counts.len()) {
                for row in [&own, &domain] {
                    // Measured, with a quarter to spare.
                    let allowed = match times {
                        1 => 1.1,
                        2..16 => 0.95,
                        _ => 0.7,
                    };
                    assert!(row[place] < allowed * random[place], "{name} {} {times}", kind.name);
                    if spp == 1 {
                        assert!(row[place] < 1.25 * owen[place], "{name} {} {times}", kind.name);
                    }
                }
            }
        }
    }
}
