//! The chapter of the estimators on functions whose integrals are known: error against time, and how it falls with
//! samples.

mod cells;
mod frontier;
mod grid;
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

pub(super) fn write(report: &Report) -> Result<Chapter> {
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
    let mut reached = Targets::default();
    targets::collect(&mut reached, &read("must_reach.csv")?)?;
    reached.write(&mut chapter);
    frontier::write(&mut chapter, &cells);
    grid::write(&mut chapter, &cells);
    precision::write(&mut chapter, &read("cells.csv")?)?;
    Ok(chapter)
}
