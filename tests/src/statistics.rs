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

/// A ratio and its 95 % confidence interval, which of few repetitions holds the truth less often: of 8 in 93 % of all
/// cases, where tails are heavy in 90 %; of hundreds in 95 %.
#[derive(Clone, Copy, Debug)]
pub struct Ratio {
    /// The estimate.
    pub value: f64,
    /// How far the interval reaches above it; infinite if nothing is known.
    pub half_width: f64,
}

impl Ratio {
    /// The upper end of the interval.
    pub fn upper(&self) -> f64 {
        self.value + self.half_width
    }

    /// The lower end: the interval is of the logarithm.
    pub fn lower(&self) -> f64 {
        if self.half_width == 0.0 { self.value } else { self.value * (self.value / self.upper()) }
    }
}

/// RMSE(a) / RMSE(b) of paired errors. The jackknife tells the standard error of the logarithm (Efron and Tibshirani
/// 1993, chapter 11), which few repetitions and heavy tails do not shrink as they do the delta method's; Student's
/// quantile goes with it, and the interval's ends are as far from the value in logarithms; the upper, longer side is
/// kept. Two sets of zero errors give 1; one is exact where the other is not: 0 or infinity. Panics on NaN, which no
/// bound would notice.
pub fn rmse_ratio(a: &[f64], b: &[f64]) -> Ratio {
    assert_eq!(a.len(), b.len());
    let squares = |errors: &[f64]| errors.iter().map(|e| e * e).sum::<f64>();
    let (square_a, square_b) = (squares(a), squares(b));
    if square_a == square_b {
        return Ratio { value: 1.0, half_width: 0.0 };
    }
    let value = (square_a / square_b).sqrt();
    assert!(!value.is_nan(), "{square_a} / {square_b}");
    if value == 0.0 || value == f64::INFINITY {
        return Ratio { value, half_width: 0.0 };
    }
    let without = |(a, b): (&f64, &f64)| 0.5 * ((square_a - a * a).max(0.0) / (square_b - b * b).max(0.0)).ln();
    let logarithms: Moments = a.iter().zip(b).map(without).collect();
    // (n - 1) / n times the sum of the squared deviations; their variance has n - 1 below.
    let freedom = logarithms.count() - 1.0;
    let error = (freedom * freedom / logarithms.count() * logarithms.variance()).sqrt();
    let half_width = value * (student(freedom) * error).exp_m1();
    // Not finite if a repetition has all of the error.
    Ratio { value, half_width: if half_width.is_nan() { f64::INFINITY } else { half_width } }
}

/// What Student's t of so many degrees of freedom exceeds with 2.5 %: exact for 1 and 2, else Abramowitz and Stegun
/// 26.7.5, to four terms, which is .004 too small for 3 and good to .001 from 4 on.
pub fn student(freedom: f64) -> f64 {
    if freedom <= 2.0 {
        return if freedom < 1.5 { 12.7062 } else { 4.3027 };
    }
    let z = 1.959_963_985_f64;
    let polynomial = |terms: &[f64]| terms.iter().fold(0.0, |sum, term| sum * z * z + term) * z;
    z + polynomial(&[1.0, 1.0]) / (4.0 * freedom)
        + polynomial(&[5.0, 16.0, 3.0]) / (96.0 * freedom.powi(2))
        + polynomial(&[3.0, 19.0, 17.0, -15.0]) / (384.0 * freedom.powi(3))
        + polynomial(&[79.0, 776.0, 1482.0, -1920.0, -945.0]) / (92_160.0 * freedom.powi(4))
}

/// exp(mean ln x): how ratios over several integrands are summarised.
pub fn geometric_mean(values: &[f64]) -> f64 {
    (values.iter().map(|v| v.ln()).sum::<f64>() / values.len() as f64).exp()
}

/// The largest of the values, or 0 if none is above; NaN if one of them is, which `f64::max` would pass over.
pub fn maximum(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |a, b| if a.is_nan() || a >= b { a } else { b })
}

/// The root of the mean of squares.
pub fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

/// The value at quantile 1/2.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2]) / 2.0
}

/// Pearson's statistic of observed counts against expected ones, and its z with `cells - 1` degrees of freedom.
pub fn chi_square(observed: &[f64], expected: &[f64]) -> (f64, f64) {
    let statistic = observed.iter().zip(expected).map(|(o, e)| (o - e) * (o - e) / e).sum::<f64>();
    (statistic, wilson_hilferty(statistic, observed.len() as f64 - 1.0))
}

