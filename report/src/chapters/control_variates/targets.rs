//! What was to be reached: the bounds that the project has set itself, as the benchmark `speed_error` judges them.

use crate::chapters::figure::Unit;
use crate::chapters::statistics::Estimate;
use crate::chapters::targets::Targets;
use crate::measure::table::Table;
use anyhow::Result;

pub(super) fn collect(targets: &mut Targets, table: &Table) -> Result<()> {
    for row in table.rows() {
        let value = row.number("value")?;
        let half = row.optional("half_width")?.unwrap_or(0.0);
        let seeds = if half > 0.0 { 2 } else { 1 };
        let estimate = Estimate::of_logarithm(value, half, seeds);
        let unit = if row.word("unit")? == "ns" { Unit::Nanoseconds } else { Unit::Ratio };
        let note = row.word("note")?;
        let note = if note.is_empty() { "all" } else { note };
        targets.at_most(row.word("target")?, note, estimate, unit, row.number("bound")?);
    }
    Ok(())
}
