//! Are shared fits unbiased? The mean of many independent frames against the reference.

use super::Section;
use crate::measure::metric::median;
use crate::measure::renderer::Sampler;
use crate::measure::samplers::{Choice, Tiles};
use crate::report::chapter::row;
use crate::report::figure::{Figure, Unit};
use crate::report::measurement::{BASELINE, Experiment, SHARED, SHARED_UNBIASED, View};
use crate::report::statistics::{Estimate, normal_quantile};
use anyhow::Result;
use image::Rgb32FImage;

const SCENES: [&str; 2] = ["dining", "killeroos"];
const SPP: [u32; 2] = [1, 4];
/// Of the whole test of an image: each pixel and channel has it divided by their number (Bonferroni), whatever the
/// dependence between them.
const SIGNIFICANCE: f64 = 0.01;

/// The estimators, as the table has them.
const NAMES: [&str; 3] = ["plain mean", "shared fits", "shared fits, K-fold"];

/// Frames that must light a pixel, about: fewer, and the mean is far from normal.
const LIT: u32 = 50;

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
    let frames = section.chapter.setting("frames of the test of biases", plan.frames);
    let size = section.chapter.setting("pixels on a side of the test of biases", plan.small);
    let percent = section.chapter.setting("significance of the test of biases, percent", 100.0 * SIGNIFICANCE);
    let lit = section.chapter.setting("frames with light, at least", LIT.min(plan.frames / 4));
    section.chapter.paragraph(&format!(
        "The mean of {frames} independent frames, {size} x {size} pixels, against the reference: for each pixel and channel its distance in \
         standard deviations, z. The largest z, of either sign, is compared with what chance allows at {percent} % for all of them together (Bonferroni, so that \
         dependence between pixels does no harm; a two-sided test). The plain mean of the same samples, unbiased by construction, shows how the test itself behaves. \
         Pixels that hardly any frame lights do not count, as z is then far from normal: the plain mean's n mean^2 / variance, about the number of frames \
         with light, must be {lit} at least. The reference's own error is part of the standard deviation. Shared fits choose how much to correct from the samples that \
         they correct, which leaves a bias that a thousand frames can show; K-fold, where halves of the neighbours choose for each other, has none where pixels are independent. A scrambled tile's are not. A bias spread over many pixels shows in the mean of z^2 before it shows \
         in the largest."
    ));
    let tiles = Tiles::new(section.measurement.renderer.tiles()?, None)?;
    let mut rows = Vec::new();
    for &scene in plan.some(&SCENES) {
        for &spp in plan.some(&SPP) {
            let samplers =
                [("random", Some(Sampler::Random)), ("tile, scrambled", Choice::Tile(2).sampler(spp, &tiles))];
            for (label, sampler) in samplers {
                let Some(sampler) = sampler else { continue };
                // The reference's error must be small beside that of the mean of so many frames.
                let view = View { precision: 8, ..View::new(scene, size) };
                let estimators = [BASELINE, SHARED, SHARED_UNBIASED];
                // A tile at other places keeps its own small error, which a thousand frames can show.
                let experiment = Experiment {
                    sampler,
                    seeds: plan.frames,
                    options: &["--scramble"],
                    ..Experiment::new(view, spp, &estimators)
                };
                let statistics = section.measurement.statistics(&experiment, 0)?;
                let reference = section.measurement.reference(view)?;
                let lit = lit_pixels(&statistics[0], &reference.images, plan.frames);
                for (estimator, [mean, mse]) in NAMES.into_iter().zip(&statistics) {
                    let scores = scores([mean, mse], &reference.images, plan.frames, &lit);
                    let allowed = normal_quantile(SIGNIFICANCE / (2.0 * scores.count as f64));
                    if estimator != NAMES[0] {
                        let statement = format!(
                            "{estimator} unbiased: largest z of the mean of independent frames, over what chance allows"
                        );
                        let estimate = Estimate::median(&[scores.largest / allowed]);
                        section.targets.at_most(
                            &statement,
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
        "largest z",
        "chance allows",
        "mean z^2",
        "median z",
        "mean z",
    ];
    section.chapter.setting("power of z", 2);
    section.chapter.table("unbiased", &columns, 1, rows);
    Ok(())
}

fn values(image: &Rgb32FImage) -> Vec<f64> {
    image.as_raw().iter().map(|&value| f64::from(value)).collect()
}

/// The frames' variance, number by number: what is measured about the reference, less the square of the distance to it.
fn variances(mean: &Rgb32FImage, mse: &Rgb32FImage, halves: &[Rgb32FImage; 2]) -> Vec<f64> {
    let (mean, mse, [a, b]) = (values(mean), values(mse), halves.each_ref().map(values));
    (0..mean.len()).map(|i| (mse[i] - (mean[i] - a[i]) * (mean[i] - b[i])).max(0.0)).collect()
}

/// Which numbers of the image enough frames light.
fn lit_pixels([mean, mse]: &[Rgb32FImage; 2], halves: &[Rgb32FImage; 2], frames: u32) -> Vec<bool> {
    let least = f64::from(LIT.min(frames / 4));
    let variances = variances(mean, mse, halves);
    let lit = |(mean, variance): (f64, f64)| variance > 0.0 && f64::from(frames) * mean * mean >= least * variance;
    values(mean).into_iter().zip(variances).map(lit).collect()
}

fn scores([mean, mse]: [&Rgb32FImage; 2], halves: &[Rgb32FImage; 2], frames: u32, lit: &[bool]) -> Scores {
    let variances = variances(mean, mse, halves);
    let (mean, [a, b]) = (values(mean), halves.each_ref().map(values));
    let mut all = Vec::new();
    for i in (0..mean.len()).filter(|&i| lit[i]) {
        let reference = 0.5 * (a[i] + b[i]);
        let own = 0.25 * (a[i] - b[i]).powi(2);
        let variance = variances[i] / f64::from(frames - 1) + own;
        // Pixels that see the light have no noise but rounding.
        if variance > 1e-12 * reference * reference {
            all.push((mean[i] - reference) / variance.sqrt());
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

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    /// 400 frames whose values are 0 or 2, in turn, plus `bias`, against a reference of 1.
    fn scored(bias: f32) -> Scores {
        let flat = |value: f32| Rgb32FImage::from_pixel(2, 2, Rgb([value; 3]));
        let (mean, mse) = (flat(1.0 + bias), flat(1.0 + bias * bias));
        let halves = [flat(1.0), flat(1.0)];
        let lit = lit_pixels(&[mean.clone(), mse.clone()], &halves, 400);
        scores([&mean, &mse], &halves, 400, &lit)
    }

    #[test]
    fn a_bias_shows_and_its_absence_too() {
        assert!(scored(0.0).largest < 1e-6);
        let scores = scored(0.5);
        // .5 over a standard error of 1 / sqrt(399).
        assert!((scores.largest - 0.5 * 399.0_f64.sqrt()).abs() < 1e-3, "{}", scores.largest);
        assert_eq!(scores.count, 12);
    }

    #[test]
    fn pixels_without_light_do_not_count() {
        let dark = Rgb32FImage::new(2, 2);
        let lit = lit_pixels(&[dark.clone(), dark.clone()], &[dark.clone(), dark], 400);
        assert!(lit.iter().all(|&lit| !lit));
    }
}
