//! The chapter of samplers, and of samplers with estimators.

use super::figure::significant;
use super::prelude::*;
use super::program;
use super::report::Report;

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let tables = program::measure(report)?;
    let (mut chapter, targets) = report.described(&|name| tables.read(name))?;
    let energies = tables.read("energies")?;
    let integrands: usize = energies.rows().next().context("no energies were measured")?.number("integrands")?;
    chapter.setting("integrands of each family, one sample", integrands * energies.distinct("batch")?.len());
    decisions(&tables.read("decisions")?, &mut chapter)?;
    targets.write(&mut chapter);
    Ok(chapter)
}

/// What `recommend()` says, and whether this run agrees.
fn decisions(table: &Table, chapter: &mut Chapter) -> Result<()> {
    chapter.section("What is recommended", "");
    let counts = table.named("n", |n| format!("n = {n}"))?;
    let (dims, kinds) = (table.distinct("dims")?, table.kinds(&["samples", "neighbours"])?);
    let down = dims.iter().flat_map(|dims| kinds.iter().map(move |of| (row![*dims, of[0], of[1]], (*dims, of))));
    chapter.grid("recommended", (3, "dims | samples | neighbours"), down, &counts, |(dims, of), n| {
        let wanted = [("dims", *dims), ("samples", of[0]), ("neighbours", of[1]), ("n", *n)];
        Ok(match table.rows().find(|row| row.has(&wanted)) {
            Some(row) if of[1].is_empty() => name(row, "recommended")?.into(),
            Some(row) => choice(row, "recommended", ["raw", "filtered"])?.into(),
            None => Cell::Missing,
        })
    })?;
    // Where something else was better by more than its noise.
    let mut rows = Vec::new();
    for row in table.rows().filter(|row| row.number::<f64>("excess_low").is_ok_and(|low| low > 1.0)) {
        let [value, low, high] = ["excess", "excess_low", "excess_high"].map(|column| row.number(column));
        rows.push(row![
            row.word("dims")?,
            row.word("n")?,
            row.word("samples")?,
            row.word("neighbours")?,
            choice(row, "recommended", ["raw", "filtered"])?,
            choice(row, "best", ["best_raw", "best_filtered"])?,
            Figure::new(Estimate { value: value?, low: low?, high: high?, seeds: 2 }, Unit::Ratio)
        ]);
    }
    chapter.quote("decisions", Figure::count(table.rows().count()));
    chapter.quote("decisions where another was better", Figure::count(rows.len()));
    let largest = table.numbers("excess")?.into_iter().fold(1.0, f64::max);
    chapter.quote("largest excess of a recommendation", Figure::exact(largest, Unit::Ratio));
    if !rows.is_empty() {
        let columns = "dims | n | samples | neighbours | recommended | better | excess";
        chapter.table("better than recommended", columns, 6, rows);
    }
    Ok(())
}

fn name(row: Row<'_>, column: &str) -> Result<String> {
    Ok(row.word(column)?.replace(';', ","))
}

/// What is chosen, and its errors, of which two digits hold.
fn choice(row: Row<'_>, column: &str, errors: [&str; 2]) -> Result<String> {
    let [raw, filtered] = errors.map(|error| row.number(error).map(|error| significant(error, 2)));
    Ok(format!("{}: {}, {}", name(row, column)?, raw?, filtered?))
}
