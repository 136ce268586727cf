//! Memory, and what many updates leave behind.

use crate::chapters::chapter::{Cell, Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::statistics::Estimate;
use crate::chapters::targets::Targets;
use crate::measure::table::Table;
use anyhow::Result;

/// Bytes per item, and the time of a pass over all items.
pub(super) fn memory(rows: &Table, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    chapter.section("Memory", "");
    let (items, bytes) = (rows.numbers("items")?, rows.numbers("bytes")?);
    let methods = rows.words("method")?;
    let epsilon = rows.words("epsilon")?;
    let mut cells: Vec<Vec<Cell>> = Vec::new();
    for (((items, bytes), method), epsilon) in items.into_iter().zip(bytes).zip(methods).zip(epsilon) {
        let epsilon = epsilon.parse().ok().map(|value: f64| Figure::exact(value, Unit::PerItem));
        if method == "nf_table" {
            let estimate = Estimate::exact(bytes / items);
            targets.at_most("Bytes per item", &format!("{items} items"), estimate, Unit::BytesPerItem, 5.0);
        }
        cells.push(row![items as u32, method, Figure::exact(bytes / items, Unit::BytesPerItem), epsilon]);
    }
    chapter.table("memory", &["items", "method", "bytes per item", "ns per item to add epsilon"], 2, cells);
    Ok(())
}

/// After many updates: against a new table, and against the importances in f64.
pub(super) fn write(rows: &Table, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    chapter.section("Drift", "");
    let number = |name: &str| rows.numbers(name);
    let (items, updates) = (number("items")?, number("updates")?);
    let count = |value: f64| Figure::exact(value, Unit::Count);
    if let (Some(&items), Some(&updates)) = (items.first(), updates.first()) {
        chapter.quote("drift: items", count(items));
        chapter.quote("drift: updates", count(updates));
    }
    let [changed, compared, risen, lost, error] = ["changed", "compared", "risen", "lost", "error"].map(number);
    let (changed, compared, risen, lost, error) = (changed?, compared?, risen?, lost?, error?);
    let mut cells: Vec<Vec<Cell>> = Vec::new();
    for (index, method) in rows.words("method")?.into_iter().enumerate() {
        let error = Figure::exact(error[index], Unit::Scientific);
        cells.push(row![
            method,
            count(changed[index]),
            count(compared[index]),
            count(risen[index]),
            count(lost[index]),
            error
        ]);
        if method == "nf_table" {
            targets.at_most(
                "Drift: numbers changed by updates",
                "all updates",
                Estimate::exact(changed[index]),
                Unit::Count,
                0.0,
            );
            let wrong = risen[index] + lost[index];
            targets.at_most("Drift: items risen or lost", "all updates", Estimate::exact(wrong), Unit::Count, 0.0);
        }
    }
    chapter.table("drift", &["method", "changed", "of", "risen", "lost", "largest error"], 1, cells);
    Ok(())
}
