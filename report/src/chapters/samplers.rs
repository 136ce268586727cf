//! The chapter of samplers, and of samplers with estimators.

use super::figure::significant;
use super::prelude::*;
use super::program;

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let tables = program::measure(report)?;
    // What `recommend()` says, what is best, and where that is better by more than its noise.
    let decisions = tables.read("decisions")?.with("shown", shown)?;
    let decisions = decisions.with("better", |row| choice(row, "best", ["best_raw", "best_filtered"]))?;
    let better = decisions.filtered(|row| row.number::<f64>("excess_low").is_ok_and(|low| low > 1.0));
    let mut chapter = report.described(&|name| match name {
        "decisions" => Ok(decisions.clone()),
        "better" => Ok(better.clone()),
        _ => tables.read(name),
    })?;
    let energies = tables.read("energies")?;
    let integrands: usize = energies.rows().next().context("no energies were measured")?.number("integrands")?;
    chapter.setting("integrands of each family, one sample", integrands * energies.distinct("batch")?.len());
    chapter.quote("decisions", Figure::count(decisions.rows().count()));
    chapter.quote("decisions where another was better", Figure::count(better.rows().count()));
    let largest = decisions.numbers("excess")?.into_iter().fold(1.0, f64::max);
    chapter.quote("largest excess of a recommendation", Figure::exact(largest, Unit::Ratio));
    chapter.judge();
    Ok(chapter)
}

/// Of samplers the name alone; of estimators with the errors.
fn shown(row: &Row) -> Result<String> {
    match row.word("neighbours")? {
        "" => name(row, "recommended"),
        _ => choice(row, "recommended", ["raw", "filtered"]),
    }
}

fn name(row: &Row, column: &str) -> Result<String> {
    Ok(row.word(column)?.replace(';', ","))
}

/// What is chosen, and its errors, of which two digits hold.
fn choice(row: &Row, column: &str, errors: [&str; 2]) -> Result<String> {
    let [raw, filtered] = errors.map(|error| row.number(error).map(|error| significant(error, 2)));
    Ok(format!("{}: {}, {}", name(row, column)?, raw?, filtered?))
}
