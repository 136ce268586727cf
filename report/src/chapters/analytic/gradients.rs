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
    let (part, points, batch) = (
        chapter.setting("uniform fraction of every table", 0.2),
        chapter.setting("points of the polynomial", 2000),
        chapter.setting("batch of the polynomial", 32),
    );
    let (order, problems) = (chapter.setting("order of the polynomial", 6), chapter.setting("problems", 3));
    chapter.paragraph(&format!(
        "Squared error of the gradient over uniform sampling's at the same state, a fraction of {part} uniform in every table. First a regression by a polynomial of order \
         {order}, {points} points, batches of {batch}, after steps of gradient descent; tables from the derivative by the coefficients, one of \
         norms (importance sampling) or one of each sign; mean of {problems} problems.",
    ));
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
    let (classes, weights, items) =
        (chapter.setting("classes", 5), chapter.setting("weights", 30), chapter.setting("items", 1000));
    chapter
        .paragraph(&format!("The same of a linear classifier of {classes} classes, {weights} weights, {items} items."));
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
    let (tables, steps) =
        (chapter.setting("tables of the bias", 4), chapter.setting("steps before the bias is measured", 300));
    chapter.paragraph(&format!(
        "Bias, and root mean squared error, over the gradient's norm: a polynomial after {steps} steps, where the exact gradient is nearly zero, {tables} signed tables.",
    ));
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
