//! One estimator against another, pixel by pixel: how many pixels are served worse, and how sure that is.

use crate::chapters::statistics::{Random, moments, student};

/// Ratios of mean squared errors beyond it are too many.
pub(crate) const TOO_MUCH: f64 = 1.2;
/// The seeds come in as many batches, or in fewer if they are few, whose spread says how sure a figure is.
pub(crate) const BATCHES: u32 = 8;
/// Of the test of each pixel, one-sided.
pub(crate) const SIGNIFICANCE: f64 = 0.01;
/// A pixel has noise if either error is more than this part of the largest of any pixel.
const NOISE: f64 = 1e-9;
const RESAMPLES: usize = 200;

/// Mean squared errors of each pixel in one batch of seeds: the plain mean's, and the estimator's.
pub(crate) type Batch = [Vec<f64>; 2];

/// The shares of the pixels with noise whose ratio of mean squared errors is beyond [`TOO_MUCH`], in per cent.
pub(crate) struct Shares {
    /// With noise.
    pub(crate) pixels: usize,
    /// Batches of seeds.
    pub(crate) batches: f64,
    /// As measured; noise throws some pixels beyond.
    pub(crate) raw: f64,
    /// The standard error of `raw`: the bootstrap's, over batches of seeds.
    pub(crate) error: f64,
    /// Beyond in both halves of the seeds.
    pub(crate) twice: f64,
    /// Beyond, significantly.
    pub(crate) sure: f64,
    /// Ratios of all pixels with noise. Where the plain mean has no error it counts as [`NOISE`], so that an error of
    /// the other shows as a large ratio.
    pub(crate) ratios: Vec<f64>,
}

impl Shares {
    pub(crate) fn new(batches: &[Batch]) -> Self {
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
        let mut random = Random::new(0x7069_7865_6c73);
        let resampled = (0..RESAMPLES).map(|_| {
            let chosen: Vec<usize> = all.iter().map(|_| random.below(batches.len())).collect();
            share(&|pixel| ratio(&chosen, pixel) > TOO_MUCH)
        });
        let resampled: Vec<f64> = resampled.collect();
        Self {
            pixels: noisy.len(),
            batches: batches.len() as f64,
            raw: share(&|pixel| ratio(&all, pixel) > TOO_MUCH),
            error: moments(&resampled).1,
            twice: share(&|pixel| ratio(first, pixel) > TOO_MUCH && ratio(second, pixel) > TOO_MUCH),
            sure: share(&|pixel| is_sure(batches, pixel)),
            ratios: noisy.iter().map(|&pixel| ratio(&all, pixel)).collect(),
        }
    }

    pub(crate) fn largest(&self) -> f64 {
        self.ratios.iter().copied().fold(0.0, f64::max)
    }

    /// 95 % about `raw`, by Student's distribution: the percentile bootstrap would count the noise that throws pixels
    /// beyond a second time.
    pub(crate) fn interval(&self) -> [f64; 2] {
        // Resampling n values spreads less than they do, by (n - 1) / n, and their spread is itself an estimate.
        let n = self.batches;
        let half = student(0.025, n - 1.0) * (n / (n - 1.0)).sqrt() * self.error;
        [(self.raw - half).max(0.0), (self.raw + half).min(100.0)]
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
        let mut random = Random::new(3);
        let mut vary = |value: f64| value * (1.0 + noise * (random.below(1 << 20) as f64 / f64::from(1 << 20) - 0.5));
        let batches = (0..8).map(|_| {
            let plain = (0..1000).map(|_| vary(1.0)).collect();
            [plain, (0..1000).map(|pixel| vary(if pixel < bad { 2.0 } else { 0.5 })).collect()]
        });
        Shares::new(&batches.collect::<Vec<Batch>>())
    }

    #[test]
    fn bad_pixels_are_counted() {
        let shares = shares(100, 0.5);
        assert_eq!((shares.pixels, shares.raw, shares.twice, shares.sure), (1000, 10.0, 10.0, 10.0));
        assert!(shares.largest() > 1.8 && shares.largest() < 2.5);
        assert_eq!(shares.interval(), [10.0, 10.0], "so clear a share does not vary");
    }

    #[test]
    fn the_interval_widens_with_noise_at_the_limit() {
        let mut random = Random::new(5);
        let mut vary = || 0.5 + random.below(1 << 20) as f64 / f64::from(1 << 20);
        let batch = |_| [vec![1.0; 400], (0..400).map(|_| 1.2 * vary()).collect()];
        let shares = Shares::new(&(0..8).map(batch).collect::<Vec<Batch>>());
        let [low, high] = shares.interval();
        assert!(low > 20.0 && low < shares.raw - 1.0 && high > shares.raw + 1.0 && high < 80.0, "{low} {high}");
        assert!(shares.sure < 5.0, "{}", shares.sure);
    }

    #[test]
    fn an_error_where_the_plain_mean_has_none_is_bad_and_no_error_at_all_does_not_count() {
        let shares = Shares::new(&vec![[vec![1.0, 0.0, 0.0, 1.0], vec![1.0, 0.1, 0.0, 1.0]]; 8]);
        assert_eq!((shares.pixels, shares.raw), (3, 100.0 / 3.0));
        assert!(shares.largest() > 1e6 && shares.largest().is_finite());
    }
}
