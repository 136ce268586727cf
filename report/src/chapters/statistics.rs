//! Medians and means with confidence intervals, and tests of many hypotheses at once.

use statrs::distribution::{Binomial, ContinuousCDF, DiscreteCDF, Normal, StudentsT};
use statrs::statistics::{Data, OrderStatistics};

/// A value measured once for each of several seeds: their median, and where it lies with at least 95 % confidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Estimate {
    pub(crate) value: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// Seeds that were measured.
    pub(crate) seeds: usize,
}

/// Of fewer values, not even the range holds the median with 95 %: of five it does with 1 - 2 / 2^5, 94 %.
const FEWEST: usize = 6;

impl Estimate {
    /// Without repetitions: a value alone.
    pub(crate) fn exact(value: f64) -> Self {
        Self { value, low: value, high: value, seeds: 1 }
    }

    /// With as much on either side.
    pub(crate) fn about(value: f64, half: f64, seeds: usize) -> Self {
        Self { value, low: value - half, high: value + half, seeds }
    }

    /// A ratio by an interval of its logarithm, whose upper end is `above` it; infinite if nothing is known.
    pub(crate) fn of_logarithm(value: f64, above: f64, seeds: usize) -> Self {
        let high = value + above;
        Self { value, low: if above == 0.0 { value } else { value * (value / high) }, high, seeds }
    }

    /// The geometric mean of positive values, and Student's interval of its logarithm. Of fewer than three there is
    /// none: Student's quantile of two, 12.7, says nothing.
    pub(crate) fn geometric_mean(values: &[f64]) -> Self {
        let logarithms: Vec<f64> = values.iter().map(|value| value.ln()).collect();
        let Self { value, low, high, seeds } = Self::mean(&logarithms);
        let value = value.exp();
        if values.len() < 3 {
            return Self { seeds, ..Self::exact(value) };
        }
        Self { value, low: low.exp(), high: high.exp(), seeds }
    }

    /// The median, and the sign test's interval of it: between the order statistics that hold it with at least 95 %,
    /// whatever the distribution (of 8 values the least and the greatest, with 99.2 %; the bootstrap's hold 92 %).
    /// Fewer values than [`FEWEST`] give none.
    pub(crate) fn median(values: &[f64]) -> Self {
        let value = median(values.iter().copied());
        if values.len() < FEWEST {
            return Self { seeds: values.len(), ..Self::exact(value) };
        }
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let below = Binomial::new(0.5, values.len() as u64);
        let is_rare = |&count: &u64| below.as_ref().is_ok_and(|below| below.cdf(count) <= 0.025);
        // Values outside, on either side.
        let outside = (0..).take_while(is_rare).count().saturating_sub(1);
        Self { value, low: sorted[outside], high: sorted[sorted.len() - 1 - outside], seeds: values.len() }
    }

    /// Without one, both ends are the value.
    pub(crate) fn has_interval(&self) -> bool {
        let ends = self.low.is_finite() && self.high.is_finite();
        ends && self.value.is_finite() && self.seeds > 1 && (self.seeds >= FEWEST || self.low < self.high)
    }

    /// The mean, and Student's interval of it: for few values, each itself a mean of many things.
    pub(crate) fn mean(values: &[f64]) -> Self {
        let (count, (value, deviation)) = (values.len() as f64, moments(values));
        let half = if values.len() < 2 { 0.0 } else { student(0.025, count - 1.0) * deviation / count.sqrt() };
        Self::about(value, half, values.len())
    }

    /// Of a / b, pair by pair: both of a pair had the same seed.
    pub(crate) fn ratio(a: &[f64], b: &[f64]) -> Self {
        Self::median(&a.iter().zip(b).map(|(a, b)| a / b).collect::<Vec<_>>())
    }

    /// The mean of `a` over that of `b`, and Student's interval by the delta method: (a - ratio b) / mean(b) spreads.
    pub(crate) fn ratio_of_means(a: &[f64], b: &[f64]) -> Self {
        let (mean, value) = (moments(b).0, moments(a).0 / moments(b).0);
        Self::about(value, half_of_difference(a, b, value) / mean.abs(), a.len().min(b.len()))
    }

    /// The geometric mean of `a` over that of `b`, all positive, with the interval of the logarithm. As of one
    /// geometric mean, fewer than three values give none.
    pub(crate) fn ratio_of_geometric_means(a: &[f64], b: &[f64]) -> Self {
        let [a, b] = [a, b].map(|of| of.iter().map(|value| value.ln()).collect::<Vec<_>>());
        let (value, count) = (moments(&a).0 - moments(&b).0, a.len().min(b.len()));
        let half = if count < 3 { 0.0 } else { half_of_difference(&a, &b, 1.0) };
        let [value, low, high] = [value, value - half, value + half].map(f64::exp);
        Self { value, low, high, seeds: count }
    }

