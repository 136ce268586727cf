//! The table of all cells.

use crate::study::{CHANNELS, Cell, Errors, Kind};
use anyhow::Result;
use noisefloor_tests::statistics::{geometric_mean, median};
use std::fmt::Write;

/// The figures of a cell.
pub(crate) struct Summary {
    pub(crate) raw: f64,
    /// The largest ratio to the plain mean of the same samples; the plain mean's own is to that of independent samples.
    pub(crate) worst: f64,
    pub(crate) filtered: f64,
    pub(crate) ns: f64,
}

pub(crate) fn summary(cell: &Cell, cells: &[Cell]) -> Summary {
    let same = |other: &&Cell| {
        (other.dims, other.n, other.source, other.method.kind) == (cell.dims, cell.n, cell.source, Kind::Mean)
    };
    let mean = cells.iter().find(same).filter(|_| cell.method.kind != Kind::Mean);
    let raw: Vec<f64> = cell.errors.iter().map(|errors| errors.raw).collect();
    let own = |index: usize| mean.map_or(1.0, |mean| mean.errors[index].raw);
    let worst = cell.errors.iter().enumerate().map(|(index, errors)| errors.raw / own(index)).fold(0.0, f64::max);
    let same = |other: &&Cell| (other.dims, other.n, other.method) == (cell.dims, cell.n, cell.method);
    let times: Vec<f64> = cells.iter().filter(same).flat_map(|other| other.ns.iter().copied()).collect();
    // A filtered image has few independent pixels, and a logarithm of few is too small: first the mean of what is
    // alike.
    let filtered: Vec<f64> = cell
        .errors
        .chunks(CHANNELS)
        .map(|all| all.iter().map(|e| e.filtered).sum::<f64>() / all.len() as f64)
        .collect();
    Summary { raw: geometric_mean(&raw), worst, filtered: geometric_mean(&filtered), ns: median(&times) }
}

/// Every integrand.
pub(crate) fn csv(cells: &[Cell]) -> Result<String> {
    let mut out = "dims,n,samples,estimator,regressed,order,family,variant,raw,filtered,worst,ns,draw_ns\n".to_owned();
    for cell in cells {
        let s = summary(cell, cells);
        for Errors { family, variant, raw, filtered } in &cell.errors {
            let (source, method) = (cell.source.name().replace(',', ";"), cell.method);
            write!(out, "{},{},{source},{:?},{},{},", cell.dims, cell.n, method.kind, method.regressed, method.order)?;
            write!(out, "{},{},{raw:.5e},{filtered:.5e},", family.name(), variant.name())?;
            writeln!(out, "{:.4},{:.2},{:.2}", s.worst, s.ns, median(&cell.draw_ns))?;
        }
    }
    Ok(out)
}
