//! Multiple importance sampling with regression: figure 4.9.

use super::Section;
use super::comparison::{seeds, thousandfold};
use crate::chapters::chapter::row;
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::measurement::{Experiment, View};
use crate::chapters::statistics::Estimate;
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
    let spp = plan.middle();
    section.chapter.setting("samples per pixel with MIS", spp);
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
    Ok(())
}
