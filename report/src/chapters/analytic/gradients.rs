//! Gradients of minibatches: optimal MIS beside importance sampling.

use crate::chapters::chapter::{Cell, Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::measure::table::Table;
use anyhow::{Context, Result};

const ONE: &str = "one table of norms";
/// The program's columns of several tables.
const SOLVERS: [&str; 3] = ["balance", "plain", "ridge"];

pub(super) fn polynomial(chapter: &mut Chapter, table: &Table) -> Result<()> {
    chapter.section("Optimal MIS gradients", "");
    let counts = table.distinct("techniques")?;
    let first = *counts.first().context("the program has measured no techniques")?;
    let several = counts.iter().flat_map(|count| SOLVERS.map(|solver| (*count, solver)));
    let several = several.map(|(count, solver)| (row![format!("{count} signed tables, {solver}")], (count, solver)));
    let down = [(row![ONE], (first, "one"))].into_iter().chain(several);
    let steps = table.headings("steps", |steps| format!("{steps} steps"))?;
    chapter.grid("polynomial", &["tables"], down, &steps, |(count, solver), steps| {
        let values = table.numbers_of(solver, &[("steps", steps), ("techniques", count)])?;
        Ok(Figure::mean(&values, Unit::Number).into())
    })
}

pub(super) fn classifier(chapter: &mut Chapter, table: &Table) -> Result<()> {
    let several = SOLVERS.map(|solver| (row![format!("10 signed tables, {solver}")], solver));
    let down = [(row![ONE], "one")].into_iter().chain(several);
    let steps = table.distinct("steps")?;
    let across: Vec<_> = table
        .distinct("batch")?
        .into_iter()
        .flat_map(|batch| steps.iter().map(move |steps| (format!("batch {batch}, {steps} steps"), (batch, *steps))))
        .collect();
    chapter.grid("classifier", &["tables"], down, &across, |solver, (batch, steps)| {
        let found = table.find(&[("batch", batch), ("steps", steps)])?;
        Ok(Figure::exact(found.number(solver)?, Unit::Number).into())
    })
}

pub(super) fn bias(chapter: &mut Chapter, table: &Table) -> Result<()> {
    let down = table.distinct("batch")?.into_iter().map(|batch| (row![format!("batch {batch}")], batch));
    let what = [("bias", "bias"), ("RMS error", "error")];
    let across: Vec<(String, _)> = ["ridge", "plain"]
        .into_iter()
        .flat_map(|solver| what.map(|(words, heading)| (format!("{solver}: {words}"), (solver, heading))))
        .collect();
    chapter.grid("gradient bias", &["batch"], down, &across, |batch, (solver, heading)| -> Result<Cell> {
        let found = table.find(&[("batch", batch), ("solver", solver)])?;
        Ok(Figure::exact(found.number(heading)?, Unit::Number).into())
    })
}
