//! `cargo xtask povray`: POV-Ray, built from Debian's source package with a patch that draws its samples from
//! noisefloor; checked, and compared with POV-Ray as it is.

mod apt;
mod build;
mod checks;
mod measure;
mod patch;
mod refusals;
mod render;
mod report;
mod scenes;
mod sheet;

use crate::measure::interrupt;
use crate::measure::output::Output;
use anyhow::{Context, Result, bail};
use clap::Args;
use std::path::{Path, PathBuf};
use std::time::Instant;
use xtask::paths;

pub(crate) use patch::check as check_patch;

#[derive(Args)]
pub(crate) struct Options {
    /// Samples per pixel; square numbers, because POV-Ray's area lights are grids
    #[arg(long, value_delimiter = ',', default_values_t = [16, 64])]
    spp: Vec<u32>,
    /// Pictures of each kind, from which medians are taken
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=16))]
    seeds: u32,
    /// Pixels in a row; rows are three quarters as many
    #[arg(long, default_value_t = 160, value_parser = clap::value_parser!(u32).range(64..=1024))]
    width: u32,
    /// Samples per pixel of each half of a reference
    #[arg(long, default_value_t = 1024, value_parser = clap::value_parser!(u32).range(16..=65536))]
    reference: u32,
    /// Build and check only
    #[arg(long)]
    check: bool,
    /// Write docs/report/povray_patched.md, .json and .png
    #[arg(long)]
    report: bool,
    /// Where everything else goes [default: target/povray/pictures]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Options {
    fn height(&self) -> u32 {
        self.width * 3 / 4
    }
}

/// Where sources, the build and pictures go.
fn folder() -> PathBuf {
    paths::target().join("povray")
}

/// What is written by us for this build.
fn ours() -> PathBuf {
    paths::root().join("tests/povray/patched")
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let start = Instant::now();
    for spp in &options.spp {
        if scenes::side(*spp).is_none() {
            bail!("--spp {spp} is no square number from 4 to 1024: POV-Ray's area lights are square grids of samples");
        }
    }
    let interrupted = interrupt::catch()?;
    let programs = render::Programs { stock: PathBuf::from("/usr/bin/povray"), patched: build::build()? };
    let renderer = render::Renderer::new(&programs, &folder(), options.width, options.height(), &interrupted)?;
    let checks = checks::run(&renderer)?;
    if options.check {
        return Ok(());
    }
    let measured = measure::run(&renderer, options)?;
    let out = options.out.clone().unwrap_or_else(|| folder().join("pictures"));
    let out = std::path::absolute(&out).with_context(|| format!("{} is no folder", out.display()))?;
    write(&out, |output| {
        measured.write_pictures(output)?;
        report::write(output, options, &checks, &measured)
    })?;
    println!("{}", out.display());
    if options.report {
        let docs = paths::root().join("docs/report");
        write(&docs, |output| report::write(output, options, &checks, &measured))?;
        println!("{}", docs.join("povray_patched.md").display());
    }
    println!("{:.0} s", start.elapsed().as_secs_f64());
    Ok(())
}

/// Writes all files or none.
fn write(folder: &Path, fill: impl FnOnce(&Output) -> Result<()>) -> Result<()> {
    let output = Output::new(folder)?;
    fill(&output)?;
    output.commit()
}
