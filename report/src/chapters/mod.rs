//! `cargo xtask report`: errors, times and overheads, as tables, plots and pictures, and as JSON. One chapter for each
//! program that measures; an index of all of them.

mod analytic;
pub(crate) mod chapter;
mod clock;
mod control_variates;
mod embree;
pub(crate) mod figure;
mod gradients;
mod index;
mod instructions;
pub(crate) mod json;
mod machine;
mod measurement;
mod minibatch_tables;
mod mitsuba;
mod outcome;
pub(crate) mod pixels;
mod plan;
mod points;
mod prelude;
mod program;
mod python;
mod run;
mod samplers;
mod scenes;
mod sign_flips;
pub(crate) mod statistics;
mod tables;
pub(crate) mod targets;
pub(crate) mod template;

use crate::measure::output::Output;
use anyhow::Result;
use chapter::Chapter;
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use clock::Clock;
use plan::Plan;
use std::path::{Path, PathBuf};

pub(crate) use run::{check_quick, run, write_chapter};

/// A chapter of the report: NAME.md, NAME.json and pictures.
struct Entry {
    /// As `--only` and files name it.
    name: &'static str,
    /// Roughly what a default run takes on a quiet machine of two cores, without compiling.
    seconds: u64,
    /// A line for the index and for `--help`.
    description: &'static str,
    /// Bench targets of noisefloor-bench that it runs.
    programs: &'static [&'static str],
    /// Where a `--full` run measures other things: a chapter of its own, which other runs leave as it is.
    full: Option<Full>,
    write: fn(&Report) -> Result<Chapter>,
}

/// What `--full` writes instead of a chapter.
#[derive(Clone, Copy)]
struct Full {
    /// As files name it.
    name: &'static str,
    description: &'static str,
}

const fn entry(
    name: &'static str,
    seconds: u64,
    description: &'static str,
    write: fn(&Report) -> Result<Chapter>,
) -> Entry {
    Entry { name, seconds, description, programs: &[], full: None, write }
}

impl Entry {
    const fn runs(self, programs: &'static [&'static str]) -> Self {
        Self { programs, ..self }
    }

    const fn full_apart(self, name: &'static str, description: &'static str) -> Self {
        Self { full: Some(Full { name, description }), ..self }
    }

    /// What a run writes: the name of the files, and the index's line.
    fn chapter(&self, plan: &Plan) -> (&'static str, &'static str) {
        match self.full {
            Some(Full { name, description }) if plan.is_full() => (name, description),
            _ => (self.name, self.description),
        }
    }

    /// Of all chapters that it can write.
    fn file_names(&self) -> impl Iterator<Item = &'static str> {
        std::iter::once(self.name).chain(self.full.map(|full| full.name))
    }
}

/// In the order of the index.
const CHAPTERS: &[Entry] = &[
    entry("tables", 16, "Time, memory and drift of importance tables, beside public peers", minibatch_tables::write)
        .runs(&["minibatch_table"]),
    entry(
        "gradients",
        95,
        "Variance of minibatches' gradients, and test error at equal steps and equal time",
        gradients::write,
    )
    .full_apart("gradients_full", "The same with more seeds and epochs, and a photograph"),
    entry("instructions", 3, "What callgrind counts: the same on a busy machine", instructions::write),
    entry(
        "control_variates",
        80,
        "Every estimator, basis and order: error against time, f32 against f64",
        control_variates::write,
    )
    .runs(&["speed_error", "estimators"]),
    entry(
        "analytic",
        30,
        "Shared fits, tiles beyond their samples and optimal MIS where exact results are known",
        analytic::write,
    )
    .runs(&["analytic"]),
    entry(
        "embree",
        315,
        "Estimators and samplers in a path tracer on Embree, scenes after the thesis's",
        embree::write,
    ),
    entry("mitsuba", 900, "Samplers in Mitsuba 3, before and after a denoiser, and its gradients", mitsuba::write),
    entry(
        "samplers",
        95,
        "Samplers beside each other, with and without estimators; what is recommended",
        samplers::write,
    )
    .runs(&["samplers", "guidance"]),
    entry("python", 420, "The Python package: overhead, PyTorch's sampling, integration, training", python::write),
    entry("points", 65, "Seconds against quality of point sets, 256 to a million points", points::write)
        .runs(&["point_sets"]),
];

#[derive(Args, Default)]
pub(crate) struct Options {
    /// Tiny images and few seeds, for tests: whether everything works, not the figures
    #[arg(long)]
    quick: bool,
    /// Larger images, finer grids and more seeds: narrower intervals, and much longer
    #[arg(long, conflicts_with = "quick")]
    full: bool,
    /// These chapters instead of all, separated by commas; the others stay as they are, in the index too
    #[arg(long, value_name = "CHAPTER", value_delimiter = ',', value_parser = names())]
    only: Vec<String>,
    /// Where everything goes [default: docs/report]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Only write the texts anew, from the JSON files that are there
    #[arg(long, conflicts_with_all = ["quick", "full", "only"])]
    render: bool,
}

impl Options {
    /// The trainers alone, for the demo.
    pub(crate) fn gradients(quick: bool, folder: &Path) -> Self {
        Self { quick, only: vec!["gradients".to_owned()], out: Some(folder.to_owned()), ..Self::default() }
    }
}

/// The chapters that can be asked for.
fn names() -> PossibleValuesParser {
    PossibleValuesParser::new(CHAPTERS.iter().map(|entry| PossibleValue::new(entry.name).help(entry.description)))
}

/// What a chapter needs.
pub(crate) struct Report<'a> {
    /// The chapter that is written, as files name it.
    name: &'static str,
    /// Bench targets that it runs.
    programs: &'static [&'static str],
    pub(crate) plan: Plan,
    /// Markdown, JSON, plots.
    pub(crate) output: &'a Output,
    clock: Clock,
}

impl Report<'_> {
    /// To be called once everything is compiled: a chapter's time is counted from here.
    pub(crate) fn compiled(&self) {
        self.clock.restart();
    }
}
