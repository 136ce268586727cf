//! docs/report/README.md: the chapters, what they were measured on, and every target. Made of the chapters' JSON files,
//! so that chapters that were not written this time stay in it.

use super::chapter::{Cell, Chapter, row};
use super::check;
use super::machine::Machine;
use super::targets::Judged;
use super::{CHAPTERS, Entry};
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
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
    /// Cores that others kept busy meanwhile, on average. None: the system does not say, or it was measured before this
    /// was recorded.
    #[serde(default)]
    pub(super) other_work: Option<f64>,
    pub(super) date: String,
    pub(super) machine: Machine,
    /// The date on which the text was written from what an earlier run had measured, the run that the other facts are
    /// of.
    #[serde(default)]
    pub(super) kept: Option<String>,
}

impl Facts {
    /// The chapter's JSON with these facts.
    pub(super) fn add_to(&self, json: &str) -> Result<String> {
        let mut json: Value = serde_json::from_str(json)?;
        json.as_object_mut().context("no object")?.insert("run".to_owned(), json!(self));
        Ok(super::json::written(&json))
    }
}

/// What the index takes from a chapter's JSON.
#[derive(Deserialize)]
struct Summary {
    title: String,
    run: Facts,
    #[serde(default)]
    targets: Vec<Judged>,
}

/// The index of the chapters in `folder`, where `name` has just been written and is not there yet.
pub(super) fn write(folder: &Path, name: &str, json: &str) -> Result<String> {
    let mut all = Vec::new();
    for chapter in CHAPTERS.iter().flat_map(Entry::file_names) {
        let text = if chapter == name {
            Some(json.to_owned())
        } else {
            // A chapter that was never written is not there.
            fs::read_to_string(folder.join(format!("{chapter}.json"))).ok()
        };
        // One that was written before there was an index does not say how it came about, and is left out until it is
        // written anew.
        all.extend(text.and_then(|text| serde_json::from_str::<Summary>(&text).ok()));
    }
    let mut chapter = Chapter::new("Measurements");
    introduce(&mut chapter);
    chapters(&mut chapter, &all);
    beside(&mut chapter, folder);
    machines(&mut chapter, &all);
    targets(&mut chapter, &all);
    check::numbers_are_recorded(chapter.markdown(), &chapter.json().to_string()).context("the index")?;
    Ok(chapter.markdown().to_owned())
}

fn introduce(chapter: &mut Chapter) {
    chapter.paragraph(
        "Made by `cargo xtask report`; do not edit. Each chapter says what was measured and how, and has its figures in a JSON file of the same \
         name. `cargo xtask report --only CHAPTER` measures one anew and leaves the others as they are; `--full` measures more, `--quick` \
         only tries whether everything works.",
    );
    let apart = CHAPTERS.iter().filter_map(|entry| Some((entry.name, entry.full?.name)));
    for (name, full) in apart {
        chapter.paragraph(&format!(
            "`--only {name} --full` measures other things than `--only {name}`, and writes `{full}`: neither replaces the other's chapter."
        ));
    }
}

fn chapters(chapter: &mut Chapter, all: &[Summary]) {
    chapter.section("Chapters", "");
    let seconds = |seconds: f64| format!("{seconds:.0}");
    let rows = all.iter().map(|one| -> Vec<Cell> {
        let run = &one.run;
        row![
            format!("[{}]({}.md)", one.title, run.name),
            run.description.clone(),
            sizes(run),
            run.date.clone(),
            run.other_work.map(|cores| format!("{cores:.2}")),
            run.seconds.map(seconds),
            run.processor_seconds.map(seconds)
        ]
    });
    let columns = ["chapter", "what it measures", "run", "measured", "other work", "seconds", "CPU seconds"];
    chapter.table("chapters", &columns, 4, rows.collect());
    chapter.paragraph(
        "Seconds are without compiling; CPU seconds are of all threads. Other work: how many cores other programs kept busy meanwhile, on average; beyond \
         a few tenths seconds say little, while CPU seconds still hold; a dash where it was not recorded.",
    );
    if all.iter().any(|one| one.run.kept.is_some()) {
        chapter.paragraph(
            "Kept: the text was written on the date in brackets from what an earlier run had measured (`--reuse`). Date, other work and seconds are \
             those of the run that measured.",
        );
    }
}