/// A chi-square as a normal deviate, by its cube root (Wilson and Hilferty 1931; good to .01 from 4 degrees of freedom
/// on).
pub fn wilson_hilferty(statistic: f64, freedom: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    ((statistic / freedom).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// The z of counts that are the same but for chance.
pub fn uniform_z(counts: &[u64]) -> f64 {
    let counts: Vec<f64> = counts.iter().map(|&count| count as f64).collect();
    let mean = counts.iter().sum::<f64>() / counts.len() as f64;
    chi_square(&counts, &vec![mean; counts.len()]).1
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

    /// Of 2000 intervals, those that miss: of errors a = .4 b + .3 c, whose scale varies from repetition to repetition.
    fn missed(repetitions: usize, variation: f64) -> usize {
        let mut rng = SplitMix64::new(3);
        let misses = |_: &usize| {
            let scales: Vec<f64> = (0..repetitions).map(|_| (variation * rng.normal()).exp()).collect();
            let b: Vec<f64> = scales.iter().map(|scale| scale * rng.normal()).collect();
            let a: Vec<f64> = b.iter().zip(&scales).map(|(b, scale)| 0.4 * b + 0.3 * scale * rng.normal()).collect();
            let ratio = rmse_ratio(&a, &b);
            !(ratio.lower()..=ratio.upper()).contains(&0.5)
        };
        (0..2000).filter(misses).count()
    }

    /// At 95 % the number that miss is binomial(2000, .05): within 100 +- 4 standard deviations of 9.7. Of 8
    /// repetitions 7 % miss: within 140 +- 4 of 11.4.
    #[test]
    fn ratio_interval_covers() {
        for (repetitions, expected) in [(8, 95..=185), (32, 61..=139), (400, 61..=139)] {
            let missed = missed(repetitions, 0.0);
            assert!(expected.contains(&missed), "{missed} of 2000, {repetitions} repetitions");
        }
    }

    /// Scales that vary by a factor of 2 (one standard deviation): few repetitions hardly show the largest. One in ten
    /// misses; one in eight would be four standard deviations more.
    #[test]
    fn ratio_interval_of_heavy_tails() {
        for repetitions in [8, 16, 100] {
            let missed = missed(repetitions, 0.7);
            assert!(missed <= 220, "{missed} of 2000, {repetitions} repetitions");
        }
    }

    /// Tables have 12.706, 4.303, 3.182, 2.571, 2.131.
    #[test]
    fn students_quantiles() {
        for (freedom, expected) in
            [(1.0, 12.706), (2.0, 4.303), (3.0, 3.182), (5.0, 2.571), (15.0, 2.131), (1e9, 1.960)]
        {
            assert!((student(freedom) - expected).abs() < 5e-3, "{freedom}: {}", student(freedom));
        }
    }

    #[test]
    fn ratios_of_exact_and_of_lonely_errors() {
        let ratio = |a: &[f64], b: &[f64]| {
            let Ratio { value, half_width } = rmse_ratio(a, b);
            (value, half_width)
        };
        assert_eq!(ratio(&[0.0; 3], &[0.0; 3]), (1.0, 0.0));
        assert_eq!(ratio(&[0.0; 3], &[1.0; 3]), (0.0, 0.0));
        assert_eq!(ratio(&[1.0; 3], &[0.0; 3]), (f64::INFINITY, 0.0));
        assert_eq!(ratio(&[2.0, 0.0, 0.0], &[1.0, 0.0, 0.0]), (2.0, f64::INFINITY));
        for (value, half_width, lower) in
            [(2.0, f64::INFINITY, 0.0), (f64::INFINITY, 0.0, f64::INFINITY), (2.0, 6.0, 0.5)]
        {
            assert_eq!(Ratio { value, half_width }.lower(), lower);
        }
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

    #[test]
    fn maxima_show_what_is_no_number() {
        assert_eq!((maximum([]), maximum([1.0, 3.0, 2.0])), (0.0, 3.0));
        for values in [[f64::NAN, 1.0], [1.0, f64::NAN], [f64::INFINITY, f64::NAN]] {
            assert!(maximum(values).is_nan(), "{values:?}");
        }
    }

    #[test]
    #[should_panic = "NaN"]
    fn no_ratio_has_an_error_that_is_no_number() {
        rmse_ratio(&[1.0, f64::NAN], &[2.0, 3.0]);
    }
}
