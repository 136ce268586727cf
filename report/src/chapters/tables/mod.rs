//! The sections of the Embree chapter: one file for each comparison, in the layout of the thesis's figure.

mod animation;
mod bases;
mod comparison;
mod direct;
mod frames;
mod indirect;
mod lights;
mod mis;
mod never_worse;
mod overhead;
pub(super) mod public;
mod samplers;
mod solvers;
mod unbiased;

use super::chapter::Chapter;
use super::measurement::Measurement;
pub(crate) use super::targets;
use anyhow::Result;
use targets::Targets;

/// What a section adds to.
pub(crate) struct Section<'a> {
    pub(crate) measurement: &'a Measurement<'a>,
    pub(crate) chapter: &'a mut Chapter,
    pub(crate) targets: &'a mut Targets,
}

/// Roughly the seconds that a section takes, and what writes it.
type Entry = (u64, fn(&mut Section) -> Result<()>);

/// In the order of the thesis.
pub(crate) const SECTIONS: &[Entry] = &[
    (22, direct::write),
    (5, indirect::write),
    (14, mis::write),
    (9, bases::write),
    (16, lights::write),
    (8, solvers::write),
    (74, samplers::write),
    (70, frames::write),
    (55, animation::write),
    (20, overhead::write),
    (34, never_worse::write),
    (23, unbiased::write),
];
