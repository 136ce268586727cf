//! Global illumination: figure 4.7.

use super::Section;
use super::comparison::{ratios, seeds, thousandfold};
use crate::chapters::chapter::{Cell, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::measurement::{BASELINE, DEFAULT, Experiment, LEAST_SQUARES, Outcome, View};
use crate::chapters::statistics::Estimate;
use anyhow::Result;

const SCENE: &str = "duck";
const ESTIMATORS: [&str; 3] = [BASELINE, DEFAULT, LEAST_SQUARES];

pub(super) fn write(section: &mut Section) -> Result<()> {
    section.chapter.section("Global illumination", "figure 4.7");
    let plan = section.measurement.plan;
    section.chapter.setting("samples per pixel, 15 dims", plan.many);
    section.chapter.setting("pixels on a side of duck", view(section).size);
    let orders = orders(section, view(section))?;
    let mut rows = vec![row![
        "MC",
        "-",
        thousandfold(&orders[0], BASELINE)?,
        Cell::Missing,
        Cell::Missing,
        Cell::Missing,
        Cell::Missing
    ]];
    for (order, outcome) in (1_u32..).zip(&orders) {
        for (estimator, label) in [(DEFAULT, "default"), (LEAST_SQUARES, "least squares")] {
            let [upper, lower] = parts(outcome, estimator)?;
            let [same_samples, same_time] = ratios(outcome, estimator)?;
            rows.push(row![label, order, thousandfold(outcome, estimator)?, same_samples, upper, lower, same_time]);
        }
        let statement = format!("15 dims, order {order}: default over MC, below 1 outside its interval");
        section.targets.below(&statement, SCENE, outcome.ratio(DEFAULT)?, Unit::Ratio, 1.0);
    }
    let columns =
        ["estimator", "order", "relMSE x 1000", "ratio to MC", "upper half", "lower half", "ratio, same time"];
    section.chapter.table("indirect", &columns, 2, rows);
    Ok(())
}

/// Ratios in the upper and in the lower half of the image.
fn parts(outcome: &Outcome, estimator: &str) -> Result<[Figure; 2]> {
    let halves = |name: &str| -> Result<[Vec<f64>; 2]> {
        let images = &outcome.of(name)?.images;
        let halves = images.iter().map(|image| {
            let terms = outcome.reference.terms(image);
            let (upper, lower) = terms.split_at(terms.len() / 2);
            [upper, lower].map(|part| part.iter().sum::<f64>())
        });
        let (upper, lower) = halves.map(|[upper, lower]| (upper, lower)).unzip();
        Ok([upper, lower])
    };
    let (own, plain) = (halves(estimator)?, halves(BASELINE)?);
    Ok([0, 1].map(|half| Figure::new(Estimate::ratio(&own[half], &plain[half]), Unit::Ratio)))
}

/// Smaller than others: order 2 has 136 terms here.
fn view(section: &Section) -> View {
    View::new(SCENE, section.measurement.plan.small * 5 / 8)
}

/// With polynomials of order 1 and 2.
fn orders(section: &Section, view: View) -> Result<[Outcome; 2]> {
    let spp = section.measurement.plan.many;
    let run = |order| {
        section.measurement.run(&seeds(section, Experiment { order, ..Experiment::new(view, spp, &ESTIMATORS) }))
    };
    Ok([run(1)?, run(2)?])
}
