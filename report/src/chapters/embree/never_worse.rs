//! Is the default ever worse than plain Monte Carlo? Pixel by pixel.

use super::Harness;
use super::pixels::{BATCHES, SIGNIFICANCE, Shares, TOO_MUCH};
use crate::chapters::prelude::*;
use crate::measure::renderer::Job;
use image::Rgb32FImage;

const SPP: u32 = 16;

pub(super) fn write(harness: &Harness, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    chapter.section("The default against plain Monte Carlo, pixel by pixel");
    let seeds = harness.plan.of("pixel_seeds");
    let batches = BATCHES.min(seeds / 2);
    chapter.setting("a pixel's ratio that is too much", TOO_MUCH);
    chapter.setting("batches of seeds", batches);
    chapter.setting("significance of a pixel's test, percent", 100.0 * SIGNIFICANCE);
    let mut rows = Vec::new();
    let section = harness.runs.section.iter().find(|section| section.name == "never worse");
    let runs = section.context("no section `never worse`")?.runs.iter();
    for (scene, order) in runs.flat_map(|run| harness.plan.some(&run.scenes).iter().map(|scene| (scene, run.order[0])))
    {
        let view = harness.view(scene, harness.plan.of("pixels_size"), 1)?;
        let job = Job { order, seeds: seeds / batches, ..Job::new(view, SPP, &["mc", "robust"]) };
        let mut errors = Vec::new();
        for batch in harness.measurement.statistics(&job, batches)? {
            let [plain, own] = &batch[..] else { bail!("statistics of other estimators than were asked for") };
            errors.push([sums(&plain[1]), sums(&own[1])]);
        }
        let shares = Shares::new(&errors);
        let statement = format!("share of pixels beyond {TOO_MUCH} as measured, {SPP} spp, percent");
        let [low, high] = shares.interval();
        let raw = Estimate { value: shares.raw, low, high, seeds: seeds as usize };
        targets.at_most(&statement, scene, raw, Unit::Percent, 1.0);
        let percent = |value| Figure::exact(value, Unit::Percent);
        rows.push(row![
            scene.as_str(),
            Figure::count(shares.pixels),
            Figure::new(raw, Unit::Percent),
            percent(shares.twice),
            percent(shares.sure),
            Figure::exact(shares.largest(), Unit::Ratio)
        ]);
    }
    let columns = "scene | pixels | as measured, % | in both halves, % | significantly, % | largest ratio";
    chapter.table("never worse, pixels", columns, 1, rows);
    Ok(())
}

/// Of the three channels of each pixel.
fn sums(image: &Rgb32FImage) -> Vec<f64> {
    image.pixels().map(|pixel| pixel.0.iter().map(|&value| f64::from(value)).sum()).collect()
}
