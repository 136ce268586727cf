//! Is the default ever worse than plain Monte Carlo? Pixel by pixel: how many are served worse, and how sure that is.

use super::Harness;
use crate::chapters::prelude::*;
use crate::chapters::statistics::{moments, student};
use crate::measure::renderer::Job;
use fastrand::Rng;
use image::Rgb32FImage;

const SPP: u32 = 16;
/// Ratios of mean squared errors beyond it are too many.
const TOO_MUCH: f64 = 1.2;
/// The seeds come in as many batches, or in fewer if they are few, whose spread says how sure a figure is.
const BATCHES: u32 = 8;
/// Of the test of each pixel, one-sided.
const SIGNIFICANCE: f64 = 0.01;
/// A pixel has noise if either error is more than this part of the largest of any pixel.
const NOISE: f64 = 1e-9;
const RESAMPLES: usize = 200;

pub(super) fn write(harness: &Harness, chapter: &mut Chapter) -> Result<()> {
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
        let Shares { pixels, raw, twice, sure, largest } = Shares::new(&errors, seeds as usize);
        let statement = format!("share of pixels beyond {TOO_MUCH} as measured, {SPP} spp, percent");
        chapter.target(&statement, scene, raw, Unit::Percent, Bound::AtMost(1.0));
        let [twice, sure] = [twice, sure].map(|share| Figure::exact(share, Unit::Percent));
        let (raw, largest) = (Figure::new(raw, Unit::Percent), Figure::exact(largest, Unit::Ratio));
        rows.push(json!([scene, Figure::count(pixels), raw, twice, sure, largest]));
    }
    let columns = "scene | pixels | as measured, % | in both halves, % | significantly, % | largest ratio";
    chapter.table("never worse, pixels", columns, 1, rows);
    Ok(())
}

/// Of the three channels of each pixel.
fn sums(image: &Rgb32FImage) -> Vec<f64> {
    image.pixels().map(|pixel| pixel.0.iter().map(|&value| f64::from(value)).sum()).collect()
}

/// Mean squared errors of each pixel in one batch of seeds: the plain mean's, and the estimator's.
type Batch = [Vec<f64>; 2];

/// The shares of the pixels with noise whose ratio of mean squared errors is beyond [`TOO_MUCH`], in per cent.
struct Shares {
    /// With noise.
    pixels: usize,
    /// As measured; noise throws some pixels beyond.
    raw: Estimate,
    /// Beyond in both halves of the seeds.
    twice: f64,
    /// Beyond, significantly.
    sure: f64,
    /// The largest ratio of a pixel. Where the plain mean has no error it counts as [`NOISE`], so that an error of the
    /// other shows as a large ratio.
    largest: f64,
}

impl Shares {
    /// `seeds`: of all batches together.
    fn new(batches: &[Batch], seeds: usize) -> Self {
        let all: Vec<usize> = (0..batches.len()).collect();
        let pixels = batches.first().map_or(0, |[plain, _]| plain.len());
        let means: Vec<[f64; 2]> = (0..pixels).map(|pixel| means(batches, &all, pixel)).collect();
        let floor = NOISE * means.iter().flatten().copied().fold(0.0, f64::max);
        let noisy: Vec<usize> = (0..pixels).filter(|&pixel| means[pixel].iter().any(|&error| error > floor)).collect();
        let ratio = |chosen: &[usize], pixel: usize| {
            let [plain, own] = self::means(batches, chosen, pixel);
            own / plain.max(floor)
        };
        let share = |of: &dyn Fn(usize) -> bool| {
            100.0 * noisy.iter().filter(|&&pixel| of(pixel)).count() as f64 / noisy.len().max(1) as f64
        };
        let (first, second) = all.split_at(all.len() / 2);
        let mut random = Rng::with_seed(0x7069_7865_6c73);
        let resampled = (0..RESAMPLES).map(|_| {
            let chosen: Vec<usize> = all.iter().map(|_| random.usize(..batches.len())).collect();
            share(&|pixel| ratio(&chosen, pixel) > TOO_MUCH)
        });
        let error = moments(&resampled.collect::<Vec<f64>>()).1;
        // 95 %, by Student's distribution: the percentile bootstrap would count the noise that throws pixels beyond a
        // second time. Resampling n values spreads less than they do, by (n - 1) / n, and their spread is itself an
        // estimate.
        let n = batches.len() as f64;
        let half = student(0.025, n - 1.0) * (n / (n - 1.0)).sqrt() * error;
        let Estimate { value, low, high, .. } =
            Estimate::about(share(&|pixel| ratio(&all, pixel) > TOO_MUCH), half, seeds);
        Self {
            pixels: noisy.len(),
            raw: Estimate { value, low: low.max(0.0), high: high.min(100.0), seeds },
            twice: share(&|pixel| ratio(first, pixel) > TOO_MUCH && ratio(second, pixel) > TOO_MUCH),
            sure: share(&|pixel| is_sure(batches, pixel)),
            largest: noisy.iter().map(|&pixel| ratio(&all, pixel)).fold(0.0, f64::max),
        }
    }
}

