//! What was to be reached, and what was measured.

use super::chapter::{Cell, Chapter, row};
use super::figure::{Figure, Unit};
use super::statistics::Estimate;
use serde::{Deserialize, Serialize};

/// Which side of a bound is right.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
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
pub(crate) struct Targets {
    all: Vec<Target>,
    reasons: Vec<Reason>,
}

/// The likely reason why a statement's bound is missed.
struct Reason {
    /// The statement's beginning and end.
    statement: [&'static str; 2],
    /// The end of the place's name, if it is the reason in some places only.
    place: Option<&'static str>,
    text: &'static str,
}

impl Reason {
    /// For a list item: nothing, unless it is about this statement and one of the places where it is missed.
    fn said_of(&self, statement: &str, missed: &[&Target]) -> Option<String> {
        let [beginning, end] = self.statement;
        let is_meant = statement.starts_with(beginning) && statement.ends_with(end);
        let text = self.text;
        match self.place {
            None if is_meant => Some(format!(". Likely: {text}")),
            Some(place) if is_meant && missed.iter().any(|target| target.scene.ends_with(place)) => {
                Some(format!(". Likely, as for {place}: {text}"))
            }
            _ => None,
        }
    }
}

/// A statement as the chapter's JSON and the index have it: its worst place stands for it.
#[derive(Serialize, Deserialize)]
pub(crate) struct Judged {
    pub(crate) statement: String,
    /// In words.
    pub(crate) bound: String,
    /// In so many of `of` places the whole interval keeps the bound; in so many the value does.
    pub(crate) reached: usize,
    pub(crate) by_value: usize,
    pub(crate) of: usize,
    /// Where it is worst, what was measured there, and whether that is enough.
    pub(crate) place: String,
    pub(crate) measured: String,
    pub(crate) verdict: String,
}

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
    /// The figure shall be `bound` at most.
    pub(crate) fn at_most(&mut self, statement: &str, scene: &str, estimate: Estimate, unit: Unit, bound: f64) {
        self.push(statement, scene, estimate, unit, (Side::AtMost, bound));
    }

    /// The figure shall be less than `bound`.
    pub(crate) fn below(&mut self, statement: &str, scene: &str, estimate: Estimate, unit: Unit, bound: f64) {
        self.push(statement, scene, estimate, unit, (Side::Below, bound));
    }

    /// The figure shall be `bound` at least.
    pub(crate) fn at_least(&mut self, statement: &str, scene: &str, estimate: Estimate, unit: Unit, bound: f64) {
        self.push(statement, scene, estimate, unit, (Side::AtLeast, bound));
    }

    fn push(&mut self, statement: &str, scene: &str, estimate: Estimate, unit: Unit, (side, bound): (Side, f64)) {
        let (statement, scene) = (statement.to_owned(), scene.to_owned());
        self.all.push(Target { statement, scene, estimate, unit, side, bound });
    }

    /// Said where a target that begins and ends like this is missed.
    pub(crate) fn reason(&mut self, statement: [&'static str; 2], reason: &'static str) {
        self.reasons.push(Reason { statement, place: None, text: reason });
    }

    /// The same, only where it is missed at a place whose name ends so.
    pub(crate) fn reason_at(&mut self, statement: [&'static str; 2], place: &'static str, reason: &'static str) {
        self.reasons.push(Reason { statement, place: Some(place), text: reason });
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

    /// One row for each statement, and what was missed. The chapter hands the same to the index.
    pub(crate) fn write_summary(&self, chapter: &mut Chapter) {
        chapter.section("What was to be reached", "");
        let groups = self.groups();
        let judged: Vec<Judged> = groups.iter().map(|group| judge(group)).collect();
        let mut count = |name: &str, of: fn(&Judged) -> bool| {
            let count = judged.iter().filter(|one| of(one)).count();
            chapter.quote(name, Figure::exact(count as f64, Unit::Count))
        };
        let reached = count("targets reached everywhere", |one| one.reached == one.of);
        let by_value = count("targets reached everywhere by the value", |one| one.by_value == one.of);
        let all = count("targets", |_| true);
        let percent = chapter.setting("confidence of verdicts, percent", 95);
        chapter.paragraph(&format!(
            "Reached everywhere: {reached} of {all}; by the value alone: {by_value}. A target is reached where the whole {percent} % interval of the figure \
             keeps the bound, and missed where the whole interval misses it; in between it is open, and counts as not reached. A figure without an interval \
             is judged as it is. The worst place stands for each."
        ));
        let rows = groups.iter().zip(&judged).map(|(group, one)| -> Vec<Cell> {
            let count = |count: usize| Figure::exact(count as f64, Unit::Count);
            row![
                one.statement.clone(),
                one.bound.clone(),
                count(one.reached),
                count(one.by_value),
                count(one.of),
                one.place.clone(),
                Figure::new(worst(group).estimate, worst(group).unit),
                one.verdict.clone()
            ]
        });
        let columns =
            ["target", "bound", "reached", "by value", "of", "worst place", "measured there", "verdict there"];
        chapter.table("targets", &columns, 2, rows.collect());
        self.write_misses(chapter, &groups);
        chapter.hand_over(judged);
    }

    fn write_misses(&self, chapter: &mut Chapter, groups: &[Vec<&Target>]) {
        let mut points = Vec::new();
        for group in groups {
            let missed: Vec<_> = group.iter().copied().filter(|target| !target.is_reached()).collect();
            if missed.is_empty() {
                continue;
            }
            let scenes = missed.iter().map(|target| {
                let figure = Figure::brief(target.estimate, target.unit);
                let name = format!("{}: {}", target.statement, target.scene);
                chapter.setting(format!("place: {}", target.scene), target.scene.as_str());
                format!("{} {}", target.scene, chapter.quote(name, figure))
            });
            let scenes = scenes.collect::<Vec<_>>().join(", ");
            let statement = &group[0].statement;
            chapter.setting(format!("statement: {statement}"), statement.as_str());
            let reason = self.reasons.iter().find_map(|reason| reason.said_of(statement, &missed)).unwrap_or_default();
            points.push(format!("{statement}: {scenes}{reason}"));
        }
        if !points.is_empty() {
            chapter.paragraph("Missed or open, with the figure, and the likely reason where there is one:");
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
                target.bound_text(),
                target.verdict()
            ]
        });
        chapter.table("targets by scene", &["target", "scene", "measured", "bound", "verdict"], 2, rows.collect());
    }
}

fn worst<'a>(group: &[&'a Target]) -> &'a Target {
    group.iter().max_by(|a, b| a.excess().total_cmp(&b.excess())).unwrap_or(&group[0])
}

