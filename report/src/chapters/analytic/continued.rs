//! Samples beyond a tile's.

use crate::chapters::chapter::{Cell, Chapter, headings};
use crate::chapters::figure::{Figure, Unit};
use crate::measure::table::Table;
use anyhow::{Context, Result};

pub(super) fn write(chapter: &mut Chapter, table: &Table) -> Result<()> {
    chapter.section("Samples beyond a tile's", "");
    let first = table.rows().next().context("the program has measured no tile")?;
    chapter.setting("integrands of each kind", first.number::<u32>("count")?);
    let times = table.distinct("times")?;
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    let mut last = None;
    for row in table.rows() {
        let key = [row.word("spp")?, row.word("tile")?, row.word("integrands")?, row.word("samples")?];
        if last != Some(key) {
            rows.push(key.map(Cell::from).to_vec());
            last = Some(key);
        }
        if let Some(cells) = rows.last_mut() {
            cells.push(Figure::exact(row.number("error")?, Unit::Number).into());
        }
    }
    // As many as there are of few samples.
    rows.iter_mut().for_each(|row| row.resize(4 + times.len(), Cell::Missing));
    let times = times.iter().map(|times| format!("n / spp = {times}"));
    let columns = headings(&["spp", "tile", "integrands", "samples"], times);
    chapter.table("continued tiles", &columns, 4, rows);
    Ok(())
}
