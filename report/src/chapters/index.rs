//! docs/report/README.md: the chapters, what they were measured on, and every target. Made of the chapters' JSON files,
//! so that chapters that were not written this time stay in it.

use super::chapter::{Cell, Chapter, row};
use super::figure::{Figure, Unit};
use super::machine::Machine;
use super::plan::{Extent, Plan};
use super::template::{self, list};
use super::{described::Description, list::chapters as all_chapters};
use anyhow::Result;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// How a chapter came about; the rest of its JSON is its own.
#[derive(Serialize, Deserialize)]
pub(super) struct Facts {
    pub(super) name: String,
    pub(super) description: String,
    /// `quick`, `default` or `full`.
    pub(super) sizes: String,
    /// Without compiling. None: the run that measured left no record.
    pub(super) seconds: Option<f64>,
    pub(super) processor_seconds: Option<f64>,
    /// Cores that others kept busy meanwhile, on average. None: the system does not say.
    #[serde(default)]
    pub(super) other_work: Option<f64>,
    pub(super) date: String,
    pub(super) machine: Machine,
}

/// What the index takes from a chapter's JSON.
#[derive(Deserialize)]
struct Summary {
    title: String,
    run: Facts,
    quoted: BTreeMap<String, Value>,
    tables: Vec<Value>,
}

/// What other commands write into the same folder: its file, what it is, the command.
const BESIDE: (&str, &str, &str) = ("sizes.md", "Code size and stack on other targets", "targets");

/// The index of the chapters in `folder`, and of one that has just been written and is not there yet.
pub(super) fn write(folder: &Path, new: Option<(&str, &Value)>) -> Result<String> {
    let (mut all, plan): (Vec<Summary>, _) = (Vec::new(), Plan::new(Extent::Full)?);
    for (name, _) in all_chapters(&[]) {
        let description = Description::read(name, &plan)?;
        for name in [Some(name), description.full.as_ref().map(|full| full.name.as_str())].into_iter().flatten() {
            let json = match new {
                Some((written, json)) if written == name => Some(json.clone()),
                // A chapter that was never written is not there.
                _ => fs::read_to_string(folder.join(format!("{name}.json")))
                    .ok()
                    .and_then(|text| serde_json::from_str(&text).ok()),
            };
            all.extend(json.and_then(|json| serde_json::from_value(json).ok()));
        }
    }
    let mut index = Chapter::new("Measurements");
    chapters(&mut index, &all);
    machines(&mut index, &all);
    targets(&mut index, &all);
    let (file, what, command) = BESIDE;
    if folder.join(file).exists() {
        index.setting(file, format!("[{what}]({file}), written by `cargo xtask {command}`, when asked for."));
    }
    template::chapter("index", &index.json(), &|_| true)
}

fn chapters(index: &mut Chapter, all: &[Summary]) {
    index.section("Chapters");
    let seconds = |seconds: f64| format!("{seconds:.0}");
    let rows = all.iter().map(|Summary { title, run, .. }| -> Vec<Cell> {
        row![
            format!("[{title}]({}.md)", run.name),
            run.description.clone(),
            if run.sizes == "default" { run.sizes.clone() } else { format!("`--{}`", run.sizes) },
            run.date.clone(),
            run.other_work.map(|cores| format!("{cores:.2}")),
            run.seconds.map(seconds),
            run.processor_seconds.map(seconds)
        ]
    });
    let columns = "chapter | what it measures | run | measured | other work | seconds | CPU seconds";
    index.table("chapters", columns, 4, rows.collect());
}

fn machines(index: &mut Chapter, all: &[Summary]) {
    index.section("Machine");
    let mut distinct: Vec<(&Machine, Vec<&str>)> = Vec::new();
    for one in all {
        match distinct.iter_mut().find(|(machine, _)| **machine == one.run.machine) {
            Some((_, names)) => names.push(&one.run.name),
            None => distinct.push((&one.run.machine, vec![&one.run.name])),
        }
    }
    let row = |(machine, names): (&Machine, Vec<&str>)| -> Vec<Cell> {
        let Machine { processor, cores, clock, kernel, compilers } = machine.clone();
        row![names.join(", "), processor, cores.to_string(), clock, kernel, compilers.join("; ")]
    };
    let columns = "chapters | processor | cores | clock | kernel | compilers";
    index.table("machine", columns, 6, distinct.into_iter().map(row).collect());
}

/// The chapters' own tables.
fn targets(index: &mut Chapter, all: &[Summary]) {
    index.section("What was to be reached");
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    for one in all {
        for table in one.tables.iter().filter(|table| table["name"] == "targets") {
            for cells in list(&table["rows"]) {
                let cells = list(cells).iter().map(|cell| Cell::from(template::word(cell)));
                rows.push(row![format!("[{0}]({0}.md)", one.run.name)].into_iter().chain(cells).collect());
            }
        }
    }
    for name in ["targets", "targets reached everywhere", "targets reached everywhere by the value"] {
        let numbers = all.iter().filter_map(|one| one.quoted.get(name)?["value"].as_f64());
        index.quote(name, Figure::exact(numbers.sum(), Unit::Count));
    }
    let columns = "chapter | target | bound | reached | by value | of | worst place | measured there | verdict there";
    index.table("targets", columns, 3, rows);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chapters::statistics::Estimate;
    use crate::chapters::targets::Targets;
    use serde_json::json;

    fn chapter(name: &str, title: &str, value: f64) -> Value {
        let mut targets = Targets::default();
        let estimate = Estimate { value, low: value - 0.01, high: value + 0.01, seeds: 8 };
        targets.at_most("error", "kitchen", estimate, Unit::Ratio, 0.5);
        let mut chapter = Chapter::new(title);
        targets.write(&mut chapter);
        let machine = json!({
            "processor": "Processor 9", "cores": 2, "clock": "-", "kernel": "linux 1.2", "compilers": ["r", "c", "x"]
        });
        let mut json = chapter.json();
        json["run"] = json!({
            "name": name, "description": "Words", "sizes": "quick", "seconds": 12.4, "processor_seconds": 20.2,
            "date": "2000-01-01", "other_work": 0.314, "machine": machine
        });
        json
    }

    #[test]
    fn chapters_that_are_not_written_anew_stay_in_the_index() {
        let folder = tempfile::tempdir().expect("a folder");
        let before = chapter("points", "Second", 0.7).to_string();
        fs::write(folder.path().join("points.json"), before).expect("writable");
        fs::write(folder.path().join("samplers.json"), "{}").expect("writable");
        let written = chapter("embree", "First", 0.4);
        let text = write(folder.path(), Some(("embree", &written))).expect("an index");
        assert!(text.contains("[First](embree.md)") && text.contains("[Second](points.md)"), "{text}");
        assert!(text.contains("1 of 2 targets are reached everywhere"), "{text}");
        assert!(text.contains("NOT REACHED") && text.contains("| `--quick` | 2000-01-01 | "), "{text}");
        assert_eq!(text.matches("Processor 9").count(), 1, "one machine is described once");
        assert!(!text.contains("sizes.md"), "what is not there is not linked");
        fs::write(folder.path().join("sizes.md"), "").expect("writable");
        let text = write(folder.path(), Some(("embree", &written))).expect("an index");
        assert!(text.contains("(sizes.md)"), "{text}");
    }
}
