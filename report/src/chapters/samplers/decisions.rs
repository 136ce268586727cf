//! What `recommend()` says, and whether this run agrees.

use crate::chapters::chapter::{Cell, Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::measure::table::{Row, Table};
use anyhow::Result;

/// Two digits are what the figures hold.
fn two_digits(value: f64) -> String {
    let before = if value > 0.0 { value.log10().floor() as i32 } else { 0 };
    format!("{value:.*}", (1 - before).max(0) as usize)
}

pub(super) fn write(table: &Table, chapter: &mut Chapter) -> Result<()> {
    chapter.section("What is recommended", "");
    let counts = table.headings("n", |n| format!("n = {n}"))?;
    let (dims, kinds) = (table.distinct("dims")?, table.kinds()?);
    let of = |dims| {
        kinds.iter().map(move |(samples, near)| (row![dims, samples.as_str(), near.as_str()], (dims, samples, near)))
    };
    chapter.grid(
        "recommended",
        &["dims", "samples", "neighbours"],
        dims.into_iter().flat_map(of),
        &counts,
        |of, n| {
            let (dims, samples, neighbours) = of;
            let wanted = [("dims", *dims), ("samples", samples), ("neighbours", neighbours), ("n", n)];
            Ok(match table.rows().find(|row| row.has(&wanted)) {
                Some(row) if neighbours.is_empty() => name(row, "recommended")?.into(),
                Some(row) => choice(row, "recommended", ["raw", "filtered"])?.into(),
                None => Cell::Missing,
            })
        },
    )?;
    other(table, chapter)
}

/// Where something else was better by more than its noise.
fn other(table: &Table, chapter: &mut Chapter) -> Result<()> {
    let mut rows = Vec::new();
    let mut count = 0;
    for row in table.rows() {
        count += 1;
        if row.number::<f64>("excess_low")? <= 1.0 {
            continue;
        }
        let mut excess = Figure::exact(row.number("excess")?, Unit::Ratio);
        let interval: [f64; 2] = [row.number("excess_low")?, row.number("excess_high")?];
        excess.text = format!("{} [{}, {}]", excess.text, Unit::Ratio.text(interval[0]), Unit::Ratio.text(interval[1]));
        excess.interval = Some(interval);
        rows.push(row![
            row.word("dims")?,
            row.word("n")?,
            row.word("samples")?,
            row.word("neighbours")?,
            choice(row, "recommended", ["raw", "filtered"])?,
            choice(row, "best", ["best_raw", "best_filtered"])?,
            excess
        ]);
    }
    chapter.quote("decisions", Figure::exact(f64::from(count), Unit::Count));
    chapter.quote("decisions where another was better", Figure::exact(rows.len() as f64, Unit::Count));
    let largest = table.rows().map(|row| row.number::<f64>("excess")).collect::<Result<Vec<_>>>()?;
    let largest = largest.into_iter().fold(1.0, f64::max);
    chapter.quote("largest excess of a recommendation", Figure::exact(largest, Unit::Ratio));
    if !rows.is_empty() {
        let columns = ["dims", "n", "samples", "neighbours", "recommended", "better", "excess"];
        chapter.table("better than recommended", &columns, 6, rows);
    }
    Ok(())
}

impl Table {
    /// Kinds of samples and neighbours, in the order of the table's first place.
    fn kinds(&self) -> Result<Vec<(String, String)>> {
        let mut all: Vec<(String, String)> = Vec::new();
        for row in self.rows() {
            let kind = (row.word("samples")?.to_owned(), row.word("neighbours")?.to_owned());
            if !all.contains(&kind) {
                all.push(kind);
            }
        }
        Ok(all)
    }
}

fn name(row: Row<'_>, column: &str) -> Result<String> {
    Ok(row.word(column)?.replace(';', ","))
}

fn choice(row: Row<'_>, column: &str, errors: [&str; 2]) -> Result<String> {
    let [raw, filtered] = errors.map(|error| row.number::<f64>(error).map(two_digits));
    Ok(format!("{}: {}, {}", name(row, column)?, raw?, filtered?))
}
