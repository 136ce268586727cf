//! The path tracer with every estimator, and independent samples.

mod measure;
mod plan;
mod table;

use super::Options;
use crate::measure::error_sheet as sheet;
use crate::measure::output::Output;
use crate::measure::progress;
use crate::measure::renderer::{Renderer, threads};
use crate::measure::runs::Runs;
use crate::measure::text;
use anyhow::Result;
use indicatif::ProgressBar;
use measure::{Measured, Measurement};
use plan::{BASELINE, Plan, SCENES, Scene};

/// Writes pictures, table.md and table.csv; returns the table.
pub(crate) fn run(options: &Options, renderer: &Renderer, output: &Output) -> Result<String> {
    let plan = Plan::new(options.quick);
    let bar = progress_bar(&plan)?;
    let runs = Runs::new(renderer, &bar, plan.size)?;
    let measurement = Measurement { runs: &runs, plan: &plan };
    let mut rows = Vec::new();
    for scene in &SCENES {
        let measured = measurement.scene(scene)?;
        write_scene(output, &plan, scene, &measured)?;
        rows.extend(measured.rows);
    }
    bar.finish_and_clear();
    let table = table::markdown(&rows);
    output.write_text("table.md", &report(&plan, &table))?;
    output.write_text("table.csv", &table::csv(&rows))?;
    Ok(table)
}

fn progress_bar(plan: &Plan) -> Result<ProgressBar> {
    let work: u64 = SCENES
        .iter()
        .map(|scene| {
            let estimators = scene.estimators().len();
            let reference = 2 * plan.work(scene, plan.reference_spp(scene), 0);
            // An equal-time rendering per estimator, of about twice the samples.
            let rest = plan.spp.map(|spp| {
                u64::from(plan.repetitions) * plan.work(scene, spp, estimators)
                    + (estimators as u64 - 1) * plan.work(scene, 2 * spp, 1)
            });
            reference + rest.iter().sum::<u64>()
        })
        .sum();
    progress::bar(work)
}

fn write_scene(output: &Output, plan: &Plan, scene: &Scene, measured: &Measured) -> Result<()> {
    let reference = &measured.reference;
    output.write_image(&format!("{}-reference", scene.name), &reference.image, reference)?;
    let mut columns: Vec<sheet::Column> = scene
        .estimators()
        .iter()
        .map(|name| {
            let title = if *name == BASELINE { "plain Monte Carlo".to_owned() } else { (*name).to_owned() };
            sheet::Column { title, cells: Vec::new() }
        })
        .collect();
    let count = columns.len();
    for (index, (image, row)) in measured.images.iter().zip(&measured.rows).enumerate() {
        output.write_image(&format!("{}-{}spp-{}", scene.name, row.spp, row.estimator), image, reference)?;
        let caption = format!("relMSE {:.2e} ({:.2}x)", row.rel_mse, row.ratio);
        columns[index % count].cells.push((image.clone(), caption));
    }
    let rows = plan.spp.map(|spp| format!("left: {}", text::samples_per_pixel(spp)));
    let title = format!("{}: integral over {}; polynomials of order {}", scene.name, scene.domain, scene.order);
    output.write_picture(&format!("{}-comparison.png", scene.name), &sheet::draw(&title, &rows, &columns, reference))
}

/// The table with what its columns mean.
fn report(plan: &Plan, table: &str) -> String {
    format!(
        "# Plain Monte Carlo and noisefloor in a path tracer\n\n\
         Images of {size} x {size} pixels, {threads} threads, medians of {repetitions} runs.\n\n{table}\n\
         - All estimators of a scene and number of samples saw the same samples.\n\
         - relMSE: mean over the pixels of (I - R)^2 / (R^2 + eps), luminance (Rec. 709), eps = 0.01 (mean of R)^2. The\n  \
           reference consists of two independent halves A and B, R = (A + B) / 2, from shifted lattices and plain means;\n  \
           (I - A)(I - B) stands for (I - R)^2, so that the reference's own noise adds nothing.\n\
         - sampling ns, estimating ns: time per sample and thread for tracing it and for estimating from it. The time ratio\n  \
           compares the sums of both; an estimator and the plain mean share the sampling time, batch by batch.\n\
         - Same time: the plain mean was rendered again with so many samples (rounded up) as it makes in the estimator's\n  \
           total time; beyond {limit} times the samples, its relMSE is scaled by 1 / samples instead.\n",
        size = plan.size,
        threads = threads(),
        repetitions = plan.repetitions,
        limit = measure::EQUAL_TIME_LIMIT,
    )
}
