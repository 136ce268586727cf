//! What was to be reached, and what was measured.

use crate::report::chapter::{Cell, Chapter, row};
use crate::report::figure::{Figure, Unit};
use crate::report::statistics::Estimate;

/// A bound, a figure, and whether it keeps the bound.
struct Target {
    statement: String,
    scene: String,
    measured: Figure,
    bound: Figure,
    verdict: &'static str,
}

/// Collected as the sections measure.
#[derive(Default)]
pub(crate) struct Targets(Vec<Target>);

impl Targets {
    /// The figure shall be `bound` at most.
    pub(crate) fn at_most(&mut self, statement: &str, scene: &str, estimate: Estimate, unit: Unit, bound: f64) {
        let verdict = match () {
            () if estimate.high <= bound => "reached",
            () if estimate.value <= bound => "reached, the interval goes beyond",
            () if estimate.low <= bound => "not reached, the interval holds the bound",
            () => "NOT REACHED",
        };
        self.0.push(Target {
            statement: statement.to_owned(),
            scene: scene.to_owned(),
            measured: Figure::new(estimate, unit),
            bound: Figure::exact(bound, unit),
            verdict,
        });
    }

    pub(crate) fn write(&self, chapter: &mut Chapter) {
        chapter.section("What was to be reached", "");
        let kept = self.0.iter().filter(|target| target.verdict.starts_with("reached")).count();
        let kept = chapter.quote("targets reached", Figure::exact(kept as f64, Unit::Count));
        let all = chapter.quote("targets", Figure::exact(self.0.len() as f64, Unit::Count));
        chapter.paragraph(&format!("Reached: {kept} of {all}. The sections below say how each was measured."));
        let rows = self.0.iter().map(|target| -> Vec<Cell> {
            row![
                target.statement.clone(),
                target.scene.clone(),
                target.measured.clone(),
                target.bound.clone(),
                target.verdict
            ]
        });
        chapter.table("targets", &["target", "scene", "measured", "at most", "verdict"], 2, rows.collect());
    }
}
