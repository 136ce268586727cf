//! Errors against samples, as the thesis's figures show them.

use super::cells::{DEFAULT, MEAN, ratio};
use crate::chapters::Report;
use crate::chapters::chapter::{self, Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::statistics::Estimate;
use crate::measure::panels::{Key, Panel, Panels};
use crate::measure::plot::{Axis, Series};
use crate::measure::table::{Row, Table};
use anyhow::Result;
use std::fmt::Write;

/// One point of a plot.
pub(super) struct Point {
    pub(super) figure: String,
    pub(super) panel: String,
    pub(super) x: usize,
    pub(super) n: usize,
    pub(super) estimator: String,
    pub(super) basis: String,
    pub(super) slices: usize,
    pub(super) order: usize,
    pub(super) ratio: Estimate,
    /// RMSE over the integrand's standard deviation.
    pub(super) error: f64,
    pub(super) ns: f64,
}

/// All points of all plots.
pub(super) struct Points(pub(super) Vec<Point>);

impl Points {
    pub(super) fn new(table: &Table) -> Result<Self> {
        let point = |row: Row| -> Result<Point> {
            Ok(Point {
                figure: row.word("figure")?.to_owned(),
                panel: row.word("panel")?.to_owned(),
                x: row.number("x")?,
                n: row.number("n")?,
                estimator: row.word("estimator")?.to_owned(),
                basis: row.word("basis")?.to_owned(),
                slices: row.number("slices")?,
                order: row.number("order")?,
                ratio: ratio(row)?,
                error: row.number::<f64>("rmse")? / row.number::<f64>("deviation")?,
                ns: row.number("ns")?,
            })
        };
        Ok(Self(table.rows().map(point).collect::<Result<_>>()?))
    }

    pub(super) fn of<'a>(&'a self, figure: &'a str) -> impl Iterator<Item = &'a Point> {
        self.0.iter().filter(move |point| point.figure == figure)
    }

    /// Every point, for other programs.
    pub(super) fn csv(&self) -> String {
        let mut out =
            "figure,panel,x,n,estimator,basis,slices,order,ratio,half_width,rmse_over_deviation,ns\n".to_owned();
        for point in &self.0 {
            let Point { figure, panel, x, n, estimator, basis, slices, order, ratio, error, ns } = point;
            let _ = write!(out, "{figure},{panel},{x},{n},{estimator},{basis},{slices},{order},");
            let _ = writeln!(out, "{:.3e},{:.1e},{error:.3e},{ns:.0}", ratio.value, ratio.high - ratio.value);
        }
        out
    }
}

/// How lines are told apart: estimator, basis, order, and what the legend says.
struct Line {
    estimator: &'static str,
    basis: &'static str,
    order: usize,
    name: &'static str,
    colour: usize,
}

const fn line(estimator: &'static str, order: usize, name: &'static str, colour: usize) -> Line {
    Line { estimator, basis: "legendre", order, name, colour }
}

const fn basis(basis: &'static str, name: &'static str, colour: usize) -> Line {
    Line { basis, ..line(DEFAULT, 2, name, colour) }
}

const MC: Line = line(MEAN, 0, "MC", 0);
const DIRECT: &str = "least squares";
const DESCENT: &str = "gradient descent";

/// What the vertical axis shows.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Shown {
    Error,
    Ratio,
    /// The error against time, a sample costing a microsecond.
    ErrorAgainstTime,
}

/// A figure: number in the thesis, heading, text, lines, whether ratios are shown, columns.
struct Figure4 {
    number: &'static str,
    heading: &'static str,
    text: &'static str,
    lines: &'static [Line],
    shown: Shown,
    /// Of the vertical axis: least squares with as many samples as terms can be a thousand times as bad as MC.
    range: (f64, f64),
    columns: usize,
}

const ERRORS: (f64, f64) = (1e-4, 3.0);

