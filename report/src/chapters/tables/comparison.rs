//! Several ways to estimate, on several scenes: rows that the sections have in common.

use super::Section;
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::measurement::{Experiment, Outcome};
use crate::chapters::statistics::Estimate;
use anyhow::Result;

/// Median relMSE, times a thousand as in the thesis.
pub(super) fn thousandfold(outcome: &Outcome, estimator: &str) -> Result<Figure> {
    let errors: Vec<f64> = outcome.errors(estimator)?.iter().map(|error| 1e3 * error).collect();
    Ok(Figure::new(Estimate::median(&errors), Unit::RelMseE3))
}

/// relMSE over the plain mean's: of the same samples, and in the same time.
pub(super) fn ratios(outcome: &Outcome, estimator: &str) -> Result<[Figure; 2]> {
    let both = [outcome.ratio(estimator)?, outcome.equal_time(estimator)?];
    Ok(both.map(|ratio| Figure::new(ratio, Unit::Ratio)))
}

/// As many seeds as everything is measured with.
pub(super) fn seeds<'a>(section: &Section, experiment: Experiment<'a>) -> Experiment<'a> {
    Experiment { seeds: section.measurement.plan.seeds, ..experiment }
}
