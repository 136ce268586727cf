//! The chapter on tables of importances: time of draws and updates against size, memory, drift.

mod drift;
mod times;

use super::Report;
use super::chapter::Chapter;
use super::program;
use super::targets::Targets;
use crate::measure::table::Table;
use anyhow::Result;
use times::Times;

/// Draws, and updates, of a step: what the program measures.
const BATCH: u32 = 64;

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let folder = tempfile::tempdir()?;
    let [program] = report.build()?;
    program::measure(report, &program, folder.path())?;
    let read = |name: &str| Table::read(&folder.path().join(name), ',');
    let times = Times::new(&read("times.csv")?)?;
    let (mut chapter, mut targets) = (Chapter::new("Tables of importances"), Targets::default());
    chapter.setting("draws and updates of a step", BATCH);
    times.write(&mut chapter, &mut targets);
    drift::memory(&read("items.csv")?, &mut chapter, &mut targets)?;
    drift::write(&read("drift.csv")?, &mut chapter, &mut targets)?;
    targets.write(&mut chapter);
    Ok(chapter)
}
