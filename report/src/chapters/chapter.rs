//! A chapter of the report, as data: tables, figures that its text quotes, settings, targets. Its text is a template.

use super::figure::{Figure, Unit};
use super::statistics::Estimate;
use super::targets::{Bound, Target, groups, worst};
use serde::Serialize;
use serde_json::{Map, Value, json};

#[derive(Default)]
pub(crate) struct Chapter {
    title: String,
    section: String,
    tables: Vec<Value>,
    quoted: Map<String, Value>,
    settings: Map<String, Value>,
    /// Not yet judged.
    targets: Vec<Target>,
}

impl Chapter {
    pub(crate) fn new(title: &str) -> Self {
        Self { title: title.to_owned(), section: title.to_owned(), ..Self::default() }
    }

    /// The tables that follow stand below this heading.
    pub(crate) fn section(&mut self, title: &str) {
        title.clone_into(&mut self.section);
    }

    /// A figure that the text quotes.
    pub(crate) fn quote(&mut self, name: &str, figure: impl Serialize) {
        self.quoted.insert(name.to_owned(), json!(figure));
    }

    /// What was chosen, not measured.
    pub(crate) fn setting(&mut self, name: &str, value: impl Serialize) {
        self.settings.insert(name.to_owned(), json!(value));
    }

    /// Columns between bars; what stands in the first `words` of them is aligned left. The cells of a row are words,
    /// figures, or null for what was not measured.
    pub(crate) fn table(&mut self, name: &str, columns: &str, words: usize, rows: impl Serialize) {
        let (section, columns) = (&self.section, columns.split(" | ").collect::<Vec<_>>());
        let table = json!({ "name": name, "section": section, "columns": columns, "words": words, "rows": rows });
        self.tables.push(table);
    }

    pub(crate) fn target(&mut self, statement: &str, place: &str, estimate: Estimate, unit: Unit, bound: Bound) {
        let (statement, place) = (statement.to_owned(), place.to_owned());
        self.targets.push(Target { statement, place, estimate, unit, bound });
    }

    /// One row for each statement, its worst place standing for it; then every place that misses it. The index reads
    /// the first table.
    pub(crate) fn judge(&mut self) {
        self.section("What was to be reached");
        let targets = std::mem::take(&mut self.targets);
        let groups = groups(&targets);
        let everywhere =
            |of: fn(&Target) -> bool| groups.iter().filter(|group| group.iter().all(|one| of(one))).count();
        self.quote("targets", Figure::count(groups.len()));
        self.quote("targets reached everywhere", Figure::count(everywhere(Target::is_reached)));
        self.quote("targets reached everywhere by the value", Figure::count(everywhere(Target::is_kept)));
        let row = |group: &Vec<&Target>| {
            let count = |of: fn(&Target) -> bool| Figure::count(group.iter().filter(|one| of(one)).count());
            let (reached, kept, all) = (count(Target::is_reached), count(Target::is_kept), Figure::count(group.len()));
            let worst @ Target { statement, place, estimate, unit, bound } = worst(group);
            let figure = Figure::new(*estimate, *unit);
            json!([statement, bound.text(*unit), reached, kept, all, place, figure, worst.verdict()])
        };
        let columns = "target | bound | reached | by value | of | worst place | measured there | verdict there";
        self.table("targets", columns, 2, groups.iter().map(row).collect::<Vec<_>>());
        let missed = groups.iter().flatten().filter(|target| !target.is_reached());
        let row = |one: &&Target| {
            let figure = Figure::new(one.estimate, one.unit);
            json!([one.statement, one.place, figure, one.bound.text(one.unit), one.verdict()])
        };
        let rows: Vec<Value> = missed.map(row).collect();
        if !rows.is_empty() {
            self.table("targets missed", "target | place | measured | bound | verdict", 2, rows);
        }
    }

    pub(crate) fn json(&self) -> Value {
        json!({ "title": self.title, "settings": self.settings, "quoted": self.quoted, "tables": self.tables })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(value: f64) -> Estimate {
        Estimate { value, low: value - 0.1, high: value + 0.1, seeds: 8 }
    }

    #[test]
    fn the_worst_scene_stands_for_a_statement_and_misses_are_said() {
        let mut chapter = Chapter::new("Title");
        chapter.target("error", "kitchen", estimate(0.3), Unit::Ratio, Bound::AtMost(0.5));
        chapter.target("error", "garden", estimate(0.7), Unit::Ratio, Bound::AtMost(0.5));
        chapter.target("strictly", "garden", estimate(0.45), Unit::Ratio, Bound::Below(0.5));
        chapter.target("time", "garden", estimate(0.35), Unit::Ratio, Bound::AtMost(0.5));
        chapter.judge();
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
        let mut chapter = Chapter::new("Title");
        for value in [0.3, 0.45, 0.55, 0.7] {
            chapter.target("low", "", estimate(value), Unit::Ratio, Bound::AtMost(0.5));
        }
        for value in [0.7, 0.55, 0.45, 0.3] {
            chapter.target("high", "", estimate(value), Unit::Ratio, Bound::AtLeast(0.5));
        }
        let targets = chapter.targets;
        let verdicts: Vec<&str> =
            targets.iter().map(|target| target.verdict().split(':').next().unwrap_or("")).collect();
        assert_eq!(verdicts, ["reached", "open", "open", "NOT REACHED"].repeat(2));
        let reached: Vec<bool> = targets.iter().map(Target::is_reached).collect();
        assert_eq!(reached, [true, false, false, false].repeat(2));
        let lowest = worst(&groups(&targets)[1]).estimate.value;
        assert_eq!(lowest, 0.3, "the lowest is worst where much is good");
    }
}
