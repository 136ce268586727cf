//! Many seeds of small pictures: biases, and the pixels that the default serves worst.

use super::ORDER;
use crate::measure::interrupt;
use crate::measure::renderer::Sampler;
use crate::povray::bias::{self, Bias, moments};
use crate::povray::oracle::{Model, Oracle, Request};
use crate::povray::scenes::SCENES;
use crate::report::Report;
use crate::report::chapter::{Chapter, row};
use crate::report::figure::{Figure, Unit};
use crate::report::statistics::Estimate;
use crate::report::tables::targets::Targets;
use anyhow::Result;
use indicatif::ProgressBar;

/// Pixels on a side, and samples of each.
const SIZE: u32 = 32;
const SPP: u32 = 16;
/// A pixel is served badly if its error is so many times the plain mean's; at most so many percent of the pixels may be.
const BAD: f64 = 1.2;
const BAD_PERCENT: f64 = 1.0;
/// Chance that an unbiased estimator exceeds the limit somewhere in the table.
const SIGNIFICANCE: f64 = 0.01;

pub(super) fn write(report: &Report, oracle: &Oracle, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    let seeds = report.plan.pixel_seeds;
    let (mut biases, mut pixels) = (Vec::new(), Vec::new());
    for scene in &SCENES {
        let view = oracle.view(scene, scene.small, SIZE)?;
        interrupt::check(&report.interrupted)?;
        let names = scene.estimators();
        let (model, sampler) = (Model::Cells, Sampler::Random);
        let request = Request { model, spp: SPP, order: ORDER, sampler, estimators: &names, seeds };
        let renderings = oracle.render(&view, &request, &ProgressBar::hidden())?;
        let plain = moments(&renderings[0].images, &view.reference);
        for (name, one) in names.iter().zip(renderings) {
            let Bias { deviations, .. } = bias::largest(&one.images, &view.reference);
            let own = moments(&one.images, &view.reference);
            biases.push(row![
                scene.name,
                *name,
                Figure::exact(deviations, Unit::Sigmas),
                Figure::exact(own.bias_over_error(), Unit::Ratio)
            ]);
            if *name == "robust" {
                let ratios: Vec<f64> = own.squares.iter().zip(&plain.squares).map(|(own, plain)| own / plain).collect();
                // A pixel that no sample changes has no error either way.
                let ratios: Vec<f64> = ratios.into_iter().filter(|ratio| ratio.is_finite()).collect();
                let bad = 100.0 * ratios.iter().filter(|&&ratio| ratio > BAD).count() as f64 / own.squares.len() as f64;
                let worst = ratios.iter().copied().fold(0.0, f64::max);
                let estimate = Estimate { value: bad, low: bad, high: bad, seeds: 1 };
                targets.at_most(
                    "percent of pixels where the default's error is beyond 1.2 of the plain mean's, 16 spp",
                    scene.name,
                    estimate,
                    Unit::Percent,
                    BAD_PERCENT,
                );
                pixels.push(row![
                    scene.name,
                    Figure::exact(bad, Unit::Percent),
                    Figure::exact(worst, Unit::Ratio),
                    Figure::new(Estimate::median(&ratios), Unit::Ratio)
                ]);
            }
        }
    }
    let limit = bias::limit(SIGNIFICANCE, biases.len() * bias::TESTS);
    let limit = chapter.quote("limit of deviations", Figure::exact(limit, Unit::Sigmas));
    let seeds = chapter.setting("seeds of biases", seeds);
    let size = chapter.setting("pixels on a side, biases", SIZE);
    let spp = chapter.setting("samples per pixel, biases", SPP);
    let tests = chapter.setting("tests of an estimator", bias::TESTS as u32);
    let percent = chapter.setting("significance, percent", 100.0 * SIGNIFICANCE);
    let bad = chapter.setting("a badly served pixel's ratio", BAD);
    chapter.section("Bias, and single pixels", "");
    chapter.paragraph(&format!(
        "{seeds} seeds of {size} x {size} pixels, grids of the tests, {spp} random samples. Deviation: of the mean picture from the exact one, in \
         standard errors, the largest of {tests} (the image, and blocks of it). If nothing were biased, the largest of the whole table would \
         exceed {limit} with a chance of at most {percent} %. Bias over error: root of the mean over the pixels of the squared bias, less what \
         chance adds to it, over the root of the mean squared error; nought where chance explains all. `mc`, `leave_one_out`, `k_fold` and \
         `incremental` are unbiased by construction."
    ));
    chapter.table("biases", &["scene", "estimator", "deviation", "bias over error"], 2, biases);
    chapter.paragraph(&format!(
        "The default pixel by pixel: mean squared error over the plain mean's, of the same samples; how many percent of the pixels are beyond \
         {bad}, the worst pixel, and the median pixel."
    ));
    chapter.table("pixels", &["scene", "percent beyond", "worst", "median"], 1, pixels);
    Ok(())
}
