//! Direct light: figures 4.4 and 4.5.

use super::Section;
use crate::chapters::chapter::{Cell, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::measurement::{BASELINE, DEFAULT, Experiment, LEAST_SQUARES, Outcome, View};
use crate::chapters::statistics::Estimate;
use anyhow::Result;

const SCENES: [&str; 3] = ["killeroos", "bathroom", "dining"];
const ORDERS: [u32; 3] = [1, 2, 3];
const ESTIMATORS: [&str; 3] = [BASELINE, DEFAULT, LEAST_SQUARES];
/// As the tables name them.
const LABELS: [(&str, &str); 2] = [(DEFAULT, "default"), (LEAST_SQUARES, "least squares")];

/// One scene at one number of samples, with each order.
struct Measured {
    spp: u32,
    orders: Vec<Outcome>,
}

pub(super) fn write(section: &mut Section) -> Result<()> {
    let plan = section.measurement.plan;
    section.chapter.section("Direct light", "figures 4.4 and 4.5");
    let (mut overview, mut ratios) = (Vec::new(), Vec::new());
    for &scene in plan.some(&SCENES) {
        let all = measure(section, scene)?;
        for one in &all {
            if one.spp == plan.middle() {
                overview.extend(overview_rows(scene, one)?);
            }
            ratios.extend(ratio_rows(scene, one)?);
        }
    }
    section.chapter.setting("samples per pixel of figure 4.4's table", plan.middle());
    section.chapter.table("direct", &["scene", "estimator", "MC", "O1", "O2", "O3"], 2, overview);
    let columns =
        ["scene", "samples", "estimator", "O1 same samples", "O2", "O3", "O1 same time", "O2 time", "O3 time"];
    section.chapter.table("direct ratios", &columns, 3, ratios);
    Ok(())
}

fn measure(section: &Section, scene: &'static str) -> Result<Vec<Measured>> {
    let plan = section.measurement.plan;
    let view = View::new(scene, plan.size);
    let one = |&spp: &u32| {
        let order = |order| {
            let experiment = Experiment { order, seeds: plan.seeds, ..Experiment::new(view, spp, &ESTIMATORS) };
            section.measurement.run(&experiment)
        };
        Ok(Measured { spp, orders: ORDERS.map(order).into_iter().collect::<Result<_>>()? })
    };
    plan.spp.iter().map(one).collect()
}

fn overview_rows(scene: &str, one: &Measured) -> Result<Vec<Vec<Cell>>> {
    let error = |outcome: &Outcome, estimator: &str| -> Result<Figure> {
        let thousandfold: Vec<f64> = outcome.errors(estimator)?.iter().map(|error| 1e3 * error).collect();
        Ok(Figure::new(Estimate::median(&thousandfold), Unit::RelMseE3))
    };
    LABELS
        .iter()
        .map(|&(estimator, label)| {
            let mut cells = row![scene, label, error(&one.orders[0], BASELINE)?];
            for outcome in &one.orders {
                cells.push(error(outcome, estimator)?.into());
            }
            Ok(cells)
        })
        .collect()
}

fn ratio_rows(scene: &str, one: &Measured) -> Result<Vec<Vec<Cell>>> {
    LABELS
        .iter()
        .map(|&(estimator, label)| {
            let mut cells = row![scene, one.spp, label];
            for outcome in &one.orders {
                cells.push(Figure::new(outcome.ratio(estimator)?, Unit::Ratio).into());
            }
            for outcome in &one.orders {
                cells.push(Figure::new(outcome.equal_time(estimator)?, Unit::Ratio).into());
            }
            Ok(cells)
        })
        .collect()
}
