//! The chapters, in the order of the index.

use super::described::Description;
use super::plan::{Extent, Plan};
use super::prelude::*;
use super::{control_variates, embree, gradients, instructions, mitsuba, program, python, samplers};
use clap::builder::{PossibleValue, PossibleValuesParser};

/// What measures and writes a chapter.
pub(crate) type Write = fn(&Report) -> Result<Chapter>;

/// Named as `--only` and files name them. Where that is all of a chapter, its programs are run.
const CHAPTERS: [(&str, Write); 12] = [
    ("tables", program::write),
    ("gradients", gradients::write),
    ("instructions", instructions::write),
    ("control_variates", control_variates::write),
    ("analytic", program::write),
    ("embree", embree::write),
    ("mitsuba", mitsuba::write),
    ("samplers", samplers::write),
    ("python", python::write),
    ("integration", python::write),
    ("training", python::write),
    ("points", program::write),
];

/// What needs nothing but a compiler.
pub(super) const ALONE: [&str; 6] = ["tables", "gradients", "control_variates", "analytic", "samplers", "points"];

/// Those that were asked for: all, if none was.
pub(crate) fn chapters(only: &[String]) -> Vec<(&'static str, Write)> {
    let is_wanted = |(name, _): &(&str, Write)| only.is_empty() || only.iter().any(|wanted| wanted == name);
    CHAPTERS.into_iter().filter(is_wanted).collect()
}

/// The chapters that can be asked for.
pub(crate) fn names() -> PossibleValuesParser {
    let plan = Plan::new(Extent::Default);
    let read = |name| plan.as_ref().ok()?.read::<Description>(name).ok();
    let value = |(name, _)| PossibleValue::new(name).help(read(name).map_or_else(String::new, |of| of.about));
    PossibleValuesParser::new(CHAPTERS.map(value))
}
