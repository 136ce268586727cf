//! The soft mixture of plain Monte Carlo and a few ridge fits, weighted by their errors on samples they have not seen.

use super::regression::{Design, LeftOut, Regression};

/// One ridge fit of the mixture.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// Total degree of its terms; larger than the configured order means the configured one.
    pub order: usize,
    /// Penalty per sample: the ridge is n * penalty.
    pub penalty: f64,
}

/// How candidates are weighed. With l_k = -n exponent ln(error_k / error_0) and Hotelling's F_k of "the samples' centre is
/// the domain's" (`Regression::offset`): w_k = exp(l_k) max(1, F_k / offset)^-2 / C for the C candidates and, for Monte
/// Carlo, w_0 = prior max(1, exp(max l_k - n^2 / cap)); then all are divided by their sum.
///
/// F guards against extrapolation, the cap against fits that are exact on a handful of badly spread samples.
#[derive(Clone, Debug)]
pub struct RobustRule {
    /// The fits.
    pub candidates: Vec<Candidate>,
    /// Power of the error ratio per sample.
    pub exponent: f64,
    /// Weight of plain Monte Carlo against 1 for all candidates together.
    pub prior: f64,
    /// F values up to this one cost nothing; infinity ignores F.
    pub offset: f64,
    /// Divisor of n^2 in the cap; 0 for no cap.
    pub cap: f64,
}

/// The samples of one estimate.
struct Samples<'a> {
    u: &'a [f64],
    dims: usize,
    f: &'a [f64],
}

impl RobustRule {
    /// The library's rule: two ridges of the highest order.
    pub fn standard() -> Self {
        let penalties = [2e-5, 0.02];
        let candidates = penalties.map(|penalty| Candidate { order: usize::MAX, penalty }).to_vec();
        Self { candidates, exponent: 1.0 / 6.0, prior: 8.0, offset: 1.5, cap: 14.0 }
    }

    /// The seven candidates of an earlier study: four ridges of the highest order and three of order 1.
    pub fn seven() -> Self {
        let highest = [5e-5, 5e-3, 0.05, 0.5].map(|penalty| Candidate { order: usize::MAX, penalty });
        let first = [0.01, 0.1, 1.0].map(|penalty| Candidate { order: 1, penalty });
        Self {
            candidates: [&highest[..], &first].concat(),
            exponent: 1.0 / 8.0,
            prior: 8.0,
            offset: f64::INFINITY,
            cap: 0.0,
        }
    }

    /// What a fit's trust loses in logarithms: 2 ln max(1, F / offset).
    fn discount(&self, f: f64) -> f64 {
        2.0 * (f / self.offset).max(1.0).ln()
    }

    /// The weights of the candidates and, last, of Monte Carlo, from each candidate's error ratio over n samples and its
    /// discount; computed in logarithms, so that nothing overflows.
    fn weigh(&self, n: f64, ratios: &[f64], discounts: &[f64]) -> Vec<f64> {
        let count = ratios.len() as f64;
        let logs: Vec<f64> = ratios.iter().map(|ratio| -n * self.exponent * ratio.max(1e-30).ln()).collect();
        let best = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let trusted = if self.cap > 0.0 { n * n / self.cap } else { f64::INFINITY };
        let penalised = logs.iter().zip(discounts).map(|(l, discount)| l - discount - count.ln());
        let scores: Vec<f64> = penalised.chain([self.prior.ln() + (best - trusted).max(0.0)]).collect();
        let largest = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let raw: Vec<f64> = scores.iter().map(|s| (s - largest).exp()).collect();
        let sum: f64 = raw.iter().sum();
        raw.iter().map(|w| w / sum).collect()
    }

    /// The estimate from samples of any design, whose order no candidate limits.
    pub fn estimate_design(&self, design: &Design, f: &[f64]) -> f64 {
        let (weights, estimates) = self.mix(f, |_| design.clone());
        weights.iter().zip(&estimates).map(|(w, e)| w * e).sum()
    }

    /// The weights of the candidates and, last, of Monte Carlo, beside each one's estimate.
    pub fn weights_and_estimates(&self, u: &[f64], dims: usize, f: &[f64], order: usize) -> (Vec<f64>, Vec<f64>) {
        self.mix(f, |candidate| Design::legendre(u, dims, candidate.order.min(order)))
    }

    fn mix(&self, f: &[f64], design: impl Fn(&Candidate) -> Design) -> (Vec<f64>, Vec<f64>) {
        let n = f.len() as f64;
        let mean = f.iter().sum::<f64>() / n;
        let press_0 = f.iter().map(|f| ((f - mean) * n / (n - 1.0)).powi(2)).sum::<f64>();
        if f.len() < 2 || press_0 == 0.0 {
            return (vec![1.0], vec![mean]);
        }
        let (mut ratios, mut discounts, mut estimates) = (vec![], vec![], vec![]);
        for candidate in &self.candidates {
            let design = design(candidate);
            let ridge = candidate.penalty * n;
            let left_out: LeftOut = Regression::leave_one_out(&design, f, ridge);
            ratios.push(left_out.press() / press_0);
            discounts.push(self.discount(Regression::offset(&design, ridge)));
            estimates.push(left_out.mean());
        }
        estimates.push(mean);
        (self.weigh(n, &ratios, &discounts), estimates)
    }

    /// The estimate of the integral from all samples: sum of w_k mean(y_k).
    pub fn estimate(&self, u: &[f64], dims: usize, f: &[f64], order: usize) -> f64 {
        let (weights, estimates) = self.weights_and_estimates(u, dims, f, order);
        weights.iter().zip(&estimates).map(|(w, e)| w * e).sum()
    }

