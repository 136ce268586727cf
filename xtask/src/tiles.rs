//! The tiles in `core/tiles`, made by `fsot` from their presets.

use crate::{paths, run};
use anyhow::{Context, Result, bail};
use clap::Args;
use serde::Deserialize;
use std::fs;
use std::path::{Path, PathBuf};

/// What `cargo xtask tiles` is asked for.
#[derive(Args)]
pub(crate) struct Options {
    /// Which tiles, such as 64_1SPP_2D [default: all]
    names: Vec<String>,
    /// Make them elsewhere, and fail if a byte differs from those in core/tiles
    #[arg(long)]
    check: bool,
    /// Threads to work on [default: one per core]
    #[arg(long)]
    threads: Option<usize>,
}

#[derive(Deserialize)]
struct Presets {
    presets: Vec<String>,
}

#[derive(Deserialize)]
struct Info {
    bytes: u64,
    sidecar: Option<Sidecar>,
}

#[derive(Deserialize)]
struct Sidecar {
    quality: Quality,
}

#[derive(Deserialize)]
struct Quality {
    energy: Vec<Row>,
    #[serde(default)]
    marginal: Vec<Row>,
    #[serde(default)]
    temporal: Vec<Row>,
}

#[derive(Deserialize)]
struct Row {
    spp: u32,
    axes: Option<[u32; 2]>,
    alpha: Option<f64>,
    filtered: [f64; 2],
    raw: [f64; 2],
}

/// Makes the tiles, or checks them, and prints what they are worth.
pub(crate) fn run(options: &Options) -> Result<()> {
    let program = build()?;
    let names = names(&program, &options.names)?;
    let elsewhere = tempfile::tempdir().context("no temporary folder")?;
    let shipped = paths::root().join("core/tiles");
    let folder = if options.check { elsewhere.path() } else { &shipped };
    let mut table = String::from("half-spaces / Gaussians, error energy relative to white noise\n");
    let mut different = Vec::new();
    for name in &names {
        let path = folder.join(format!("{name}.nft"));
        eprintln!("{name}");
        let mut command = run::command(&program);
        command.args(["tile", "--preset", name, "--quiet", "--out"]).arg(&path);
        if let Some(threads) = options.threads {
            command.arg("--threads").arg(threads.to_string());
        }
        run::check(&mut command)?;
        describe(&program, name, &path, &mut table)?;
        if options.check {
            for file in [format!("{name}.nft"), format!("{name}.toml")] {
                let read = |folder: &Path| fs::read(folder.join(&file));
                if read(&shipped).ok() != read(folder).ok() {
                    different.push(file);
                }
            }
        }
    }
    print!("{table}");
    if !different.is_empty() {
        bail!("not what is made now: {}. `cargo xtask tiles` writes them anew", different.join(", "));
    }
    Ok(())
}

/// The program, optimised.
fn build() -> Result<PathBuf> {
    run::check(run::cargo().args(["build", "--quiet", "--profile", "fsot", "--package", "noisefloor-fsot"]))?;
    Ok(paths::target().join("fsot/fsot").with_extension(std::env::consts::EXE_EXTENSION))
}

fn names(program: &Path, wanted: &[String]) -> Result<Vec<String>> {
    let list = run::read(run::command(program).args(["info", "--json"]))?;
    let Presets { presets } = serde_json::from_str(&list).context("fsot info --json is not as expected")?;
    if let Some(unknown) = wanted.iter().find(|name| !presets.contains(name)) {
        bail!("there is no tile {unknown}; there are {}", presets.join(", "));
    }
    Ok(if wanted.is_empty() { presets } else { wanted.to_vec() })
}

fn describe(program: &Path, name: &str, path: &Path, table: &mut String) -> Result<()> {
    let json = run::read(run::command(program).args(["info", "--json"]).arg(path))?;
    let info: Info = serde_json::from_str(&json).context("fsot info --json is not as expected")?;
    table.push_str(&format!("{name}, {} bytes\n", info.bytes));
    let Some(Sidecar { quality }) = info.sidecar else { bail!("{name} has no sidecar") };
    for row in quality.energy.iter().chain(&quality.marginal).chain(&quality.temporal) {
        let axes = row.axes.map_or(String::new(), |[a, b]| format!(", dims {a} and {b}"));
        let alpha = row.alpha.map_or(String::new(), |alpha| format!(", after EMA {alpha}"));
        let case = format!("{} spp{axes}{alpha}", row.spp);
        let ([a, b], [c, d]) = (row.filtered, row.raw);
        table.push_str(&format!("  {case:<28}filtered {a:<8} / {b:<10} raw {c:<8} / {d}\n"));
    }
    Ok(())
}
