//! The chapter of samplers, and of samplers with estimators.

mod decisions;
mod draws;
mod errors;
mod grid;
mod sheet;

use super::Report;
use super::chapter::Chapter;
use super::program;
use super::targets::Targets;
use crate::measure::table::Table;
use anyhow::Result;

pub(super) fn write(report: &Report) -> Result<()> {
    let programs: [_; 2] = report.build()?;
    let folder = tempfile::tempdir()?;
    for program in &programs {
        program::measure(report, program, folder.path())?;
    }
    let read = |name: &str| Table::read(&folder.path().join(name), ',');
    let (energies, times) = (read("energies.csv")?, read("draws.csv")?);
    let (cells, decisions) = (read("cells.csv")?, read("decisions.csv")?);

    let mut targets = Targets::default();
    let mut chapter = Chapter::new("Samplers, alone and with estimators");
    introduce(&mut chapter);
    errors::write(report.output, &energies, &mut chapter, &mut targets)?;
    draws::write(&times, &mut chapter, &mut targets)?;
    sheet::write(report.output, folder.path(), &mut chapter)?;
    decisions::write(&decisions, &mut chapter)?;
    grid::write(report.output, &cells, &mut chapter)?;
    targets.write_summary(&mut chapter);
    report.write(&chapter)
}

fn introduce(chapter: &mut Chapter) {
    chapter.paragraph(
        "Made by `cargo xtask report --only samplers`; machine-readable in `samplers.json`; a run also writes `samplers-grid.csv`. First the samplers \
         alone, the same integrand in every pixel: what a tile is made for. Then samplers with estimators, on integrands that change from \
         pixel to pixel, and what `recommend()` makes of it.",
    );
}
