//! The chapter of the estimators on functions whose integrals are known: error against time, and how it falls with
//! samples.

mod cells;
mod convergence;
mod fits;
mod frontier;
mod grid;
mod lights;
mod precision;
mod targets;

use super::Report;
use super::chapter::Chapter;
use super::program;
use super::targets::Targets;
use crate::measure::progress;
use crate::measure::table::Table;
use anyhow::Result;
use cells::Cells;

/// Roughly the seconds of each program.
const SECONDS: [u64; 2] = [25, 50];

pub(super) fn write(report: &Report) -> Result<()> {
    let programs: [_; 2] = report.build()?;
    let folder = tempfile::tempdir()?;
    let bar = progress::bar(SECONDS.iter().sum())?;
    for (program, seconds) in programs.iter().zip(SECONDS) {
        program::measure(report, program, folder.path())?;
        bar.inc(seconds);
    }
    bar.finish_and_clear();
    let read = |name: &str| Table::read(&folder.path().join(name), if name == "must_reach.csv" { ';' } else { ',' });
    let cells = Cells::new(&read("grid.csv")?, &read("recommended.csv")?)?;
    let mut chapter = Chapter::new("Control variates: error against time");
    introduce(&mut chapter);
    let mut reached = Targets::default();
    targets::collect(&mut reached, &read("must_reach.csv")?)?;
    reached.write_summary(&mut chapter);
    frontier::write(report, &mut chapter, &cells)?;
    grid::write(report, &mut chapter, &cells)?;
    fits::write(report, &mut chapter, &read("fits.csv")?)?;
    let points = convergence::Points::new(&read("convergence.csv")?)?;
    convergence::write(report, &mut chapter, &points)?;
    lights::write(report, &mut chapter, &points)?;
    precision::write(&mut chapter, &read("cells.csv")?)?;
    reached.write_all(&mut chapter);
    report.output.write_text("control_variates.csv", &cells.csv())?;
    report.output.write_text("control_variates_convergence.csv", &points.csv())?;
    report.write(&chapter)
}

fn introduce(chapter: &mut Chapter) {
    let confidence = chapter.setting("confidence, percent", 95);
    chapter.paragraph(
        "Made by `cargo xtask report`; machine-readable in `control_variates.json`, a run also writes every \
         single cell to `control_variates.csv` and every point of the convergence plots to `control_variates_convergence.csv`. Independent samples of integrands whose integrals are known, one pixel at a time; renderers are in the chapter \
         on [Embree](embree.md), shared fits and tiles too. Through the C functions of the library that ships, one thread.",
    );
    chapter.list(&[
        format!(
            "Error: the root mean square error over the plain mean's (MC) of the same samples, in brackets its {confidence} % interval. Over several integrands the \
             geometric mean, beside it always the worst of them. A ratio below one hundredth counts as that in means: some integrands are polynomials."
        ),
        "Time: nanoseconds per sample of the estimate alone, the integrand not counted; settings take turns on the same samples, so that a busy machine slows all \
         alike."
            .to_owned(),
        "Efficiency: one over the product of mean squared error and time, over MC's. It depends on what a sample costs: as if samples were free, and with samples of a \
         microsecond, about what a ray and its shading cost."
            .to_owned(),
        "Integrands: the nine of the targets, ten held out while rules were chosen, six adversarial ones, and the thesis's sum of sines in 15 dims; they are in \
         `tests/src/integrands.rs`."
            .to_owned(),
    ]);
    chapter.setting("dims of the sum of sines", 15);
}
