//! Many seeds of small pictures: biases, and the pixels that the default serves worst.

use super::ORDER;
use crate::chapters::Report;
use crate::chapters::chapter::{Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::pixels::{BATCHES, Batch, Shares, TOO_MUCH};
use crate::chapters::statistics::Estimate;
use crate::chapters::tables::targets::Targets;
use crate::measure::interrupt;
use crate::measure::metric::{Reference, median};
use crate::measure::renderer::Sampler;
use crate::povray::bias::{self, Bias, moments};
use crate::povray::oracle::{Model, Oracle, Request};
use crate::povray::scenes::SCENES;
use anyhow::{Result, bail};
use image::Rgb32FImage;

/// Pixels on a side, and samples of each.
const SIZE: u32 = 32;
const SPP: u32 = 16;
/// At most so many percent of the pixels may be beyond [`TOO_MUCH`].
const BAD_PERCENT: f64 = 1.0;
/// Chance that an unbiased estimator exceeds the limit somewhere in the table.
const SIGNIFICANCE: f64 = 0.01;

pub(super) fn write(report: &Report, oracle: &Oracle, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    let seeds = report.plan.pixel_seeds;
    // What takes time is `shared` and `slices`; a quarter of the seeds shows a bias of twice the size.
    let bias_seeds = if report.plan.is_full() { seeds / 2 } else { (seeds / 4).max(seeds.min(8)) };
    let (mut biases, mut pixels) = (Vec::new(), Vec::new());
    for scene in &SCENES {
        let view = oracle.view(scene, scene.small, SIZE)?;
        interrupt::check(&report.interrupted)?;
        let names = scene.estimators();
        let (model, sampler) = (Model::Cells, Sampler::Random);
        let request = |estimators, seeds| Request { model, spp: SPP, order: ORDER, sampler, estimators, seeds };
        for (name, one) in names.iter().zip(oracle.render(&view, &request(&names, bias_seeds))?) {
            let Bias { deviations, .. } = bias::largest(&one.images, &view.reference);
            let own = moments(&one.images, &view.reference);
            biases.push(row![
                scene.name,
                *name,
                Figure::exact(deviations, Unit::Sigmas),
                Figure::exact(own.bias_over_error(), Unit::Ratio)
            ]);
        }
        let [plain, default] = &oracle.render(&view, &request(&["mc", "robust"], seeds))?[..] else {
            bail!("other estimators were rendered than were asked for");
        };
        let shares = Shares::new(&batches(&plain.images, &default.images, &view.reference));
        let [low, high] = shares.interval();
        let estimate = Estimate { value: shares.raw, low, high, seeds: seeds as usize };
        targets.at_most(
            "percent of pixels where the default's error is beyond 1.2 of the plain mean's, 16 spp",
            scene.name,
            estimate,
            Unit::Percent,
            BAD_PERCENT,
        );
        pixels.push(row![
            scene.name,
            Figure::exact(shares.pixels as f64, Unit::Count),
            Figure::new(estimate, Unit::Percent),
            Figure::exact(shares.largest(), Unit::Ratio),
            Figure::exact(median(shares.ratios), Unit::Ratio)
        ]);
    }
    let limit = bias::limit(SIGNIFICANCE, biases.len() * bias::TESTS);
    let limit = chapter.quote("limit of deviations", Figure::exact(limit, Unit::Sigmas));
    let bias_seeds = chapter.setting("seeds of biases", bias_seeds);
    let seeds = chapter.setting("seeds of single pixels", seeds);
    let size = chapter.setting("pixels on a side, biases", SIZE);
    let spp = chapter.setting("samples per pixel, biases", SPP);
    let tests = chapter.setting("tests of an estimator", bias::TESTS as u32);
    let percent = chapter.setting("significance, percent", 100.0 * SIGNIFICANCE);
    let bad = chapter.setting("a badly served pixel's ratio", TOO_MUCH);
    let confidence = chapter.setting("confidence, percent", 95);
    let batches = chapter.setting("batches of seeds", BATCHES);
    chapter.section("Bias, and single pixels", "");
    chapter.paragraph(&format!(
        "{bias_seeds} seeds of {size} x {size} pixels, grids of the tests, {spp} random samples. Deviation: of the mean picture from the exact one, in \
         standard errors, the largest of {tests} (the image, and blocks of it). If nothing were biased, the largest of the whole table would \
         exceed {limit} with a chance of at most {percent} %. Bias over error: root of the mean over the pixels of the squared bias, less what \
         chance adds to it, over the root of the mean squared error; nought where chance explains all. `mc`, `leave_one_out`, `k_fold` and \
         `incremental` are unbiased by construction."
    ));
    chapter.table("biases", &["scene", "estimator", "deviation", "bias over error"], 2, biases);
    chapter.paragraph(&format!(
        "The default pixel by pixel, {seeds} seeds: mean squared error over the plain mean's, of the same samples; how many percent of the pixels are \
         beyond {bad}, with its {confidence} % interval (bootstrap over {batches} batches of seeds), the worst pixel, and the median pixel. Pixels \
         where neither has an error do not count; those where only the plain mean has none count as beyond."
    ));
    chapter.table("pixels", &["scene", "pixels", "percent beyond", "worst", "median"], 1, pixels);
    Ok(())
}

/// Mean squared errors of both, in batches of consecutive seeds.
fn batches(plain: &[Rgb32FImage], own: &[Rgb32FImage], reference: &Reference) -> Vec<Batch> {
    let size = (plain.len() / BATCHES as usize).max(1);
    let pairs = plain.chunks(size).zip(own.chunks(size));
    pairs.map(|(plain, own)| [plain, own].map(|images| moments(images, reference).squares)).collect()
}
