//! What was to be reached, and what was measured.

use super::figure::Unit;
use super::statistics::Estimate;
use itertools::Itertools;

/// What a figure shall keep.
#[derive(Clone, Copy)]
pub(crate) enum Bound {
    AtMost(f64),
    Below(f64),
    AtLeast(f64),
}

impl Bound {
    fn is_kept_by(self, value: f64) -> bool {
        match self {
            Self::AtMost(bound) => value <= bound,
            Self::Below(bound) => value < bound,
            Self::AtLeast(bound) => value >= bound,
        }
    }

    /// How far a value is on the wrong side.
    fn excess(self, value: f64) -> f64 {
        match self {
            Self::AtMost(bound) | Self::Below(bound) => value - bound,
            Self::AtLeast(bound) => bound - value,
        }
    }

    pub(super) fn text(self, unit: Unit) -> String {
        match self {
            Self::AtMost(bound) => format!("at most {}", unit.text(bound)),
            Self::Below(bound) => format!("below {}", unit.text(bound)),
            Self::AtLeast(bound) => format!("at least {}", unit.text(bound)),
        }
    }
}

/// A figure, measured in one of several places, and what it shall keep.
pub(crate) struct Target {
    pub(super) statement: String,
    pub(super) place: String,
    pub(super) estimate: Estimate,
    pub(super) unit: Unit,
    pub(super) bound: Bound,
}

impl Target {
    /// The value alone keeps the bound.
    pub(super) fn is_kept(&self) -> bool {
        self.bound.is_kept_by(self.estimate.value)
    }

    /// The whole interval does.
    pub(super) fn is_reached(&self) -> bool {
        self.bound.is_kept_by(self.estimate.low) && self.bound.is_kept_by(self.estimate.high)
    }

    pub(super) fn verdict(&self) -> &'static str {
        let Estimate { value, low, high, .. } = self.estimate;
        match [low, value, high].map(|value| self.bound.is_kept_by(value)) {
            [true, true, true] => "reached",
            [_, true, _] => "open: the value keeps the bound, its interval does not",
            [false, false, false] => "NOT REACHED",
            [_, false, _] => "open: the value misses the bound, its interval does not",
        }
    }
}

/// Targets of the same statement, in the order in which they were measured.
pub(super) fn groups(targets: &[Target]) -> Vec<Vec<&Target>> {
    let statements = targets.iter().map(|target| &target.statement).unique();
    statements.map(|of| targets.iter().filter(|target| target.statement == *of).collect()).collect()
}

pub(super) fn worst<'a>(group: &[&'a Target]) -> &'a Target {
    let excess = |target: &Target| target.bound.excess(target.estimate.value);
    group.iter().max_by(|a, b| excess(a).total_cmp(&excess(b))).unwrap_or(&group[0])
}
