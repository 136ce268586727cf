//! The path tracer with random samples, Owen-scrambled Sobol points and noisefloor's tiles.

mod animation;
mod hero;
mod measure;
mod plan;
mod table;

use super::Options;
use crate::measure::metric::Reference;
use crate::measure::output::Output;
use crate::measure::progress;
use crate::measure::renderer::{Renderer, threads};
use crate::measure::runs::Runs;
use crate::measure::samplers::{Choice, Tiles};
use crate::measure::spectrum_sheet as sheet;
use crate::measure::text;
use anyhow::Result;
use measure::{Measured, Measurement, baseline, find, ratios};
use plan::{BASELINE, ESTIMATORS, Plan, SCENES, Scene};

/// Writes pictures, tiles.md, tiles.csv and tiles-animation.csv; returns the tables.
pub(crate) fn run(options: &Options, renderer: &Renderer, output: &Output) -> Result<String> {
    let plan = Plan::new(options.quick);
    let tiles = Tiles::new(renderer.tiles()?, options.tiles.as_deref())?;
    let bar = progress::bar(work(&plan))?;
    let runs = Runs::new(renderer, &bar, plan.size)?;
    let measurement = Measurement { runs: &runs, plan: &plan, tiles: &tiles };
    let (mut rows, mut summary, mut shared, mut animation) = (Vec::new(), Vec::new(), Vec::new(), None);
    let mut largest = 0.0_f64;
    for scene in &SCENES {
        let reference = measurement.reference(scene)?;
        let all = measurement.scene(scene, &reference)?;
        write_images(output, scene, &all, &reference)?;
        write_sheet(output, &plan, scene, &all, &reference)?;
        rows.extend(table::rows(scene.name, &all));
        summary.extend(table::summary_rows(scene.name, &all));
        shared.extend(table::shared_rows(scene, &all));
        largest = largest.max(table::largest_shared_ratio(&all));
        if animation.is_none() {
            output.write_picture("shared.png", &hero::draw(&plan, &all, &reference))?;
            animation = Some(animation::run(&measurement, scene, &reference, output)?);
        }
    }
    bar.finish_and_clear();
    let shared = format!("{}\nLargest raw ratio: {largest:.3}.\n", table::shared(&shared));
    let tables = [table::summary(&summary), shared, table::markdown(&rows), animation.unwrap_or_default()];
    output.write_text("tiles.md", &report(&plan, &tables))?;
    output.write_text("tiles.csv", &table::csv(&rows))?;
    Ok(tables.join("\n"))
}

/// Roughly what the progress bar will count.
fn work(plan: &Plan) -> u64 {
    let scene = |scene: &Scene| {
        let each: u64 = plan.spp.iter().map(|&spp| plan.work(scene, spp, ESTIMATORS.len())).sum();
        let samplers = scene.samplers.len() as u64 * u64::from(plan.frames(scene)) * each;
        2 * plan.work(scene, plan.reference_spp(scene), 0) + samplers
    };
    let animation = 4 * 2 * u64::from(animation::FRAMES) * plan.work(&SCENES[0], 1, 1);
    SCENES.iter().map(scene).sum::<u64>() + animation
}

fn write_images(output: &Output, scene: &Scene, all: &[Measured], reference: &Reference) -> Result<()> {
    output.write_image(&format!("tiles-{}-reference", scene.name), &reference.image, reference)?;
    for one in all {
        let name = format!("tiles-{}-{}spp-{}-{}", scene.name, one.spp, one.choice.slug(), one.estimator);
        output.write_image(&name, &one.image, reference)?;
    }
    Ok(())
}

