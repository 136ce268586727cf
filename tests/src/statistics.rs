//! The statistics that tests decide by: each states what it estimates and with what uncertainty.

/// Running count, mean and sum of squared deviations (Welford 1962; merge after Chan et al. 1979).
#[derive(Clone, Copy, Debug, Default)]
pub struct Moments {
    count: f64,
    mean: f64,
    squares: f64,
}

impl Moments {
    /// Adds one value.
    pub fn add(&mut self, value: f64) {
        self.count += 1.0;
        let delta = value - self.mean;
        self.mean += delta / self.count;
        self.squares += delta * (value - self.mean);
    }

    /// Number of values.
    pub fn count(&self) -> f64 {
        self.count
    }

    /// Their mean; 0 for none.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// The unbiased variance; NaN for fewer than two values.
    pub fn variance(&self) -> f64 {
        if self.count < 2.0 { f64::NAN } else { self.squares / (self.count - 1.0) }
    }

    /// The standard error of the mean.
    pub fn standard_error(&self) -> f64 {
        (self.variance() / self.count).sqrt()
    }

    /// The z statistic of the mean against an exact value. Equal values that are exact to rounding give 0.
    pub fn z(&self, expected: f64) -> f64 {
        let difference = self.mean - expected;
        if difference.abs() <= 1e-12 * expected.abs() { 0.0 } else { difference / self.standard_error() }
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut moments = Self::default();
        values.into_iter().for_each(|value| moments.add(value));
        moments
    }
}

/// A ratio and the half width of its 95 % confidence interval.
#[derive(Clone, Copy, Debug)]
pub struct Ratio {
    /// The estimate.
    pub value: f64,
    /// 1.96 standard errors.
    pub half_width: f64,
}

impl Ratio {
    /// The upper end of the interval.
    pub fn upper(&self) -> f64 {
        self.value + self.half_width
    }
}

/// RMSE(a) / RMSE(b) of paired errors, with the delta method: for A = mean a^2, B = mean b^2, d_i = a_i^2 / A - b_i^2 / B
/// has mean 0 and the standard error of ln(A / B) is that of mean d. Two sets of zero errors give 1.
pub fn rmse_ratio(a: &[f64], b: &[f64]) -> Ratio {
    assert_eq!(a.len(), b.len());
    let mean_square = |errors: &[f64]| errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
    let (square_a, square_b) = (mean_square(a), mean_square(b));
    if square_a == square_b {
        return Ratio { value: 1.0, half_width: 0.0 };
    }
    let value = (square_a / square_b).sqrt();
    let spread: Moments = a.iter().zip(b).map(|(a, b)| a * a / square_a - b * b / square_b).collect();
    Ratio { value, half_width: 1.96 * value * 0.5 * spread.standard_error() }
}

/// exp(mean ln x): how ratios over several integrands are summarised.
pub fn geometric_mean(values: &[f64]) -> f64 {
    (values.iter().map(|v| v.ln()).sum::<f64>() / values.len() as f64).exp()
}

/// The value at quantile 1/2.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2]) / 2.0
}

/// Pearson's statistic of observed counts against expected ones, and its two-sided z by the Wilson-Hilferty cube root
/// with `cells - 1` degrees of freedom (good to .01 in z from 4 degrees on).
pub fn chi_square(observed: &[f64], expected: &[f64]) -> (f64, f64) {
    let statistic = observed.iter().zip(expected).map(|(o, e)| (o - e) * (o - e) / e).sum::<f64>();
    let freedom = observed.len() as f64 - 1.0;
    let spread = 2.0 / (9.0 * freedom);
    (statistic, ((statistic / freedom).cbrt() - (1.0 - spread)) / spread.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn moments_of_a_known_set() {
        let moments: Moments = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0].into_iter().collect();
        assert_eq!((moments.count(), moments.mean(), moments.variance()), (8.0, 5.0, 32.0 / 7.0));
    }

    /// 200 intervals at 95 %: the number that miss is binomial(200, .05), within 10 +- 4 standard deviations (seed 3).
    #[test]
    fn ratio_interval_covers() {
        let mut rng = SplitMix64::new(3);
        let missed = (0..200).filter(|_| {
            let b: Vec<f64> = (0..400).map(|_| rng.normal()).collect();
            let a: Vec<f64> = b.iter().map(|b| 0.4 * b + 0.3 * rng.normal()).collect();
            let ratio = rmse_ratio(&a, &b);
            (ratio.value - 0.5).abs() > ratio.half_width
        });
        assert!(missed.count() <= 22);
    }

    /// The 95 % point of chi-square with 9 degrees of freedom is 16.919, where z = 1.645.
    #[test]
    fn chi_square_at_a_table_value() {
        let expected = [100.0; 10];
        let mut observed = expected;
        observed[0] += (16.919_f64 * 50.0).sqrt();
        observed[1] -= (16.919_f64 * 50.0).sqrt();
        let (statistic, z) = chi_square(&observed, &expected);
        assert!((statistic - 16.919).abs() < 1e-9 && (z - 1.645).abs() < 0.02);
    }

    #[test]
    fn averages() {
        assert!((geometric_mean(&[0.5, 2.0, 8.0]) - 2.0).abs() < 1e-15);
        assert_eq!(median(&[3.0, 1.0, 2.0, 10.0]), 2.5);
    }
}
