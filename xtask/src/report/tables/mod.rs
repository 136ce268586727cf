//! The sections of the Embree chapter: one file for each comparison, in the layout of the thesis's figure.

mod direct;
pub(crate) mod targets;

use super::chapter::Chapter;
use super::measurement::Measurement;
use crate::measure::output::Output;
use anyhow::Result;
use targets::Targets;

/// What a section adds to.
pub(crate) struct Section<'a> {
    pub(crate) measurement: &'a Measurement<'a>,
    pub(crate) chapter: &'a mut Chapter,
    pub(crate) targets: &'a mut Targets,
    pub(crate) output: &'a Output,
    pub(crate) large: &'a Output,
}

/// Roughly the seconds that a section takes, and what writes it.
type Entry = (u64, fn(&mut Section) -> Result<()>);

/// In the order of the thesis.
pub(crate) const SECTIONS: &[Entry] = &[(40, direct::write)];
