//! What was to be reached, and what was measured.

use crate::report::chapter::{Cell, Chapter, row};
use crate::report::figure::{Figure, Unit};
use crate::report::statistics::Estimate;

/// A bound, a figure, and whether it keeps the bound.
struct Target {
    statement: String,
    scene: String,
    estimate: Estimate,
    unit: Unit,
    bound: f64,
    /// The whole interval shall keep the bound.
    strict: bool,
}

/// Collected as the sections measure.
#[derive(Default)]
pub(crate) struct Targets {
    all: Vec<Target>,
    /// The likely reason why a statement's bound is missed: the statement's beginning and end, and the reason.
    reasons: Vec<([&'static str; 2], &'static str)>,
}

impl Target {
    fn is_kept(&self) -> bool {
        let figure = if self.strict { self.estimate.high } else { self.estimate.value };
        figure <= self.bound
    }

    fn verdict(&self) -> &'static str {
        let Estimate { value, low, high, .. } = self.estimate;
        match () {
            () if high <= self.bound => "reached",
            () if self.strict && low <= self.bound => "not reached, the interval holds the bound",
            () if value <= self.bound => "reached, the interval goes beyond",
            () if low <= self.bound => "not reached, the interval holds the bound",
            () => "NOT REACHED",
        }
    }
}

impl Targets {
    /// The figure shall be `bound` at most.
    pub(crate) fn at_most(&mut self, statement: &str, scene: &str, estimate: Estimate, unit: Unit, bound: f64) {
        let (statement, scene) = (statement.to_owned(), scene.to_owned());
        self.all.push(Target { statement, scene, estimate, unit, bound, strict: false });
    }

    /// The figure's interval shall lie below `bound`.
    pub(crate) fn below(&mut self, statement: &str, scene: &str, estimate: Estimate, unit: Unit, bound: f64) {
        let (statement, scene) = (statement.to_owned(), scene.to_owned());
        self.all.push(Target { statement, scene, estimate, unit, bound, strict: true });
    }

    /// Said where a target that begins and ends like this is missed.
    pub(crate) fn reason(&mut self, statement: [&'static str; 2], reason: &'static str) {
        self.reasons.push((statement, reason));
    }

    /// Targets of the same statement, in the order in which they were measured.
    fn groups(&self) -> Vec<Vec<&Target>> {
        let mut groups: Vec<Vec<&Target>> = Vec::new();
        for target in &self.all {
            match groups.iter_mut().find(|group| group[0].statement == target.statement) {
                Some(group) => group.push(target),
                None => groups.push(vec![target]),
            }
        }
        groups
    }

    /// One row for each statement, and what was missed.
    pub(crate) fn write_summary(&self, chapter: &mut Chapter) {
        chapter.section("What was to be reached", "");
        let groups = self.groups();
        let kept = groups.iter().filter(|group| group.iter().all(|target| target.is_kept())).count();
        let kept = chapter.quote("statements kept in every scene", Figure::exact(kept as f64, Unit::Count));
        let all = chapter.quote("statements", Figure::exact(groups.len() as f64, Unit::Count));
        chapter.paragraph(&format!(
            "Kept in every scene: {kept} of {all}. The worst scene stands for each; the last section has all scenes, the others how each was measured."
        ));
        let rows = groups.iter().map(|group| -> Vec<Cell> {
            let worst = group.iter().max_by(|a, b| a.excess().total_cmp(&b.excess())).unwrap_or(&group[0]);
            let count = |count: usize| Figure::exact(count as f64, Unit::Count);
            row![
                worst.statement.clone(),
                Figure::exact(worst.bound, worst.unit),
                count(group.iter().filter(|target| target.is_kept()).count()),
                count(group.len()),
                worst.scene.clone(),
                Figure::new(worst.estimate, worst.unit),
                worst.verdict()
            ]
        });
        let columns = ["target", "at most", "kept", "of", "worst scene", "measured there", "verdict there"];
        chapter.table("targets", &columns, 1, rows.collect());
        self.write_misses(chapter, &groups);
    }

    fn write_misses(&self, chapter: &mut Chapter, groups: &[Vec<&Target>]) {
        let mut points = Vec::new();
        for group in groups {
            let missed: Vec<_> = group.iter().filter(|target| !target.is_kept()).collect();
            if missed.is_empty() {
                continue;
            }
            let scenes = missed.iter().map(|target| {
                let figure = Figure::brief(target.estimate, target.unit);
                let name = format!("{}: {}", target.statement, target.scene);
                format!("{} {}", target.scene, chapter.quote(name, figure))
            });
            let scenes = scenes.collect::<Vec<_>>().join(", ");
            let statement = &group[0].statement;
            chapter.setting(format!("statement: {statement}"), statement.as_str());
            let reason = self
                .reasons
                .iter()
                .find(|([beginning, end], _)| statement.starts_with(beginning) && statement.ends_with(end));
            let reason = reason.map_or(String::new(), |(_, reason)| format!(". Likely: {reason}"));
            points.push(format!("{statement}: {scenes}{reason}"));
        }
        if !points.is_empty() {
            chapter.paragraph("Missed, with the figure, and the likely reason where there is one:");
            chapter.list(&points);
        }
    }

    /// Every scene.
    pub(crate) fn write_all(&self, chapter: &mut Chapter) {
        chapter.section("What was to be reached, scene by scene", "");
        let rows = self.all.iter().map(|target| -> Vec<Cell> {
            row![
                target.statement.clone(),
                target.scene.clone(),
                Figure::new(target.estimate, target.unit),
                Figure::exact(target.bound, target.unit),
                target.verdict()
            ]
        });
        chapter.table("targets by scene", &["target", "scene", "measured", "at most", "verdict"], 2, rows.collect());
    }
}

impl Target {
    /// Over the bound: what is worst.
    fn excess(&self) -> f64 {
        self.estimate.value / self.bound
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_scene_stands_for_a_statement_and_misses_are_said() {
        let mut targets = Targets::default();
        let exact = |value| Estimate { value, low: value - 0.1, high: value + 0.1, seeds: 8 };
        targets.at_most("error", "kitchen", exact(0.3), Unit::Ratio, 0.5);
        targets.at_most("error", "garden", exact(0.7), Unit::Ratio, 0.5);
        targets.below("strictly", "garden", exact(0.45), Unit::Ratio, 0.5);
        targets.at_most("time", "garden", exact(0.45), Unit::Ratio, 0.5);
        targets.reason(["err", "or"], "Leaves.");
        let mut chapter = Chapter::new("Title");
        targets.write_summary(&mut chapter);
        targets.write_all(&mut chapter);
        let text = chapter.markdown();
        assert!(text.contains("Kept in every scene: 1 of 3."), "{text}");
        assert!(text.contains("- error: garden 0.700. Likely: Leaves."), "{text}");
        assert!(text.contains("reached, the interval goes beyond") && text.contains("NOT REACHED"), "{text}");
        assert_eq!(text.matches("kitchen").count(), 1, "only in the table of all scenes");
    }
}
