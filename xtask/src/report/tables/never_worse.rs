//! Is the default ever worse than plain Monte Carlo? Over whole images, and pixel by pixel.

use super::Section;
use super::comparison::seeds;
use crate::report::chapter::row;
use crate::report::figure::{Figure, Unit};
use crate::report::measurement::{BASELINE, DEFAULT, Experiment, View};
use crate::report::scenes::{SCENES, Scene};
use crate::report::statistics::{Estimate, normal_quantile};
use anyhow::{Result, bail};
use image::Rgb32FImage;

/// Ratios of mean squared errors beyond it are too many.
const TOO_MUCH: f64 = 1.2;
/// The seeds come in as many batches, whose spread says how sure a pixel's ratio is.
const BATCHES: u32 = 8;
/// Of the test of each pixel, one-sided.
const SIGNIFICANCE: f64 = 0.01;

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

fn order(scene: &Scene) -> u32 {
    // 136 terms are more than there are samples.
    if scene.dims > 8 { 1 } else { 2 }
}

fn write_images(section: &mut Section) -> Result<()> {
    section.chapter.section("The default against plain Monte Carlo, every scene", "");
    let plan = section.measurement.plan;
    let [one, two] = [section.chapter.setting("order at many dims", 1), section.chapter.setting("order else", 2)];
    section.chapter.paragraph(&format!(
        "relMSE of the default over MC's, the same samples; order {two}, at more than eight dims order {one}. Least squares beside it shows what \
         the default guards against."
    ));
    let spps: Vec<u32> = plan.spp.iter().copied().filter(|&spp| spp <= 64).collect();
    let mut rows = Vec::new();
    for scene in plan.some(SCENES) {
        let size = if scene.dims > 8 { plan.small } else { plan.size };
        let mut cells = row![scene.name, scene.dims];
        for &spp in &spps {
            let estimators = [BASELINE, DEFAULT, crate::report::measurement::LEAST_SQUARES];
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
            if scene.one_light {
                let bound = if spp >= 64 { 0.4 } else { 0.6 };
                let statement = format!("default over MC, one light, order {two}, {spp} spp");
                section.targets.at_most(&statement, scene.name, ratio, Unit::Ratio, bound);
            }
            cells.push(Figure::new(ratio, Unit::Ratio).into());
            cells.push(Figure::new(outcome.ratio(estimators[2])?, Unit::Ratio).into());
        }
        rows.push(cells);
    }
    let mut columns = vec!["scene".to_owned(), "dims".to_owned()];
    columns.extend(spps.iter().flat_map(|spp| [format!("default, {spp} spp"), format!("least squares, {spp} spp")]));
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    section.chapter.table("never worse, images", &columns, 1, rows);
    Ok(())
}

/// The shares of a scene's pixels whose ratio of mean squared errors is beyond [`TOO_MUCH`], in per cent.
struct Shares {
    pixels: usize,
    /// As measured; noise throws some pixels beyond.
    raw: f64,
    /// Beyond in both halves of the seeds.
    twice: f64,
    /// Beyond, significantly.
    sure: f64,
    /// Of the measured ratios.
    largest: f64,
}

fn write_pixels(section: &mut Section) -> Result<()> {
    section.chapter.section("The default against plain Monte Carlo, pixel by pixel", "");
    let plan = section.measurement.plan;
    let spp = section.chapter.setting("samples per pixel of the pixels' ratios", 16);
    let size = section.chapter.setting("pixels on a side of the pixels' ratios", plan.small);
    let seeds = section.chapter.setting("seeds of the pixels' ratios", plan.pixel_seeds);
    let limit = section.chapter.setting("a pixel's ratio that is too much", TOO_MUCH);
    let percent = section.chapter.setting("significance of a pixel's test, percent", 100.0 * SIGNIFICANCE);
    section.chapter.paragraph(&format!(
        "Mean squared error of each pixel over {seeds} seeds, {spp} samples per pixel, {size} x {size} pixels; the share of pixels where \
         the default's is more than {limit} times MC's. Measured ratios are noisy, so three figures: pixels beyond it as measured (too many), pixels beyond it \
         in both halves of the seeds, and pixels where a one-sided test over {BATCHES} batches of seeds says so at a level of {percent} % each (too few). \
         Pixels without noise do not count."
    ));
    section.chapter.setting("batches of seeds", BATCHES);
    let mut rows = Vec::new();
    for scene in plan.some(SCENES) {
        let shares = shares(section, scene, spp)?;
        let statement = format!("share of pixels beyond {limit} as measured, {spp} spp, percent");
        let estimate = Estimate { value: shares.raw, low: shares.raw, high: shares.raw, seeds: seeds as usize };
        section.targets.at_most(&statement, scene.name, estimate, Unit::Percent, 1.0);
        let percent = |value| Figure::exact(value, Unit::Percent);
        rows.push(row![
            scene.name,
            Figure::exact(shares.pixels as f64, Unit::Count),
            percent(shares.raw),
            percent(shares.twice),
            percent(shares.sure),
            Figure::exact(shares.largest, Unit::Ratio)
        ]);
    }
    let columns = ["scene", "pixels", "as measured, %", "in both halves, %", "significantly, %", "largest ratio"];
    section.chapter.table("never worse, pixels", &columns, 1, rows);
    Ok(())
}

