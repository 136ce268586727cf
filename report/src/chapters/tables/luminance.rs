//! Regression on luminance, as in the thesis's section 4.3, against regression on each channel.

use super::Section;
use super::comparison::{ratios, seeds, thousandfold};
use crate::chapters::chapter::row;
use crate::chapters::measurement::{BASELINE, DEFAULT, Experiment, LEAST_SQUARES, View};
use anyhow::Result;

const SCENES: [&str; 4] = ["killeroos", "bathroom", "dining", "microcity"];
/// Least squares and the default, of luminance.
const LUMINANCE: [&str; 2] = ["luminance", "robust_luminance"];

pub(super) fn write(section: &mut Section) -> Result<()> {
    section.chapter.section("Luminance or channels", "section 4.3");
    let plan = section.measurement.plan;
    let spp = plan.middle();
    section.chapter.setting("samples per pixel, luminance", spp);
    let [thesis, luminance] = LUMINANCE;
    let estimators = [BASELINE, thesis, LEAST_SQUARES, luminance, DEFAULT];
    let mut rows = Vec::new();
    for &scene in plan.some(&SCENES) {
        let experiment = seeds(section, Experiment::new(View::new(scene, plan.size), spp, &estimators));
        let outcome = section.measurement.run(&experiment)?;
        let mut cells = row![scene, thousandfold(&outcome, BASELINE)?];
        for estimator in &estimators[1..] {
            cells.extend(ratios(&outcome, estimator)?.map(crate::chapters::chapter::Cell::from));
        }
        rows.push(cells);
    }
    let columns = [
        "scene",
        "MC, relMSE x 1000",
        "least squares, luminance: same samples",
        "same time",
        "least squares, channels: same samples",
        "same time",
        "default, luminance: same samples",
        "same time",
        "default, channels: same samples",
        "same time",
    ];
    section.chapter.table("luminance", &columns, 1, rows);
    Ok(())
}
