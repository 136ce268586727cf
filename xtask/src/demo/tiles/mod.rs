//! The path tracer with random samples, Owen-scrambled Sobol points and noisefloor's tiles.

mod animation;
mod filter;
mod measure;
mod plan;
mod score;
mod sheet;
mod spectrum;
mod table;

use super::Options;
use super::metric::Reference;
use super::output::Output;
use super::progress;
use super::renderer::Renderer;
use anyhow::{Context, Result};
use measure::{Measured, Measurement, baseline};
use plan::{ESTIMATORS, Plan, SCENES, Scene, Tiles};

/// Writes pictures, tiles.md, tiles.csv and tiles-animation.csv; returns the tables.
pub(crate) fn run(options: &Options, renderer: &Renderer, output: &Output) -> Result<String> {
    let plan = Plan::new(options.quick);
    let tiles = Tiles::new(renderer.tiles()?, options.tiles.as_deref())?;
    let scratch = tempfile::tempdir().context("cannot create a temporary folder")?;
    let bar = progress::bar(work(&plan))?;
    let measurement = Measurement { renderer, plan: &plan, bar: &bar, scratch: scratch.path(), tiles: &tiles };
    let (mut rows, mut summary, mut animation) = (Vec::new(), Vec::new(), None);
    for scene in &SCENES {
        let reference = measurement.reference(scene)?;
        let all = measurement.scene(scene, &reference)?;
        write_images(output, scene, &all, &reference)?;
        for estimator in ESTIMATORS {
            write_sheet(output, &plan, scene, estimator, &all, &reference)?;
        }
        rows.extend(table::rows(scene.name, &all));
        summary.extend(table::summary_rows(scene.name, &all));
        if animation.is_none() {
            animation = Some(animation::run(&measurement, scene, &reference, output)?);
        }
    }
    bar.finish_and_clear();
    let tables = [table::summary(&summary), table::markdown(&rows), animation.unwrap_or_default()];
    output.write_text("tiles.md", &report(&plan, &tables))?;
    output.write_text("tiles.csv", &table::csv(&rows))?;
    Ok(tables.join("\n"))
}

/// Roughly what the progress bar will count.
fn work(plan: &Plan) -> u64 {
    let scene = |scene: &Scene| {
        let each: u64 = plan.spp.iter().map(|&spp| plan.work(scene, spp, ESTIMATORS.len())).sum();
        let samplers = scene.samplers.len() as u64 * u64::from(plan.frames) * each;
        2 * plan.work(scene, plan.reference_spp, 0) + samplers
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

fn write_sheet(
    output: &Output,
    plan: &Plan,
    scene: &Scene,
    estimator: &str,
    all: &[Measured],
    reference: &Reference,
) -> Result<()> {
    // Only samplers that exist.
    let used = scene.samplers.iter().filter(|choice| all.iter().any(|one| one.choice == **choice));
    let choices: Vec<_> = used.copied().collect();
    let rows: Vec<sheet::Row> = plan
        .spp
        .iter()
        .map(|&spp| {
            let cell = |choice| {
                let one =
                    all.iter().find(|one| one.choice == choice && one.spp == spp && one.estimator == estimator)?;
                let ratio = |of: fn(&Measured) -> f64| baseline(all, one).map_or(f64::NAN, |plain| of(one) / of(plain));
                let (raw, filtered) = (ratio(|one| one.score.raw), ratio(|one| one.score.filtered));
                Some(sheet::Cell { image: &one.image, caption: format!("raw {raw:.3}x filtered {filtered:.3}x") })
            };
            sheet::Row {
                name: format!("{spp} sample{} per pixel", if spp == 1 { "" } else { "s" }),
                cells: choices.iter().map(|&choice| cell(choice)).collect(),
            }
        })
        .collect();
    let columns: Vec<String> = choices.iter().map(|choice| choice.label()).collect();
    let how = if estimator == ESTIMATORS[0] { "plain mean" } else { "control variate, shared fits" };
    let title = format!("{}: integral over {}; {how}", scene.name, scene.domain);
    let picture = sheet::draw(&title, &columns, &rows, scene, reference);
    output.write_picture(&format!("tiles-{}-{estimator}.png", scene.name), &picture)
}

/// The tables with what their columns mean.
fn report(plan: &Plan, [summary, samplers, animation]: &[String; 3]) -> String {
    format!(
        "# Samplers in a path tracer\n\n\
         Images of {size} x {size} pixels, {threads} threads; errors are means, times medians over {frames} frames.\n\n\
         Error over that of the plain mean of as many random samples, raw / filtered:\n\n{summary}\n\
         All figures:\n\n{samplers}\n\
         - `mc`: the plain mean. `block`: `nf_cv_block_estimate()`, blocks of 8 x 8 pixels, those of one\n  \
           surface share a fit, polynomials of order {order}.\n\
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
        threads = plan.threads,
        frames = plan.frames,
        order = plan::ORDER,
        sigma = filter::SIGMA,
        limit = score::LIMIT,
        scene = SCENES[0].name,
        alpha = animation::ALPHA,
        from = animation::FRAMES,
        to = 2 * animation::FRAMES - 1,
    )
}
