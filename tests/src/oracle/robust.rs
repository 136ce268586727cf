//! The soft mixture of plain Monte Carlo and ridge fits, weighted by their errors on samples they have not seen.

use super::regression::{Design, Regression};
use core::ops::Range;

/// How the fits are made and weighed, with F and d of [`Regression::offset`] and n samples:
///
/// - A fit's estimate is y = a + s (l - a), a the constant of the fit to all samples, l the estimate that corrects
///   samples by fits to others, and s = F / (F + `even`).
/// - Its trust is (error / error of the mean)^(-n `exponent`) / C for C fits, divided by max(1, F /
///   `offset`)^`discount` and by e^(`surprise` (y - mean)^2 / variance of the mean), of which no more than `far`
///   standard errors count.
/// - The mean's is `prior` (1 + `few` / n^4), and at least e^-(n^2 / `cap`) of the largest before those divisions.
/// - A fit that corrects other samples loses to the mean all but 1 / (1 + e^(d (F - 1 - ln F) - `doubt`)) of its
///   weight, if F is below one.
#[derive(Clone, Copy, Debug)]
pub struct RobustRule {
    /// Penalties per sample: the ridges are n times them.
    pub penalties: [f64; 2],
    /// Power of the error ratio per sample.
    pub exponent: f64,
    /// Trust in plain Monte Carlo against 1 for all fits together.
    pub prior: f64,
    /// The fourth power of the n that doubles it.
    pub few: f64,
    /// Divisor of n^2 in the cap.
    pub cap: f64,
    /// F values up to this one cost nothing.
    pub offset: f64,
    /// The power of F.
    pub discount: f64,
    /// The factor of the squared number of standard errors.
    pub surprise: f64,
    /// And the most standard errors that it counts.
    pub far: f64,
    /// The F at which half of what leaving out changes is used.
    pub even: f64,
    /// How much likelier even samples must be than independent ones, as the logarithm of the ratio's square.
    pub doubt: f64,
}

/// The folds of n samples that are all there: runs, the first of them one sample longer where they do not divide
/// evenly.
pub fn runs(n: usize, folds: usize) -> Vec<Range<usize>> {
    let longer = |fold: usize| usize::from(fold < n % folds);
    let mut start = 0;
    let mut run = |fold| {
        let range = start..start + n / folds + longer(fold);
        start = range.end;
        range
    };
    (0..folds).map(&mut run).collect()
}

/// The fold of each of the first n samples of a stream: P runs of 4 for the power of two P next to the number of folds,
/// P of 4 again, then P of 8, of 16 and so on, dealt to the folds in turn.
pub fn stream_folds(n: usize, folds: usize) -> Vec<usize> {
    let runs = folds.next_power_of_two();
    let lengths = (0..runs).map(|_| 4).chain((0..32).flat_map(|octave| vec![4_usize << octave; runs]));
    let dealt = lengths.enumerate().flat_map(|(run, length)| core::iter::repeat_n(run % folds, length));
    dealt.take(n).collect()
}

/// The samples of one estimate, with a fold for each.
struct Samples<'a> {
    design: &'a Design,
    f: &'a [f64],
    folds: Vec<usize>,
}

impl RobustRule {
    /// The library's rule.
    pub fn standard() -> Self {
        Self {
            penalties: [2e-5, 0.02],
            exponent: 1.0 / 6.0,
            prior: 5.0,
            few: 128.0,
            cap: 14.0,
            offset: 0.5,
            discount: 0.8,
            surprise: 0.25,
            far: 4.0,
            even: 0.2,
            doubt: 6.0,
        }
    }

    /// What a fit's trust loses in logarithms because of F.
    fn discount(&self, f: f64) -> f64 {
        self.discount * (f / self.offset).max(1.0).ln()
    }

    /// What it loses for moving the mean by so many of its variances.
    fn surprise(&self, squared_errors: f64) -> f64 {
        self.surprise * squared_errors.min(self.far.powi(2))
    }

