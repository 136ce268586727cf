//! The sections of the Embree chapter: one file for each comparison, in the layout of the thesis's figure.

mod animation;
mod bases;
mod comparison;
mod direct;
mod environment;
mod indirect;
mod lights;
mod luminance;
mod mis;
mod never_worse;
mod overhead;
pub(super) mod public;
mod reconstruction;
mod samplers;
mod solvers;
mod unbiased;

use super::chapter::Chapter;
use super::measurement::Measurement;
pub(crate) use super::targets;
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
pub(crate) const SECTIONS: &[Entry] = &[
    (22, direct::write),
    (16, indirect::write),
    (7, mis::write),
    (8, environment::write),
    (8, bases::write),
    (16, lights::write),
    (9, solvers::write),
    (4, luminance::write),
    (90, samplers::write),
    (12, reconstruction::write),
    (20, animation::write),
    (15, overhead::write),
    (33, never_worse::write),
    (28, unbiased::write),
];
