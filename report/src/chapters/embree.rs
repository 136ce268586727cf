//! The chapter of the Embree harness.

use super::Report;
use super::chapter::{Chapter, row};
use super::clock::Clock;
use super::figure::{Figure, Unit};
use super::measurement::Measurement;
use super::tables::{SECTIONS, Section};
use super::targets::Targets;
use crate::measure::interrupt;
use crate::measure::progress;
use crate::measure::renderer::{Renderer, threads};
use anyhow::Result;

/// Units of the progress bar in a second.
const SECOND: u64 = 1000;

pub(super) fn write(report: &Report) -> Result<()> {
    let program = match &report.program {
        Some(program) => program.clone(),
        None => xtask::embree::build()?,
    };
    super::tables::public::build()?;
    report.compiled();
    let renderer = Renderer::new(program, report.interrupted.clone());
    let bar = progress::bar(SECTIONS.iter().map(|(seconds, _)| seconds * SECOND).sum())?;
    let measurement = Measurement::new(report.plan, &renderer, &bar)?;
    let (mut body, mut targets) = (Chapter::default(), Targets::default());
    let (mut start, mut times) = (0, Vec::new());
    for (seconds, section) in SECTIONS {
        let end = start + seconds * SECOND;
        let (clock, before) = (Clock::start(), body.sections().len());
        measurement.begin_section(start, end);
        let (chapter, targets) = (&mut body, &mut targets);
        section(&mut Section {
            measurement: &measurement,
            chapter,
            targets,
            output: report.output,
            large: report.large,
        })?;
        interrupt::check(&report.interrupted)?;
        let name = body.sections().get(before).cloned().unwrap_or_default();
        let text = |seconds: Option<f64>| seconds.map_or("unknown".to_owned(), |seconds| format!("{seconds:.0}"));
        let [wall, processor] = [text(Some(clock.seconds())), text(clock.processor_seconds())];
        // Where there is no terminal, and so no bar, this alone tells how far it is.
        bar.suspend(|| println!("   {name}: {wall} s, {processor} CPU seconds"));
        let whole = |seconds: f64| Figure::exact(seconds, Unit::Count);
        times.push(row![name, whole(clock.seconds()), clock.processor_seconds().map(whole)]);
        start = end;
    }
    bar.finish_and_clear();
    let mut chapter = Chapter::new("Control variates and tiles in an Embree path tracer");
    introduce(report, &mut chapter);
    targets.write_summary(&mut chapter);
    chapter.append(body);
    targets.write_all(&mut chapter);
    chapter.section("Where the time went", "");
    chapter.paragraph(
        "A section's references, and experiments that later sections show too, are counted where they are made.",
    );
    chapter.table("time", &["from section", "seconds", "CPU seconds"], 1, times);
    report.write(&chapter)
}

fn introduce(report: &Report, chapter: &mut Chapter) {
    let plan = report.plan;
    let threads = chapter.setting("threads", threads());
    let seeds = chapter.setting("seeds", plan.seeds);
    let size = chapter.setting("pixels on a side, estimators", plan.size);
    let tile_size = chapter.setting("pixels on a side, samplers", plan.tile_size);
    let confidence = chapter.setting("confidence, percent", 95);
    chapter.paragraph(&format!(
        "Made by `cargo xtask report`; machine-readable in `embree.json`. Scenes after those of C. Salaün's thesis (\"Toward \
         Improving Monte Carlo Estimator for Rendering and Machine Learning\"), chapters 4 and 5, of other meshes: figures \
         can be held side by side in what they compare and how, not in their absolute values. Images of {size} x {size} \
         pixels where estimators are compared and {tile_size} x {tile_size} where samplers are; {threads} threads."
    ));
    chapter.list(&[
        format!(
            "A figure is the median over {seeds} seeds, and in brackets its {confidence} % confidence interval (bootstrap). Ratios are \
             taken seed by seed: both of a pair saw the same samples, or, for samplers, the same seed."
        ),
        "relMSE: mean over the pixels of (I - R)^2 / (R^2 + eps), luminance (Y of linear sRGB), eps a hundredth of the squared mean of R. \
         The reference consists of two independent halves A and B, R = (A + B) / 2, from shifted lattices; (I - A)(I - B) stands \
         for (I - R)^2, so that the reference's own noise adds nothing on average. Sections on samplers, shared fits, reconstruction and animation, and \
         their targets, limit relative errors to five: one highlight in a dark pixel would otherwise decide."
            .to_owned(),
        "MC: the plain mean of random samples. Default: `NF_CV_ROBUST`, for each colour channel. Least squares: the thesis's \
         estimator, for each channel. O1, O2, O3: total degree of the polynomials."
            .to_owned(),
        "Same time: relMSE over that of the plain mean of as many samples as it makes in the estimator's total time; its error \
         falls as one over the number of samples. Error and time are taken seed by seed, so that the interval has the noise of both."
            .to_owned(),
    ]);
}
