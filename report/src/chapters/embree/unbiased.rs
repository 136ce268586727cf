//! Are shared fits unbiased? The mean of many independent frames against the reference.

use super::Harness;
use super::sign_flips::SignFlips;
use crate::chapters::prelude::*;
use crate::chapters::statistics::{median, normal_quantile};
use crate::measure::renderer::Job;
use image::Rgb32FImage;
use itertools::iproduct;

const SCENES: [&str; 2] = ["dining", "killeroos"];
const SPP: [u32; 2] = [1, 4];
/// Of all tests of the table together: each of them has a part of it (Bonferroni), whatever the dependence between
/// them.
const SIGNIFICANCE: f64 = 0.01;
/// Batches of frames, whose signs the test of the mean of z^2 flips: 8192 ways, enough for its part of the
/// significance.
const BATCHES: u32 = 14;

/// The estimators, as the table has them.
const NAMES: [&str; 3] = ["plain mean", "shared fits", "shared fits, K-fold"];

/// Frames that must light a pixel, about: fewer, and the mean is far from normal.
const LIT: u32 = 50;

/// Standard scores of every pixel and channel that has noise.
struct Scores {
    count: usize,
    largest: f64,
    /// Of the mean of their squares, which is about 1 without bias.
    flips: SignFlips,
    /// Of the image's mean.
    image: f64,
    median: f64,
}

/// What frames say together: of each batch the mean, and over all the mean of (I - A)(I - B).
struct Frames {
    count: u32,
    batches: Vec<Vec<f64>>,
    mse: Vec<f64>,
}

impl Frames {
    fn new(batches: &[[Rgb32FImage; 2]], count: u32) -> Self {
        let mse: Vec<Vec<f64>> = batches.iter().map(|[_, mse]| values(mse)).collect();
        Self { count, batches: batches.iter().map(|[mean, _]| values(mean)).collect(), mse: average(&mse) }
    }
}

pub(super) fn write(harness: &Harness, chapter: &mut Chapter) -> Result<()> {
    chapter.section("Are shared fits unbiased?");
    let (plan, measurement) = (harness.plan, &harness.measurement);
    let count = plan.of("frames") / BATCHES * BATCHES;
    chapter.setting("frames of the test of biases", count);
    chapter.setting("significance of the test of biases, percent", 100.0 * SIGNIFICANCE);
    chapter.setting("frames with light, at least", LIT.min(plan.of("frames") / 4));
    chapter.setting("batches of the test of biases", BATCHES);
    let samplers = [("random", "random"), ("tile, scrambled", "tile 2D")];
    let tests = iproduct!(plan.some(&SCENES), plan.some(&SPP), samplers);
    let tests: Vec<_> = tests
        .filter_map(|(&scene, &spp, (label, of))| Some((scene, spp, label, measurement.renderer.sampler(of, spp)?)))
        .collect();
    // Of two estimators, the largest z and the mean of z^2.
    let level = SIGNIFICANCE / (4 * tests.len()) as f64;
    let mut rows = Vec::new();
    for (scene, spp, label, sampler) in tests {
        // The reference's error must be small beside that of the mean of so many frames.
        let view = harness.view(scene, plan.of("bias_size"), 8)?;
        // A tile at other places keeps its own small error, which a thousand frames can show.
        let options = vec!["--scramble"];
        let job = Job::new(view, spp, &["mc", "shared", "shared_k_fold"]);
        let job = Job { sampler, seeds: count / BATCHES, options, ..job };
        let batches = measurement.statistics(&job, BATCHES)?;
        let halves = measurement.reference(view)?.images.each_ref().map(values);
        let frames = |estimator: usize| {
            let one: Vec<[Rgb32FImage; 2]> = batches.iter().map(|batch| batch[estimator].clone()).collect();
            Frames::new(&one, count)
        };
        let lit = lit_pixels(&frames(0), &halves);
        for (index, estimator) in NAMES.into_iter().enumerate() {
            let scores = scores(&frames(index), &halves, &lit);
            let allowed = [normal_quantile(level / (2.0 * scores.count as f64)), scores.flips.allowed(level)];
            let found = [scores.largest, scores.flips.measured()];
            for (at, what) in ["largest z", "mean z^2"].into_iter().enumerate().filter(|_| index > 0) {
                let statement =
                    format!("{estimator} unbiased: {what} of the mean of independent frames, over what chance allows");
                let (place, ratio) = (format!("{scene}, {label}, {spp} spp"), Estimate::exact(found[at] / allowed[at]));
                chapter.target(&statement, &place, ratio, Unit::Ratio, Bound::AtMost(1.0));
            }
            let [largest, chance, median, image] =
                [found[0], allowed[0], scores.median, scores.image].map(|value| Figure::exact(value, Unit::Hundredths));
            let [square, by_chance] = [found[1], allowed[1]].map(|value| Figure::exact(value, Unit::Ratio));
            let (spp, count) = (spp.to_string(), Figure::count(scores.count));
            rows.push(json!([scene, spp, label, estimator, count, largest, chance, square, by_chance, median, image]));
        }
    }
    let columns = "scene | samples | sampler | estimator | numbers | largest z | chance allows | mean z^2 | chance \
                   allows | median z | mean z";
    chapter.table("unbiased", columns, 1, rows);
    Ok(())
}

