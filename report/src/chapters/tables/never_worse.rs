//! Is the default ever worse than plain Monte Carlo? Over whole images, and pixel by pixel.

use super::Section;
use super::comparison::seeds;
use crate::chapters::chapter::{headings, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::measurement::{BASELINE, DEFAULT, Experiment, View};
use crate::chapters::pixels::{BATCHES, SIGNIFICANCE, Shares, TOO_MUCH};
use crate::chapters::scenes::{SCENES, Scene};
use crate::chapters::statistics::Estimate;
use anyhow::{Result, bail};
use image::Rgb32FImage;

pub(super) fn write(section: &mut Section) -> Result<()> {
    section.targets.reason(
        ["default over MC, one light", ""],
        "What remains is the visibility of the light, a step that polynomials follow roughly: where penumbras fill the image, or the \
         environment varies faster than that, the gain is small.",
    );
    section.targets.reason(
        ["share of pixels beyond", ""],
        "Pixels whose few bright samples carry the integral: leave-one-out errors do not see what was not sampled.",
    );
    write_images(section)?;
    write_pixels(section)
}

/// Scenes that earlier sections have rendered in the full size, so that it costs nothing here.
const LARGE: [&str; 5] = ["killeroos", "bathroom", "dining", "dragon", "chopper"];

/// Many seeds of few pixels.
fn pixels_size(section: &Section) -> u32 {
    section.measurement.plan.small * 3 / 4
}

/// Of the seeds of pixels' ratios.
fn batches(section: &Section) -> u32 {
    BATCHES.min(section.measurement.plan.pixel_seeds / 2)
}

fn order(scene: &Scene) -> u32 {
    // 136 terms are more than there are samples.
    if scene.dims > 8 { 1 } else { 2 }
}

fn write_images(section: &mut Section) -> Result<()> {
    section.chapter.section("The default against plain Monte Carlo, every scene", "");
    let plan = section.measurement.plan;
    let [one, two] = [section.chapter.setting("order at many dims", 1), section.chapter.setting("order else", 2)];
    let names = LARGE.map(|name| format!("`{name}`")).join(", ");
    let size = section.chapter.setting("pixels on a side, every scene", plan.small);
    section.chapter.paragraph(&format!(
        "{size} x {size} pixels, but in {names}, whose images are those of earlier sections. relMSE of the default over MC's, the same samples; order {two}, at more than eight dims order {one}. Least squares beside it shows what \
         the default guards against."
    ));
    let mut rows = Vec::new();
    for scene in plan.some(SCENES) {
        let size = if LARGE.contains(&scene.name) { plan.size } else { plan.small };
        let mut cells = row![scene.name, scene.dims];
        for &spp in plan.spp {
            let estimators = [BASELINE, DEFAULT, crate::chapters::measurement::LEAST_SQUARES];
            let experiment =
                Experiment { order: order(scene), ..Experiment::new(View::new(scene.name, size), spp, &estimators) };
            let outcome = section.measurement.run(&seeds(section, experiment))?;
            let ratio = outcome.ratio(DEFAULT)?;
            section.targets.at_most(
                &format!("default over MC, whole image, {spp} spp"),
                scene.name,
                ratio,
                Unit::Ratio,
                1.01,
            );
            // The bounds were set for 16 and 64 samples.
            if scene.one_light && spp <= 64 {
                let bound = if spp >= 64 { 0.4 } else { 0.6 };
                let statement = format!("default over MC, one light, order {two}, {spp} spp");
                section.targets.at_most(&statement, scene.name, ratio, Unit::Ratio, bound);
            }
            cells.push(Figure::new(ratio, Unit::Ratio).into());
            cells.push(Figure::new(outcome.ratio(estimators[2])?, Unit::Ratio).into());
        }
        rows.push(cells);
    }
    let each = plan.spp.iter().flat_map(|spp| [format!("default, {spp} spp"), format!("least squares, {spp} spp")]);
    let columns = headings(&["scene", "dims"], each);
    section.chapter.table("never worse, images", &columns, 1, rows);
    Ok(())
}

fn write_pixels(section: &mut Section) -> Result<()> {
    section.chapter.section("The default against plain Monte Carlo, pixel by pixel", "");
    let plan = section.measurement.plan;
    let spp = section.chapter.setting("samples per pixel of the pixels' ratios", 16);
    let size = section.chapter.setting("pixels on a side of the pixels' ratios", pixels_size(section));
    let seeds = section.chapter.setting("seeds of the pixels' ratios", plan.pixel_seeds);
    let limit = section.chapter.setting("a pixel's ratio that is too much", TOO_MUCH);
    let confidence = section.chapter.setting("confidence, percent", 95);
    let batches = section.chapter.setting("batches of seeds", batches(section));
    let percent = section.chapter.setting("significance of a pixel's test, percent", 100.0 * SIGNIFICANCE);
    section.chapter.paragraph(&format!(
        "Mean squared error of each pixel over {seeds} seeds, {spp} samples per pixel, {size} x {size} pixels; the share of pixels where \
         the default's is more than {limit} times MC's. Measured ratios are noisy, so three figures: pixels beyond it as measured (too many), pixels beyond it \
         in both halves of the seeds, and pixels where a one-sided test over {batches} batches of seeds says so at a level of {percent} % each (too few). \
         The first has a {confidence} % interval, from the bootstrap over the batches. A pixel without noise, where neither has an error, does not count; \
         where only the plain mean has none, the pixel counts as beyond."
    ));
    let mut rows = Vec::new();
    for scene in plan.some(SCENES) {
        let shares = shares(section, scene, spp)?;
        let statement = format!("share of pixels beyond {limit} as measured, {spp} spp, percent");
        let [low, high] = shares.interval();
        let raw = Estimate { value: shares.raw, low, high, seeds: seeds as usize };
        section.targets.at_most(&statement, scene.name, raw, Unit::Percent, 1.0);
        let percent = |value| Figure::exact(value, Unit::Percent);
        rows.push(row![
            scene.name,
            Figure::exact(shares.pixels as f64, Unit::Count),
            Figure::new(raw, Unit::Percent),
            percent(shares.twice),
            percent(shares.sure),
            Figure::exact(shares.largest(), Unit::Ratio)
        ]);
    }
    let columns = ["scene", "pixels", "as measured, %", "in both halves, %", "significantly, %", "largest ratio"];
    section.chapter.table("never worse, pixels", &columns, 1, rows);
    Ok(())
}

fn shares(section: &Section, scene: &Scene, spp: u32) -> Result<Shares> {
    let (plan, batches) = (section.measurement.plan, batches(section));
    let estimators = [BASELINE, DEFAULT];
    let experiment = Experiment {
        order: order(scene),
        seeds: plan.pixel_seeds / batches,
        ..Experiment::new(View::new(scene.name, pixels_size(section)), spp, &estimators)
    };
    let mut errors = Vec::new();
    for batch in section.measurement.statistics(&experiment, batches)? {
        let [plain, own] = &batch[..] else {
            bail!("statistics of other estimators than were asked for");
        };
        errors.push([sums(&plain[1]), sums(&own[1])]);
    }
    Ok(Shares::new(&errors))
}

/// Of the three channels of each pixel.
fn sums(image: &Rgb32FImage) -> Vec<f64> {
    image.pixels().map(|pixel| pixel.0.iter().map(|&value| f64::from(value)).sum()).collect()
}
