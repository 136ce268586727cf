//! Environment maps: figure 4.10, without the method of Crespo et al. that it compares with.

use super::Section;
use super::comparison::{ratio_row, seeds};
use crate::chapters::measurement::{BASELINE, DEFAULT, Experiment, LEAST_SQUARES, View};
use anyhow::Result;

const SCENES: [&str; 2] = ["dragon", "chopper"];

pub(super) fn write(section: &mut Section) -> Result<()> {
    section.chapter.section("Environment maps", "figure 4.10");
    let plan = section.measurement.plan;
    let mut rows = Vec::new();
    for &scene in plan.some(&SCENES) {
        for &spp in plan.spp {
            let experiment = Experiment::new(View::new(scene, plan.size), spp, &[BASELINE, DEFAULT, LEAST_SQUARES]);
            let experiment = seeds(section, experiment);
            let outcome = section.measurement.run(&experiment)?;
            rows.push(ratio_row(&experiment, &outcome, &[DEFAULT, LEAST_SQUARES])?);
        }
    }
    let columns = [
        "scene",
        "samples",
        "MC, relMSE x 1000",
        "default, same samples",
        "default, same time",
        "least squares, same samples",
        "least squares, same time",
    ];
    section.chapter.table("environment maps", &columns, 1, rows);
    Ok(())
}