    /// The slopes of all fits mixed by their weights; Monte Carlo has none.
    fn slopes(&self, u: &[f64], dims: usize, f: &[f64], order: usize) -> Vec<f64> {
        let (weights, _) = self.weights_and_estimates(u, dims, f, order);
        let design = Design::legendre(u, dims, order);
        let mut slopes = vec![0.0; design.weights.len()];
        if weights.len() > 1 {
            for (candidate, weight) in self.candidates.iter().zip(weights) {
                let fit = Regression::fit(&design, f, candidate.penalty * f.len() as f64);
                slopes.iter_mut().zip(fit.slopes).for_each(|(total, slope)| *total += weight * slope);
            }
        }
        slopes
    }

    /// Cross-fit over `folds` folds by index modulo `folds`: each fold's samples meet the mixture of the others alone.
    /// Exactly unbiased. Every candidate must be of the highest order.
    pub fn split(&self, u: &[f64], dims: usize, f: &[f64], order: usize, folds: usize) -> f64 {
        let n = f.len();
        let design = Design::legendre(u, dims, order);
        let mut sum = 0.0;
        for fold in 0..folds {
            let others: Vec<usize> = (0..n).filter(|i| i % folds != fold).collect();
            let f_others: Vec<f64> = others.iter().map(|&i| f[i]).collect();
            let u_others: Vec<f64> = others.iter().flat_map(|&i| u[i * dims..(i + 1) * dims].to_vec()).collect();
            let fit = Regression { intercept: 0.0, slopes: self.slopes(&u_others, dims, &f_others, order) };
            sum += (fold..n).step_by(folds).map(|i| f[i] - fit.control(&design.rows[i])).sum::<f64>();
        }
        sum / n as f64
    }

    /// Cross-fit over `folds` folds by index modulo `folds`: each fold's samples meet only fits to the others, with
    /// penalty times the size of the fit's own samples. Trust comes from held-out errors, and F is that of the samples the
    /// judged fits were made of. With `nested` the fits that decide about a fold neither know it nor are judged on it,
    /// which keeps the estimate exactly unbiased; else all folds decide together.
    pub fn k_fold(&self, u: &[f64], dims: usize, f: &[f64], order: usize, folds: usize, nested: bool) -> f64 {
        let samples = Samples { u, dims, f };
        let n = f.len();
        let orders =
            self.candidates.iter().map(|c| (c.order.min(order), c.penalty)).chain([(0, 1.0)]).collect::<Vec<_>>();
        let last = orders.len() - 1;
        let mut estimate = 0.0;
        for fold in 0..folds.min(n) {
            let inside: Vec<usize> = (fold..n).step_by(folds).collect();
            let judges: Vec<usize> = (0..folds.min(n)).filter(|&other| !(nested && other == fold)).collect();
            let judged = judges.iter().map(|&other| (other..n).step_by(folds).count()).sum::<usize>() as f64;
            let (mut errors, mut discounts) = (vec![0.0; orders.len()], vec![0.0; last]);
            for &other in &judges {
                let left = if nested { vec![fold, other] } else { vec![other] };
                for (k, &(order, penalty)) in orders.iter().enumerate() {
                    let fit = samples.fit_without(folds, &left, order, penalty);
                    errors[k] += samples.squared_error(&fit, folds, other, order);
                    if k < last {
                        let offset = samples.offset_without(folds, &left, order, penalty);
                        discounts[k] += self.discount(offset) / judges.len() as f64;
                    }
                }
            }
            if errors[last] == 0.0 {
                return f.iter().sum::<f64>() / n as f64;
            }
            let ratios: Vec<f64> = errors[..last].iter().map(|error| error / errors[last]).collect();
            for (weight, &(order, penalty)) in self.weigh(judged, &ratios, &discounts).iter().zip(&orders) {
                let fit = samples.fit_without(folds, &[fold], order, penalty);
                let design = Design::legendre(u, dims, order);
                let sum: f64 = inside.iter().map(|&i| f[i] - fit.control(&design.rows[i])).sum();
                estimate += weight * sum / n as f64;
            }
        }
        estimate
    }
}

impl Samples<'_> {
    fn fit_without(&self, folds: usize, left: &[usize], order: usize, penalty: f64) -> Regression {
        let keep: Vec<usize> = (0..self.f.len()).filter(|i| !left.contains(&(i % folds))).collect();
        let f: Vec<f64> = keep.iter().map(|&i| self.f[i]).collect();
        let design = Design::legendre(self.u, self.dims, order).select(&keep);
        Regression::fit(&design, &f, penalty * keep.len() as f64)
    }

    fn offset_without(&self, folds: usize, left: &[usize], order: usize, penalty: f64) -> f64 {
        let keep: Vec<usize> = (0..self.f.len()).filter(|i| !left.contains(&(i % folds))).collect();
        let design = Design::legendre(self.u, self.dims, order).select(&keep);
        Regression::offset(&design, penalty * keep.len() as f64)
    }

    fn squared_error(&self, fit: &Regression, folds: usize, fold: usize, order: usize) -> f64 {
        let design = Design::legendre(self.u, self.dims, order);
        let inside = (0..self.f.len()).filter(|i| i % folds == fold);
        inside.map(|i| (self.f[i] - fit.intercept - fit.control(&design.rows[i])).powi(2)).sum()
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
            RobustRule::standard().k_fold(&u, 2, &[2.5; 8], 3, 4, false),
            RobustRule::standard().k_fold(&u, 2, &[2.5; 8], 3, 4, true),
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
            nested.add(rule.k_fold(&u, 2, &f, 2, 4, true));
        }
        assert!(rmse_ratio(&robust, &plain).upper() < 0.5);
        assert!(nested.z(integrand.integral).abs() < 4.0);
    }
}
