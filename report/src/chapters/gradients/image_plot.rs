//! fit_image.cpp: a photograph learned by a network (figure 6.13): losses, errors of the gradient, and pictures.

use crate::measure::plot::{Plot, Series};
use crate::measure::table::Table;
use anyhow::Result;

const METHODS: [&str; 4] = ["uniform", "is", "omis3", "omis6"];
pub(super) fn loss_plot(csv: &str, strata: &str) -> Result<String> {
    let mut series = Vec::new();
    for (csv, name, dashed) in [(csv, "", false), (strata, ", strata", true)] {
        let rows = Table::parse(csv, "the trainer's table", ',')?;
        for method in rows.distinct("method")? {
            let mut line =
                rows.only("method", method)?.line(&format!("{method}{name}"), "step", "step", ("psnr", 1.0))?;
            line.band.clear(); // The seeds' networks differ more than the methods do.
            line.dashed = dashed;
            line.colour = METHODS.iter().position(|other| *other == method);
            series.push(line);
        }
    }
    let series: Vec<Series> = series;
    Plot {
        title: "A photograph, batches of 256 pixels, Adam",
        x: "steps",
        y: "PSNR, dB",
        logarithmic: false,
        series: &series,
    }
    .svg()
}