fn shares(section: &Section, scene: &Scene, spp: u32) -> Result<Shares> {
    let plan = section.measurement.plan;
    let batches = BATCHES.min(plan.pixel_seeds / 2);
    let estimators = [BASELINE, DEFAULT];
    let experiment = Experiment {
        order: order(scene),
        seeds: plan.pixel_seeds / batches,
        ..Experiment::new(View::new(scene.name, plan.small), spp, &estimators)
    };
    let mut errors = Vec::new();
    for batch in 0..batches {
        let [plain, own] = &section.measurement.statistics(&experiment, batch * experiment.seeds)?[..] else {
            bail!("statistics of other estimators than were asked for");
        };
        errors.push([sums(&plain[1]), sums(&own[1])]);
    }
    let pixels = errors.first().map_or(0, |[plain, _]| plain.len());
    let mean = |batches: &[[Vec<f64>; 2]], estimator: usize, pixel: usize| {
        batches.iter().map(|batch| batch[estimator][pixel]).sum::<f64>() / batches.len() as f64
    };
    let brightest = (0..pixels).map(|pixel| mean(&errors, 0, pixel)).fold(0.0, f64::max);
    let noisy: Vec<usize> = (0..pixels).filter(|&pixel| mean(&errors, 0, pixel) > 1e-9 * brightest).collect();
    let ratio = |batches: &[[Vec<f64>; 2]], pixel| mean(batches, 1, pixel) / mean(batches, 0, pixel);
    let (first, second) = errors.split_at(errors.len() / 2);
    let beyond = |batches: &[[Vec<f64>; 2]], pixel| ratio(batches, pixel) > TOO_MUCH;
    let share = |of: &dyn Fn(usize) -> bool| {
        100.0 * noisy.iter().filter(|&&pixel| of(pixel)).count() as f64 / noisy.len().max(1) as f64
    };
    Ok(Shares {
        pixels: noisy.len(),
        raw: share(&|pixel| beyond(&errors, pixel)),
        twice: share(&|pixel| beyond(first, pixel) && beyond(second, pixel)),
        sure: share(&|pixel| is_sure(&errors, pixel)),
        largest: noisy.iter().map(|&pixel| ratio(&errors, pixel)).fold(0.0, f64::max),
    })
}

/// Is the mean over the batches of (own - limit * plain) above 0? Of 8 batches, Student's distribution: its quantile at
/// 1 % is 3.00 for 7 degrees of freedom, the normal one 2.33; Cornish and Fisher's terms make up for it (2.98).
fn is_sure(batches: &[[Vec<f64>; 2]], pixel: usize) -> bool {
    let excess: Vec<f64> = batches.iter().map(|[plain, own]| own[pixel] - TOO_MUCH * plain[pixel]).collect();
    let n = excess.len() as f64;
    let mean = excess.iter().sum::<f64>() / n;
    let variance = excess.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    let normal = normal_quantile(SIGNIFICANCE);
    let freedom = (n - 1.0).max(1.0);
    let first = (normal.powi(3) + normal) / (4.0 * freedom);
    let second = (5.0 * normal.powi(5) + 16.0 * normal.powi(3) + 3.0 * normal) / (96.0 * freedom * freedom);
    let quantile = normal + first + second;
    mean > quantile * (variance / n).sqrt() && mean > 0.0
}

/// Of the three channels of each pixel.
fn sums(image: &Rgb32FImage) -> Vec<f64> {
    image.pixels().map(|pixel| pixel.0.iter().map(|&value| f64::from(value)).sum()).collect()
}
