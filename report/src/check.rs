//! The steps of `cargo xtask test` that run what is here.

use crate::chapters;
use anyhow::Result;
use clap::{Args, ValueEnum};
use std::process::ExitCode;
use xtask::embree;
use xtask::outcome::{NOT_RUN, Outcome};

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

/// Ends with 0, with [`NOT_RUN`] and a reason on standard error, or with an error.
pub(crate) fn run(options: &Options) -> ExitCode {
    match step(options.step) {
        Ok(Outcome::Passed) => ExitCode::SUCCESS,
        Ok(Outcome::NotRun(why)) => {
            eprintln!("{why}");
            ExitCode::from(NOT_RUN)
        }
        Err(error) => {
            eprintln!("   {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn step(step: Step) -> Result<Outcome> {
    match step {
        Step::Chapters => chapters::check_quick(&CHAPTERS).map(|()| Outcome::Passed),
        Step::Embree => embree::report(|| chapters::check_quick(&["embree"])),
        Step::Mitsuba => if_there("mitsuba"),
        Step::Python => if_there("python"),
    }
}

/// A quick chapter of what is not everywhere: it says what is missing.
fn if_there(chapter: &str) -> Result<Outcome> {
    match chapters::check_quick(&[chapter]) {
        Ok(()) => Ok(Outcome::Passed),
        Err(error) => {
            let why = format!("{error:#}");
            let is_missing = ["missing: ", "to be had", "be installed"].iter().any(|words| why.contains(words));
            if is_missing { Ok(Outcome::NotRun(why.replace('\n', " "))) } else { Err(error) }
        }
    }
}
