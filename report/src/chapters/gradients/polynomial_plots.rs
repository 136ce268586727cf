//! fit_polynomial.c: loss against steps, and errors of the gradient by coefficient (figure 6.10).

use crate::measure::plot::{Plot, Series};
use crate::measure::table::Table;
use anyhow::Result;

/// A method has the same colour in every plot.
const METHODS: [&str; 8] = ["exact", "uniform", "is", "balance2", "omis2", "balance4", "omis4", "omis4-beta"];

fn coloured(mut series: Series) -> Series {
    series.colour = METHODS.iter().position(|method| *method == series.name);
    series
}

/// The means over the seeds: single problems differ a hundredfold, their order does not.
fn losses(csv: &str) -> Result<Vec<Series>> {
    let rows = Table::parse(csv, "the trainer's table", ',')?.only("seed", "mean")?;
    let line = |method: &str| rows.only("method", method)?.line(method, "step", "step", ("loss", 1.0)).map(coloured);
    rows.distinct("method")?.into_iter().map(line).collect()
}

/// The same over the loss that the exact gradient has at the same step.
pub(super) fn ratio_plot(csv: &str) -> Result<String> {
    let mut series = losses(csv)?;
    let exact: Vec<_> = series.first().map(|exact| exact.points.clone()).unwrap_or_default();
    for (point, exact) in series.iter_mut().flat_map(|series| series.points.iter_mut().zip(&exact)) {
        point.1 /= exact.1;
    }
    Plot {
        title: "Polynomial of order 6, batches of 32, Adam",
        x: "steps",
        y: "mean loss / the exact gradient's",
        logarithmic: false,
        series: &series,
    }
    .svg()
}

/// At the last state.
pub(super) fn error_plot(csv: &str) -> Result<String> {
    let rows = Table::parse(csv, "the trainer's table", ',')?;
    let last = rows.distinct("step")?.pop().unwrap_or_default();
    let rows = rows.only("step", last)?;
    let line = |method: &str| -> Result<Series> {
        let rows = rows.only("method", method)?;
        Ok(coloured(rows.line(method, "coefficient", "coefficient", ("error", 1.0))?))
    };
    let series: Vec<Series> = rows.distinct("method")?.into_iter().map(line).collect::<Result<_>>()?;
    let title = format!("Error of the gradient's estimate, step {last}");
    Plot {
        title: &title,
        x: "power whose coefficient it is",
        y: "mean squared error / uniform's",
        logarithmic: true,
        series: &series,
    }
    .svg()
}
