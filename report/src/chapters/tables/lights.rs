//! Many lights, one of them picked at random: figure 4.15.

use super::Section;
use super::comparison::{seeds, thousandfold};
use crate::chapters::chapter::row;
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::measurement::{BASELINE, DEFAULT, Experiment, LEAST_SQUARES, Outcome, View};
use crate::chapters::statistics::Estimate;
use anyhow::Result;

const SCENES: [(&str, u32); 4] = [("plane_1", 1), ("plane_4", 4), ("plane_16", 16), ("plane_64", 64)];
/// Told that the last number picks a light.
const SLICES: &str = "slices";

pub(super) fn write(section: &mut Section) -> Result<()> {
    section.chapter.section("Many lights", "figure 4.15");
    let plan = section.measurement.plan;
    let (spp, size) = (2 * plan.many, plan.small * 3 / 4);
    section.chapter.setting("samples per pixel of many lights", spp);
    section.chapter.setting("pixels on a side of many lights", size);
    let mut rows = Vec::new();
    for &(scene, lights) in plan.some(&SCENES) {
        let estimators: &[&str] = match lights {
            1 => &[BASELINE, DEFAULT, LEAST_SQUARES],
            _ => &[BASELINE, DEFAULT, LEAST_SQUARES, SLICES],
        };
        let run = |order| {
            let experiment = Experiment {
                order,
                ..Experiment::new(View { precision: 8, ..View::new(scene, size) }, spp, estimators)
            };
            section.measurement.run(&seeds(section, experiment))
        };
        let orders = [run(1)?, run(2)?, run(3)?];
        let ratio = |outcome: &Outcome, name: &str| outcome.ratio(name);
        let mut values: Vec<Option<Estimate>> = Vec::new();
        for outcome in &orders {
            values.push(Some(ratio(outcome, LEAST_SQUARES)?));
        }
        values.push(Some(ratio(&orders[1], DEFAULT)?));
        values.push(if lights > 1 { Some(ratio(&orders[1], SLICES)?) } else { None });
        let mut cells = row![lights, thousandfold(&orders[0], BASELINE)?];
        for value in values {
            cells.push(value.map(|value| Figure::new(value, Unit::Ratio)).into());
        }
        rows.push(cells);
    }
    let columns =
        ["lights", "MC, relMSE x 1000", "least squares, O1", "O2", "O3", "default, O2", "default with slices, O2"];
    section.chapter.table("many lights", &columns, 0, rows);
    Ok(())
}