fn values(image: &Rgb32FImage) -> Vec<f64> {
    image.as_raw().iter().map(|&value| f64::from(value)).collect()
}

fn average(all: &[Vec<f64>]) -> Vec<f64> {
    let numbers = all.first().map_or(0, Vec::len);
    (0..numbers).map(|i| all.iter().map(|one| one[i]).sum::<f64>() / all.len() as f64).collect()
}

/// The frames' variance, number by number: what is measured about the reference, less the square of the distance to it.
fn variances(frames: &Frames, [a, b]: &[Vec<f64>; 2]) -> Vec<f64> {
    let mean = average(&frames.batches);
    (0..mean.len()).map(|i| (frames.mse[i] - (mean[i] - a[i]) * (mean[i] - b[i])).max(0.0)).collect()
}

/// Which numbers of the image enough frames light.
fn lit_pixels(frames: &Frames, halves: &[Vec<f64>; 2]) -> Vec<bool> {
    let least = f64::from(LIT.min(frames.count / 4));
    let lit =
        |(mean, variance): (f64, f64)| variance > 0.0 && f64::from(frames.count) * mean * mean >= least * variance;
    average(&frames.batches).into_iter().zip(variances(frames, halves)).map(lit).collect()
}

fn scores(frames: &Frames, halves: &[Vec<f64>; 2], lit: &[bool]) -> Scores {
    let (variances, mean, [a, b]) = (variances(frames, halves), average(&frames.batches), halves);
    let (mut all, mut counted) = (Vec::new(), Vec::new());
    for i in (0..mean.len()).filter(|&i| lit[i]) {
        let reference = 0.5 * (a[i] + b[i]);
        let own = 0.25 * (a[i] - b[i]).powi(2);
        let variance = variances[i] / f64::from(frames.count - 1) + own;
        // Pixels that see the light have no noise but rounding.
        if variance > 1e-12 * reference * reference {
            all.push((mean[i] - reference) / variance.sqrt());
            counted.push((i, variance.sqrt() * frames.batches.len() as f64));
        }
    }
    let deviations =
        |batch: &Vec<f64>| [a, b].map(|half| counted.iter().map(|&(i, unit)| (batch[i] - half[i]) / unit).collect());
    let deviations: Vec<[Vec<f64>; 2]> = frames.batches.iter().map(deviations).collect();
    Scores {
        count: all.len(),
        largest: all.iter().map(|z| z.abs()).fold(0.0, f64::max),
        flips: SignFlips::new(&deviations),
        image: all.iter().sum::<f64>() / all.len().max(1) as f64,
        median: median(all.iter().copied()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 400 frames in 8 batches whose values are 0 or 2, in turn, plus `bias`, against a reference of 1; the batches'
    /// means differ by chance.
    fn scored(bias: f64) -> Scores {
        let batch = |batch: i32| vec![1.0 + bias + 0.1 * (f64::from(batch) - 3.5); 12];
        let frames = Frames { count: 400, batches: (0..8).map(batch).collect(), mse: vec![1.0 + bias * bias; 12] };
        let halves = [vec![1.0; 12], vec![1.0; 12]];
        let lit = lit_pixels(&frames, &halves);
        scores(&frames, &halves, &lit)
    }

    #[test]
    fn a_bias_shows_and_its_absence_too() {
        let unbiased = scored(0.0);
        assert!(unbiased.largest < 1e-6 && unbiased.flips.measured() < unbiased.flips.allowed(0.1));
        let scores = scored(0.5);
        // .5 over a standard error of 1 / sqrt(399).
        assert!((scores.largest - 0.5 * 399.0_f64.sqrt()).abs() < 1e-3, "{}", scores.largest);
        assert!((scores.flips.measured() - 0.25 * 399.0).abs() < 1e-3, "{}", scores.flips.measured());
        assert!(scores.flips.measured() > scores.flips.allowed(0.01));
        assert_eq!(scores.count, 12);
    }

    #[test]
    fn pixels_without_light_do_not_count() {
        let dark = || vec![0.0; 12];
        let frames = Frames { count: 400, batches: vec![dark(); 8], mse: dark() };
        assert!(lit_pixels(&frames, &[dark(), dark()]).iter().all(|&lit| !lit));
    }
}
