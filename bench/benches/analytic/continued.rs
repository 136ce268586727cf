//! Samples beyond a tile's.

use anyhow::{Result, anyhow};
use noisefloor::tile::Tile;
use noisefloor_bench::Extent;
use noisefloor_tests::continued::{Errors, TIMES, counts, kinds, measure, tiles};
use noisefloor_tests::random::SplitMix64;
use std::fmt::Write;

/// Root mean square errors over the integrand's standard deviation, after multiples of the tile's samples.
pub(crate) fn table(size: Extent) -> Result<String> {
    let mut rng = SplitMix64::new(41);
    let count = size.of(48);
    let kinds = kinds(count, &mut rng);
    let mut text = "spp;tile;integrands;count;samples;times;error\n".to_owned();
    for (name, bytes) in &tiles() {
        let tile = Tile::from_bytes(bytes).map_err(|error| anyhow!("the tile {name}: {error}"))?;
        let spp = tile.shape().spp;
        for kind in &kinds {
            let Errors { random, owen, tile, domain } = measure(&tile, kind, &counts(spp), &mut rng);
            let rows =
                [("random", random), ("Owen-scrambled Sobol", owen), ("tile, continued", tile), ("its domain", domain)];
            for (samples, errors) in rows {
                for (times, error) in TIMES.iter().zip(errors) {
                    let _ = writeln!(text, "{spp};{name};{};{count};{samples};{times};{error}", kind.name);
                }
            }
        }
    }
    Ok(text)
}
