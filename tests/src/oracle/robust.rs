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

/// How candidates are weighed: w_k = (error_k / error_0)^(-n * exponent) / (C max(1, q_k)^leverage), Monte Carlo has
/// weight `prior`, and the weights are divided by their sum.
#[derive(Clone, Debug)]
pub struct RobustRule {
    /// The fits.
    pub candidates: Vec<Candidate>,
    /// Power of the error ratio per sample.
    pub exponent: f64,
    /// Weight of plain Monte Carlo against 1 for all candidates together.
    pub prior: f64,
    /// Power of the offset leverage `Regression::offset_leverage`; 0 ignores it.
    pub leverage: f64,
}

/// The samples of one estimate.
struct Samples<'a> {
    u: &'a [f64],
    dims: usize,
    f: &'a [f64],
}

impl RobustRule {
    /// The rule with four ridges of the highest order.
    pub fn standard() -> Self {
        let penalties = [1e-5, 1e-3, 0.02, 0.2];
        let candidates = penalties.map(|penalty| Candidate { order: usize::MAX, penalty }).to_vec();
        Self { candidates, exponent: 1.0 / 6.0, prior: 8.0, leverage: 1.0 }
    }

    /// The seven candidates of an earlier study: four ridges of the highest order and three of order 1.
    pub fn seven() -> Self {
        let highest = [5e-5, 5e-3, 0.05, 0.5].map(|penalty| Candidate { order: usize::MAX, penalty });
        let first = [0.01, 0.1, 1.0].map(|penalty| Candidate { order: 1, penalty });
        Self { candidates: [&highest[..], &first].concat(), exponent: 1.0 / 8.0, prior: 8.0, leverage: 0.0 }
    }

    /// Weights from log-likelihood-like scores, the last one that of Monte Carlo; computed without overflow.
    fn normalise(scores: &[f64]) -> Vec<f64> {
        let largest = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let raw: Vec<f64> = scores.iter().map(|s| (s - largest).exp()).collect();
        let sum: f64 = raw.iter().sum();
        raw.iter().map(|w| w / sum).collect()
    }

    fn score(&self, samples: f64, ratio: f64, leverage: f64) -> f64 {
        let count = self.candidates.len() as f64;
        -samples * self.exponent * ratio.max(1e-30).ln() - self.leverage * leverage.max(1.0).ln() - count.ln()
    }

    /// The weights of the candidates and, last, of Monte Carlo, beside each one's estimate.
    pub fn weights_and_estimates(&self, u: &[f64], dims: usize, f: &[f64], order: usize) -> (Vec<f64>, Vec<f64>) {
        let n = f.len() as f64;
        let mean = f.iter().sum::<f64>() / n;
        let press_0 = f.iter().map(|f| ((f - mean) * n / (n - 1.0)).powi(2)).sum::<f64>();
        if f.len() < 2 || press_0 == 0.0 {
            return (vec![1.0], vec![mean]);
        }
        let (mut scores, mut estimates) = (vec![], vec![]);
        for candidate in &self.candidates {
            let design = Design::legendre(u, dims, candidate.order.min(order));
            let ridge = candidate.penalty * n;
            let left_out: LeftOut = Regression::leave_one_out(&design, f, ridge);
            let leverage = Regression::offset_leverage(&design, ridge);
            scores.push(self.score(n, left_out.press() / press_0, leverage));
            estimates.push(left_out.mean());
        }
        scores.push(self.prior.ln());
        estimates.push(mean);
        (Self::normalise(&scores), estimates)
    }

    /// The estimate of the integral from all samples: sum of w_k mean(y_k).
    pub fn estimate(&self, u: &[f64], dims: usize, f: &[f64], order: usize) -> f64 {
        let (weights, estimates) = self.weights_and_estimates(u, dims, f, order);
        weights.iter().zip(&estimates).map(|(w, e)| w * e).sum()
    }

    /// Cross-fit over `folds` folds by index modulo `folds`: each fold's samples meet only fits to the others, with
    /// penalty times the size of the fit's own samples. With `unbiased` the fold's weights come from fits without the fold
    /// and errors on the remaining ones (nested), else from the held-out errors of all folds.
    pub fn k_fold(&self, u: &[f64], dims: usize, f: &[f64], order: usize, folds: usize, unbiased: bool) -> f64 {
        let samples = Samples { u, dims, f };
        let n = f.len();
        let orders =
            self.candidates.iter().map(|c| (c.order.min(order), c.penalty)).chain([(0, 1.0)]).collect::<Vec<_>>();
        let mut estimate = 0.0;
        for fold in 0..folds {
            let inside: Vec<usize> = (0..n).filter(|i| i % folds == fold).collect();
            if inside.is_empty() {
                continue;
            }
            let mut errors = vec![0.0; orders.len()];
            for other in 0..folds {
                if unbiased && other == fold {
                    continue;
                }
                let left = if unbiased { vec![fold, other] } else { vec![other] };
                for (error, &(order, penalty)) in errors.iter_mut().zip(&orders) {
                    let fit = samples.fit_without(folds, &left, order, penalty);
                    *error += samples.squared_error(&fit, folds, other, order);
                }
            }
            let last = errors.len() - 1;
            let ratio = |k: usize| if errors[last] > 0.0 { errors[k] / errors[last] } else { 1.0 };
            let mut scores: Vec<f64> = (0..last).map(|k| self.score(n as f64, ratio(k), 1.0)).collect();
            scores.push(self.prior.ln());
            for (weight, &(order, penalty)) in Self::normalise(&scores).iter().zip(&orders) {
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
