//! The chapter on gradients of minibatches: variance, and what it is worth at equal steps and at equal time.

mod mlp;
mod trainer;

use super::prelude::*;
use super::report::Report;
use crate::measure::progress;
use indicatif::ProgressBar;
use std::path::PathBuf;
use trainer::{Program, Summary};
use xtask::library;

/// What the parts need, and what they add to.
struct Parts<'a> {
    report: &'a Report<'a>,
    archive: PathBuf,
    bar: ProgressBar,
    chapter: Chapter,
    targets: Targets,
}

impl Parts<'_> {
    /// Writes a plot under the chapter's name.
    fn plot(&self, name: &str, plot: &str) -> Result<()> {
        self.report.output.write_text(&format!("{}-{name}.svg", self.report.names[0]), plot)
    }

    fn sizes(&self) -> &'static str {
        self.report.plan.name()
    }

    /// Runs a trainer: its table as CSV, and what else it says.
    fn run(&self, program: &Program, name: &str, arguments: &[&str]) -> Result<(String, String)> {
        self.bar.set_message(format!("gradients: {name}"));
        let said = program.run(arguments)?;
        self.bar.inc(1);
        Ok(said)
    }

    /// The summary of a trainer's run.
    fn summary(&self, program: &Program, name: &str, arguments: &[&str]) -> Result<Summary> {
        Summary::parse(&self.run(program, name, arguments)?.1)
    }
}

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let is_full = report.plan.is_full();
    let (archive, bar) = (library::build()?, progress::bar(7)?);
    let mut parts = Parts { report, archive, bar, chapter: Chapter::new(report.names[1]), targets: Targets::default() };
    let perceptrons = mlp::Trainer::new(&parts)?;
    let fit_polynomial = Program::compile("fit_polynomial.c", &parts.archive)?;
    report.compiled();
    perceptrons.write(&mut parts)?;
    polynomial(&fit_polynomial, &mut parts)?;
    if is_full {
        photograph(&Program::compile("fit_image.cpp", &parts.archive)?, &mut parts)?;
    }
    parts.bar.finish_and_clear();
    parts.targets.write(&mut parts.chapter);
    Ok(parts.chapter)
}

/// fit_polynomial.c: loss at the end, and errors of the gradient by coefficient (figure 6.10).
fn polynomial(program: &Program, parts: &mut Parts) -> Result<()> {
    let (seeds, steps, batches) = if parts.sizes() == "quick" { ("2", "1000", "100") } else { ("40", "3000", "2000") };
    let small = ["--seeds", seeds, "--steps", steps, "--batches", batches];
    let losses = parts.summary(program, "polynomial", &[&small[..], &["--beta", "0.7"]].concat())?;
    let variance = parts.summary(program, "polynomial variance", &[&small[..], &["--variance"]].concat())?;

    parts.chapter.section("A polynomial of order 6", "figure 6.10");
    for (name, value) in [("problems", seeds), ("steps", steps), ("batches", batches)] {
        parts.chapter.setting(format!("polynomial: {name}"), value);
    }
    losses.write(&mut parts.chapter, "polynomial", 1);
    variance.write(&mut parts.chapter, "polynomial variance", 2);
    if let Some((ratio, _)) = losses.number(&["omis4"], "over exact") {
        let statement = "Polynomial: loss at the end over the exact gradient's, omis4";
        let place = format!("{seeds} problems, step {steps}");
        parts.targets.at_most(statement, &place, Estimate::exact(ratio), Unit::Ratio, 2.0);
    }
    for power in 0..=6 {
        let column = format!("x^{power}");
        let statement = "Polynomial: error of a coefficient's derivative, omis4 over is";
        below_is(
            &mut parts.targets,
            statement,
            &variance,
            ["omis4", steps],
            &column,
            &format!("{column}, step {steps}"),
        );
    }
    Ok(())
}

/// fit_image.cpp: a photograph learned by a network (figure 6.13).
fn photograph(program: &Program, parts: &mut Parts) -> Result<()> {
    let all = ["--methods", "is,balance3,omis3,balance6,omis6", "--variance"];
    let losses = ["--methods", "uniform,is,omis3,omis6"];
    let strata = ["--methods", "is,omis3,omis6", "--stratified"];
    let errors_of_strata = [&all[..], &["--stratified"]].concat();
    let runs: [(&'static str, &[&str], usize); 4] = [
        ("photograph", &losses, 1),
        ("photograph strata", &strata, 1),
        ("photograph variance", &all, 2),
        ("photograph variance strata", &errors_of_strata, 2),
    ];
    parts.chapter.section("A photograph", "figure 6.13");
    for (name, arguments, words) in runs {
        let summary = parts.summary(program, name, arguments)?;
        summary.write(&mut parts.chapter, name, words);
        if name != "photograph variance" {
            continue;
        }
        // The mean of each parameter's ratio.
        let column = summary.columns.get(3).map_or("", String::as_str);
        for step in ["1000", "2000", "3000", "4000"] {
            let statement = "Photograph: error of the gradient, omis3 over is, tables as kept";
            below_is(&mut parts.targets, statement, &summary, ["omis3", step], column, &format!("step {step}"));
        }
    }
    Ok(())
}

/// At a step a method's error shall be below that of importance sampling.
fn below_is(
    targets: &mut Targets,
    statement: &str,
    summary: &Summary,
    [method, step]: [&str; 2],
    column: &str,
    place: &str,
) {
    let error = |method: &str| summary.number(&[step, method], column).map(|(error, _)| error);
    if let (Some(own), Some(is)) = (error(method), error("is")) {
        targets.below(statement, place, Estimate::exact(own / is), Unit::Ratio, 1.0);
    }
}
