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
    }
}
