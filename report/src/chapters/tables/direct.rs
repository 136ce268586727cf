//! Direct light: figures 4.4 and 4.5.

use super::Section;
use crate::chapters::chapter::{Cell, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::measurement::{BASELINE, DEFAULT, Experiment, LEAST_SQUARES, Outcome, View};
use crate::chapters::pictures::write_small;
use crate::chapters::statistics::Estimate;
use crate::measure::error_sheet::{self, Column};
use crate::measure::plot::{Axis, Plot, Series};
use crate::measure::text;
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
    let (mut overview, mut ratios, mut drawings) = (Vec::new(), Vec::new(), Vec::new());
    let mut counts = Counts::default();
    for &scene in plan.some(&SCENES) {
        let all = measure(section, scene)?;
        for one in &all {
            if one.spp == plan.middle() {
                overview.extend(overview_rows(scene, one)?);
                write_sheet(section, scene, one)?;
            }
            ratios.extend(ratio_rows(scene, one)?);
            counts.add(one)?;
        }
        drawings.push(draw(section, scene, &all)?);
    }
    let spp = section.chapter.setting("samples per pixel of figure 4.4's table", plan.middle());
    section.chapter.paragraph(&format!(
        "relMSE times a thousand, {spp} samples per pixel, in the layout of figure 4.4. `killeroos`: a spherical light and motion \
         blur (3 dims); `bathroom`: mesh lights picked at random (3); `dining`: one triangle as a light (2)."
    ));
    section.chapter.setting("dims of killeroos and bathroom", 3);
    section.chapter.setting("dims of dining", 2);
    section.chapter.table("direct", &["scene", "estimator", "MC", "O1", "O2", "O3"], 2, overview);
    section.chapter.paragraph("Ratios to MC, from the same samples and in the same time (convergence, figure 4.5):");
    let columns =
        ["scene", "samples", "estimator", "O1 same samples", "O2", "O3", "O1 same time", "O2 time", "O3 time"];
    section.chapter.table("direct ratios", &columns, 3, ratios);
    conclude(section, counts);
    for (file, title) in drawings {
        section.chapter.picture(&file, &title);
    }
    for &scene in plan.some(&SCENES) {
        section
            .chapter
            .picture(&format!("direct-{scene}.png"), &format!("{scene}: images and errors of each estimator"));
    }
    Ok(())
}

/// In how many cells of the table of ratios it pays.
#[derive(Default)]
struct Counts {
    cells: u32,
    default_same_samples: u32,
    default_same_time: u32,
    least_squares_same_samples: u32,
    least_squares_same_time: u32,
}

impl Counts {
    fn add(&mut self, one: &Measured) -> Result<()> {
        let better = |ratio: Estimate| u32::from(ratio.value < 1.0);
        for outcome in &one.orders {
            self.cells += 1;
            self.default_same_samples += better(outcome.ratio(DEFAULT)?);
            self.default_same_time += better(outcome.equal_time(DEFAULT)?);
            self.least_squares_same_samples += better(outcome.ratio(LEAST_SQUARES)?);
            self.least_squares_same_time += better(outcome.equal_time(LEAST_SQUARES)?);
        }
        Ok(())
    }
}

/// What the table says, in a sentence.
fn conclude(section: &mut Section, counts: Counts) {
    let mut quote = |name: &str, count: u32| section.chapter.quote(name, Figure::exact(f64::from(count), Unit::Count));
    let cells = quote("direct light: cells of orders, samples and scenes", counts.cells);
    let same_samples = quote("direct light: default better, same samples", counts.default_same_samples);
    let same_time = quote("direct light: default better, same time", counts.default_same_time);
    let plain_samples = quote("direct light: least squares better, same samples", counts.least_squares_same_samples);
    let plain_time = quote("direct light: least squares better, same time", counts.least_squares_same_time);
    let limit = if counts.default_same_time < counts.cells {
        " Where it does not, the fit costs more than the samples that it saves: these scenes' samples are cheap, and orders above the first pay from \
         more samples on."
    } else {
        ""
    };
    section.chapter.paragraph(&format!(
        "Of {cells} cells, the default is below MC in {same_samples} with the same samples and in {same_time} in the same time, least squares in \
         {plain_samples} and {plain_time}.{limit}"
    ));
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

/// relMSE against time; the file and its title.
fn draw(section: &Section, scene: &str, all: &[Measured]) -> Result<(String, String)> {
    let line = |name: &str, order: usize, estimator: &str| -> Result<Series> {
        let mut series = Series { name: name.to_owned(), dashed: estimator == LEAST_SQUARES, ..Series::default() };
        series.colour = Some(if estimator == BASELINE { 0 } else { 1 + order });
        for one in all {
            let outcome = &one.orders[order];
            let renderings = outcome.of(estimator)?;
            let time = renderings.nanoseconds(|t| t.sampling_ns_per_sample + t.estimating_ns_per_sample).value;
            let error = Estimate::median(&outcome.errors(estimator)?);
            let time = time * f64::from(one.spp) * 1e-3;
            series.points.push((time, error.value));
            series.band.push((time, error.low, error.high));
        }
        Ok(series)
    };
    let mut series = vec![line("MC", 0, BASELINE)?];
    for (index, order) in ORDERS.into_iter().enumerate() {
        series.push(line(&format!("default, O{order}"), index, DEFAULT)?);
        series.push(line(&format!("least squares, O{order}"), index, LEAST_SQUARES)?);
    }
    let title = format!("{scene}: relMSE against time");
    let x = Axis { label: "microseconds per pixel and thread", logarithmic: true, range: None };
    let y = Axis { label: "relMSE", logarithmic: true, range: None };
    let file = format!("direct-{scene}.svg");
    section.output.write_text(&file, &Plot { title: &title, x, y, series: &series }.svg()?)?;
    Ok((file, title))
}

/// Images of the first seed, and their errors.
fn write_sheet(section: &Section, scene: &str, one: &Measured) -> Result<()> {
    let reference = &one.orders[0].reference;
    let mut columns = Vec::new();
    let mut add = |title: String, outcome: &Outcome, estimator: &str| -> Result<()> {
        let image = outcome.of(estimator)?.images[0].clone();
        let caption = format!("relMSE {:.2e}", reference.rel_mse(&image));
        section.large.write_image(
            &format!("{scene}-{}spp-{}", one.spp, title.replace([',', ' '], "")),
            &image,
            reference,
        )?;
        columns.push(Column { title, cells: vec![(image, caption)] });
        Ok(())
    };
    add("MC".to_owned(), &one.orders[0], BASELINE)?;
    for (order, outcome) in ORDERS.into_iter().zip(&one.orders) {
        add(format!("default, O{order}"), outcome, DEFAULT)?;
    }
    add("least squares, O2".to_owned(), &one.orders[1], LEAST_SQUARES)?;
    section.large.write_image(&format!("{scene}-reference"), &reference.image, reference)?;
    let rows = [format!("left: {}", text::samples_per_pixel(one.spp))];
    let title = format!("{scene}: the same samples");
    let picture = error_sheet::draw(&title, &rows, &columns, reference);
    write_small(section.output, &format!("direct-{scene}.png"), &picture)
}
