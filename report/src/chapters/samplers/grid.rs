//! Every kind of samples with every estimator.

use super::decisions::two_digits;
use crate::chapters::chapter::{Cell, Chapter, row};
use crate::chapters::statistics::Estimate;
use crate::measure::output::Output;
use crate::measure::plot::{Axis, Plot, Series};
use crate::measure::table::{Row, Table};
use anyhow::Result;
use std::fmt::Write;

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

pub(super) fn write(output: &Output, table: &Table, chapter: &mut Chapter) -> Result<()> {
    introduce(table, chapter)?;
    let mut csv =
        "dims,n,samples,estimator,raw,raw_low,raw_high,filtered,filtered_low,filtered_high,worst,ns\n".to_owned();
    for dims in table.distinct("dims")? {
        chapter.section(&format!("Samplers and estimators, {dims} dims"), "");
        let file = format!("samplers-grid-{dims}d.svg");
        let (mut rows, mut times, mut series) = (Vec::new(), Vec::new(), Vec::new());
        let counts = table.distinct("n")?;
        for (colour, source) in table.distinct("samples")?.into_iter().enumerate() {
            for method in methods(table, dims, source)? {
                let name = name(&method, dims);
                let mut cells: Vec<Cell> = row![source.replace(';', ","), name.as_str()];
                let mut time: Vec<Cell> = row!["estimate", name.as_str()];
                let mut points = Vec::new();
                for n in &counts {
                    let Some(of) = of(table, dims, n, source, &method)? else {
                        cells.push(Cell::Missing);
                        time.push(Cell::Missing);
                        continue;
                    };
                    let text = [of.raw.value, of.filtered.value, of.worst].map(two_digits);
                    cells.push(format!("{}, {} ({})", text[0], text[1], text[2]).into());
                    time.push(two_digits(of.ns).into());
                    let count: f64 = n.parse()?;
                    points.push((count, of.raw.value / count));
                    write!(csv, "{dims},{n},{source},{}", name.replace(',', ";"))?;
                    for Estimate { value, low, high, .. } in [of.raw, of.filtered] {
                        write!(csv, ",{value:.4e},{low:.4e},{high:.4e}")?;
                    }
                    writeln!(csv, ",{:.3},{:.1}", of.worst, of.ns)?;
                }
                if is_drawn(source, &method, dims) {
                    let name = format!("{source}, {}", short(&method));
                    let (colour, dashed) = (Some(colour), method.0 != "Mean");
                    // Estimators of the same samples share the colour; shared fits have none of the plain mean's line.
                    let colour = if method.0 == "Blocks" { colour.map(|colour| colour + 4) } else { colour };
                    series.push(Series { name, points, dashed, colour, ..Series::default() });
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
        chapter.paragraph("Nanoseconds per sample:");
        chapter.table("times", &columns(["of", ""]), 2, times);
        output.write_text(&file, &plot(dims, &series)?)?;
        chapter.picture(&file, &format!("raw error against samples per pixel, by samples and estimator, {dims} dims"));
    }
    output.write_text("samplers-grid.csv", &csv)
}

fn introduce(table: &Table, chapter: &mut Chapter) -> Result<()> {
    chapter.section("Samplers with estimators", "");
    let first = table.distinct("dims")?.into_iter().next().unwrap_or_default();
    let mean = ("Mean".to_owned(), first.parse()?, 0);
    let integrands = of(table, first, "1", "independent", &mean)?.map_or(0, |of| of.raw.seeds);
    let integrands = chapter.setting("integrands of a cell", integrands);
    chapter.setting("standard deviation of the filter, pixels", 2.1);
    chapter.setting("pixels in a stripe", 24);
    chapter.setting("pixels on a side of the largest image", 64);
    chapter.setting("movement and scaling, denominators", vec![64, 32]);
    chapter.setting("channels", 3);
    chapter.setting("nothing to gain", 1);
    chapter.setting("strides", vec![8, 4]);
    let confidence = chapter.setting("confidence of intervals, percent", 95);
    chapter.paragraph(&format!(
        "Images of 24 x 24 to 64 x 64 pixels, each with n samples; {integrands} integrands for each cell, three of each kind estimated together as \
         colours are: half-spaces, Gaussian bumps, products of cosines, sums of such functions of two coordinates each, of falling weight, \
         as a path's vertices are. Their parameters move slowly from pixel to pixel (the first coordinate by 1/64 a pixel, the scale by 1/32), \
         or jump at slanted edges, 24 pixels apart, of which the estimators know nothing. Seeds are fixed, means and variances exact."
    ));
    chapter.list(&[
        "A cell is \"raw, filtered (worst)\": the mean squared error over that of the plain mean of as many independent samples; the same of \
         the image filtered by a Gaussian of 2.1 pixels; both geometric means over integrands. Worst: the largest ratio, over the integrands, of \
         the raw error to that of the plain mean of the same samples (for the plain mean itself: of independent ones)."
            .to_owned(),
        format!(
            "`samplers-grid.csv` has {confidence} % intervals over integrands. Filtered errors of small images are few numbers: the plain mean of \
             independent samples, which should have 1, shows it."
        ),
        "per pixel: the robust estimator on each pixel's samples, told that they are independent; shared, stride 8 or 4: windows of 8 x 8 \
         pixels, side by side or overlapping by half. tile: of as many samples, or of 16, continued; each pair of coordinates is a domain. \
         Sobol per pixel: Owen-scrambled in each pixel."
            .to_owned(),
        "Cells that would take most of the time are measured with `--full` alone: overlapping windows of more than 30 functions or of 64 samples \
         and more, and more than 100 functions from 64 samples on."
            .to_owned(),
        "Times are taken on one thread while nothing else runs, each the median of images of independent samples, one of each family of integrands; drawing the median of several rounds.".to_owned(),
    ]);
    chapter.setting("functions beyond which overlapping windows are left out", 30);
    chapter.setting("functions beyond which many samples are left out", 100);
    chapter.setting("samples from which both are left out", 64);
    chapter.setting("samples of the largest tile", 16);
    chapter.paragraph("In the plots errors are divided by n, so that each line falls as samples are added.");
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

fn short((kind, ..): &Method) -> &'static str {
    match kind.as_str() {
        "Mean" => "mean",
        "PerPixel" => "per pixel",
        _ => "shared",
    }
}

/// Three kinds of samples with three estimators each, of the order that is best in most cells.
fn is_drawn(source: &str, (kind, regressed, order): &Method, dims: &str) -> bool {
    let best = match dims {
        "2" | "4" => 3,
        "8" => 2,
        _ => 1,
    };
    ["independent", "Sobol per pixel", "tile"].contains(&source)
        && regressed.to_string() == dims
        && (kind == "Mean" || (*order == best && kind != "Windows"))
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
    let ones = vec![1.0; rows.len()];
    Ok(Some(Of {
        raw: Estimate::mean_ratio(&raw, &ones),
        filtered: Estimate::mean_ratio(&alike(&filtered), &ones),
        worst: first.number("worst")?,
        ns: first.number("ns")?,
        draw_ns: first.number("draw_ns")?,
    }))
}

fn plot(dims: &str, series: &[Series]) -> Result<String> {
    let title = format!("Raw error, {dims} dims");
    let axis = |label| Axis { label, logarithmic: true, range: None };
    let y = axis("mean squared error over that of one random sample");
    Plot { title: &title, x: axis("samples per pixel"), y, series }.svg()
}
