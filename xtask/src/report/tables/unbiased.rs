//! Are shared fits unbiased? The mean of many independent frames against the reference.

use super::Section;
use crate::measure::metric::median;
use crate::measure::renderer::Sampler;
use crate::measure::samplers::{Choice, Tiles};
use crate::report::chapter::row;
use crate::report::figure::{Figure, Unit};
use crate::report::measurement::{BASELINE, Experiment, SHARED, View};
use crate::report::statistics::{Estimate, normal_quantile};
use anyhow::Result;
use image::Rgb32FImage;

const SCENES: [&str; 2] = ["dining", "killeroos"];
const SPP: [u32; 2] = [1, 4];
/// Of the whole test of an image: each pixel and channel has it divided by their number (Bonferroni), whatever the
/// dependence between them.
const SIGNIFICANCE: f64 = 0.01;

/// Standard scores of every pixel and channel that has noise.
struct Scores {
    count: usize,
    largest: f64,
    /// Of their squares: 1 without bias.
    mean_square: f64,
    /// Of the image's mean.
    image: f64,
    median: f64,
}

pub(super) fn write(section: &mut Section) -> Result<()> {
    section.chapter.section("Are shared fits unbiased?", "");
    let plan = section.measurement.plan;
    let (frames, size) = (section.chapter.setting("frames of the test of biases", plan.frames), plan.small);
    let percent = section.chapter.setting("significance of the test of biases, percent", 100.0 * SIGNIFICANCE);
    section.chapter.paragraph(&format!(
        "The mean of {frames} independent frames, {size} x {size} pixels, against the reference: for each pixel and channel its distance in \
         standard deviations, z. The largest |z| is compared with what chance allows at {percent} % for all of them together (Bonferroni, so that \
         dependence between pixels does no harm; a two-sided test). The plain mean of the same samples, unbiased by construction, shows how the test itself behaves: \
         rare bright samples make z of a pixel skewed, and the reference's own error is small but not nought."
    ));
    let tiles = Tiles::new(section.measurement.renderer.tiles()?, None)?;
    let mut rows = Vec::new();
    for &scene in plan.some(&SCENES) {
        for &spp in plan.some(&SPP) {
            let samplers = [("random", Some(Sampler::Random)), ("tile", Choice::Tile(2).sampler(spp, &tiles))];
            for (label, sampler) in samplers {
                let Some(sampler) = sampler else { continue };
                // The reference's error must be small beside that of the mean of so many frames.
                let view = View { precision: 16, ..View::new(scene, size) };
                let estimators = [BASELINE, SHARED];
                let experiment = Experiment { sampler, seeds: plan.frames, ..Experiment::new(view, spp, &estimators) };
                let statistics = section.measurement.statistics(&experiment, 0)?;
                let reference = section.measurement.reference(view)?;
                for (estimator, [mean, mse]) in ["plain mean", "shared fits"].into_iter().zip(&statistics) {
                    let scores = scores(mean, mse, &reference.images, plan.frames);
                    let allowed = normal_quantile(SIGNIFICANCE / (2.0 * scores.count as f64));
                    if estimator == "shared fits" {
                        let statement = "shared fits unbiased: largest |z| of the mean of independent frames, over what chance allows";
                        let estimate = Estimate::median(&[scores.largest / allowed]);
                        section.targets.at_most(
                            statement,
                            &format!("{scene}, {label}, {spp} spp"),
                            estimate,
                            Unit::Ratio,
                            1.0,
                        );
                    }
                    let sigmas = |value| Figure::exact(value, Unit::Sigmas);
                    rows.push(row![
                        scene,
                        spp,
                        label,
                        estimator,
                        Figure::exact(scores.count as f64, Unit::Count),
                        sigmas(scores.largest),
                        sigmas(allowed),
                        Figure::exact(scores.mean_square, Unit::Ratio),
                        sigmas(scores.median),
                        sigmas(scores.image)
                    ]);
                }
            }
        }
    }
    let columns = [
        "scene",
        "samples",
        "sampler",
        "estimator",
        "tests",
        "largest |z|",
        "chance allows",
        "mean z^2",
        "median z",
        "mean z",
    ];
    section.chapter.setting("power of z", 2);
    section.chapter.table("unbiased", &columns, 1, rows);
    Ok(())
}

fn scores(mean: &Rgb32FImage, mse: &Rgb32FImage, halves: &[Rgb32FImage; 2], frames: u32) -> Scores {
    let n = f64::from(frames);
    let values = |image: &Rgb32FImage| -> Vec<f64> { image.as_raw().iter().map(|&value| f64::from(value)).collect() };
    let (mean, mse, [a, b]) = (values(mean), values(mse), halves.each_ref().map(values));
    let mut all = Vec::new();
    for i in 0..mean.len() {
        // What is measured about the reference, less the square of the distance, is the frames' variance.
        let reference = 0.5 * (a[i] + b[i]);
        let (distance, own) = (mean[i] - reference, 0.25 * (a[i] - b[i]).powi(2));
        let variance = (mse[i] - (mean[i] - a[i]) * (mean[i] - b[i])).max(0.0) / (n - 1.0) + own;
        if variance > 1e-12 * reference * reference + 1e-30 {
            all.push(distance / variance.sqrt());
        }
    }
    let count = all.len();
    let total = |of: fn(f64) -> f64| all.iter().map(|&z| of(z)).sum::<f64>() / count.max(1) as f64;
    Scores {
        count,
        largest: all.iter().map(|z| z.abs()).fold(0.0, f64::max),
        mean_square: total(|z| z * z),
        image: total(|z| z),
        median: median(all.iter().copied()),
    }
}
