//! Every kind of samples with every estimator.

use super::decisions::two_digits;
use crate::chapters::chapter::{Cell, Chapter, row};
use crate::chapters::statistics::Estimate;
use crate::measure::table::{Row, Table};
use anyhow::Result;

/// An estimator as the program's table names it: kind, coordinates regressed, order.
type Method = (String, u32, u32);

/// One kind of samples with one estimator, at one number of samples.
struct Of {
    /// Geometric means over integrands, with Student's intervals of logarithms.
    raw: Estimate,
    filtered: Estimate,
    worst: f64,
    ns: f64,
    draw_ns: f64,
}

pub(super) fn write(table: &Table, chapter: &mut Chapter) -> Result<()> {
    introduce(table, chapter)?;
    for dims in table.distinct("dims")? {
        chapter.section(&format!("Samplers and estimators, {dims} dims"), "");
        let (mut rows, mut times) = (Vec::new(), Vec::new());
        let counts = table.distinct("n")?;
        for source in table.distinct("samples")? {
            for method in methods(table, dims, source)? {
                let name = name(&method, dims);
                let mut cells: Vec<Cell> = row![source.replace(';', ","), name.as_str()];
                let mut time: Vec<Cell> = row!["estimate", name.as_str()];
                for n in &counts {
                    let Some(of) = of(table, dims, n, source, &method)? else {
                        cells.push(Cell::Missing);
                        time.push(Cell::Missing);
                        continue;
                    };
                    let text = [of.raw.value, of.filtered.value, of.worst].map(two_digits);
                    cells.push(format!("{}, {} ({})", text[0], text[1], text[2]).into());
                    time.push(two_digits(of.ns).into());
                }
                if source == "independent" {
                    times.push(time);
                }
                rows.push(cells);
            }
            let mut time: Vec<Cell> = row!["drawing", source.replace(';', ",")];
            for n in &counts {
                let mean = ("Mean".to_owned(), dims.parse()?, 0);
                time.push(of(table, dims, n, source, &mean)?.map(|of| two_digits(of.draw_ns)).into());
            }
            if time[2..].iter().any(|cell| matches!(cell, Cell::Word(_))) {
                times.push(time);
            }
        }
        let headings: Vec<String> = counts.iter().map(|n| format!("n = {n}")).collect();
        let columns = |first: [&'static str; 2]| -> Vec<&str> {
            first.into_iter().chain(headings.iter().map(String::as_str)).collect()
        };
        chapter.table("grid", &columns(["samples", "estimator"]), 2, rows);
        chapter.table("times", &columns(["of", ""]), 2, times);
    }
    Ok(())
}

fn introduce(table: &Table, chapter: &mut Chapter) -> Result<()> {
    chapter.section("Samplers with estimators", "");
    let first = table.distinct("dims")?.into_iter().next().unwrap_or_default();
    let mean = ("Mean".to_owned(), first.parse()?, 0);
    let integrands = of(table, first, "1", "independent", &mean)?.map_or(0, |of| of.raw.seeds);
    chapter.setting("integrands of a cell", integrands);
    Ok(())
}

fn method(row: Row<'_>) -> Result<Method> {
    Ok((row.word("estimator")?.to_owned(), row.number("regressed")?, row.number("order")?))
}

/// All estimators of a kind of samples, at any number of them: the plain mean first.
fn methods(table: &Table, dims: &str, source: &str) -> Result<Vec<Method>> {
    let mut all = Vec::new();
    for row in table.rows().filter(|row| row.has(&[("dims", dims), ("samples", source)])) {
        let method = method(row)?;
        if !all.contains(&method) {
            all.push(method);
        }
    }
    let kind = |name: &str| ["Mean", "PerPixel", "Blocks", "Windows"].iter().position(|kind| *kind == name);
    all.sort_by_key(|(name, regressed, order)| (kind(name), regressed.to_string() != dims, *order));
    Ok(all)
}

fn name((kind, regressed, order): &Method, dims: &str) -> String {
    let of = if regressed.to_string() == dims { String::new() } else { format!(" of the first {regressed} dims") };
    match kind.as_str() {
        "Mean" => "plain mean".to_owned(),
        "PerPixel" => format!("per pixel, order {order}{of}"),
        "Blocks" => format!("shared, stride 8, order {order}{of}"),
        _ => format!("shared, stride 4, order {order}{of}"),
    }
}

/// None where it was not measured.
fn of(table: &Table, dims: &str, n: &str, source: &str, wanted: &Method) -> Result<Option<Of>> {
    let (kind, regressed, order) = (wanted.0.as_str(), wanted.1.to_string(), wanted.2.to_string());
    let wanted = [
        ("dims", dims),
        ("n", n),
        ("samples", source),
        ("estimator", kind),
        ("regressed", regressed.as_str()),
        ("order", order.as_str()),
    ];
    let rows: Vec<Row<'_>> = table.rows().filter(|row| row.has(&wanted)).collect();
    let Some(first) = rows.first() else { return Ok(None) };
    let numbers = |column: &str| rows.iter().map(|row| row.number(column)).collect::<Result<Vec<f64>>>();
    let (raw, filtered, channels) = (numbers("raw")?, numbers("filtered")?, 3);
    // Of few pixels: first the mean of what is alike, then the logarithm.
    let alike =
        |all: &[f64]| all.chunks(channels).map(|of| of.iter().sum::<f64>() / of.len() as f64).collect::<Vec<_>>();
    Ok(Some(Of {
        raw: Estimate::geometric_mean(&raw),
        filtered: Estimate::geometric_mean(&alike(&filtered)),
        worst: first.number("worst")?,
        ns: first.number("ns")?,
        draw_ns: first.number("draw_ns")?,
    }))
}
