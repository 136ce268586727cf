//! The chapter of samplers, and of samplers with estimators.

mod decisions;
mod draws;
mod errors;

use super::Report;
use super::chapter::Chapter;
use super::program;
use super::targets::Targets;
use crate::measure::table::Table;
use anyhow::Result;

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let programs: [_; 2] = report.build()?;
    let folder = tempfile::tempdir()?;
    for program in &programs {
        program::measure(report, program, folder.path())?;
    }
    let read = |name: &str| Table::read(&folder.path().join(name), ',');
    let (energies, times, decisions) = (read("energies.csv")?, read("draws.csv")?, read("decisions.csv")?);

    let mut targets = Targets::default();
    let mut chapter = Chapter::new("Samplers, alone and with estimators");
    errors::write(&energies, &mut chapter, &mut targets)?;
    draws::write(&times, &mut chapter, &mut targets)?;
    decisions::write(&decisions, &mut chapter)?;
    targets.write(&mut chapter);
    Ok(chapter)
}
