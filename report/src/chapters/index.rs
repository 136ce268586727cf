//! docs/report/README.md: the chapters, what they were measured on, and every target. Made of the chapters' JSON files,
//! so that chapters that were not written this time stay in it.

use super::chapter::Chapter;
use super::described::Description;
use super::figure::{Figure, Unit};
use super::list::chapters as all_chapters;
use super::plan::{Extent, Plan};
use super::template::{self, word};
use anyhow::Result;
use itertools::Itertools;
use serde_json::{Value, json};
use std::path::Path;
use xtask::paths::{self, elements};

/// The index of the chapters in `folder`, and of one that has just been written and is not there yet.
pub(super) fn write(folder: &Path, new: Option<(&str, &Value)>) -> Result<String> {
    let (mut all, plan): (Vec<Value>, _) = (Vec::new(), Plan::new(Extent::Full)?);
    for (name, _) in all_chapters(&[]) {
        let description: Description = plan.read(name)?;
        for name in [name, description.names(name, &plan)[0]].into_iter().unique() {
            let json = match new {
                Some((written, json)) if written == name => Some(json.clone()),
                // A chapter that was never written is not there.
                _ => Some(folder.join(format!("{name}.json")))
                    .filter(|path| path.exists())
                    .map(paths::json)
                    .transpose()?,
            };
            all.extend(json.filter(|json| json["run"].is_object()));
        }
    }
    let mut index = Chapter::new("Measurements");
    chapters(&mut index, &all);
    machines(&mut index, &all);
    targets(&mut index, &all);
    // What another command writes into the same folder.
    if folder.join("sizes.md").exists() {
        let what = "[Code size and stack on other targets](sizes.md)";
        index.setting("sizes.md", format!("{what}, written by `cargo xtask targets`, when asked for."));
    }
    template::chapter("index", &index.json(), &|_| true)
}

/// How each came about.
fn chapters(index: &mut Chapter, all: &[Value]) {
    index.section("Chapters");
    let row = |one: &Value| {
        let run = &one["run"];
        let [title, name, sizes] =
            [&one["title"], &run["name"], &run["sizes"]].map(|value| word(value).unwrap_or_default());
        let sizes = if sizes == "default" { sizes } else { format!("`--{sizes}`") };
        let [seconds, processor] =
            ["seconds", "processor_seconds"].map(|name| run[name].as_f64().map(|of| format!("{of:.0}")));
        let other_work = run["other_work"].as_f64().map(|cores| format!("{cores:.2}"));
        json!([format!("[{title}]({name}.md)"), run["description"], sizes, run["date"], other_work, seconds, processor])
    };
    let columns = "chapter | what it measures | run | measured | other work | seconds | CPU seconds";
    index.table("chapters", columns, 4, all.iter().map(row).collect::<Vec<_>>());
}

fn machines(index: &mut Chapter, all: &[Value]) {
    index.section("Machine");
    let row = |machine: &Value| {
        let here = all.iter().filter(|one| one["run"]["machine"] == *machine);
        let names = here.filter_map(|one| word(&one["run"]["name"])).join(", ");
        let compilers = elements(&machine["compilers"]).iter().filter_map(word).join("; ");
        let cores = word(&machine["cores"]);
        json!([names, machine["processor"], cores, machine["clock"], machine["kernel"], compilers])
    };
    let columns = "chapters | processor | cores | clock | kernel | compilers";
    let machines = all.iter().map(|one| &one["run"]["machine"]).unique();
    index.table("machine", columns, 6, machines.map(row).collect::<Vec<_>>());
}

/// The chapters' own tables.
fn targets(index: &mut Chapter, all: &[Value]) {
    index.section("What was to be reached");
    let mut rows = Vec::new();
    for one in all {
        let link = word(&one["run"]["name"]).map(|name| format!("[{name}]({name}.md)"));
        for table in elements(&one["tables"]).iter().filter(|table| table["name"] == "targets") {
            rows.extend(elements(&table["rows"]).iter().map(|cells| [&[json!(link)], elements(cells)].concat()));
        }
    }
    for name in ["targets", "targets reached everywhere", "targets reached everywhere by the value"] {
        let numbers = all.iter().filter_map(|one| one["quoted"][name]["value"].as_f64());
        index.quote(name, Figure::exact(numbers.sum(), Unit::Count));
    }
    let columns = "chapter | target | bound | reached | by value | of | worst place | measured there | verdict there";
    index.table("targets", columns, 3, rows);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chapters::statistics::Estimate;
    use crate::chapters::targets::Bound;
    use std::fs;

    fn chapter(name: &str, title: &str, value: f64) -> Value {
        let mut chapter = Chapter::new(title);
        let estimate = Estimate { value, low: value - 0.01, high: value + 0.01, seeds: 8 };
        chapter.target("error", "kitchen", estimate, Unit::Ratio, Bound::AtMost(0.5));
        chapter.judge();
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