    fn estimate_of(&self, all: f64, left_out: f64, f: f64) -> f64 {
        all + f / (f + self.even) * (left_out - all)
    }

    /// The share of a fold's fit.
    fn independence(&self, (f, freedom): (f64, f64)) -> f64 {
        if f >= 1.0 {
            return 1.0;
        }
        let f = f.max(1e-12);
        1.0 / (1.0 + (freedom * (f - 1.0 - f.ln()) - self.doubt).min(80.0).exp())
    }

    /// The weights of the fits and, last, of Monte Carlo, from each fit's error ratio over n samples and its discount;
    /// computed in logarithms, so that nothing overflows.
    fn weigh(&self, n: f64, ratios: &[f64], discounts: &[f64]) -> Vec<f64> {
        let count = ratios.len() as f64;
        let logs: Vec<f64> = ratios.iter().map(|ratio| -n * self.exponent * ratio.max(1e-30).ln()).collect();
        let best = logs.iter().copied().fold(0.0, f64::max);
        let prior = (self.prior * (1.0 + self.few / n.powi(4))).ln() + (best - n * n / self.cap).max(0.0);
        let penalised = logs.iter().zip(discounts).map(|(l, discount)| l - discount - count.ln());
        let scores: Vec<f64> = penalised.chain([prior]).collect();
        let largest = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let raw: Vec<f64> = scores.iter().map(|s| (s - largest).exp()).collect();
        let sum: f64 = raw.iter().sum();
        raw.iter().map(|w| w / sum).collect()
    }

    /// The weights of the fits and, last, of Monte Carlo, beside each one's estimate.
    pub fn weights_and_estimates(&self, design: &Design, f: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let n = f.len() as f64;
        let mean = f.iter().sum::<f64>() / n;
        let press_0 = f.iter().map(|f| ((f - mean) * n / (n - 1.0)).powi(2)).sum::<f64>();
        if f.len() < 2 || press_0 == 0.0 {
            return (vec![1.0], vec![mean]);
        }
        let variance = press_0 * (n - 1.0) / n.powi(3);
        let (mut ratios, mut discounts, mut estimates) = (vec![], vec![], vec![]);
        for penalty in self.penalties {
            let ridge = penalty * n;
            let left_out = Regression::leave_one_out(design, f, ridge);
            let (offset, _) = Regression::offset(design, ridge);
            let estimate = self.estimate_of(Regression::fit(design, f, ridge).intercept, left_out.mean(), offset);
            ratios.push(left_out.press() / press_0);
            discounts.push(self.discount(offset) + self.surprise((estimate - mean).powi(2) / variance));
            estimates.push(estimate);
        }
        estimates.push(mean);
        (self.weigh(n, &ratios, &discounts), estimates)
    }

    /// The estimate from samples of any design.
    pub fn estimate_design(&self, design: &Design, f: &[f64]) -> f64 {
        let (weights, estimates) = self.weights_and_estimates(design, f);
        weights.iter().zip(&estimates).map(|(w, e)| w * e).sum()
    }

    /// The estimate from points in `dims` dimensions, by Legendre terms.
    pub fn estimate(&self, u: &[f64], dims: usize, f: &[f64], order: usize) -> f64 {
        self.estimate_design(&Design::legendre(u, dims, order), f)
    }

    /// The slopes of a fit that corrects other samples: of all fits, mixed by their weights; Monte Carlo has none.
    fn slopes(&self, design: &Design, f: &[f64]) -> Vec<f64> {
        let (weights, _) = self.weights_and_estimates(design, f);
        let mut slopes = vec![0.0; design.weights.len()];
        if weights.len() > 1 {
            for (penalty, weight) in self.penalties.into_iter().zip(weights) {
                let ridge = penalty * f.len() as f64;
                let weight = weight * self.independence(Regression::offset(design, ridge));
                let fit = Regression::fit(design, f, ridge);
                slopes.iter_mut().zip(fit.slopes).for_each(|(total, slope)| *total += weight * slope);
            }
        }
        slopes
    }

