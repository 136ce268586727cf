//! How the fit is solved for: figure 4.16.

use super::Section;
use super::comparison::seeds;
use crate::chapters::chapter::row;
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::measurement::{BASELINE, DEFAULT, Experiment, LEAST_SQUARES, Outcome, View};
use anyhow::Result;

const SCENE: &str = "bathroom";
const DESCENT: &str = "gradient_descent";

fn time(outcome: &Outcome, estimator: &str) -> Result<Figure> {
    let time = outcome.of(estimator)?.nanoseconds(|timing| timing.estimating_ns_per_sample);
    Ok(Figure::brief(time, Unit::Nanoseconds))
}

pub(super) fn write(section: &mut Section) -> Result<()> {
    section.chapter.section("Direct solution against gradient descent", "figure 4.16");
    let plan = section.measurement.plan;
    let mut rows = Vec::new();
    for &spp in plan.some(&[32, plan.many]) {
        for &order in plan.some(&[2, 5, 7]) {
            let view = View::new(SCENE, plan.small / 2);
            let estimators = [BASELINE, LEAST_SQUARES, DESCENT, DEFAULT];
            let experiment = Experiment { order, ..Experiment::new(view, spp, &estimators) };
            let outcome = section.measurement.run(&seeds(section, experiment))?;
            let mut cells = row![spp, order];
            for estimator in [LEAST_SQUARES, DESCENT, DEFAULT] {
                cells.push(Figure::new(outcome.ratio(estimator)?, Unit::Ratio).into());
                cells.push(time(&outcome, estimator)?.into());
            }
            rows.push(cells);
        }
    }
    let columns = ["samples", "order", "direct", "its ns", "gradient descent", "its ns ", "default", "its ns  "];
    section.chapter.table("solvers", &columns.map(str::trim), 0, rows);
    Ok(())
}
