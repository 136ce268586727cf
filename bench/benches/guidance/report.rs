//! The tables: Markdown to read, CSV to look further into.

use crate::samplers::Source;
use crate::study::{CHANNELS, COUNTS, Cell, DIMS, Kind};
use anyhow::Result;
use noisefloor_tests::statistics::{geometric_mean, median};
use std::fmt::Write;

/// The figures of a cell.
pub(crate) struct Summary {
    pub(crate) raw: f64,
    /// The largest ratio to the plain mean of the same samples; the plain mean's own is to that of independent samples.
    pub(crate) worst: f64,
    pub(crate) filtered: f64,
    worst_filtered: f64,
    pub(crate) ns: f64,
}

pub(crate) fn summary(cell: &Cell, cells: &[Cell]) -> Summary {
    let same = |other: &&Cell| {
        (other.dims, other.n, other.source, other.method.kind) == (cell.dims, cell.n, cell.source, Kind::Mean)
    };
    let mean = cells.iter().find(same).filter(|_| cell.method.kind != Kind::Mean);
    let all = |of: fn(&crate::study::Errors) -> f64| cell.errors.iter().map(of).collect::<Vec<f64>>();
    let worst = |of: fn(&crate::study::Errors) -> f64| {
        let own = |index: usize| mean.map_or(1.0, |mean| of(&mean.errors[index]));
        cell.errors.iter().enumerate().map(|(index, errors)| of(errors) / own(index)).fold(0.0, f64::max)
    };
    let same = |other: &&Cell| (other.dims, other.n, other.method) == (cell.dims, cell.n, cell.method);
    let times: Vec<f64> = cells.iter().filter(same).flat_map(|other| other.ns.iter().copied()).collect();
    // A filtered image has few independent pixels, and a logarithm of few is too small: first the mean of what is
    // alike.
    let filtered: Vec<f64> = cell
        .errors
        .chunks(CHANNELS)
        .map(|all| all.iter().map(|e| e.filtered).sum::<f64>() / all.len() as f64)
        .collect();
    Summary {
        raw: geometric_mean(&all(|errors| errors.raw)),
        worst: worst(|errors| errors.raw),
        filtered: geometric_mean(&filtered),
        worst_filtered: worst(|errors| errors.filtered),
        ns: median(&times),
    }
}

/// Three significant digits without a leading zero.
pub(crate) fn figure(value: f64) -> String {
    let text = match value {
        9.95.. => format!("{value:.0}"),
        0.995.. => format!("{value:.1}"),
        0.1.. => format!("{value:.2}"),
        0.01.. => format!("{value:.3}"),
        0.001.. => format!("{value:.4}"),
        _ => return format!("{value:.0e}"),
    };
    text.strip_prefix('0').map_or(text.clone(), str::to_owned)
}

/// The dims that there are.
fn measured(cells: &[Cell]) -> impl Iterator<Item = usize> {
    DIMS.into_iter().filter(|&dims| cells.iter().any(|cell| cell.dims == dims))
}

pub(crate) fn markdown(cells: &[Cell]) -> Result<String> {
    let mut out = String::new();
    for dims in measured(cells) {
        writeln!(out, "### {dims} dims\n")?;
        writeln!(out, "| samples | estimator |{}", COUNTS.map(|n| format!(" n = {n} |")).concat())?;
        writeln!(out, "|---|---|{}", "---|".repeat(COUNTS.len()))?;
        rows(cells, dims, &mut out, |s| format!("{}, {} ({})", figure(s.raw), figure(s.filtered), figure(s.worst)))?;
        writeln!(out)?;
    }
    writeln!(out, "### Nanoseconds per sample\n")?;
    for dims in measured(cells) {
        writeln!(out, "| {dims} dims | |{}", COUNTS.map(|n| format!(" n = {n} |")).concat())?;
        writeln!(out, "|---|---|{}", "---|".repeat(COUNTS.len()))?;
        let independent: Vec<&Cell> =
            cells.iter().filter(|cell| cell.source == Source::Independent && cell.dims == dims).collect();
        line("estimate", &independent, cells, dims, &mut out, |s| figure(s.ns))?;
        for source in Source::ALL {
            let here = |n: usize| {
                let mut here = cells.iter().filter(|cell| (cell.dims, cell.n, cell.source) == (dims, n, source));
                here.next().map_or(" – |".to_owned(), |cell| format!(" {} |", figure(median(&cell.draw_ns))))
            };
            if cells.iter().any(|cell| (cell.dims, cell.source) == (dims, source)) {
                writeln!(out, "| drawing | {} |{}", source.name(), COUNTS.map(here).concat())?;
            }
        }
        writeln!(out)?;
    }
    Ok(out)
}

fn rows(cells: &[Cell], dims: usize, out: &mut String, text: impl Fn(&Summary) -> String) -> Result<()> {
    for source in Source::ALL {
        let here: Vec<&Cell> = cells.iter().filter(|cell| cell.source == source && cell.dims == dims).collect();
        line(source.name(), &here, cells, dims, out, &text)?;
    }
    Ok(())
}

/// A row for each method.
fn line(
    label: &str,
    here: &[&Cell],
    cells: &[Cell],
    dims: usize,
    out: &mut String,
    text: impl Fn(&Summary) -> String,
) -> Result<()> {
    let mut methods = Vec::new();
    for cell in here {
        if !methods.contains(&cell.method) {
            methods.push(cell.method);
        }
    }
    // Where n = 1 has fewer methods, later ones are appended out of order.
    methods.sort_by_key(|method| (method.kind as usize, method.regressed != dims, method.regressed, method.order));
    for method in methods {
        let of = |n: usize| {
            let cell = here.iter().find(|cell| cell.n == n && cell.method == method);
            cell.map_or(" – |".to_owned(), |cell| format!(" {} |", text(&summary(cell, cells))))
        };
        writeln!(out, "| {label} | {} |{}", method.name(dims), COUNTS.map(of).concat())?;
    }
    Ok(())
}

/// Every integrand.
pub(crate) fn csv(cells: &[Cell]) -> Result<String> {
    let mut out =
        "dims,n,samples,estimator,regressed,order,family,variant,raw,filtered,ns,draw_ns,raw_geometric,worst,\
                   filtered_geometric,worst_filtered\n"
            .to_owned();
    for cell in cells {
        let s = summary(cell, cells);
        for errors in &cell.errors {
            let (source, method) = (cell.source.name().replace(',', ";"), cell.method);
            write!(out, "{},{},{source},{:?},{},{},", cell.dims, cell.n, method.kind, method.regressed, method.order)?;
            write!(
                out,
                "{},{},{:.5e},{:.5e},",
                errors.family.name(),
                errors.variant.name(),
                errors.raw,
                errors.filtered
            )?;
            write!(out, "{:.2},{:.2},{:.5e},", s.ns, median(&cell.draw_ns), s.raw)?;
            writeln!(out, "{:.4},{:.5e},{:.4}", s.worst, s.filtered, s.worst_filtered)?;
        }
    }
    Ok(out)
}
