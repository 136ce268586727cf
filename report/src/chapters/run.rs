//! Writing chapters one after the other. Each is complete, with the index, before the next begins.

use super::clock::Clock;
use super::index::{self, Facts};
use super::machine::{self, Machine};
use super::measured;
use super::plan::Plan;
use super::{CHAPTERS, Entry, Options, Report, check, program};
use crate::measure::interrupt::{self, Interrupted};
use crate::measure::output::{self, Output};
use crate::measure::progress;
use anyhow::{Context, Result, bail};
use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Instant;
use xtask::paths;

/// Where a run writes.
struct Folders {
    /// Markdown, JSON, plots, small pictures.
    small: PathBuf,
    /// EXR and full pictures.
    large: PathBuf,
}

impl Folders {
    fn new(options: &Options) -> Result<Self> {
        let folder = |given: Option<PathBuf>, default: PathBuf| -> Result<PathBuf> {
            let folder = given.unwrap_or(default);
            std::path::absolute(&folder).with_context(|| format!("{} is no folder", folder.display()))
        };
        // Beside the folder that was asked for, because it does not exist before all is done.
        let beside = options.out.as_ref().map(|out| out.with_extension("pictures"));
        Ok(Self {
            small: folder(options.out.clone(), paths::root().join("docs/report"))?,
            large: folder(beside, paths::target().join("report"))?,
        })
    }
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let start = Instant::now();
    let folders = Folders::new(options)?;
    let interrupted = interrupt::catch()?;
    let wanted: Vec<&Entry> = CHAPTERS
        .iter()
        .filter(|entry| options.only.is_empty() || options.only.iter().any(|o| o == entry.name))
        .collect();
    let machine = Machine::read();
    let programs: Vec<&str> = wanted.iter().flat_map(|entry| entry.programs).copied().collect();
    if wanted.len() > 1 && !programs.is_empty() && !options.reuse {
        println!("building the programs that measure: {}", programs.join(", "));
        // Side by side, for all chapters. What does not compile is said again by the chapter that needs it.
        _ = program::build(&programs, &Plan::new(options.quick, options.full));
    }
    let bar = progress::bar(wanted.iter().map(|entry| entry.seconds).sum())?;
    let (mut written, mut failed) = (Vec::new(), Vec::new());
    for (number, entry) in (1..).zip(&wanted) {
        bar.set_message(format!("chapter {number} of {}: {}", wanted.len(), entry.name));
        match write(entry, options, &folders, &machine, &interrupted) {
            Ok(()) => written.push(entry.name),
            Err(_) if interrupted.load(Ordering::Relaxed) => {
                bar.finish_and_clear();
                bail!(
                    "interrupted in chapter {}; {} before",
                    entry.name,
                    say(&written, "written", "nothing was written")
                );
            }
            // The others do not depend on it.
            Err(error) => failed.push(format!("{}: {error:#}", entry.name)),
        }
        bar.inc(entry.seconds);
    }
    bar.finish_and_clear();
    let seconds = start.elapsed().as_secs_f64();
    if !failed.is_empty() {
        bail!(
            "{}; failed, and left as they were:\n{}",
            say(&written, "written", "no chapter was written"),
            failed.join("\n")
        );
    }
    println!(
        "report: {}; large pictures: {} ({seconds:.0} s, compiling included)",
        folders.small.display(),
        folders.large.display()
    );
    Ok(())
}

fn say(names: &[&str], done: &str, nothing: &str) -> String {
    if names.is_empty() { nothing.to_owned() } else { format!("{done}: {}", names.join(", ")) }
}

/// One chapter and the index, both or neither.
fn write(
    entry: &Entry,
    options: &Options,
    folders: &Folders,
    machine: &Machine,
    interrupted: &Interrupted,
) -> Result<()> {
    let (output, large) = (Output::new(&folders.small)?, Output::new(&folders.large)?);
    let date = machine::date();
    let plan = Plan::new(options.quick, options.full);
    let (name, description) = entry.chapter(&plan);
    let report = Report {
        name,
        programs: entry.programs,
        plan,
        program: options.program.clone(),
        interrupted: interrupted.clone(),
        output: &output,
        large: &large,
        clock: Clock::start(),
        reuse: options.reuse,
        reused: Cell::new(false),
    };
    (entry.write)(&report)?;
    interrupt::check(interrupted)?;
    let facts = Facts {
        name: name.to_owned(),
        description: description.to_owned(),
        sizes: report.plan.name().to_owned(),
        seconds: Some(report.clock.seconds()),
        processor_seconds: report.clock.processor_seconds(),
        other_work: report.clock.other_work(),
        date,
        machine: machine.clone(),
        kept: None,
    };
    let facts = if report.reused.get() { measured::earlier_run(facts)? } else { facts };
    let [text, json] = ["md", "json"].map(|end| format!("{name}.{end}"));
    let completed = facts.add_to(&output.read_text(&json)?).with_context(|| format!("{json} is damaged"))?;
    check::numbers_are_recorded(&output.read_text(&text)?, &completed).with_context(|| text.clone())?;
    output.write_text(&json, &completed)?;
    output.write_text("README.md", &index::write(&folders.small, name, &completed)?)?;
    output::commit_together([output, large])?;
    if facts.kept.is_none() { measured::keep_run(&facts) } else { Ok(()) }
}

/// Pictures of the report are smaller, so that they can be committed.
const LARGEST_PICTURE: u64 = 600_000;

/// Quick chapters, and whether all that their texts quote and show is there.
pub(crate) fn check_quick(chapters: &[&str]) -> Result<()> {
    let scratch = tempfile::tempdir().context("cannot create a temporary folder")?;
    let folder = scratch.path().join("report");
    let only = chapters.iter().map(|&chapter| chapter.to_owned()).collect();
    run(&Options { quick: true, full: false, only, out: Some(folder.clone()), program: None, reuse: false })?;
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).with_context(|| format!("there is no {name}"));
    let index = read("README.md")?;
    for chapter in chapters {
        let text = read(&format!("{chapter}.md"))?;
        check::numbers_are_recorded(&text, &read(&format!("{chapter}.json"))?)
            .with_context(|| format!("{chapter}.md"))?;
        if !index.contains(&format!("]({chapter}.md)")) {
            bail!("the index does not link {chapter}.md");
        }
        pictures_are_there(&text, &folder)?;
    }
    Ok(())
}

fn pictures_are_there(text: &str, folder: &Path) -> Result<()> {
    let links = text.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(name, _)| name);
    // Links to other chapters are not looked for: not every run writes them.
    for name in links.filter(|name| name.ends_with(".svg") || name.ends_with(".png")) {
        let bytes = std::fs::metadata(folder.join(name)).with_context(|| format!("there is no {name}"))?.len();
        if bytes == 0 || bytes > LARGEST_PICTURE {
            bail!("{name} has {bytes} bytes; at most {LARGEST_PICTURE} are meant to be committed");
        }
    }
    Ok(())
}