fn judge(group: &[&Target]) -> Judged {
    let worst = worst(group);
    Judged {
        statement: worst.statement.clone(),
        bound: worst.bound_text(),
        reached: group.iter().filter(|target| target.is_reached()).count(),
        by_value: group.iter().filter(|target| target.keeps(target.estimate.value)).count(),
        of: group.len(),
        place: worst.scene.clone(),
        measured: Figure::new(worst.estimate, worst.unit).text,
        verdict: worst.verdict().to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(value: f64) -> Estimate {
        Estimate { value, low: value - 0.1, high: value + 0.1, seeds: 8 }
    }

    #[test]
    fn the_worst_scene_stands_for_a_statement_and_misses_are_said() {
        let mut targets = Targets::default();
        targets.at_most("error", "kitchen", exact(0.3), Unit::Ratio, 0.5);
        targets.at_most("error", "garden", exact(0.7), Unit::Ratio, 0.5);
        targets.below("strictly", "garden", exact(0.45), Unit::Ratio, 0.5);
        targets.at_most("time", "garden", exact(0.35), Unit::Ratio, 0.5);
        targets.reason(["err", "or"], "Leaves.");
        let mut chapter = Chapter::new("Title");
        targets.write_summary(&mut chapter);
        targets.write_all(&mut chapter);
        let text = chapter.markdown();
        assert!(text.contains("Reached everywhere: 1 of 3; by the value alone: 2."), "{text}");
        assert!(text.contains("- error: garden 0.700. Likely: Leaves."), "{text}");
        assert!(text.contains("open: the value keeps the bound") && text.contains("NOT REACHED"), "{text}");
        assert_eq!(text.matches("kitchen").count(), 1, "only in the table of all scenes");
        let json = chapter.json();
        assert_eq!(json["targets"][0]["place"], "garden");
        assert_eq!(json["targets"][0]["bound"], "at most 0.500");
        assert_eq!((json["targets"][0]["reached"].as_u64(), json["targets"][0]["of"].as_u64()), (Some(1), Some(2)));
    }

    #[test]
    fn a_reason_of_one_place_is_said_where_that_place_misses() {
        let text = |eye: f64| {
            let mut targets = Targets::default();
            targets.at_most("error", "garden, average", exact(0.7), Unit::Ratio, 0.5);
            targets.at_most("error", "garden, eye", exact(eye), Unit::Ratio, 0.5);
            targets.reason_at(["error", ""], "eye", "Leaves.");
            let mut chapter = Chapter::new("Title");
            targets.write_summary(&mut chapter);
            chapter.markdown().to_owned()
        };
        let missed = text(0.8);
        assert!(missed.contains("garden, average 0.700, garden, eye 0.800. Likely, as for eye: Leaves."), "{missed}");
        let kept = text(0.2);
        assert!(kept.contains("- error: garden, average 0.700\n") && !kept.contains("Leaves"), "{kept}");
    }

    #[test]
    fn a_verdict_goes_by_the_whole_interval_on_either_side() {
        let mut targets = Targets::default();
        for value in [0.3, 0.45, 0.55, 0.7] {
            targets.at_most("low", "", exact(value), Unit::Ratio, 0.5);
        }
        for value in [0.7, 0.55, 0.45, 0.3] {
            targets.at_least("high", "", exact(value), Unit::Ratio, 0.5);
        }
        let verdicts: Vec<&str> =
            targets.all.iter().map(|target| target.verdict().split(':').next().unwrap_or("")).collect();
        assert_eq!(verdicts, ["reached", "open", "open", "NOT REACHED"].repeat(2));
        let reached: Vec<bool> = targets.all.iter().map(Target::is_reached).collect();
        assert_eq!(reached, [true, false, false, false].repeat(2));
        assert_eq!(
            judge(&targets.groups()[1]).measured,
            "0.300 [0.200, 0.400]",
            "the lowest is worst where much is good"
        );
    }
}
