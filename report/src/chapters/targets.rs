//! What was to be reached, and what was measured.

use super::chapter::{Cell, Chapter, row};
use super::figure::{Figure, Unit};
use super::statistics::Estimate;

/// Which side of a bound is right.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    AtMost,
    Below,
    AtLeast,
}

/// A bound, a figure, and whether it keeps the bound.
struct Target {
    statement: String,
    scene: String,
    estimate: Estimate,
    unit: Unit,
    side: Side,
    bound: f64,
}

/// Collected as the sections measure.
#[derive(Default)]
pub(crate) struct Targets(Vec<Target>);

impl Target {
    fn keeps(&self, value: f64) -> bool {
        match self.side {
            Side::AtMost => value <= self.bound,
            Side::Below => value < self.bound,
            Side::AtLeast => value >= self.bound,
        }
    }

    /// The whole interval keeps the bound.
    fn is_reached(&self) -> bool {
        self.keeps(self.estimate.low) && self.keeps(self.estimate.high)
    }

    fn verdict(&self) -> &'static str {
        let Estimate { value, low, high, .. } = self.estimate;
        match [low, value, high].map(|value| self.keeps(value)) {
            [true, true, true] => "reached",
            [_, true, _] => "open: the value keeps the bound, its interval does not",
            [false, false, false] => "NOT REACHED",
            [_, false, _] => "open: the value misses the bound, its interval does not",
        }
    }

    fn bound_text(&self) -> String {
        let words = match self.side {
            Side::AtMost => "at most",
            Side::Below => "below",
            Side::AtLeast => "at least",
        };
        format!("{words} {}", self.unit.text(self.bound))
    }

    /// How far on the wrong side: what is worst.
    fn excess(&self) -> f64 {
        let excess = self.estimate.value - self.bound;
        if self.side == Side::AtLeast { -excess } else { excess }
    }
}

impl Targets {
    pub(crate) fn add(
        &mut self,
        statement: &str,
        scene: &str,
        estimate: Estimate,
        unit: Unit,
        (side, bound): (Side, f64),
    ) {
        let (statement, scene) = (statement.to_owned(), scene.to_owned());
        self.0.push(Target { statement, scene, estimate, unit, side, bound });
    }

    /// The figure shall be `bound` at most.
    pub(crate) fn at_most(&mut self, statement: &str, scene: &str, estimate: Estimate, unit: Unit, bound: f64) {
        self.add(statement, scene, estimate, unit, (Side::AtMost, bound));
    }

    /// Targets of the same statement, in the order in which they were measured.
    fn groups(&self) -> Vec<Vec<&Target>> {
        let mut groups: Vec<Vec<&Target>> = Vec::new();
        for target in &self.0 {
            match groups.iter_mut().find(|group| group[0].statement == target.statement) {
                Some(group) => group.push(target),
                None => groups.push(vec![target]),
            }
        }
        groups
    }

    /// One row for each statement, its worst place standing for it; then every place that misses it. The index reads
    /// the first table.
    pub(crate) fn write(&self, chapter: &mut Chapter) {
        chapter.section("What was to be reached");
        let groups = self.groups();
        let all = |of: fn(&Target) -> bool| groups.iter().filter(|group| group.iter().all(|one| of(one))).count();
        chapter.quote("targets", Figure::count(groups.len()));
        chapter.quote("targets reached everywhere", Figure::count(all(Target::is_reached)));
        chapter
            .quote("targets reached everywhere by the value", Figure::count(all(|one| one.keeps(one.estimate.value))));
        let row = |group: &Vec<&Target>| -> Vec<Cell> {
            let worst = worst(group);
            row![
                worst.statement.clone(),
                worst.bound_text(),
                Figure::count(group.iter().filter(|target| target.is_reached()).count()),
                Figure::count(group.iter().filter(|target| target.keeps(target.estimate.value)).count()),
                Figure::count(group.len()),
                worst.scene.clone(),
                Figure::new(worst.estimate, worst.unit),
                worst.verdict()
            ]
        };
        let columns = "target | bound | reached | by value | of | worst place | measured there | verdict there";
        chapter.table("targets", columns, 2, groups.iter().map(row).collect());
        let missed = groups.iter().flatten().filter(|target| !target.is_reached());
        let row = |one: &&Target| -> Vec<Cell> {
            let figure = Figure::new(one.estimate, one.unit);
            row![one.statement.clone(), one.scene.clone(), figure, one.bound_text(), one.verdict()]
        };
        let rows: Vec<Vec<Cell>> = missed.map(row).collect();
        if !rows.is_empty() {
            chapter.table("targets missed", "target | place | measured | bound | verdict", 2, rows);
        }
    }
}

fn worst<'a>(group: &[&'a Target]) -> &'a Target {
    group.iter().max_by(|a, b| a.excess().total_cmp(&b.excess())).unwrap_or(&group[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(value: f64) -> Estimate {
        Estimate { value, low: value - 0.1, high: value + 0.1, seeds: 8 }
    }

    #[test]
    fn the_worst_scene_stands_for_a_statement_and_misses_are_said() {
        let mut targets = Targets::default();
        targets.at_most("error", "kitchen", estimate(0.3), Unit::Ratio, 0.5);
        targets.at_most("error", "garden", estimate(0.7), Unit::Ratio, 0.5);
        targets.add("strictly", "garden", estimate(0.45), Unit::Ratio, (Side::Below, 0.5));
        targets.at_most("time", "garden", estimate(0.35), Unit::Ratio, 0.5);
        let mut chapter = Chapter::new("Title");
        targets.write(&mut chapter);
        let json = chapter.json();
        let quoted = ["targets", "targets reached everywhere", "targets reached everywhere by the value"];
        assert_eq!(quoted.map(|name| json["quoted"][name]["value"].as_f64()), [Some(3.0), Some(1.0), Some(2.0)]);
        let [all, missed] = [0, 1].map(|table| &json["tables"][table]["rows"]);
        assert_eq!([&all[0][1], &all[0][5], &all[0][7]], ["at most 0.500", "garden", "NOT REACHED"]);
        assert_eq!([2, 3, 4].map(|at| all[0][at]["text"].as_str()), [Some("1"), Some("1"), Some("2")]);
        assert_eq!([&missed[0][1], &missed[1][0]], ["garden", "strictly"]);
        assert_eq!(missed[0][2]["text"], "0.700 [0.600, 0.800]");
        assert!(missed[2].is_null());
    }

    #[test]
    fn a_verdict_goes_by_the_whole_interval_on_either_side() {
        let mut targets = Targets::default();
        for value in [0.3, 0.45, 0.55, 0.7] {
            targets.at_most("low", "", estimate(value), Unit::Ratio, 0.5);
        }
        for value in [0.7, 0.55, 0.45, 0.3] {
            targets.add("high", "", estimate(value), Unit::Ratio, (Side::AtLeast, 0.5));
        }
        let verdicts: Vec<&str> =
            targets.0.iter().map(|target| target.verdict().split(':').next().unwrap_or("")).collect();
        assert_eq!(verdicts, ["reached", "open", "open", "NOT REACHED"].repeat(2));
        let reached: Vec<bool> = targets.0.iter().map(Target::is_reached).collect();
        assert_eq!(reached, [true, false, false, false].repeat(2));
        let lowest = worst(&targets.groups()[1]).estimate.value;
        assert_eq!(lowest, 0.3, "the lowest is worst where much is good");
    }
}
