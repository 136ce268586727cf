//! What a draw costs.

use crate::chapters::chapter::{Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::statistics::Estimate;
use crate::chapters::targets::Targets;
use crate::measure::table::Table;
use anyhow::Result;

/// The public sampler that the library's draws are to be as fast as.
const PEER: &str = "OpenQMC lattice-bn";
/// What draws go through.
const DOORS: [&str; 3] = ["Rust", "C ABI", "C ABI by pixel"];

pub(super) fn write(table: &Table, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    chapter.section("Nanoseconds of a draw", "");
    chapter.setting("rounds", table.distinct("round")?.len());
    let counts = table.headings("spp", |spp| format!("{spp} spp"))?;
    let times = |dims: &str, spp: &str, sampler: &str, door: &str| {
        table.numbers_of("ns", &[("dims", dims), ("spp", spp), ("sampler", sampler), ("door", door)])
    };
    for dims in table.distinct("dims")? {
        let samplers = table.distinct("sampler")?;
        let down = samplers.iter().flat_map(|sampler| DOORS.map(|door| (row![*sampler, door], (*sampler, door))));
        chapter.grid("draws", &["sampler", "through"], down, &counts, |(sampler, door), spp| {
            Ok(Figure::median(&times(dims, spp, sampler, door)?, Unit::Nanoseconds).into())
        })?;
        for (door, sampler) in DOORS.into_iter().flat_map(|door| ["tile", "progressive tile"].map(|of| (door, of))) {
            for (_, spp) in counts.iter().filter(|(_, spp)| *spp != "64") {
                let (own, peer) = (times(dims, spp, sampler, door)?, times(dims, spp, PEER, "Rust")?);
                if own.is_empty() || peer.is_empty() {
                    continue;
                }
                let statement = format!("time of a draw over that of {PEER}, {dims} numbers, {door}");
                let place = format!("{sampler}, {spp} spp");
                targets.at_most(&statement, &place, Estimate::ratio(&own, &peer), Unit::Ratio, 1.0);
            }
        }
    }
    Ok(())
}