/// Every sampler with every estimator, but stratified samples without the fits that a pixel keeps to itself.
fn write_sheet(output: &Output, plan: &Plan, scene: &Scene, all: &[Measured], reference: &Reference) -> Result<()> {
    let columns: Vec<(Choice, &str)> = scene
        .samplers
        .iter()
        .filter(|choice| all.iter().any(|one| one.choice == **choice))
        .flat_map(|&choice| ESTIMATORS.map(|estimator| (choice, estimator)))
        .filter(|&(choice, estimator)| choice == BASELINE || estimator != ESTIMATORS[1])
        .collect();
    let rows: Vec<sheet::Row> = plan
        .spp
        .iter()
        .map(|&spp| {
            let cell = |&(choice, estimator): &(Choice, &str)| {
                let one = find(all, choice, spp, estimator)?;
                let [raw, filtered] = ratios(one, baseline(all, one));
                Some(sheet::Cell { image: &one.image, caption: format!("raw {raw:.3}x filtered {filtered:.3}x") })
            };
            sheet::Row { name: text::samples_per_pixel(spp), cells: columns.iter().map(cell).collect() }
        })
        .collect();
    let names: Vec<String> =
        columns.iter().map(|(choice, estimator)| format!("{}, {estimator}", choice.label())).collect();
    let title = format!("{}: integral over {}; polynomials of order {}", scene.name, scene.domain, scene.order);
    let picture = sheet::draw(&title, &names, &rows, scene.crop, reference);
    output.write_picture(&format!("tiles-{}.png", scene.name), &picture)
}

/// The tables with what their columns mean.
fn report(plan: &Plan, [summary, shared, samplers, animation]: &[String; 4]) -> String {
    let orders: Vec<String> = SCENES.iter().map(|scene| format!("`{}` {}", scene.name, scene.order)).collect();
    let frames: Vec<String> = SCENES.iter().map(|scene| format!("`{}` {}", scene.name, plan.frames(scene))).collect();
    format!(
        "# Samplers in a path tracer\n\n\
         Images of {size} x {size} pixels, {threads} threads; errors are means, times medians over frames ({frames}).\n\n\
         Error over that of the plain mean of as many random samples, raw / filtered:\n\n{summary}\n\
         Error of `shared` over that of the same sampler's plain mean, raw / filtered, and what they cost:\n\n{shared}\n\
         All figures:\n\n{samplers}\n\
         - `mc`: the plain mean. `robust`: `nf_cv_estimate()`, fits to each pixel's own samples; told that samples are\n  \
           stratified, it is the plain mean. `shared`: `nf_cv_image_estimate()`, fits to neighbouring pixels that show the\n  \
           same surface, in windows of 8 x 8; told which of the numbers picks a light.\n\
         - Order of the polynomials: {orders}.\n\
         - relMSE: as in table.md, but relative errors beyond {limit} count as {limit}: one highlight in a dark pixel would\n  \
           otherwise decide. Filtered: the error image is filtered by a Gaussian of standard deviation {sigma} pixels\n  \
           first. Ratios are to the plain mean of as many random samples.\n\
         - low frequencies: power of the errors below .1 cycles per pixel over the mean of all frequencies; white noise has 1.\n\
         - drawing ns: making a sample's coordinates. total ns: that, tracing and estimating, per sample and thread.\n\
         - same time: the ratio times the total time over that of the plain mean of random samples, whose error falls as\n  \
           1 / samples: what is left once random sampling has been given the same time.\n\
         - tile 4D draws lens and light together; tile 2D draws each from its own domain. At 16 samples tile 4D goes on\n  \
           beyond its own 4.\n\n\
         ## Animation\n\n\
         Scene `{scene}`, one sample per pixel and frame, exponential moving average with weight {alpha} for the newest frame;\n\
         means over frames {from} to {to}.\n\n{animation}",
        size = plan.size,
        threads = threads(),
        frames = frames.join(", "),
        orders = orders.join(", "),
        sigma = crate::measure::filter::SIGMA,
        limit = crate::measure::score::LIMIT,
        scene = SCENES[0].name,
        alpha = animation::ALPHA,
        from = animation::FRAMES,
        to = 2 * animation::FRAMES - 1,
    )
}
