//! `cargo xtask report`: errors, times and overheads on the scenes of the thesis's figures, as tables, plots and pictures
//! that can be held beside them, and as JSON.

pub(crate) mod chapter;
pub(crate) mod check;
mod embree;
pub(crate) mod figure;
mod measurement;
pub(crate) mod pictures;
mod plan;
mod povray;
mod scenes;
pub(crate) mod statistics;
mod tables;

use crate::measure::interrupt::{self, Interrupted};
use crate::measure::output::Output;
use crate::paths;
use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use plan::Plan;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Args)]
pub(crate) struct Options {
    /// Tiny images and few seeds, for tests: whether everything works, not the figures
    #[arg(long)]
    quick: bool,
    /// Larger images and more seeds: narrower intervals, about ten times as long
    #[arg(long, conflicts_with = "quick")]
    full: bool,
    /// One chapter instead of all
    #[arg(long, value_enum)]
    only: Option<Part>,
    /// Where everything goes [default: docs/report, and the large pictures target/report]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// A program with the harness's command line, instead of the one that is built
    #[arg(long, value_name = "FILE", hide = true)]
    program: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Embree's intersector: the scenes of the thesis's chapters 4 and 5
    Embree,
    /// POV-Ray's pictures as integrands
    Povray,
}

/// What a chapter needs.
pub(crate) struct Report<'a> {
    pub(crate) plan: Plan,
    pub(crate) program: Option<PathBuf>,
    pub(crate) interrupted: Interrupted,
    /// Markdown, JSON, plots, small pictures.
    pub(crate) output: &'a Output,
    /// EXR and full pictures.
    pub(crate) large: &'a Output,
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let start = Instant::now();
    let folder = |given: Option<PathBuf>, default: PathBuf| -> Result<PathBuf> {
        let folder = given.unwrap_or(default);
        std::path::absolute(&folder).with_context(|| format!("{} is no folder", folder.display()))
    };
    let small = folder(options.out.clone(), paths::root().join("docs/report"))?;
    // Beside the folder that was asked for, because it does not exist before all is done.
    let beside = options.out.as_ref().map(|out| out.with_extension("pictures"));
    let large = folder(beside, paths::target().join("report"))?;
    let interrupted = interrupt::catch()?;
    let (output, pictures) = (Output::new(&small)?, Output::new(&large)?);
    let chapters = [(Part::Embree, embree::write as fn(&Report) -> Result<()>), (Part::Povray, povray::write)];
    let report = Report {
        plan: Plan::new(options.quick, options.full),
        program: options.program.clone(),
        interrupted: interrupted.clone(),
        output: &output,
        large: &pictures,
    };
    for (_, write) in chapters.into_iter().filter(|(part, _)| options.only.is_none_or(|only| only == *part)) {
        write(&report)?;
    }
    interrupt::check(&interrupted)?;
    output.commit()?;
    pictures.commit()?;
    println!(
        "report: {}; large pictures: {} ({:.0} s)",
        small.display(),
        large.display(),
        start.elapsed().as_secs_f64()
    );
    Ok(())
}

/// Pictures of the report are smaller, so that they can be committed.
const LARGEST_PICTURE: u64 = 600_000;

/// A quick report, and whether all that its text quotes and shows is there.
pub(crate) fn check_quick() -> Result<()> {
    let scratch = tempfile::tempdir().context("cannot create a temporary folder")?;
    let folder = scratch.path().join("report");
    run(&Options { quick: true, full: false, only: Some(Part::Embree), out: Some(folder.clone()), program: None })?;
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).with_context(|| format!("there is no {name}"));
    let text = read("embree.md")?;
    check::numbers_are_recorded(&text, &read("embree.json")?)?;
    let pictures = text.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(name, _)| name);
    for name in pictures {
        let bytes = std::fs::metadata(folder.join(name)).with_context(|| format!("there is no {name}"))?.len();
        if bytes == 0 || bytes > LARGEST_PICTURE {
            bail!("{name} has {bytes} bytes");
        }
    }
    Ok(())
}