/// How large the run was, and whether it measured at all.
fn sizes(run: &Facts) -> String {
    let sizes = if run.sizes == "default" { run.sizes.clone() } else { format!("`--{}`", run.sizes) };
    match &run.kept {
        Some(date) => format!("{sizes}, kept ({date})"),
        None => sizes,
    }
}

/// What other commands write into the same folder: its file, what it is, the command.
const BESIDE: [(&str, &str, &str); 2] = [
    ("povray_patched.md", "POV-Ray with our patch beside POV-Ray as it is", "povray --report"),
    ("sizes.md", "Code size and stack on other targets", "targets"),
];

/// Links to those that are there.
fn beside(chapter: &mut Chapter, folder: &Path) {
    let there = BESIDE.iter().filter(|(file, ..)| folder.join(file).exists());
    let links: Vec<String> = there
        .map(|(file, what, command)| format!("[{what}]({file}), written by `cargo xtask {command}`, when asked for."))
        .collect();
    if !links.is_empty() {
        chapter.paragraph("Beside the chapters, and not measured with them:");
        chapter.list(&links);
    }
}

fn machines(chapter: &mut Chapter, all: &[Summary]) {
    chapter.section("Machine", "");
    let mut distinct: Vec<(&Machine, Vec<&str>)> = Vec::new();
    for one in all {
        match distinct.iter_mut().find(|(machine, _)| **machine == one.run.machine) {
            Some((_, names)) => names.push(&one.run.name),
            None => distinct.push((&one.run.machine, vec![&one.run.name])),
        }
    }
    let several = distinct.len() > 1;
    let mut rows = Vec::new();
    for (machine, names) in distinct {
        if several {
            rows.push(row!["chapters", names.join(", ")]);
        }
        let [rustc, c, cxx] = &machine.compilers;
        rows.push(row!["processor", machine.processor.clone()]);
        rows.push(row!["cores", machine.cores.to_string()]);
        rows.push(row!["clock", machine.clock.clone()]);
        rows.push(row!["kernel", machine.kernel.clone()]);
        rows.push(row!["Rust", rustc.clone()]);
        rows.push(row!["C", c.clone()]);
        rows.push(row!["C++", cxx.clone()]);
    }
    chapter.table("machine", &["what", "of this report"], 2, rows);
}

