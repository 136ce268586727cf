//! The chapter of instruction counts.

use super::prelude::*;
use xtask::{instructions, library, tools};

pub(super) fn write(report: &Report) -> Result<Chapter> {
    tools::packages(&instructions::PACKAGES)?;
    let program = instructions::compile(&library::build()?)?;
    report.compiled();
    let counted = instructions::count(&program)?;

    let mut chapter = Chapter::new(report.names[1]);
    chapter.setting("compiler", counted.compiler.as_str());
    chapter.setting("vector units", counted.vector_units.as_str());
    let counts = counted.counts.iter();
    let rows = counts.map(|of| json!([of.name, of.unit, Figure::exact(of.instructions, Unit::Instructions)]));
    chapter.table("counts", "function | per | instructions", 2, rows.collect::<Vec<_>>());
    Ok(chapter)
}
