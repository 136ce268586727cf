//! Multiple importance sampling with regression: figure 4.9.

use super::Section;
use super::comparison::{seeds, thousandfold};
use crate::chapters::chapter::row;
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::measurement::{Experiment, Outcome, View};
use crate::chapters::pictures::write_small;
use crate::chapters::statistics::Estimate;
use crate::measure::error_sheet::{self, Column};
use anyhow::Result;

const SCENES: [&str; 3] = ["veach", "chopper", "dining"];
const BALANCE: &str = "balance";
/// As the program names them, and the columns (a) to (d) of the figure.
const ESTIMATORS: [(&str, &str); 4] = [
    (BALANCE, "balance"),
    ("balance_regression", "balance, regression"),
    ("optimal", "optimal"),
    ("optimal_regression", "optimal, regression"),
];

pub(super) fn write(section: &mut Section) -> Result<()> {
    section.chapter.section("Multiple importance sampling", "figure 4.9");
    let plan = section.measurement.plan;
    let spp = section.chapter.setting("samples per pixel with MIS", plan.middle());
    let techniques = section.chapter.setting("techniques", 2);
    section.chapter.paragraph(&format!(
        "Direct light by {techniques} techniques, light and direction sampling, {spp} samples, a half of each; order {techniques}. Regression is of each \
         technique's weighted samples by themselves. Optimal weights: Kondapaneni et al. 2019, solved with a ridge. Medians of relMSE first, \
         then ratios to the balance heuristic."
    ));
    let names = ESTIMATORS.map(|(name, _)| name);
    let mut rows = Vec::new();
    for &scene in plan.some(&SCENES) {
        let experiment =
            Experiment { options: &["--mis"], ..Experiment::new(View::new(scene, plan.size), spp, &names) };
        let outcome = section.measurement.run(&seeds(section, experiment))?;
        let mut cells = row![scene];
        for (name, _) in ESTIMATORS {
            cells.push(thousandfold(&outcome, name)?.into());
        }
        let balance = outcome.errors(BALANCE)?;
        for (name, _) in &ESTIMATORS[1..] {
            cells.push(Figure::new(Estimate::ratio(&outcome.errors(name)?, &balance), Unit::Ratio).into());
        }
        rows.push(cells);
        if scene == SCENES[0] {
            write_sheet(section, &outcome)?;
        }
    }
    let columns = [
        "scene",
        "balance, relMSE x 1000",
        "balance, regression",
        "optimal",
        "optimal, regression",
        "ratio: balance, regression",
        "ratio: optimal",
        "ratio: optimal, regression",
    ];
    section.chapter.table("mis", &columns, 1, rows);
    section.chapter.picture("mis-veach.png", "Glossy plates by each combination, and the errors");
    Ok(())
}

fn write_sheet(section: &Section, outcome: &Outcome) -> Result<()> {
    let column = |&(name, label): &(&str, &str)| -> Result<Column> {
        let image = outcome.of(name)?.images[0].clone();
        let caption = format!("relMSE {:.2e}", outcome.reference.rel_mse(&image));
        Ok(Column { title: label.to_owned(), cells: vec![(image, caption)] })
    };
    let columns = ESTIMATORS.iter().map(column).collect::<Result<Vec<_>>>()?;
    let rows = [format!("left: {} samples", section.measurement.plan.middle())];
    let picture = error_sheet::draw("veach: two techniques", &rows, &columns, &outcome.reference);
    write_small(section.output, "mis-veach.png", &picture)
}
