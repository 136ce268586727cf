//! Gradients of minibatches: optimal MIS beside importance sampling.

use crate::chapters::chapter::{Cell, Chapter, headings, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::statistics::Estimate;
use crate::measure::table::Table;
use anyhow::{Context, Result};

const ONE: &str = "one table of norms";
/// The program's columns of several tables.
const SOLVERS: [&str; 3] = ["balance", "plain", "ridge"];

pub(super) fn polynomial(chapter: &mut Chapter, table: &Table) -> Result<()> {
    chapter.section("Optimal MIS gradients", "");
    let steps = table.distinct("steps")?;
    let mean = |heading: &str, keys: &[(&str, &str)]| -> Result<Cell> {
        let values: Vec<f64> =
            table.rows().filter(|row| row.has(keys)).map(|row| row.number(heading)).collect::<Result<_>>()?;
        Ok(Figure::brief(Estimate::mean(&values), Unit::Number).into())
    };
    let techniques = table.distinct("techniques")?;
    let first = *techniques.first().context("the program has measured no techniques")?;
    let mut rows: Vec<Vec<Cell>> = vec![row![ONE]];
    for &step in &steps {
        rows[0].push(mean("one", &[("steps", step), ("techniques", first)])?);
    }
    for &count in &techniques {
        for solver in SOLVERS {
            let mut cells = row![format!("{count} signed tables, {solver}")];
            for &step in &steps {
                cells.push(mean(solver, &[("steps", step), ("techniques", count)])?);
            }
            rows.push(cells);
        }
    }
    let columns = headings(&["tables"], steps.iter().map(|step| format!("{step} steps")));
    chapter.table("polynomial", &columns, 1, rows);
    Ok(())
}

pub(super) fn classifier(chapter: &mut Chapter, table: &Table) -> Result<()> {
    let names = [
        ("one", ONE.to_owned()),
        ("balance", "10 signed tables, balance".to_owned()),
        ("plain", "10 signed tables, plain".to_owned()),
        ("ridge", "10 signed tables, ridge".to_owned()),
    ];
    let mut columns = vec!["tables".to_owned()];
    let mut rows: Vec<Vec<Cell>> = names.iter().map(|(_, name)| row![name.clone()]).collect();
    for batch in table.distinct("batch")? {
        for steps in table.distinct("steps")? {
            columns.push(format!("batch {batch}, {steps} steps"));
            let found = table.find(&[("batch", batch), ("steps", steps)])?;
            for ((heading, _), cells) in names.iter().zip(&mut rows) {
                cells.push(Figure::exact(found.number(heading)?, Unit::Number).into());
            }
        }
    }
    chapter.table("classifier", &columns, 1, rows);
    Ok(())
}

pub(super) fn bias(chapter: &mut Chapter, table: &Table) -> Result<()> {
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    for batch in table.distinct("batch")? {
        let mut cells = row![format!("batch {batch}")];
        for solver in ["ridge", "plain"] {
            let found = table.find(&[("batch", batch), ("solver", solver)])?;
            for heading in ["bias", "error"] {
                cells.push(Figure::exact(found.number(heading)?, Unit::Number).into());
            }
        }
        rows.push(cells);
    }
    let columns = ["batch", "ridge: bias", "ridge: RMS error", "plain: bias", "plain: RMS error"];
    chapter.table("gradient bias", &columns, 1, rows);
    Ok(())
}
