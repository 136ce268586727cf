//! Figure 4.15: one of many lights, picked at random.

use super::cells::DEFAULT;
use super::convergence::{Point, Points};
use crate::chapters::Report;
use crate::chapters::chapter::{Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::measure::plot::{Axis, Plot, Series};
use anyhow::Result;

/// Estimator, order, whether it knows of slices, name.
const LINES: [(&str, usize, bool, &str); 5] = [
    ("least squares", 1, false, "least squares, O1"),
    ("least squares", 2, false, "least squares, O2"),
    ("least squares", 3, false, "least squares, O3"),
    (DEFAULT, 2, false, "default, O2"),
    (DEFAULT, 2, true, "default with slices, O2"),
];

pub(super) fn write(report: &Report, chapter: &mut Chapter, points: &Points) -> Result<()> {
    chapter.section("Many lights", "figure 4.15");
    let here: Vec<&Point> = points.of("4.15").collect();
    let samples = chapter.setting("samples of many lights", here.first().map_or(0, |point| point.n));
    chapter.paragraph(&format!(
        "Two numbers are a point on a light, the third picks one of the lights; every fourth light is half hidden. {samples} samples. The number that picks jumps from light to \
         light, which polynomials cannot follow; told of it (`slices`), the default fits each light for itself as far as terms last. The lights of a renderer are in \
         the chapter on [Embree](embree.md).",
    ));
    let mut counts: Vec<usize> = here.iter().map(|point| point.x).collect();
    counts.sort_unstable();
    counts.dedup();
    let find = |lights: usize, (estimator, order, slices, _): (&str, usize, bool, &str)| {
        let same = |point: &&&Point| {
            (point.x, point.estimator.as_str(), point.order, point.slices > 1) == (lights, estimator, order, slices)
        };
        here.iter().find(same).map(|point| point.ratio)
    };
    let series: Vec<Series> = LINES
        .iter()
        .enumerate()
        .map(|(index, line)| {
            let found: Vec<_> =
                counts.iter().filter_map(|&lights| Some((lights as f64, find(lights, *line)?))).collect();
            Series {
                name: line.3.to_owned(),
                points: found.iter().map(|(x, ratio)| (*x, ratio.value)).collect(),
                band: found.iter().map(|(x, ratio)| (*x, ratio.low, ratio.high)).collect(),
                colour: Some(index + 1),
                ..Series::default()
            }
        })
        .collect();
    let x = Axis { label: "lights", logarithmic: true, range: None };
    let y = Axis { label: "RMSE over MC's", logarithmic: false, range: None };
    let plot = Plot { title: "Many lights, one picked at random (figure 4.15)", x, y, series: &series };
    report.output.write_text("control_variates_lights.svg", &plot.svg()?)?;
    chapter.picture("control_variates_lights.svg", "Error over MC's against the number of lights");
    let rows = counts.iter().map(|&lights| {
        let mut cells = row![lights as u32];
        cells.extend(LINES.map(|line| find(lights, line).map(|ratio| Figure::new(ratio, Unit::Ratio)).into()));
        cells
    });
    let columns = [&["lights"][..], &LINES.map(|line| line.3)].concat();
    chapter.table("many lights", &columns, 0, rows.collect());
    Ok(())
}
