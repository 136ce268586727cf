//! Estimators on several scenes, in the layouts of the thesis's figures.

use super::Section;
use crate::chapters::measurement::{BASELINE, DEFAULT, Experiment, LEAST_SQUARES, Outcome, View};
use crate::chapters::prelude::*;

/// What a cell holds of an estimator.
#[derive(Clone, Copy)]
enum Of {
    /// Median relMSE, times a thousand as in the thesis.
    Error(&'static str),
    /// relMSE over the plain mean's of the same samples, and in the same time.
    Ratio(&'static str),
    SameTime(&'static str),
    /// relMSE over that of another.
    Over(&'static str, &'static str),
    /// Its own nanoseconds per sample.
    Time(&'static str),
    Nothing,
}

use Of::{Error, Nothing, Over, Ratio, SameTime, Time};

impl Of {
    fn cell(self, outcome: &Outcome) -> Result<Cell> {
        let ratio = |ratio| Figure::new(ratio, Unit::Ratio).into();
        Ok(match self {
            Error(name) => {
                let thousandfold: Vec<f64> = outcome.errors(name)?.iter().map(|error| 1e3 * error).collect();
                Figure::new(Estimate::median(&thousandfold), Unit::RelMseE3).into()
            }
            Ratio(name) => ratio(outcome.ratio(name)?),
            SameTime(name) => ratio(outcome.equal_time(name)?),
            Over(name, other) => ratio(Estimate::ratio(&outcome.errors(name)?, &outcome.errors(other)?)),
            Time(name) => {
                let time = outcome.of(name)?.nanoseconds(|timing| timing.estimating_ns_per_sample);
                Figure::brief(time, Unit::Nanoseconds).into()
            }
            Nothing => Cell::Missing,
        })
    }
}

/// A row: its words, then what is asked of each experiment.
fn line(section: &Section, words: Vec<Cell>, parts: &[(Experiment, &[Of])]) -> Result<Vec<Cell>> {
    let mut cells = words;
    for (experiment, all) in parts {
        let outcome = section.measurement.run(&seeds(section, *experiment))?;
        for of in *all {
            cells.push(of.cell(&outcome)?);
        }
    }
    Ok(cells)
}

/// As many seeds as everything is measured with.
pub(super) fn seeds<'a>(section: &Section, experiment: Experiment<'a>) -> Experiment<'a> {
    Experiment { seeds: section.measurement.plan.seeds, ..experiment }
}

/// Those of most figures, and how tables name them.
const ESTIMATORS: [&str; 3] = [BASELINE, DEFAULT, LEAST_SQUARES];
const LABELS: [(&str, &str); 2] = [(DEFAULT, "default"), (LEAST_SQUARES, "least squares")];

/// Figures 4.4 and 4.5.
pub(super) fn direct(section: &mut Section) -> Result<()> {
    let plan = section.measurement.plan;
    section.chapter.section("Direct light", "figures 4.4 and 4.5");
    let (mut overview, mut ratios) = (Vec::new(), Vec::new());
    for &scene in plan.some(&["killeroos", "bathroom", "dining"]) {
        for &spp in plan.spp {
            let with = |order| Experiment { order, ..Experiment::new(View::new(scene, plan.size), spp, &ESTIMATORS) };
            let [one, two, three] = [1, 2, 3].map(with);
            for (name, label) in LABELS {
                let error = [Error(name)];
                let parts = [(one, &[Error(BASELINE), Error(name)][..]), (two, &error), (three, &error)];
                if spp == plan.middle() {
                    overview.push(line(section, row![scene, label], &parts)?);
                }
                let (ratio, time) = ([Ratio(name)], [SameTime(name)]);
                let parts =
                    [(one, &ratio[..]), (two, &ratio), (three, &ratio), (one, &time), (two, &time), (three, &time)];
                ratios.push(line(section, row![scene, spp, label], &parts)?);
            }
        }
    }
    section.chapter.setting("samples per pixel of figure 4.4's table", plan.middle());
    section.chapter.table("direct", "scene | estimator | MC | O1 | O2 | O3", 2, overview);
    let columns = "scene | samples | estimator | O1 same samples | O2 | O3 | O1 same time | O2 time | O3 time";
    section.chapter.table("direct ratios", columns, 3, ratios);
    Ok(())
}

/// Figure 4.7.
pub(super) fn indirect(section: &mut Section) -> Result<()> {
    const SCENE: &str = "duck";
    section.chapter.section("Global illumination", "figure 4.7");
    let plan = section.measurement.plan;
    // Smaller than others: order 2 has 136 terms here.
    let view = View::new(SCENE, plan.small * 5 / 8);
    section.chapter.setting("samples per pixel, 15 dims", plan.many);
    section.chapter.setting("pixels on a side of duck", view.size);
    let with = |order| Experiment { order, ..Experiment::new(view, plan.many, &ESTIMATORS) };
    let nothing = [Error(BASELINE), Nothing, Nothing, Nothing, Nothing];
    let mut rows = vec![line(section, row!["MC", "-"], &[(with(1), &nothing)])?];
    for order in [1, 2] {
        let outcome = section.measurement.run(&seeds(section, with(order)))?;
        for (name, label) in LABELS {
            let [upper, lower] = halves(&outcome, name)?;
            let [error, ratio, time] = [Error(name), Ratio(name), SameTime(name)].map(|of| of.cell(&outcome));
            rows.push(vec![label.into(), order.into(), error?, ratio?, upper, lower, time?]);
        }
        let statement = format!("15 dims, order {order}: default over MC, below 1 outside its interval");
        section.targets.below(&statement, SCENE, outcome.ratio(DEFAULT)?, Unit::Ratio, 1.0);
    }
    let columns = "estimator | order | relMSE x 1000 | ratio to MC | upper half | lower half | ratio, same time";
    section.chapter.table("indirect", columns, 2, rows);
    Ok(())
}

/// Ratios in the upper and in the lower half of the image.
fn halves(outcome: &Outcome, estimator: &str) -> Result<[Cell; 2]> {
    let halves = |name: &str| -> Result<[Vec<f64>; 2]> {
        let halves = outcome.of(name)?.images.iter().map(|image| {
            let terms = outcome.reference.terms(image);
            let (upper, lower) = terms.split_at(terms.len() / 2);
            [upper, lower].map(|part| part.iter().sum::<f64>())
        });
        let (upper, lower) = halves.map(|[upper, lower]| (upper, lower)).unzip();
        Ok([upper, lower])
    };
    let (own, plain) = (halves(estimator)?, halves(BASELINE)?);
    Ok([0, 1].map(|half| Figure::new(Estimate::ratio(&own[half], &plain[half]), Unit::Ratio).into()))
}

/// Figure 4.9.
pub(super) fn mis(section: &mut Section) -> Result<()> {
    // As the program names them, in the order of the figure's columns (a) to (d).
    const BALANCE: &str = "balance";
    const NAMES: [&str; 4] = [BALANCE, "balance_regression", "optimal", "optimal_regression"];
    section.chapter.section("Multiple importance sampling", "figure 4.9");
    let plan = section.measurement.plan;
    section.chapter.setting("samples per pixel with MIS", plan.middle());
    let over = NAMES[1..].iter().map(|name| Over(name, BALANCE));
    let all: Vec<Of> = NAMES.map(Error).into_iter().chain(over).collect();
    let mut rows = Vec::new();
    for &scene in plan.some(&["veach", "chopper", "dining"]) {
        let experiment = Experiment::new(View::new(scene, plan.size), plan.middle(), &NAMES);
        rows.push(line(section, row![scene], &[(Experiment { options: &["--mis"], ..experiment }, &all)])?);
    }
    let columns = "scene | balance, relMSE x 1000 | balance, regression | optimal | optimal, regression | ratio: \
                   balance, regression | ratio: optimal | ratio: optimal, regression";
    section.chapter.table("mis", columns, 1, rows);
    Ok(())
}

/// Figure 4.14.
pub(super) fn bases(section: &mut Section) -> Result<()> {
    section.chapter.section("Bases", "figure 4.14");
    let plan = section.measurement.plan;
    section.chapter.setting("samples per pixel of the bases", plan.middle());
    let mut rows = Vec::new();
    for &scene in plan.some(&["killeroos", "dining", "dragon", "chopper"]) {
        let with = |options| Experiment {
            options,
            ..Experiment::new(View::new(scene, plan.size), plan.middle(), &ESTIMATORS)
        };
        let [legendre, step, gaussian, sine] =
            [&["--basis", "legendre"], &["--basis", "step"], &["--basis", "gaussian"], &["--basis", "sine"]]
                .map(|options| with(options));
        for (name, label) in LABELS {
            let ratio = [Ratio(name)];
            let first = [Error(BASELINE), Ratio(name)];
            let parts = [(legendre, &first[..]), (step, &ratio), (gaussian, &ratio), (sine, &ratio)];
            rows.push(line(section, row![scene, label], &parts)?);
        }
    }
    let columns = "scene | estimator | MC, relMSE x 1000 | polynomials | step functions | Gaussians | sines";
    section.chapter.table("bases", columns, 2, rows);
    Ok(())
}

/// Many lights, one of them picked at random: figure 4.15.
pub(super) fn lights(section: &mut Section) -> Result<()> {
    // Told that the last number picks a light.
    const SLICES: &str = "slices";
    section.chapter.section("Many lights", "figure 4.15");
    let plan = section.measurement.plan;
    let (spp, size) = (2 * plan.many, plan.small * 3 / 4);
    section.chapter.setting("samples per pixel of many lights", spp);
    section.chapter.setting("pixels on a side of many lights", size);
    let mut rows = Vec::new();
    for &(scene, lights) in plan.some(&[("plane_1", 1_u32), ("plane_4", 4), ("plane_16", 16), ("plane_64", 64)]) {
        let all = [BASELINE, DEFAULT, LEAST_SQUARES, SLICES];
        let (estimators, slices) = if lights > 1 { (&all[..], Ratio(SLICES)) } else { (&all[..3], Nothing) };
        let view = View { precision: 8, ..View::new(scene, size) };
        let with = |order| Experiment { order, ..Experiment::new(view, spp, estimators) };
        let (first, ratio, last) =
            ([Error(BASELINE), Ratio(LEAST_SQUARES)], [Ratio(LEAST_SQUARES)], [Ratio(DEFAULT), slices]);
        let parts = [(with(1), &first[..]), (with(2), &ratio), (with(3), &ratio), (with(2), &last)];
        rows.push(line(section, row![lights], &parts)?);
    }
    let columns = "lights | MC, relMSE x 1000 | least squares, O1 | O2 | O3 | default, O2 | default with slices, O2";
    section.chapter.table("many lights", columns, 0, rows);
    Ok(())
}

/// How the fit is solved for: figure 4.16.
pub(super) fn solvers(section: &mut Section) -> Result<()> {
    const DESCENT: &str = "gradient_descent";
    section.chapter.section("Direct solution against gradient descent", "figure 4.16");
    let plan = section.measurement.plan;
    let all = [LEAST_SQUARES, DESCENT, DEFAULT].map(|name| [Ratio(name), Time(name)]).concat();
    let mut rows = Vec::new();
    for &spp in plan.some(&[32, plan.many]) {
        for &order in plan.some(&[2, 5, 7]) {
            let estimators = [BASELINE, LEAST_SQUARES, DESCENT, DEFAULT];
            let experiment = Experiment::new(View::new("bathroom", plan.small / 2), spp, &estimators);
            rows.push(line(section, row![spp, order], &[(Experiment { order, ..experiment }, &all)])?);
        }
    }
    let columns = "samples | order | direct | its ns | gradient descent | its ns | default | its ns";
    section.chapter.table("solvers", columns, 0, rows);
    Ok(())
}
