//! The chapter on gradients of minibatches: variance, and what it is worth at equal steps and at equal time.

mod classify;
mod photograph;
mod polynomial;
mod summary;

use super::Report;
use super::chapter::Chapter;
use super::measured::Measured;
use super::targets::Targets;
use crate::demo::training::program::Program;
use crate::measure::progress;
use anyhow::Result;
use indicatif::ProgressBar;
use std::ffi::OsStr;
use std::path::PathBuf;
use xtask::library;

/// What the parts need.
struct Context<'a> {
    report: &'a Report<'a>,
    measured: Measured,
    archive: PathBuf,
    bar: ProgressBar,
}

/// What a trainer wrote.
struct Written {
    csv: String,
    /// Markdown.
    summary: String,
}

impl Context<'_> {
    /// Writes a plot under the chapter's name, and shows it.
    fn plot(&self, chapter: &mut Chapter, name: &str, plot: &str, description: &str) -> Result<()> {
        let file = format!("{}-{name}.svg", self.report.name);
        self.report.output.write_text(&file, plot)?;
        chapter.picture(&file, description);
        Ok(())
    }

    fn sizes(&self) -> &'static str {
        self.report.plan.name()
    }

    /// Runs a trainer, or takes what an earlier run has left under `name`.
    fn run(&self, program: &Program, name: &str, arguments: &[impl AsRef<OsStr>]) -> Result<Written> {
        self.bar.set_message(format!("gradients: {name}"));
        let mut csv = None;
        let summary = self.measured.text(&format!("{name}.md"), || {
            let written = program.run(arguments, &self.report.interrupted, |_| ())?;
            csv = Some(written.csv);
            Ok(written.summary)
        })?;
        // Kept at the same time as the summary.
        let csv = match csv {
            Some(csv) => self.measured.text_anew(&format!("{name}.csv"), csv)?,
            None => self.measured.kept(&format!("{name}.csv"))?,
        };
        self.bar.inc(1);
        Ok(Written { csv, summary })
    }
}

pub(super) fn write(report: &Report) -> Result<()> {
    let archive = library::build()?;
    let measured = Measured::new(report.name, report.plan.name(), report.reuse)?;
    let context = Context { report, measured, archive, bar: progress::bar(7)? };
    let classify = classify::Trainer::new(&context)?;
    let polynomial = Program::compile("fit_polynomial.c", &context.archive)?;
    report.compiled();

    let is_full = report.plan.is_full();
    let mut chapter =
        Chapter::new(if is_full { "Gradients of minibatches, long runs" } else { "Gradients of minibatches" });
    let (mut body, mut targets) = (Chapter::default(), Targets::default());
    classify.write(&context, &mut body, &mut targets)?;
    polynomial::write(&context, &polynomial, &mut body, &mut targets)?;
    if is_full {
        photograph::write(&context, &mut body, &mut targets)?;
    }
    context.bar.finish_and_clear();
    introduce(report.name, &mut chapter);
    if let Some(note) = context.measured.note() {
        report.reused.set(true);
        chapter.paragraph(&note);
    }
    targets.write_summary(&mut chapter);
    chapter.append(body);
    report.write(&chapter)
}

fn introduce(name: &str, chapter: &mut Chapter) {
    let percent = chapter.setting("confidence of intervals, percent", 95);
    chapter.paragraph(&format!(
        "Made by `cargo xtask report`; machine-readable in `{name}.json`; the programs are the trainers of `examples_c`. `--only gradients` \
         writes `gradients`; with `--full` it trains longer, with more seeds, adds the photograph, and writes `gradients_full`. \"+-\": half of a {percent} % confidence interval, Student's t over the seeds; differences \
         are taken seed by seed: the modes of a seed begin with the same network and see the same first epoch. Time is processor time of training \
         alone; modes take turns, an epoch at a time."
    ));
    chapter.list(&[
        "uniform: each item once per epoch, in random order. importance: one table. adaptive: the same draws without weights, biased. balance, omis: \
         several tables, balance heuristic or optimal MIS.",
        "Equal time: the error at the processor time that uniform takes for so many epochs, between two epochs linearly.",
    ]);
}
