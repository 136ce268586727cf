//! `cargo xtask report`: errors, times and overheads, as tables, plots and pictures, and as JSON. One chapter for each
//! program that measures; an index of all of them.

pub(crate) mod chapter;
mod clock;
mod control_variates;
pub(crate) mod described;
mod embree;
pub(crate) mod figure;
mod gradients;
mod index;
mod instructions;
pub(crate) mod json;
mod list;
mod machine;
pub(crate) mod measurement;
mod mitsuba;
pub(crate) mod plan;
mod prelude;
mod program;
mod python;
mod report;
mod run;
mod samplers;
pub(crate) mod statistics;
pub(crate) mod targets;
pub(crate) mod template;

pub(crate) use run::{Options, check, run, write_chapter};
