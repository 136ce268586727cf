//! A measured figure: its value, and its confidence interval, as text and as JSON.

use super::statistics::Estimate;
use serde::{Deserialize, Serialize};

/// What a figure counts, and how it is written.
#[derive(Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub(crate) enum Unit {
    /// One error, time or variance over another.
    #[default]
    Ratio,
    Percent,
    Nanoseconds,
    /// Of the processor.
    Instructions,
    Count,
    /// Of any size: three digits.
    Number,
    Hundredths,
    Thousandths,
    /// Of any size, in the integrand's unit or relative, with an exponent.
    Error,
    /// The same with a digit less.
    Scientific,
}

impl Unit {
    pub(crate) fn text(self, value: f64) -> String {
        match self {
            _ if value.is_nan() => "-".to_owned(),
            _ if value.is_infinite() => "infinite".to_owned(),
            Self::Ratio if value.abs() < 10.0 => format!("{value:.3}"),
            Self::Number => significant(value, 3),
            Self::Percent if value.abs() < 10.0 => format!("{value:.2}"),
            Self::Hundredths => format!("{value:.2}"),
            Self::Thousandths => format!("{value:.3}"),
            Self::Instructions if value.abs() < 1000.0 => significant(value, 4),
            Self::Instructions => format!("{value:.0}"),
            Self::Error | Self::Scientific if value == 0.0 => "0".to_owned(),
            Self::Error => format!("{value:.2e}"),
            Self::Scientific => format!("{value:.1e}"),
            Self::Nanoseconds | Self::Count if value.abs() >= 10.0 || self == Self::Count => format!("{value:.0}"),
            Self::Ratio | Self::Percent | Self::Nanoseconds | Self::Count => format!("{value:.1}"),
        }
    }
}

/// Rounded to so many digits, without an exponent.
pub(super) fn significant(value: f64, digits: i32) -> String {
    let before = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    format!("{value:.*}", (digits - 1 - before).max(0) as usize)
}

/// What the report quotes.
#[derive(Clone, Serialize)]
pub(crate) struct Figure {
    /// As it is written, with its interval.
    pub(crate) text: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) value: Option<f64>,
    /// Ends of the confidence interval.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) interval: Option<[f64; 2]>,
}

impl Figure {
    /// With its confidence interval, if there were enough seeds for one.
    pub(crate) fn new(estimate: Estimate, unit: Unit) -> Self {
        let Estimate { value, low, high, .. } = estimate;
        let mut figure = Self::exact(value, unit);
        if estimate.has_interval() {
            figure.interval = Some([low, high]);
            figure.text = format!("{} [{}, {}]", figure.text, unit.text(low), unit.text(high));
        }
        figure
    }

    /// The value alone is written; its interval is in the JSON.
    pub(crate) fn brief(estimate: Estimate, unit: Unit) -> Self {
        Self { text: unit.text(estimate.value), ..Self::new(estimate, unit) }
    }

    pub(crate) fn count(count: usize) -> Self {
        Self::exact(count as f64, Unit::Count)
    }

    /// Without an interval: a count, or the largest of several figures.
    pub(crate) fn exact(value: f64, unit: Unit) -> Self {
        let value_or_none = Some(value).filter(|value| value.is_finite());
        Self { text: unit.text(value), value: value_or_none, interval: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_as_text() {
        let estimate = Estimate { value: 0.4, low: 0.38, high: 0.4149, seeds: 8 };
        assert_eq!(Figure::new(estimate, Unit::Ratio).text, "0.400 [0.380, 0.415]");
        assert_eq!(Figure::brief(estimate, Unit::Ratio).text, "0.400");
        assert_eq!(Figure::exact(12.34, Unit::Percent).text, "12.3");
        assert_eq!(Unit::Number.text(12.345), "12.3");
        assert_eq!(Unit::Number.text(0.012_345), "0.0123");
        assert_eq!(Unit::Nanoseconds.text(123.4), "123");
        assert_eq!(Figure::exact(f64::NAN, Unit::Ratio).text, "-");
        assert_eq!(Figure::exact(f64::INFINITY, Unit::Ratio).text, "infinite");
    }
}
