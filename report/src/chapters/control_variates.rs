//! The chapter of the estimators on functions whose integrals are known: error against time, and how it falls with
//! samples.

mod cells;
mod frontier;

use super::prelude::*;
use super::program;
use super::report::Report;
use cells::{Cells, DEFAULT, MEAN, Summary};

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let tables = program::measure(report)?;
    let cells = Cells::new(&tables.read("grid")?, &tables.read("recommended")?)?;
    let (mut chapter, _) = report.described(&|_| Ok(grid(&cells)))?;
    chapter.setting("dims of the table of estimators, at most", DIMS);
    judge(&tables.read("must_reach")?)?.write(&mut chapter);
    frontier::write(&mut chapter, &cells);
    integrands(&mut chapter, &cells);
    precision(&mut chapter, &tables.read("cells")?)?;
    Ok(chapter)
}

/// What was to be reached: the bounds that the project has set itself, as the benchmark `speed_error` judges them.
fn judge(table: &Table) -> Result<Targets> {
    let mut targets = Targets::default();
    for row in table.rows() {
        let half = row.optional("half_width")?.unwrap_or(0.0);
        let estimate = Estimate::of_logarithm(row.number("value")?, half, if half > 0.0 { 2 } else { 1 });
        let unit = if row.word("unit")? == "ns" { Unit::Nanoseconds } else { Unit::Ratio };
        let place = Some(row.word("note")?).filter(|note| !note.is_empty()).unwrap_or("all");
        targets.at_most(row.word("target")?, place, estimate, unit, row.number("bound")?);
    }
    Ok(targets)
}

/// Up to so many dims orders 1, 2, 3 and 5 have at most as many terms as the library admits.
const DIMS: usize = 3;

/// Of each setting the geometric mean of the error, and the worst.
fn grid(cells: &Cells) -> Table {
    let mut all = Table::new("settings", "n | estimator | basis | order | errors");
    for &n in &cells.counts {
        for Summary { setting, ratio, worst, .. } in cells.summaries(|dims| dims <= DIMS, n) {
            let errors = [ratio.value, worst.value].map(|value| Unit::Ratio.text(value)).join("; ");
            let (n, order) = (n.to_string(), setting.order.to_string());
            all.push(vec![n, setting.estimator, setting.basis, order, errors]);
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
        let small = |value: f64| if value < 0.0095 { Unit::Error } else { Unit::Ratio };
        rows.push(row![
            mean.integrand.clone(),
            mean.dims as u32,
            mean.n as u32,
            if advised.estimator == DEFAULT { format!("order {}", advised.order) } else { "MC".to_owned() },
            Figure::new(own.ratio, small(own.ratio.value)),
            Figure::exact(own.ns, Unit::Nanoseconds),
            cost.map(|cost| Figure::exact(cost, Unit::Nanoseconds)),
            best.setting.name(),
            Figure::brief(best.ratio, small(best.ratio.value)),
            Figure::exact(best.ns, Unit::Nanoseconds),
        ]);
    }
    let columns = "integrand | dims | samples | recommended | its error | its ns | pays from, ns | least error by | \
                   that error | its ns";
    chapter.table("each integrand", columns, 1, rows);
}

/// What `f32` accumulation costs in error and saves in time.
fn precision(chapter: &mut Chapter, table: &Table) -> Result<()> {
    chapter.section("f32 against f64");
    let mut rows = Vec::new();
    for (method, degree) in ["robust", "least squares"].into_iter().flat_map(|of| ["2", "3"].map(|degree| (of, degree)))
    {
        let narrow = table.of(&[("method", &format!("{method} f32")), ("degree", degree)]);
        let wide = table.of(&[("method", method), ("degree", degree)]);
        let place = |row: &Row| -> Result<String> { Ok(format!("{}, n = {}", row.word("integrand")?, row.word("n")?)) };
        let largest = |column: &str| -> Result<Option<(f64, String)>> {
            let each = narrow.rows().map(|row| Ok((row.number::<f64>(column)?, place(&row)?)));
            let mut each = each.collect::<Result<Vec<_>>>()?;
            each.retain(|(value, _)| value.is_finite() && *value > 0.0);
            // Of equal ones the first.
            Ok(each.into_iter().rev().max_by(|a, b| a.0.total_cmp(&b.0)))
        };
        let Some((worst, at_worst)) = largest("rmse_to_f64")? else { continue };
        let (difference, at_difference) = largest("difference_from_f64")?.unwrap_or_default();
        let ratios = narrow.numbers("rmse_to_f64")?.into_iter().filter(|ratio| ratio.is_finite() && *ratio > 0.0);
        let times = narrow.numbers("ns_per_sample")?.into_iter().zip(wide.numbers("ns_per_sample")?);
        let (ratios, times): (Vec<f64>, Vec<f64>) =
            (ratios.collect(), times.map(|(narrow, wide)| narrow / wide).collect());
        let ratio = |value: f64| Figure::exact(value, Unit::Ratio);
        rows.push(row![
            method,
            degree,
            ratio(Estimate::geometric_mean(&ratios).value),
            ratio(worst),
            at_worst,
            Figure::exact(difference, Unit::Error),
            at_difference,
            ratio(Estimate::geometric_mean(&times).value),
            ratio(times.iter().copied().fold(0.0, f64::max)),
        ]);
    }
    let columns =
        "estimator | order | RMSE over f64's | worst | where | difference | where | time over f64's | largest";
    chapter.table("f32 against f64", columns, 1, rows);
    Ok(())
}
