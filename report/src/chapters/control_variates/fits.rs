//! Figure 4.3: functions of one coordinate, their fits, and what the fits leave.

use crate::chapters::Report;
use crate::chapters::chapter::Chapter;
use crate::measure::panels::{Key, Panel, Panels};
use crate::measure::plot::{Axis, Series};
use crate::measure::table::Table;
use anyhow::Result;

/// Columns of the table, and what the legend calls them.
const FITS: [(&str, &str); 4] = [("mean", "MC"), ("order 1", "O1"), ("order 3", "O3"), ("order 5", "O5")];

pub(super) fn write(report: &Report, chapter: &mut Chapter, table: &Table) -> Result<()> {
    chapter.section("Functions of one number and their fits", "figure 4.3");
    let mut functions: Vec<&str> = Vec::new();
    for row in table.rows() {
        let name = row.word("function")?;
        if functions.last() != Some(&name) {
            functions.push(name);
        }
    }
    let samples = table.rows().next().map_or(Ok(0), |row| row.number("samples"))?;
    let samples = chapter.setting("samples of the fits that are shown", samples);
    let colour = |index: usize| index + 1;
    let mut panels = Vec::new();
    for residual in [false, true] {
        for function in &functions {
            let rows: Vec<_> =
                table.rows().filter(|row| row.word("function").is_ok_and(|name| name == *function)).collect();
            let line = |heading: &str| -> Result<Vec<(f64, f64)>> {
                rows.iter()
                    .map(|row| {
                        let own = if residual { row.number("value")? } else { 0.0 };
                        let value = row.number(heading)?;
                        Ok((row.number("x")?, if residual { own - value } else { value }))
                    })
                    .collect()
            };
            let mut series = Vec::new();
            for (index, (heading, _)) in FITS.iter().enumerate() {
                series.push(Series { points: line(heading)?, colour: Some(colour(index)), ..Series::default() });
            }
            if !residual {
                series.push(Series { points: line("value")?, colour: Some(0), ..Series::default() });
            }
            let title = if residual { format!("{function}: what is left") } else { (*function).to_owned() };
            panels.push(Panel { title, series, ..Panel::default() });
        }
    }
    let mut legend: Vec<Key> = FITS
        .iter()
        .enumerate()
        .map(|(index, (_, name))| Key::Line { name: (*name).to_owned(), colour: colour(index), dashed: false })
        .collect();
    legend.push(Key::Line { name: "function".to_owned(), colour: 0, dashed: false });
    let title = format!("Fits to {samples} samples (figure 4.3)");
    let x = Axis { label: "u", logarithmic: false, range: Some((0.0, 1.0)) };
    let y = Axis { label: "f", logarithmic: false, range: None };
    let plots = Panels { title: &title, x, y, columns: functions.len(), panels: &panels, legend: &legend };
    report.output.write_text("control_variates_fits.svg", &plots.svg()?)?;
    chapter.paragraph(&format!(
        "Least-squares fits of orders 1, 3 and 5 to {samples} samples, and what they leave; how the error falls with samples follows. A step and a peak are fitted roughly, and \
         even so the error is lower."
    ));
    for order in [1, 3, 5] {
        chapter.setting(format!("an order of figure 4.3: {order}"), order);
    }
    chapter.picture("control_variates_fits.svg", "Functions, fits and residuals");
    Ok(())
}
