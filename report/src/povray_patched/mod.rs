//! `cargo xtask povray`: POV-Ray, built from Debian's source package with a patch that draws its samples from
//! noisefloor; checked, and compared with POV-Ray as it is.

mod checks;
mod measure;
mod render;
mod report;
mod scenes;
mod sheet;

use crate::measure::output::Output;
use anyhow::{Context, Result, bail};
use clap::Args;
use std::path::PathBuf;
use std::time::Instant;
use xtask::{library, paths, run, tools};

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
    #[arg(long, conflicts_with = "out")]
    report: bool,
    /// Where they go otherwise [default: target/povray/pictures]
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
    let programs = render::Programs { stock: PathBuf::from("/usr/bin/povray"), patched: build()? };
    let renderer = render::Renderer::new(&programs, &folder(), options.width, options.height())?;
    let checks = checks::run(&renderer)?;
    if options.check {
        return Ok(());
    }
    let measured = measure::run(&renderer, options)?;
    let pictures = || options.out.clone().unwrap_or_else(|| folder().join("pictures"));
    let out = if options.report { paths::root().join("docs/report") } else { pictures() };
    let output = Output::new(&std::path::absolute(&out).with_context(|| format!("{} is no folder", out.display()))?)?;
    report::write(&output, options, &checks, &measured)?;
    output.commit()?;
    println!("{}", out.display());
    println!("{:.0} s", start.elapsed().as_secs_f64());
    Ok(())
}

/// Builds what has changed since it was last called, and returns the program.
fn build() -> Result<PathBuf> {
    let packages = [
        tools::Package { name: "povray", file: "/usr/bin/povray" },
        tools::Package { name: "povray-includes", file: "/usr/share/povray-3.7/include/colors.inc" },
        tools::Package { name: "dpkg-dev", file: "/usr/bin/dpkg-source" },
        tools::Package { name: "patch", file: "/usr/bin/patch" },
        tools::Package { name: "make", file: "/usr/bin/make" },
    ];
    if let Some(missing) = tools::packages(&packages)? {
        bail!(missing);
    }
    println!("building the C library");
    let archive = library::build()?;
    run::check(run::command("sh").arg(ours().join("build.sh")).arg(folder()).arg(archive))?;
    Ok(folder().join("source/unix/povray"))
}
