//! The chapter of the estimators on functions whose integrals are known: error against time, and how it falls with
//! samples.

mod cells;
mod frontier;

use super::prelude::*;
use super::program;
use cells::{Cells, MEAN};
use itertools::{Itertools, iproduct};

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let tables = program::measure(report)?;
    let cells = Cells::new(&tables.read("grid")?, &tables.read("recommended")?)?;
    let mut chapter = report.described(&|_| Ok(grid(&cells)))?;
    chapter.setting("dims of the table of estimators, at most", DIMS);
    bounds(&mut chapter, &tables.read("must_reach")?)?;
    chapter.judge();
    frontier::write(&mut chapter, &cells);
    integrands(&mut chapter, &cells);
    precision(&mut chapter, &tables.read("cells")?)?;
    Ok(chapter)
}

/// What was to be reached: the bounds that the project has set itself, as the benchmark `speed_error` judges them.
fn bounds(chapter: &mut Chapter, table: &Table) -> Result<()> {
    for row in table.rows() {
        let half = row.optional("half_width")?.unwrap_or(0.0);
        let estimate = Estimate::of_logarithm(row.number("value")?, half, if half > 0.0 { 2 } else { 1 });
        let unit = if row.word("unit")? == "ns" { Unit::Nanoseconds } else { Unit::Ratio };
        let place = Some(row.word("note")?).filter(|note| !note.is_empty()).unwrap_or("all");
        chapter.target(row.word("target")?, place, estimate, unit, Bound::AtMost(row.number("bound")?));
    }
    Ok(())
}

/// Up to so many dims orders 1, 2, 3 and 5 have at most as many terms as the library admits.
const DIMS: usize = 3;

/// Of each setting the geometric mean of the error, and the worst.
fn grid(cells: &Cells) -> Table {
    let mut all = Table::new("settings", "n | estimator | basis | order | errors");
    for &n in &cells.counts {
        for of in cells.summaries(|dims| dims <= DIMS, n) {
            let errors = [of.ratio(), of.worst().ratio].map(|ratio| Unit::Ratio.text(ratio.value)).join("; ");
            let (n, order) = (n.to_string(), of.setting.order.to_string());
            all.push([&n, &of.setting.estimator, &of.setting.basis, &order, &errors]);
        }
    }
    all
}

/// Each integrand: the recommended setting, and the one of least error.
fn integrands(chapter: &mut Chapter, cells: &Cells) {
    chapter.section("Each integrand");
    let mut rows = Vec::new();
    for mean in cells.all.iter().filter(|cell| cell.setting.estimator == MEAN) {
        let here = || cells.all.iter().filter(|cell| cell.integrand == mean.integrand && cell.n == mean.n);
        let advised = cells.recommended(mean.dims, mean.n);
        let Some(own) = here().find(|cell| cell.setting == advised) else { continue };
        let Some(best) = here().min_by(|a, b| a.ratio.value.total_cmp(&b.ratio.value)) else { continue };
        let square = own.ratio.value.powi(2);
        let cost = (square < 1.0).then(|| ((square * own.ns - own.mean_ns) / (1.0 - square)).max(0.0));
        let unit = |ratio: Estimate| if ratio.value < 0.0095 { Unit::Error } else { Unit::Ratio };
        let ns = |of: f64| Figure::exact(of, Unit::Nanoseconds);
        rows.push(json!([
            mean.integrand,
            mean.dims.to_string(),
            mean.n.to_string(),
            if advised.estimator == MEAN { "MC".to_owned() } else { format!("order {}", advised.order) },
            Figure::new(own.ratio, unit(own.ratio)),
            ns(own.ns),
            cost.map(ns),
            best.setting.name(),
            Figure::brief(best.ratio, unit(best.ratio)),
            ns(best.ns),
        ]));
    }
    let columns = "integrand | dims | samples | recommended | its error | its ns | pays from, ns | least error by | \
                   that error | its ns";
    chapter.table("each integrand", columns, 1, rows);
}

/// What `f32` accumulation costs in error and saves in time.
fn precision(chapter: &mut Chapter, table: &Table) -> Result<()> {
    chapter.section("f32 against f64");
    let mut rows = Vec::new();
    for (method, degree) in iproduct!(["robust", "least squares"], ["2", "3"]) {
        let narrow = table.of(&[("method", &format!("{method} f32")), ("degree", degree)]);
        let wide = table.of(&[("method", method), ("degree", degree)]);
        // Numbers that say something, and where they are from.
        let measured = |column: &str| -> Result<Vec<(f64, String)>> {
            let place =
                |row: &Row| Ok::<_, anyhow::Error>(format!("{}, n = {}", row.word("integrand")?, row.word("n")?));
            let each = narrow.rows().map(|row| Ok((row.number::<f64>(column)?, place(&row)?)));
            each.filter_ok(|(number, _)| number.is_finite() && *number > 0.0).collect()
        };
        // Of equal ones the first.
        let largest = |of: &[(f64, String)]| of.iter().rev().max_by(|a, b| a.0.total_cmp(&b.0)).cloned();
        let (errors, differences) = (measured("rmse_to_f64")?, measured("difference_from_f64")?);
        let Some((worst, at_worst)) = largest(&errors) else { continue };
        let (difference, at_difference) = largest(&differences).unwrap_or_default();
        let times = narrow.numbers("ns_per_sample")?.into_iter().zip(wide.numbers("ns_per_sample")?);
        let times: Vec<f64> = times.map(|(narrow, wide)| narrow / wide).collect();
        let ratio = |value: f64| Figure::exact(value, Unit::Ratio);
        let mean = |of: &[f64]| ratio(Estimate::geometric_mean(of).value);
        rows.push(json!([
            method,
            degree,
            mean(&errors.iter().map(|(error, _)| *error).collect::<Vec<_>>()),
            ratio(worst),
            at_worst,
            Figure::exact(difference, Unit::Error),
            at_difference,
            mean(&times),
            ratio(times.iter().copied().fold(0.0, f64::max)),
        ]));
    }
    let columns =
        "estimator | order | RMSE over f64's | worst | where | difference | where | time over f64's | largest";
    chapter.table("f32 against f64", columns, 1, rows);
    Ok(())
}