    /// A figure over the least of several others: of each its value, and the figure over it. The same numbers say which
    /// is least, so that the ends are those of all that may be: whose intervals are not below another's.
    pub(crate) fn over_least(others: &[(f64, Self)]) -> Option<Self> {
        let (_, chosen) = *others.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        if !chosen.has_interval() {
            return Some(chosen);
        }
        let ratios = || others.iter().map(|(_, ratio)| ratio).filter(|ratio| ratio.has_interval());
        let least = ratios().map(|ratio| ratio.low).fold(f64::NEG_INFINITY, f64::max);
        let widened = |all: Self, one: &Self| Self { low: all.low.min(one.low), high: all.high.max(one.high), ..all };
        Some(ratios().filter(|ratio| ratio.high >= least).fold(chosen, widened))
    }
}

/// Half of Student's interval of mean(a) - factor mean(b): of the differences pair by pair, if they are as many; else
/// both spread. 0 of a single value.
fn half_of_difference(a: &[f64], b: &[f64], factor: f64) -> f64 {
    let fewest = a.len().min(b.len());
    if fewest < 2 {
        return 0.0;
    }
    let squared = |of: &[f64]| moments(of).1.powi(2) / of.len() as f64;
    let variance = match a.len() == b.len() {
        true => squared(&a.iter().zip(b).map(|(a, b)| a - factor * b).collect::<Vec<_>>()),
        false => squared(a) + factor * factor * squared(b),
    };
    student(0.025, fewest as f64 - 1.0) * variance.sqrt()
}

/// What so many per cent of the values are below.
pub(crate) fn percentile(values: impl IntoIterator<Item = f64>, percent: usize) -> f64 {
    Data::new(values.into_iter().collect::<Vec<_>>()).percentile(percent)
}

/// The middle value; of an even number of values, the mean of the two in the middle.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    Data::new(values.into_iter().collect::<Vec<_>>()).median()
}

/// Mean and standard deviation.
pub(crate) fn moments(values: &[f64]) -> (f64, f64) {
    let (count, mean) = (values.len() as f64, values.iter().sum::<f64>() / values.len() as f64);
    (mean, (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0)).sqrt())
}

/// What Student's t exceeds with probability `tail`.
pub(crate) fn student(tail: f64, freedom: f64) -> f64 {
    -StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |distribution| distribution.inverse_cdf(tail))
}

