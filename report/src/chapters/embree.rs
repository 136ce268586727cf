//! The chapter of the Embree harness.

use super::Report;
use super::clock::Clock;
use super::measurement::Measurement;
use super::tables::{SECTIONS, Section};
use crate::chapters::prelude::*;
use crate::measure::progress;
use crate::measure::renderer::{Renderer, threads};

/// Units of the progress bar in a second.
const SECOND: u64 = 1000;

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let program = xtask::embree::build()?;
    super::tables::public::build()?;
    report.compiled();
    let renderer = Renderer::new(program);
    let bar = progress::bar(SECTIONS.iter().map(|(seconds, _)| seconds * SECOND).sum())?;
    let measurement = Measurement::new(report.plan, &renderer, &bar)?;
    let mut chapter = Chapter::new("Control variates and tiles in an Embree path tracer");
    chapter.setting("threads", threads());
    chapter.setting("seeds", report.plan.seeds);
    chapter.setting("pixels on a side, estimators", report.plan.size);
    chapter.setting("pixels on a side, samplers", report.plan.tile_size);
    let (mut targets, mut start) = (Targets::default(), 0);
    for (seconds, section) in SECTIONS {
        let (clock, end) = (Clock::start(), start + seconds * SECOND);
        measurement.begin_section(start, end);
        section(&mut Section { measurement: &measurement, chapter: &mut chapter, targets: &mut targets })?;
        // Where there is no terminal, and so no bar, this alone tells how far it is.
        bar.suspend(|| println!("   {}: {:.0} s", chapter.current_section(), clock.seconds()));
        start = end;
    }
    bar.finish_and_clear();
    targets.write(&mut chapter);
    Ok(chapter)
}