    /// Cross-fit over `folds` folds, which are runs: each fold's samples meet the mixture of the others alone. Exactly
    /// unbiased.
    pub fn split(&self, u: &[f64], dims: usize, f: &[f64], order: usize, folds: usize) -> f64 {
        let design = Design::legendre(u, dims, order);
        let mut sum = 0.0;
        for fold in runs(f.len(), folds) {
            let others: Vec<usize> = (0..f.len()).filter(|i| !fold.contains(i)).collect();
            let values: Vec<f64> = others.iter().map(|&i| f[i]).collect();
            let fit = Regression { intercept: 0.0, slopes: self.slopes(&design.select(&others), &values) };
            sum += fold.map(|i| f[i] - fit.control(&design.rows[i])).sum::<f64>();
        }
        sum / f.len() as f64
    }

    /// The streaming robust estimate: fits to all samples, weighted by the errors of fits to all folds but one on that
    /// one.
    pub fn pooled(&self, u: &[f64], dims: usize, f: &[f64], order: usize, folds: usize) -> f64 {
        let design = Design::legendre(u, dims, order);
        let samples = Samples { design: &design, f, folds: stream_folds(f.len(), folds) };
        let n = f.len() as f64;
        let mean = f.iter().sum::<f64>() / n;
        let variance = f.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / (n * (n - 1.0));
        let errors = |penalty| (0..folds).map(|fold| samples.squared_error(&[fold], fold, penalty)).sum::<f64>();
        let error_0 = errors(None);
        if error_0 == 0.0 || samples.folds.iter().all(|&fold| fold == 0) {
            return mean;
        }
        let (mut ratios, mut discounts, mut estimates) = (vec![], vec![], vec![]);
        for penalty in self.penalties {
            let all = Regression::fit(&design, f, penalty * n);
            let crossed =
                (0..f.len()).map(|i| f[i] - samples.fit(&[samples.folds[i]], penalty).control(&design.rows[i]));
            let (offset, _) = Regression::offset(&design, penalty * n);
            let estimate = self.estimate_of(all.intercept, crossed.sum::<f64>() / n, offset);
            ratios.push(errors(Some(penalty)) / error_0);
            discounts.push(self.discount(offset) + self.surprise((estimate - mean).powi(2) / variance));
            estimates.push(estimate);
        }
        estimates.push(mean);
        self.weigh(n, &ratios, &discounts).iter().zip(&estimates).map(|(w, e)| w * e).sum()
    }

    /// The streaming K-fold estimate: each fold's samples meet only fits to the others, weighted by fits that neither
    /// know that fold nor are judged on it.
    pub fn nested(&self, u: &[f64], dims: usize, f: &[f64], order: usize, folds: usize) -> f64 {
        let design = Design::legendre(u, dims, order);
        let samples = Samples { design: &design, f, folds: stream_folds(f.len(), folds) };
        let filled: Vec<usize> = (0..folds).filter(|fold| samples.folds.contains(fold)).collect();
        let mut sum = 0.0;
        for &fold in &filled {
            let judges: Vec<usize> = filled.iter().copied().filter(|&other| other != fold).collect();
            let judged = samples.folds.iter().filter(|&&other| other != fold).count() as f64;
            let errors = |penalty| {
                judges.iter().map(|&other| samples.squared_error(&[fold, other], other, penalty)).sum::<f64>()
            };
            let discounts = self.penalties.map(|penalty| {
                let each = judges.iter().map(|&other| samples.offset(&[fold, other], penalty));
                each.map(|offset| offset.map_or(0.0, |(f, _)| self.discount(f))).sum::<f64>() / judges.len() as f64
            });
            let error_0 = errors(None);
            let weights = if error_0 > 0.0 {
                let ratios = self.penalties.map(|penalty| errors(Some(penalty)) / error_0);
                self.weigh(judged, &ratios, &discounts)
            } else {
                vec![0.0, 0.0, 1.0]
            };
            for i in (0..f.len()).filter(|&i| samples.folds[i] == fold) {
                let mut value = f[i];
                for (penalty, weight) in self.penalties.into_iter().zip(&weights) {
                    let independence = samples.offset(&[fold], penalty).map_or(1.0, |offset| self.independence(offset));
                    value -= weight * independence * samples.fit(&[fold], penalty).control(&design.rows[i]);
                }
                sum += value;
            }
        }
        sum / f.len() as f64
    }
}

