//! The sections of the Embree chapter, in the layouts of the thesis's figures.

mod animation;
mod estimators;
mod frames;
mod never_worse;
mod overhead;
pub(super) mod public;
mod samplers;
mod unbiased;

use super::measurement::Measurement;
pub(crate) use super::targets;
use crate::chapters::prelude::*;
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
    (22, estimators::direct),
    (5, estimators::indirect),
    (14, estimators::mis),
    (9, estimators::bases),
    (16, estimators::lights),
    (8, estimators::solvers),
    (74, samplers::write),
    (70, frames::write),
    (55, animation::write),
    (20, overhead::write),
    (34, never_worse::write),
    (23, unbiased::write),
];
