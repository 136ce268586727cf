//! Writing chapters one after the other. Each is complete, with the index, before the next begins.

use super::clock::Clock;
use super::index::{self, Facts};
use super::machine::{self, Machine};
use super::plan::Plan;
use super::{CHAPTERS, Entry, Options, Report, json, program, template};
use crate::measure::output::Output;
use crate::measure::progress;
use anyhow::{Context, Result, bail};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::time::Instant;
use xtask::paths;

pub(crate) fn run(options: &Options) -> Result<()> {
    let start = Instant::now();
    let folder = options.out.clone().unwrap_or_else(|| paths::root().join("docs/report"));
    let folder = std::path::absolute(&folder).with_context(|| format!("{} is no folder", folder.display()))?;
    if options.render {
        return render(&folder);
    }
    let wanted: Vec<&Entry> = CHAPTERS
        .iter()
        .filter(|entry| options.only.is_empty() || options.only.iter().any(|o| o == entry.name))
        .collect();
    let machine = Machine::read();
    let programs: Vec<&str> = wanted.iter().flat_map(|entry| entry.programs).copied().collect();
    if wanted.len() > 1 && !programs.is_empty() {
        println!("building the programs that measure: {}", programs.join(", "));
        // Side by side, for all chapters. What does not compile is said again by the chapter that needs it.
        _ = program::build(&programs, &Plan::new(options.quick, options.full));
    }
    let bar = progress::bar(wanted.iter().map(|entry| entry.seconds).sum())?;
    let (mut written, mut failed) = (Vec::new(), Vec::new());
    for (number, entry) in (1..).zip(&wanted) {
        bar.set_message(format!("chapter {number} of {}: {}", wanted.len(), entry.name));
        match write(entry, options, &folder, &machine) {
            Ok(()) => written.push(entry.name),
            // The others do not depend on it.
            Err(error) => failed.push(format!("{}: {error:#}", entry.name)),
        }
        bar.inc(entry.seconds);
    }
    bar.finish_and_clear();
    if !failed.is_empty() {
        bail!("written: {}; failed, and left as they were:\n{}", written.join(", "), failed.join("\n"));
    }
    let seconds = start.elapsed().as_secs_f64();
    println!("report: {} ({seconds:.0} s, compiling included)", folder.display());
    Ok(())
}

/// One chapter and the index, both or neither.
fn write(entry: &Entry, options: &Options, folder: &Path, machine: &Machine) -> Result<()> {
    let output = Output::new(folder)?;
    let date = machine::date();
    let plan = Plan::new(options.quick, options.full);
    let (name, description) = entry.chapter(&plan);
    let report = Report { name, programs: entry.programs, plan, output: &output, clock: Clock::start() };
    let mut chapter = (entry.write)(&report)?.json();
    let facts = Facts {
        name: name.to_owned(),
        description: description.to_owned(),
        sizes: report.plan.name().to_owned(),
        seconds: Some(report.clock.seconds()),
        processor_seconds: report.clock.processor_seconds(),
        other_work: report.clock.other_work(),
        date,
        machine: machine.clone(),
    };
    chapter["run"] = json!(facts);
    write_chapter(&output, name, &chapter)?;
    output.write_text("README.md", &index::write(folder, Some((name, &chapter)))?)?;
    output.commit()
}

/// NAME.json and NAME.md, beside the plots that were written before.
pub(crate) fn write_chapter(output: &Output, name: &str, chapter: &Value) -> Result<()> {
    let plots = output.names()?;
    let text = template::chapter(name, chapter, &|file| plots.iter().any(|plot| plot == file))?;
    output.write_text(&format!("{name}.md"), &text)?;
    output.write_text(&format!("{name}.json"), &json::written(chapter))
}

/// The texts of all chapters that are there, and the index.
fn render(folder: &Path) -> Result<()> {
    let output = Output::new(folder)?;
    for entry in fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))? {
        let path = entry?.path();
        let Some(name) = path.file_name().and_then(|name| name.to_str()?.strip_suffix(".json")) else { continue };
        let chapter: Value = serde_json::from_str(&fs::read_to_string(&path)?).with_context(|| name.to_owned())?;
        let text = template::chapter(name, &chapter, &|file| folder.join(file).exists())?;
        output.write_text(&format!("{name}.md"), &text)?;
        output.write_text(&format!("{name}.json"), &json::written(&chapter))?;
    }
    output.write_text("README.md", &index::write(folder, None)?)?;
    output.commit()
}

/// Quick chapters: whether they can be measured, and their templates show every table.
pub(crate) fn check_quick(chapters: &[&str]) -> Result<()> {
    let scratch = tempfile::tempdir().context("cannot create a temporary folder")?;
    let folder = scratch.path().join("report");
    let only = chapters.iter().map(|&chapter| chapter.to_owned()).collect();
    run(&Options { quick: true, only, out: Some(folder.clone()), ..Options::default() })?;
    let index = fs::read_to_string(folder.join("README.md")).context("there is no index")?;
    for chapter in chapters {
        let text = fs::read_to_string(folder.join(format!("{chapter}.md"))).context("a chapter has no text")?;
        if !text.contains("\n| ") || !index.contains(&format!("]({chapter}.md)")) {
            bail!("{chapter}.md has no table, or the index does not link it");
        }
    }
    Ok(())
}
