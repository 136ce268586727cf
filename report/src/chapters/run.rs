//! Writing chapters one after the other. Each is complete, with the index, before the next begins.

use super::clock::Clock;
use super::described::Description;
use super::list::{self, Write};
use super::plan::{Extent, Plan};
use super::report::Report;
use super::template::Exists;
use super::{index, json, machine, program, template};
use crate::measure::output::Output;
use crate::measure::progress;
use anyhow::{Context, Result, anyhow, bail};
use clap::Args;
use serde_json::{Value, json};
use std::cell::{OnceCell, RefCell};
use std::path::{Path, PathBuf};
use std::time::Instant;
use xtask::paths;
use xtask::tools::Missing;

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
    let (plan, machine) = (options.plan()?, machine::read());
    let describe = |(name, write)| Ok((name, write, plan.read(name)?));
    let wanted: Vec<Wanted> = list::chapters(&options.only).into_iter().map(describe).collect::<Result<_>>()?;
    let programs: Vec<String> = wanted.iter().flat_map(|(.., of)| &of.programs).cloned().collect();
    if wanted.len() > 1 && !programs.is_empty() {
        println!("building the programs that measure: {}", programs.join(", "));
        // Side by side, for all chapters. What does not compile is said again by the chapter that needs it.
        _ = program::build("--bench", &programs, &plan);
    }
    let bar = progress::bar(wanted.iter().map(|(.., of)| of.seconds).sum())?;
    let (mut failed, mut is_missing) = (Vec::new(), true);
    for (number, one @ (name, _, description)) in (1..).zip(&wanted) {
        bar.set_message(format!("chapter {number} of {}: {name}", wanted.len()));
        // The others do not depend on it.
        if let Err(error) = write_one(one, &plan, &folder, &machine) {
            is_missing &= error.is::<Missing>();
            failed.push(format!("{name}: {error:#}"));
        }
        bar.inc(description.seconds);
    }
    bar.finish_and_clear();
    if !failed.is_empty() {
        let why = format!("failed, and left as they were:\n{}", failed.join("\n"));
        // An error that says what is missing stays one.
        return Err(if is_missing { Missing(why).into() } else { anyhow!(why) });
    }
    let seconds = start.elapsed().as_secs_f64();
    println!("report: {} (made in {seconds:.0} s)", folder.display());
    Ok(())
}

/// A chapter that was asked for.
type Wanted = (&'static str, Write, Description);

/// One chapter and the index, both or neither. Beside what was measured its JSON says how it came about: seconds are
/// without compiling; what the system does not say is null.
fn write_one((name, write, description): &Wanted, plan: &Plan, folder: &Path, machine: &Value) -> Result<()> {
    let (output, date) = (Output::new(folder)?, machine::date());
    let names @ [name, _, about] = description.names(name, plan);
    let earlier = OnceCell::new();
    let report = Report { names, description, plan, output: &output, clock: Clock::start(), earlier };
    let mut chapter = write(&report)?.json();
    chapter["run"] = json!({
        "name": name,
        "description": about,
        "sizes": plan.name(),
        "seconds": report.clock.seconds(),
        "processor_seconds": report.clock.processor_seconds(),
        "other_work": report.clock.other_work(),
        "date": date,
        "machine": machine,
    });
    if let (Some(run), Some(earlier)) =
        (chapter["run"].as_object_mut(), report.earlier.get().and_then(Value::as_object))
    {
        run.extend(earlier.clone());
    }
    let former = write_new(&output, name, &chapter)?;
    output.write_text("README.md", &index::write(folder, Some((name, &chapter)))?)?;
    output.commit(&former)
}

/// A chapter that was measured, with the pictures that were made of it; those that it shows otherwise and now has not.
fn write_new(output: &Output, name: &str, chapter: &Value) -> Result<Vec<String>> {
    let (pictures, former) = (output.names()?, RefCell::new(Vec::new()));
    let exists = |file: &str| {
        let is_new = pictures.iter().any(|picture| picture == file);
        former.borrow_mut().extend((!is_new).then(|| file.to_owned()));
        is_new
    };
    write_chapter(output, name, chapter, &exists)?;
    Ok(former.into_inner())
}

/// NAME.json and NAME.md.
pub(crate) fn write_chapter(output: &Output, name: &str, chapter: &Value, exists: Exists) -> Result<()> {
    output.write_text(&format!("{name}.md"), &template::chapter(name, chapter, exists)?)?;
    output.write_text(&format!("{name}.json"), &json::written(chapter))
}

/// The texts of all chapters that are there, and the index.
fn render(folder: &Path) -> Result<()> {
    let output = Output::new(folder)?;
    for path in paths::list(folder)? {
        let Some(name) = path.file_name().and_then(|name| name.to_str()?.strip_suffix(".json")) else { continue };
        let chapter = paths::json(&path)?;
        write_chapter(&output, name, &chapter, &|file| folder.join(file).exists())?;
    }
    output.write_text("README.md", &index::write(folder, None)?)?;
    output.commit(&[])
}

/// Steps of the tests, quick chapters: whether they can be measured, and their templates show every table.
pub(crate) fn check(step: &str) -> Result<()> {
    let chapters = match step {
        "chapters" => &list::ALONE[..],
        "python" => &["python", "integration", "training"],
        _ => &[step],
    };
    let scratch = tempfile::tempdir().context("cannot create a temporary folder")?;
    let folder = scratch.path().join("report");
    let only = chapters.iter().map(|&chapter| chapter.to_owned()).collect();
    run(&Options { quick: true, only, out: Some(folder.clone()), ..Options::default() })?;
    let index = paths::read(folder.join("README.md"))?;
    for chapter in chapters {
        let text = paths::read(folder.join(format!("{chapter}.md")))?;
        if !text.contains("\n| ") || !index.contains(&format!("]({chapter}.md)")) {
            bail!("{chapter}.md has no table, or the index does not link it");
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn pictures_of_an_earlier_run_go() -> Result<()> {
        let scratch = tempfile::tempdir()?;
        let folder = scratch.path().join("report");
        let has = |name: &str| folder.join(format!("gradients-{name}.svg")).exists();
        let chapter = json!({"title": "Gradients", "run": {"name": "gradients"}});
        for pictures in [&["digits-time", "mnist-time"][..], &["digits-time"]] {
            let output = Output::new(&folder)?;
            pictures.iter().try_for_each(|name| output.write_text(&format!("gradients-{name}.svg"), ""))?;
            let former = write_new(&output, "gradients", &chapter)?;
            output.commit(&former)?;
            assert!(has("digits-time") && has("mnist-time") == (pictures.len() == 2), "{former:?}");
        }
        assert!(!fs::read_to_string(folder.join("gradients.md"))?.contains("mnist-time"));
        Ok(())
    }
}