/// What a standard normal variable exceeds with probability `tail`.
pub(crate) fn normal_quantile(tail: f64) -> f64 {
    -Normal::standard().inverse_cdf(tail)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median([3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median([4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median([]).is_nan());
    }

    #[test]
    fn medians_have_intervals() {
        // Ranks of the lower ends, as tables of the sign test have them.
        for (count, rank) in [(6, 1), (7, 1), (8, 1), (9, 2), (16, 4), (24, 7), (48, 17)] {
            let values: Vec<f64> = (1..=count).rev().map(f64::from).collect();
            let estimate = Estimate::median(&values);
            let [low, high] = [rank, count + 1 - rank].map(f64::from);
            assert_eq!((estimate.low, estimate.high), (low, high), "{count}");
            assert!(estimate.value == (low + high) / 2.0 && estimate.has_interval());
        }
        for few in [&[3.0][..], &[3.0, 4.0], &[1.0, 2.0, 3.0, 4.0, 5.0]] {
            let estimate = Estimate::median(few);
            assert!(estimate.low == estimate.high && !estimate.has_interval(), "{few:?}");
        }
        // Student's is one, of two values already.
        assert!(Estimate::mean(&[3.0, 4.0]).has_interval());
    }

    #[test]
    fn ratios_are_paired() {
        let ratio = Estimate::ratio(&[1.0, 20.0, 3.0], &[2.0, 40.0, 6.0]);
        assert_eq!((ratio.value, ratio.low, ratio.high), (0.5, 0.5, 0.5));
    }

    #[test]
    fn what_is_divided_by_spreads_too() {
        let mut random = fastrand::Rng::with_seed(9);
        let uniform = |random: &mut fastrand::Rng| (0..32).map(|_| 1.0 + random.f64()).collect::<Vec<_>>();
        let (mut held, mut of_less, mut as_exact) = (0, 0, 0);
        for _ in 0..2000 {
            let [a, b] = [(); 2].map(|()| uniform(&mut random));
            let holds = |of: Estimate| usize::from(of.low <= 1.0 && 1.0 <= of.high);
            held += holds(Estimate::ratio_of_means(&a, &b));
            of_less += holds(Estimate::ratio_of_means(&a, &b[..24]));
            let mean = moments(&b).0;
            as_exact += holds(Estimate::mean(&a.iter().map(|a| a / mean).collect::<Vec<_>>()));
        }
        // Of 2000 at 95 % with four standard deviations of 9.7; as if the mean of b were exact it is 84 %.
        assert!((1861..1939).contains(&held) && (1861..1961).contains(&of_less), "{held} {of_less}");
        assert!(as_exact < 1750, "{as_exact}");
    }

    #[test]
    fn pairs_that_go_together_are_sure_of_their_ratio() {
        let b = [1.0, 2.0, 4.0];
        let a = b.map(|b| 0.5 * b);
        for ratio in [Estimate::ratio_of_means(&a, &b), Estimate::ratio_of_geometric_means(&a, &b)] {
            assert!([ratio.low, ratio.value, ratio.high].iter().all(|end| (end - 0.5).abs() < 1e-12), "{ratio:?}");
        }
        // Logarithms 0, 1 and 2 over four that are 0.
        let known = Estimate::ratio_of_geometric_means(&[1.0, 1f64.exp(), 2f64.exp()], &[1.0; 4]);
        assert!((known.high.ln() - 1.0 - 4.302_652_729_911_275 / 3f64.sqrt()).abs() < 1e-9, "{known:?}");
        assert!(!Estimate::ratio_of_geometric_means(&[1.0, 2.0], &[1.0, 3.0]).has_interval());
        assert!(!Estimate::ratio_of_means(&[1.0], &[1.0, 3.0]).has_interval());
    }

    #[test]
    fn which_is_least_is_uncertain_too() {
        let ratio = |low, high| Estimate { value: 0.5 * (low + high), low, high, seeds: 8 };
        let all = [(2.0, ratio(0.9, 1.1)), (2.1, ratio(0.8, 1.2)), (4.0, ratio(0.4, 0.6))];
        let over = Estimate::over_least(&all).expect("several");
        assert_eq!((over.value, over.low, over.high), (1.0, 0.8, 1.2));
        assert_eq!(Estimate::over_least(&all[2..]), Some(all[2].1));
        let few = [(2.0, Estimate::exact(0.9)), (2.1, Estimate::exact(1.2))];
        assert_eq!(Estimate::over_least(&few), Some(few[0].1));
        assert_eq!(Estimate::over_least(&[]), None);
    }

    #[test]
    fn students_interval_of_a_mean() {
        let quantiles = [12.7062, 2.5706, 2.3646, 2.1314, 2.1199, 2.0687, 1.9799];
        for (freedom, expected) in [1.0, 5.0, 7.0, 15.0, 16.0, 23.0, 120.0].into_iter().zip(quantiles) {
            assert!((student(0.025, freedom) - expected).abs() < 5e-4, "{freedom}: {}", student(0.025, freedom));
        }
        let mean = Estimate::mean(&[1.0, 2.0, 3.0]);
        assert!(mean.value == 2.0 && (mean.high - 2.0 - 4.302_652_729_911_275 / 3.0_f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn intervals_of_logarithms_are_positive() {
        let few = Estimate::geometric_mean(&[1.0, 4.0]);
        assert!((few.value - 2.0).abs() < 1e-12 && !few.has_interval(), "{few:?}");
        let three = Estimate::geometric_mean(&[0.5, 1.0, 8.0]);
        assert!(three.has_interval() && three.low > 0.0, "{three:?}");
        let value = 4f64.powf(1.0 / 3.0);
        assert!((three.value - value).abs() < 1e-12 && (three.low * three.high - value * value).abs() < 1e-9);
        // Logarithms 0, 1 and 2, whose standard deviation is 1.
        let known = Estimate::geometric_mean(&[1.0, 1f64.exp(), 2f64.exp()]);
        assert!((known.high.ln() - 1.0 - 4.302_652_729_911_275 / 3f64.sqrt()).abs() < 1e-9, "{known:?}");
        let ratio = Estimate::of_logarithm(2.0, 6.0, 27);
        assert_eq!((ratio.low, ratio.high), (0.5, 8.0));
        let unknown = Estimate::of_logarithm(2.0, f64::INFINITY, 16);
        assert!(unknown.low == 0.0 && !unknown.has_interval());
        assert_eq!(Estimate::of_logarithm(0.0, 0.0, 16).low, 0.0);
    }

    #[test]
    fn at_least_95_in_100_intervals_hold_the_truth() {
        // Medians of uniform numbers: 1/2 is the truth.
        let mut random = fastrand::Rng::with_seed(7);
        for (count, confidence) in [(6, 0.969_f64), (7, 0.984), (8, 0.992), (16, 0.979)] {
            let held = (0..2000).filter(|_| {
                let estimate = Estimate::median(&(0..count).map(|_| random.f64()).collect::<Vec<_>>());
                estimate.low <= 0.5 && 0.5 <= estimate.high
            });
            // Four standard deviations on either side.
            let (held, half) = (held.count() as f64, 4.0 * (2000.0 * confidence * (1.0 - confidence)).sqrt());
            assert!((held - 2000.0 * confidence).abs() < half, "{held} of 2000 with {count} values");
        }
    }

    #[test]
    fn quantiles_of_the_normal_distribution() {
        for (tail, expected) in [(0.025, 1.959_963_985), (0.005, 2.575_829_304), (1e-6, 4.753_424_309)] {
            assert!((normal_quantile(tail) - expected).abs() < 1e-6, "{tail}: {}", normal_quantile(tail));
        }
    }
}
