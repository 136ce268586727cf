//! Samples beyond a tile's.

use crate::chapters::chapter::{Cell, Chapter};
use crate::chapters::figure::{Figure, Unit};
use crate::measure::table::Table;
use anyhow::{Context, Result};

pub(super) fn write(chapter: &mut Chapter, table: &Table) -> Result<()> {
    chapter.section("Samples beyond a tile's", "");
    let first = table.rows().next().context("the program has measured no tile")?;
    chapter.setting("integrands of each kind", first.number::<u32>("count")?);
    const KEYS: [&str; 4] = ["spp", "tile", "integrands", "samples"];
    let mut kinds: Vec<[&str; 4]> = Vec::new();
    for row in table.rows() {
        let [spp, tile, integrands, samples] = KEYS.map(|key| row.word(key));
        let kind = [spp?, tile?, integrands?, samples?];
        kinds.extend((!kinds.contains(&kind)).then_some(kind));
    }
    let times = table.headings("times", |times| format!("n / spp = {times}"))?;
    let down = kinds.into_iter().map(|kind| (kind.map(Cell::from).to_vec(), kind));
    chapter.grid("continued tiles", &KEYS, down, &times, |[spp, tile, integrands, samples], times| {
        let wanted =
            [("spp", *spp), ("tile", tile), ("integrands", integrands), ("samples", samples), ("times", times)];
        Ok(Figure::mean(&table.numbers_of("error", &wanted)?, Unit::Number).into())
    })
}
