//! How the fit is solved for: figures 4.16 and 4.17.

use super::Section;
use super::comparison::{seeds, thousandfold};
use crate::chapters::chapter::row;
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::measurement::{BASELINE, DEFAULT, Experiment, LEAST_SQUARES, Outcome, View};
use anyhow::Result;

const SCENE: &str = "bathroom";
const DESCENT: &str = "gradient_descent";
const INCREMENTAL: &str = "incremental";

pub(super) fn write(section: &mut Section) -> Result<()> {
    write_descent(section)?;
    write_incremental(section)
}

fn time(outcome: &Outcome, estimator: &str) -> Result<Figure> {
    let time = outcome.of(estimator)?.nanoseconds(|timing| timing.estimating_ns_per_sample);
    Ok(Figure::brief(time, Unit::Nanoseconds))
}

fn write_descent(section: &mut Section) -> Result<()> {
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

fn write_incremental(section: &mut Section) -> Result<()> {
    section.chapter.section("Incremental estimates", "figure 4.17");
    let plan = section.measurement.plan;
    let view = View::new(SCENE, plan.small);
    let estimators = [BASELINE, DESCENT, INCREMENTAL, LEAST_SQUARES];
    let outcome = section.measurement.run(&seeds(section, Experiment::new(view, plan.many, &estimators)))?;
    section.chapter.setting("samples per pixel of the incremental estimate", plan.many);
    let labels = [
        (BASELINE, "MC"),
        (DESCENT, "gradient descent"),
        (INCREMENTAL, "incremental"),
        (LEAST_SQUARES, "direct solution"),
    ];
    let mut rows = Vec::new();
    for (estimator, label) in labels {
        let ratio = Figure::new(outcome.ratio(estimator)?, Unit::Ratio);
        rows.push(row![label, thousandfold(&outcome, estimator)?, ratio, time(&outcome, estimator)?]);
    }
    let columns = ["estimator", "relMSE x 1000", "ratio to MC", "ns per sample"];
    section.chapter.table("incremental", &columns, 1, rows);
    Ok(())
}