const FIGURES: [Figure4; 6] = [
    Figure4 {
        number: "4.3",
        heading: "Convergence in one dim",
        text: "The functions above: least squares of three orders, and the default. Below a few samples per term least squares is worse than MC, where the default keeps to it.",
        lines: &[
            MC,
            line(DIRECT, 1, "least squares, O1", 1),
            line(DIRECT, 3, "least squares, O3", 2),
            line(DIRECT, 5, "least squares, O5", 3),
            line(DEFAULT, 5, "default, O5", 4),
        ],
        shown: Shown::Error,
        range: ERRORS,
        columns: 4,
    },
    Figure4 {
        number: "4.5",
        heading: "Convergence in the same time",
        text: "What figure 4.5 shows of three scenes is in the chapter on [Embree](embree.md); here are the integrands of that kind whose integrals are known: lights picked at \
               random, one of them half hidden; a visible edge; an unoccluded light. A sample is taken to cost a microsecond, so that the estimate's own time moves a line to \
               the right.",
        lines: &[
            MC,
            line(DIRECT, 1, "least squares, O1", 1),
            line(DIRECT, 2, "least squares, O2", 2),
            line(DIRECT, 3, "least squares, O3", 3),
            line(DEFAULT, 1, "default, O1", 4),
            line(DEFAULT, 2, "default, O2", 5),
            line(DEFAULT, 3, "default, O3", 6),
        ],
        shown: Shown::ErrorAgainstTime,
        range: ERRORS,
        columns: 3,
    },
    Figure4 {
        number: "4.6",
        heading: "Convergence in 1, 5 and 15 dims",
        text: "Sums of sines and exponentials. In 15 dims order 2 has 136 terms: least squares needs more samples than that, the default does not get worse than MC meanwhile. \
               Paths of as many dims in a renderer are in the chapter on [Embree](embree.md).",
        lines: &[
            MC,
            line(DIRECT, 1, "least squares, O1", 1),
            line(DIRECT, 2, "least squares, O2", 2),
            line(DEFAULT, 1, "default, O1", 4),
            line(DEFAULT, 2, "default, O2", 5),
        ],
        shown: Shown::Error,
        range: ERRORS,
        columns: 2,
    },
    Figure4 {
        number: "4.14",
        heading: "Convergence of the bases",
        text: "The default at order 2 with each basis. As with the thesis's scenes, none is best for all: sines where the function oscillates, polynomials where it is smooth, \
               and little between them where it jumps.",
        lines: &[
            MC,
            basis("legendre", "polynomials", 1),
            basis("step", "step functions", 2),
            basis("sine", "sines", 3),
            basis("gaussian", "Gaussians", 4),
        ],
        shown: Shown::Ratio,
        range: (0.02, 3.0),
        columns: 4,
    },
    Figure4 {
        number: "4.16",
        heading: "Direct solution against gradient descent",
        text: "Four lights (3 dims), orders 2, 5 and 7: 10, 56 and 120 terms. Descent stops after half as many steps as samples, which shrinks its fit: with few samples it is \
               the safer of the two, with many the direct solution has less error. Times are in the table.",
        lines: &[
            line(DIRECT, 2, "direct, O2", 1),
            line(DIRECT, 5, "direct, O5", 2),
            line(DIRECT, 7, "direct, O7", 3),
            line(DESCENT, 2, "descent, O2", 4),
            line(DESCENT, 5, "descent, O5", 5),
            line(DESCENT, 7, "descent, O7", 6),
        ],
        shown: Shown::Ratio,
        range: (0.3, 4.0),
        columns: 1,
    },
    Figure4 {
        number: "4.17",
        heading: "Incremental estimates",
        text: "Order 2. Each sample is corrected by the fit to those before it: any prefix is an unbiased estimate, and the error is above that of a fit to all samples: little where a fit explains little, several times where it explains nearly all.",
        lines: &[
            MC,
            line(DESCENT, 2, "gradient descent", 1),
            line("incremental", 2, "incremental", 2),
            line(DIRECT, 2, "least squares", 3),
        ],
        shown: Shown::Error,
        range: ERRORS,
        columns: 2,
    },
];

pub(super) fn write(report: &Report, chapter: &mut Chapter, points: &Points) -> Result<()> {
    for figure in &FIGURES {
        write_figure(report, chapter, points, figure)?;
    }
    Ok(())
}

