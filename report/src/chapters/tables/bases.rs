//! Bases of the fits: figure 4.14.

use super::Section;
use super::comparison::{seeds, thousandfold};
use crate::chapters::chapter::row;
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::measurement::{BASELINE, DEFAULT, Experiment, LEAST_SQUARES, View};
use anyhow::Result;

const SCENES: [&str; 4] = ["killeroos", "dining", "dragon", "chopper"];
/// As the program names them, in the columns' order.
const BASES: [&str; 4] = ["legendre", "step", "gaussian", "sine"];

pub(super) fn write(section: &mut Section) -> Result<()> {
    section.chapter.section("Bases", "figure 4.14");
    let plan = section.measurement.plan;
    let spp = plan.middle();
    section.chapter.setting("samples per pixel of the bases", spp);
    let mut rows = Vec::new();
    for &scene in plan.some(&SCENES) {
        let view = View::new(scene, plan.size);
        let mut outcomes = Vec::new();
        for basis in BASES {
            let options = ["--basis", basis];
            let estimators = [BASELINE, DEFAULT, LEAST_SQUARES];
            let experiment = Experiment { options: &options, ..Experiment::new(view, spp, &estimators) };
            outcomes.push(section.measurement.run(&seeds(section, experiment))?);
        }
        for (estimator, label) in [(DEFAULT, "default"), (LEAST_SQUARES, "least squares")] {
            let mut cells = row![scene, label, thousandfold(&outcomes[0], BASELINE)?];
            for outcome in &outcomes {
                cells.push(Figure::new(outcome.ratio(estimator)?, Unit::Ratio).into());
            }
            rows.push(cells);
        }
    }
    let columns = ["scene", "estimator", "MC, relMSE x 1000", "polynomials", "step functions", "Gaussians", "sines"];
    section.chapter.table("bases", &columns, 2, rows);
    Ok(())
}