/// Over the chosen batches.
fn means(batches: &[Batch], chosen: &[usize], pixel: usize) -> [f64; 2] {
    [0, 1].map(|which| chosen.iter().map(|&batch| batches[batch][which][pixel]).sum::<f64>() / chosen.len() as f64)
}

/// Is the mean over the batches of (own - limit * plain) above 0? Of 8 batches, Student's distribution: its quantile at
/// 1 % is 3.00 for 7 degrees of freedom, the normal one 2.33.
fn is_sure(batches: &[Batch], pixel: usize) -> bool {
    let excess: Vec<f64> = batches.iter().map(|[plain, own]| own[pixel] - TOO_MUCH * plain[pixel]).collect();
    let n = excess.len() as f64;
    let (mean, deviation) = moments(&excess);
    mean > student(SIGNIFICANCE, (n - 1.0).max(1.0)) * deviation / n.sqrt() && mean > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1000 pixels, of which the first `bad` are twice as bad as the plain mean's; errors vary by `noise` from batch to
    /// batch.
    fn shares(bad: usize, noise: f64) -> Shares {
        let mut random = Rng::with_seed(3);
        let mut vary = |value: f64| value * (1.0 + noise * (random.f64() - 0.5));
        let batches = (0..8).map(|_| {
            let plain = (0..1000).map(|_| vary(1.0)).collect();
            [plain, (0..1000).map(|pixel| vary(if pixel < bad { 2.0 } else { 0.5 })).collect()]
        });
        Shares::new(&batches.collect::<Vec<Batch>>(), 8)
    }

    #[test]
    fn bad_pixels_are_counted() {
        let shares = shares(100, 0.5);
        assert_eq!((shares.pixels, shares.raw.value, shares.twice, shares.sure), (1000, 10.0, 10.0, 10.0));
        assert!(shares.largest > 1.8 && shares.largest < 2.5);
        assert_eq!([shares.raw.low, shares.raw.high], [10.0, 10.0], "so clear a share does not vary");
    }

    #[test]
    fn the_interval_widens_with_noise_at_the_limit() {
        let mut random = Rng::with_seed(5);
        let mut vary = || 0.5 + random.f64();
        let batch = |_| [vec![1.0; 400], (0..400).map(|_| 1.2 * vary()).collect()];
        let shares = Shares::new(&(0..8).map(batch).collect::<Vec<Batch>>(), 8);
        let Estimate { value, low, high, .. } = shares.raw;
        assert!(low > 20.0 && low < value - 1.0 && high > value + 1.0 && high < 80.0, "{low} {high}");
        assert!(shares.sure < 5.0, "{}", shares.sure);
    }

    #[test]
    fn an_error_where_the_plain_mean_has_none_is_bad_and_no_error_at_all_does_not_count() {
        let shares = Shares::new(&vec![[vec![1.0, 0.0, 0.0, 1.0], vec![1.0, 0.1, 0.0, 1.0]]; 8], 8);
        assert_eq!((shares.pixels, shares.raw.value), (3, 100.0 / 3.0));
        assert!(shares.largest > 1e6 && shares.largest.is_finite());
    }
}