fn write_figure(report: &Report, chapter: &mut Chapter, points: &Points, figure: &Figure4) -> Result<()> {
    chapter.section(figure.heading, &format!("figure {}", figure.number));
    // What a text says of dims, orders and terms is no measurement.
    chapter.setting(format!("about figure {}", figure.number), figure.text);
    chapter.paragraph(figure.text);
    let here: Vec<&Point> = points.of(figure.number).collect();
    let mut names: Vec<&str> = Vec::new();
    here.iter().for_each(|point| {
        if names.last() != Some(&point.panel.as_str()) {
            names.push(&point.panel);
        }
    });
    let of = |name: &str, line: &Line| -> Vec<&Point> {
        let same = |point: &&&Point| {
            point.panel == name
                && (point.estimator.as_str(), point.basis.as_str(), point.order)
                    == (line.estimator, line.basis, line.order)
        };
        here.iter().filter(same).copied().collect()
    };
    let panels = names.iter().map(|name| {
        let series = figure.lines.iter().map(|line| Series {
            points: of(name, line).into_iter().map(|point| place(point, figure.shown)).collect(),
            colour: Some(line.colour),
            dashed: line.estimator == DEFAULT && figure.shown != Shown::Ratio,
            ..Series::default()
        });
        Panel { title: (*name).to_owned(), series: series.collect(), ..Panel::default() }
    });
    let panels: Vec<Panel> = panels.collect();
    let legend: Vec<Key> = figure
        .lines
        .iter()
        .map(|line| Key::Line {
            name: line.name.to_owned(),
            colour: line.colour,
            dashed: line.estimator == DEFAULT && figure.shown != Shown::Ratio,
        })
        .collect();
    let time = figure.shown == Shown::ErrorAgainstTime;
    let x = Axis { label: if time { "microseconds" } else { "samples" }, logarithmic: true, range: None };
    let label = if figure.shown == Shown::Ratio { "RMSE over MC's" } else { "RMSE over std. deviation" };
    let y = Axis { label, logarithmic: true, range: Some(figure.range) };
    let title = format!("{} (figure {})", figure.heading, figure.number);
    let plots = Panels { title: &title, x, y, columns: figure.columns, panels: &panels, legend: &legend };
    let file = format!("control_variates_figure_{}.svg", figure.number.replace('.', "_"));
    report.output.write_text(&file, &plots.svg()?)?;
    chapter.picture(&file, &title);
    write_table(chapter, figure, &names, &of);
    Ok(())
}

fn place(point: &Point, shown: Shown) -> (f64, f64) {
    let samples = point.x as f64;
    match shown {
        Shown::Error => (samples, point.error),
        Shown::Ratio => (samples, point.ratio.value),
        Shown::ErrorAgainstTime => (samples * (1.0 + 1e-3 * point.ns), point.error),
    }
}

/// Ratios to MC at a few sample counts; for solvers also times.
fn write_table<'a>(
    chapter: &mut Chapter,
    figure: &Figure4,
    names: &[&str],
    of: &dyn Fn(&str, &Line) -> Vec<&'a Point>,
) {
    let mut rows = Vec::new();
    for name in names {
        for line in figure.lines.iter().filter(|line| line.estimator != MEAN) {
            let points = of(name, line);
            let at = |n: usize| points.iter().find(|point| point.n == n);
            let mut cells = row![*name, line.name];
            for n in COUNTS {
                cells.push(at(n).map(|point| small(point.ratio)).into());
            }
            let worst = points.iter().max_by(|a, b| a.ratio.value.total_cmp(&b.ratio.value));
            cells.push(worst.map(|point| Figure::brief(point.ratio, Unit::Ratio)).into());
            cells.push(worst.map(|point| point.n as u32).into());
            cells.push(at(COUNTS[0]).map(|point| Figure::exact(point.ns, Unit::Nanoseconds)).into());
            cells.push(at(COUNTS[2]).map(|point| Figure::exact(point.ns, Unit::Nanoseconds)).into());
            rows.push(cells);
        }
    }
    let columns =
        ["integrand", "setting", "32 samples", "64", "256", "1024", "worst", "at", "ns per sample, 32", "ns, 256"];
    chapter.table(figure.number, &columns, 2, rows);
}

/// Columns of the tables; the thesis compares solvers at the first and the third.
const COUNTS: [usize; 4] = [32, 64, 256, 1024];

fn small(ratio: Estimate) -> chapter::Cell {
    Figure::new(ratio, if ratio.value < 0.0095 { Unit::Error } else { Unit::Ratio }).into()
}
