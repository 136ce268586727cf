//! What a draw costs.

use crate::chapters::chapter::{Cell, Chapter, row};
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
    let counts = table.distinct("spp")?;
    let times = |dims: &str, spp: &str, sampler: &str, door: &str| -> Result<Vec<f64>> {
        let wanted = [("dims", dims), ("spp", spp), ("sampler", sampler), ("door", door)];
        table.rows().filter(|row| row.has(&wanted)).map(|row| row.number("ns")).collect()
    };
    for dims in table.distinct("dims")? {
        let headings: Vec<String> = counts.iter().map(|spp| format!("{spp} spp")).collect();
        let columns: Vec<&str> =
            ["sampler", "through"].into_iter().chain(headings.iter().map(String::as_str)).collect();
        let mut rows = Vec::new();
        for sampler in table.distinct("sampler")? {
            for door in DOORS {
                let mut cells: Vec<Cell> = row![sampler, door];
                for spp in &counts {
                    let all = times(dims, spp, sampler, door)?;
                    cells.push(match all.is_empty() {
                        true => Cell::Missing,
                        false => Figure::new(Estimate::median(&all), Unit::Nanoseconds).into(),
                    });
                }
                if cells[2..].iter().any(|cell| matches!(cell, Cell::Figure(_))) {
                    rows.push(cells);
                }
            }
        }
        chapter.table("draws", &columns, 2, rows);
        for (door, sampler) in DOORS.into_iter().flat_map(|door| ["tile", "progressive tile"].map(|of| (door, of))) {
            for spp in counts.iter().filter(|spp| **spp != "64") {
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
