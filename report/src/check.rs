//! The steps of `cargo xtask test` that run what is here.

use crate::chapters;
use anyhow::Result;
use clap::{Args, ValueEnum};

#[derive(Args)]
pub(crate) struct Options {
    step: Step,
}

#[derive(Clone, Copy, ValueEnum)]
enum Step {
    /// Quick chapters of what needs nothing but a compiler.
    Chapters,
    /// A quick chapter of the path tracer on Embree.
    Embree,
    /// A quick chapter of Mitsuba 3.
    Mitsuba,
    /// A quick chapter of the Python package.
    Python,
}

const CHAPTERS: [&str; 6] = ["tables", "gradients", "control_variates", "analytic", "samplers", "points"];

pub(crate) fn run(options: &Options) -> Result<()> {
    chapters::check_quick(match options.step {
        Step::Chapters => &CHAPTERS,
        Step::Embree => &["embree"],
        Step::Mitsuba => &["mitsuba"],
        Step::Python => &["python"],
    })
}