impl Samples<'_> {
    /// The samples that are in none of these folds.
    fn without(&self, left_out: &[usize]) -> (Design, Vec<f64>) {
        let keep: Vec<usize> = (0..self.f.len()).filter(|&i| !left_out.contains(&self.folds[i])).collect();
        (self.design.select(&keep), keep.iter().map(|&i| self.f[i]).collect())
    }

    /// A fit to them, with a penalty per sample of its own; of nothing it is zero.
    fn fit(&self, left_out: &[usize], penalty: f64) -> Regression {
        let (design, f) = self.without(left_out);
        if f.is_empty() {
            return Regression { intercept: 0.0, slopes: vec![0.0; design.weights.len()] };
        }
        Regression::fit(&design, &f, penalty * f.len() as f64)
    }

    /// Where they lie, if they are two or more.
    fn offset(&self, left_out: &[usize], penalty: f64) -> Option<(f64, f64)> {
        let (design, f) = self.without(left_out);
        (f.len() > 1).then(|| Regression::offset(&design, penalty * f.len() as f64))
    }

    /// The squared errors on a fold of such a fit or, without a penalty, of the mean.
    fn squared_error(&self, left_out: &[usize], fold: usize, penalty: Option<f64>) -> f64 {
        let fit = match penalty {
            Some(penalty) => self.fit(left_out, penalty),
            None => {
                let (_, f) = self.without(left_out);
                let mean = f.iter().sum::<f64>() / (f.len() as f64).max(1.0);
                Regression { intercept: mean, slopes: vec![0.0; self.design.weights.len()] }
            }
        };
        let inside = (0..self.f.len()).filter(|&i| self.folds[i] == fold);
        inside.map(|i| (self.f[i] - fit.intercept - fit.control(&self.design.rows[i])).powi(2)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrands;
    use crate::random::SplitMix64;
    use crate::statistics::{Moments, rmse_ratio};

    #[test]
    fn a_constant_is_exact() {
        let u: Vec<f64> = (0..16).map(|i| f64::from(i) / 16.0).collect();
        for estimate in [
            RobustRule::standard().estimate(&u, 2, &[2.5; 8], 3),
            RobustRule::standard().pooled(&u, 2, &[2.5; 8], 3, 4),
            RobustRule::standard().nested(&u, 2, &[2.5; 8], 3, 4),
        ] {
            assert!((estimate - 2.5).abs() < 1e-14);
        }
    }

    /// exp(-x - y) at 16 samples, order 2: below half of Monte Carlo's error; the nested K-fold is unbiased, two-sided
    /// |z| < 4 (p = 6e-5), seed 11.
    #[test]
    fn helps_and_stays_unbiased() {
        let integrand = integrands::nine()[1];
        let rule = RobustRule::standard();
        let mut rng = SplitMix64::new(11);
        let (mut robust, mut plain, mut nested) = (vec![], vec![], Moments::default());
        for _ in 0..200 {
            let u: Vec<f64> = (0..32).map(|_| rng.uniform()).collect();
            let f: Vec<f64> = u.chunks(2).map(integrand.evaluate).collect();
            robust.push(rule.estimate(&u, 2, &f, 2) - integrand.integral);
            plain.push(f.iter().sum::<f64>() / 16.0 - integrand.integral);
            nested.add(rule.nested(&u, 2, &f, 2, 4));
        }
        assert!(rmse_ratio(&robust, &plain).upper() < 0.5);
        assert!(nested.z(integrand.integral).abs() < 4.0);
    }
}
