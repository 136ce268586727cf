//! Is the default ever worse than plain Monte Carlo? Over whole images, and pixel by pixel.

use super::Section;
use super::estimators::seeds;
use crate::chapters::chapter::headings;
use crate::chapters::measurement::{BASELINE, DEFAULT, Experiment, View};
use crate::chapters::pixels::{BATCHES, SIGNIFICANCE, Shares, TOO_MUCH};
use crate::chapters::prelude::*;
use crate::chapters::scenes::{SCENES, Scene};
use anyhow::bail;
use image::Rgb32FImage;

pub(super) fn write(section: &mut Section) -> Result<()> {
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
    section.chapter.setting("pixels on a side, every scene", plan.small);
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
                let statement = format!("default over MC, one light, order 2, {spp} spp");
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
    let (spp, seeds) = (16, plan.pixel_seeds);
    section.chapter.setting("pixels on a side of the pixels' ratios", pixels_size(section));
    section.chapter.setting("seeds of the pixels' ratios", plan.pixel_seeds);
    section.chapter.setting("a pixel's ratio that is too much", TOO_MUCH);
    section.chapter.setting("batches of seeds", batches(section));
    section.chapter.setting("significance of a pixel's test, percent", 100.0 * SIGNIFICANCE);
    let mut rows = Vec::new();
    for scene in plan.some(SCENES) {
        let shares = shares(section, scene, spp)?;
        let statement = format!("share of pixels beyond {TOO_MUCH} as measured, {spp} spp, percent");
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
    let columns = "scene | pixels | as measured, % | in both halves, % | significantly, % | largest ratio";
    section.chapter.table("never worse, pixels", columns, 1, rows);
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
