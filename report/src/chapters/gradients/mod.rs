//! The chapter on gradients of minibatches: variance, and what it is worth at equal steps and at equal time.

mod classify;
mod curves;
mod mlp;
mod photograph;
mod polynomial;
mod summary;
mod trainer;

use super::Report;
use super::chapter::Chapter;
use super::targets::Targets;
use crate::measure::progress;
use anyhow::Result;
use indicatif::ProgressBar;
use std::ffi::OsStr;
use std::path::PathBuf;
use trainer::{Program, Written};
use xtask::library;

/// What the parts need.
struct Context<'a> {
    report: &'a Report<'a>,
    archive: PathBuf,
    bar: ProgressBar,
}

impl Context<'_> {
    /// Writes a plot under the chapter's name.
    fn plot(&self, name: &str, plot: &str) -> Result<()> {
        self.report.output.write_text(&format!("{}-{name}.svg", self.report.name), plot)
    }

    fn sizes(&self) -> &'static str {
        self.report.plan.name()
    }

    /// Runs a trainer.
    fn run(&self, program: &Program, name: &str, arguments: &[impl AsRef<OsStr>]) -> Result<Written> {
        self.bar.set_message(format!("gradients: {name}"));
        let written = program.run(arguments)?;
        self.bar.inc(1);
        Ok(written)
    }
}

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let context = Context { report, archive: library::build()?, bar: progress::bar(7)? };
    let classify = classify::Trainer::new(&context)?;
    let polynomial = Program::compile("fit_polynomial.c", &context.archive)?;
    report.compiled();

    let is_full = report.plan.is_full();
    let title = if is_full { "Gradients of minibatches, long runs" } else { "Gradients of minibatches" };
    let (mut chapter, mut targets) = (Chapter::new(title), Targets::default());
    classify.write(&context, &mut chapter, &mut targets)?;
    polynomial::write(&context, &polynomial, &mut chapter, &mut targets)?;
    if is_full {
        photograph::write(&context, &mut chapter, &mut targets)?;
    }
    context.bar.finish_and_clear();
    targets.write(&mut chapter);
    Ok(chapter)
}