fn targets(chapter: &mut Chapter, all: &[Summary]) {
    chapter.section("What was to be reached", "");
    let targets = || all.iter().flat_map(|one| one.targets.iter().map(move |target| (one.run.name.as_str(), target)));
    let count = |kept: fn(&Judged) -> bool| targets().filter(|(_, target)| kept(target)).count() as u64;
    let reached = chapter.setting("reached", count(|target| target.reached == target.of));
    let by_median = chapter.setting("reached by the value", count(|target| target.by_value == target.of));
    let of = chapter.setting("targets", targets().count() as u64);
    let percent = chapter.setting("confidence, percent", 95);
    chapter.paragraph(&format!(
        "{reached} of {of} targets are reached everywhere, in the sense that the whole {percent} % interval keeps the bound; {by_median} are if the \
         measured value alone counts. A target measured in several places, scenes mostly, is shown where it is worst."
    ));
    let rows = targets().map(|(name, target)| -> Vec<Cell> {
        row![
            format!("[{name}]({name}.md)"),
            target.statement.clone(),
            target.bound.clone(),
            target.measured.clone(),
            target.place.clone(),
            target.verdict.clone(),
            format!("{} of {}", target.reached, target.of),
            format!("{} of {}", target.by_value, target.of)
        ]
    });
    let columns =
        ["chapter", "target", "bound", "measured where worst", "there", "verdict there", "reached", "by the value"];
    chapter.table("targets", &columns, 6, rows.collect());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chapters::figure::Unit;
    use crate::chapters::plan::Plan;
    use crate::chapters::statistics::Estimate;
    use crate::chapters::targets::Targets;

    fn json(name: &str, title: &str, value: f64) -> String {
        let mut targets = Targets::default();
        let estimate = Estimate { value, low: value - 0.01, high: value + 0.01, seeds: 8 };
        targets.at_most("error", "kitchen", estimate, Unit::Ratio, 0.5);
        let mut chapter = Chapter::new(title);
        targets.write_summary(&mut chapter);
        let machine = Machine {
            processor: "Processor 9".to_owned(),
            cores: 2,
            clock: "not readable".to_owned(),
            kernel: "linux 1.2".to_owned(),
            compilers: ["r", "c", "x"].map(str::to_owned),
        };
        let facts = Facts {
            name: name.to_owned(),
            description: "Words".to_owned(),
            sizes: "quick".to_owned(),
            seconds: Some(12.4),
            processor_seconds: Some(20.2),
            date: "2000-01-01".to_owned(),
            other_work: Some(0.314),
            machine,
            kept: (name == "povray").then(|| "2000-01-02".to_owned()),
        };
        facts.add_to(&chapter.json().to_string()).expect("an object")
    }

    #[test]
    fn a_full_run_of_other_things_stands_beside_the_default_one() {
        let entry = CHAPTERS.iter().find(|entry| entry.name == "gradients").expect("a chapter");
        let names = [[true, false], [false, false], [false, true]]
            .map(|[quick, full]| entry.chapter(&Plan::new(quick, full)).0);
        assert_eq!(names, ["gradients", "gradients", "gradients_full"]);
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("gradients.json"), json("gradients", "Short", 0.7)).expect("writable");
        let text = write(folder.path(), "gradients_full", &json("gradients_full", "Long", 0.4)).expect("an index");
        assert!(text.contains("[Short](gradients.md)") && text.contains("[Long](gradients_full.md)"), "{text}");
        assert!(text.contains("[gradients_full](gradients_full.md)"), "its targets too: {text}");
    }

    #[test]
    fn chapters_that_are_not_written_anew_stay_in_the_index() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("povray.json"), json("povray", "Second", 0.7)).expect("writable");
        let text = write(folder.path(), "embree", &json("embree", "First", 0.4)).expect("an index");
        assert!(text.contains("[First](embree.md)") && text.contains("[Second](povray.md)"), "{text}");
        assert!(text.contains("1 of 2 targets are reached everywhere"), "{text}");
        assert!(text.contains("NOT REACHED") && text.contains("| Processor 9"), "{text}");
        assert_eq!(text.matches("Processor 9").count(), 1, "one machine is described once");
        assert!(
            text.contains("| `--quick`, kept (2000-01-02) | 2000-01-01 |"),
            "what was not measured anew says so: {text}"
        );
        assert!(!text.contains("povray_patched.md"), "what is not there is not linked");
        fs::write(folder.path().join("povray_patched.md"), "").expect("writable");
        let text = write(folder.path(), "embree", &json("embree", "First", 0.4)).expect("an index");
        assert!(text.contains("(povray_patched.md)"), "{text}");
        // A chapter from before other work was recorded has a dash there.
        let mut before: Value = serde_json::from_str(&json("povray", "Second", 0.7)).expect("an object");
        let run = before["run"].as_object_mut().expect("an object");
        assert!(run.remove("other_work").is_some() && run.insert("load".to_owned(), json!("3.31")).is_none());
        fs::write(folder.path().join("povray.json"), before.to_string()).expect("writable");
        let text = write(folder.path(), "embree", &json("embree", "First", 0.4)).expect("an index");
        let cells = |title: &str| {
            let row = text.lines().find(|line| line.contains(title)).expect("a row");
            row.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>()
        };
        assert_eq!(cells("[First]")[5], "0.31");
        assert_eq!(cells("[Second]")[5], "-");
        // A chapter from before the index is no reason to fail.
        fs::write(folder.path().join("povray.json"), "{\"tables\": []}").expect("writable");
        assert!(write(folder.path(), "embree", &json("embree", "First", 0.4)).is_ok());
    }
}
