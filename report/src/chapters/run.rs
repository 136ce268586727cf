//! Writing chapters one after the other. Each is complete, with the index, before the next begins.

use super::clock::Clock;
use super::described::Description;
use super::index::{self, Facts};
use super::list::{self, Write};
use super::machine::{self, Machine};
use super::plan::{Extent, Plan};
use super::report::Report;
use super::{json, program, template};
use crate::measure::output::Output;
use crate::measure::progress;
use anyhow::{Context, Result, bail};
use clap::Args;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;
use xtask::paths;

#[derive(Args, Default)]
pub(crate) struct Options {
    /// Tiny images and few seeds, for tests: whether everything works, not the figures
    #[arg(long)]
    quick: bool,
    /// Larger images, finer grids and more seeds: narrower intervals, and much longer
    #[arg(long, conflicts_with = "quick")]
    full: bool,
    /// These chapters instead of all, separated by commas; the others stay as they are, in the index too
    #[arg(long, value_name = "CHAPTER", value_delimiter = ',', value_parser = list::names())]
    only: Vec<String>,
    /// Where everything goes [default: docs/report]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Only write the texts anew, from the JSON files that are there
    #[arg(long, conflicts_with_all = ["quick", "full", "only"])]
    render: bool,
}

impl Options {
    /// The trainers alone, for the demo.
    pub(crate) fn gradients(quick: bool, folder: &Path) -> Self {
        Self { quick, only: vec!["gradients".to_owned()], out: Some(folder.to_owned()), ..Self::default() }
    }

    fn plan(&self) -> Result<Plan> {
        Plan::new(match (self.quick, self.full) {
            (true, _) => Extent::Quick,
            (_, true) => Extent::Full,
            _ => Extent::Default,
        })
    }
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let start = Instant::now();
    let folder = options.out.clone().unwrap_or_else(|| paths::root().join("docs/report"));
    let folder = std::path::absolute(&folder).with_context(|| format!("{} is no folder", folder.display()))?;
    if options.render {
        return render(&folder);
    }
    let (plan, machine) = (options.plan()?, Machine::read());
    let describe = |(name, write)| Ok((name, write, Description::read(name, &plan)?));
    let wanted: Vec<(&str, Write, Description)> =
        list::chapters(&options.only).into_iter().map(describe).collect::<Result<_>>()?;
    let programs: Vec<String> = wanted.iter().flat_map(|(.., of)| &of.programs).cloned().collect();
    if wanted.len() > 1 && !programs.is_empty() {
        println!("building the programs that measure: {}", programs.join(", "));
        // Side by side, for all chapters. What does not compile is said again by the chapter that needs it.
        _ = program::build(&programs, &plan);
    }
    let bar = progress::bar(wanted.iter().map(|(.., of)| of.seconds).sum())?;
    let (mut written, mut failed) = (Vec::new(), Vec::new());
    for (number, (name, write, description)) in (1..).zip(&wanted) {
        bar.set_message(format!("chapter {number} of {}: {name}", wanted.len()));
        match write_one(name, *write, description, &plan, &folder, &machine) {
            Ok(()) => written.push(*name),
            // An error that says what is missing stays one.
            Err(error) if wanted.len() == 1 => return Err(error),
            // The others do not depend on it.
            Err(error) => failed.push(format!("{name}: {error:#}")),
        }
        bar.inc(description.seconds);
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
fn write_one(
    name: &str,
    write: Write,
    description: &Description,
    plan: &Plan,
    folder: &Path,
    machine: &Machine,
) -> Result<()> {
    let (output, date) = (Output::new(folder)?, machine::date());
    let names = description.names(name, plan);
    let report = Report { names, description, plan, output: &output, clock: Clock::start() };
    let mut chapter = write(&report)?.json();
    let [name, _, about] = names.map(str::to_owned);
    chapter["run"] = json!(Facts {
        name: name.clone(),
        description: about,
        sizes: plan.name().to_owned(),
        seconds: Some(report.clock.seconds()),
        processor_seconds: report.clock.processor_seconds(),
        other_work: report.clock.other_work(),
        date,
        machine: machine.clone(),
    });
    write_chapter(&output, &name, &chapter)?;
    output.write_text("README.md", &index::write(folder, Some((&name, &chapter)))?)?;
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
