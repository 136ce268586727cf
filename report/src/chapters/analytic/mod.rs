//! The chapter of what can be told only where integrals and gradients are known exactly.

mod continued;
mod gradients;
mod shared;

use super::chapter::Chapter;
use super::targets::Targets;
use super::{Report, program};
use crate::measure::table::Table;
use anyhow::Result;

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let [program] = report.build()?;
    let folder = tempfile::tempdir()?;
    program::measure(report, &program, folder.path())?;
    let read = |name: &str| Table::read(&folder.path().join(name), ';');
    let mut targets = Targets::default();
    let mut chapter = Chapter::new("Known integrands and gradients");
    shared::tiles(&mut chapter, &mut targets, &read("tiles.csv")?)?;
    shared::hard(&mut chapter, &mut targets, &read("hard.csv")?)?;
    shared::bias(&mut chapter, &read("bias.csv")?)?;
    continued::write(&mut chapter, &read("continued.csv")?)?;
    gradients::polynomial(&mut chapter, &read("polynomial.csv")?)?;
    gradients::classifier(&mut chapter, &read("classifier.csv")?)?;
    gradients::bias(&mut chapter, &read("gradient_bias.csv")?)?;
    targets.write(&mut chapter);
    Ok(chapter)
}
