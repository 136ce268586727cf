//! The tiles in `core/tiles`, made by `fsot` from their presets.

use crate::{paths, run};
use anyhow::{Context, Result, bail};
use clap::Args;
use serde::Deserialize;
use std::fs;
use std::path::{Path, PathBuf};

/// What `cargo xtask tiles` is asked for.
#[derive(Args)]
pub struct Options {
    /// Which tiles, such as 64_1SPP_2D [default: all]
    names: Vec<String>,
    /// Make them elsewhere, and fail if a byte differs from those in core/tiles, or a sidecar says another thing
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

/// Without the version, which need not change a tile.
#[derive(Deserialize)]
struct Sidecar {
    command: String,
    seed: u64,
    kernel: String,
    iterations: u64,
    sha256: String,
    quality: Quality,
}

#[derive(Deserialize)]
struct Quality {
    integrands: u64,
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
    perceptual: [f64; 2],
    raw: [f64; 2],
}

impl Quality {
    fn rows(&self) -> impl Iterator<Item = &Row> {
        self.energy.iter().chain(&self.marginal).chain(&self.temporal)
    }
}

/// What a measured energy may differ by, relatively: its last digits depend on the Fourier transform.
const TOLERANCE: f64 = 0.02;

/// Makes the tiles, or checks them, and prints what they are worth.
pub fn run(options: &Options) -> Result<()> {
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
        let made = info(&program, &path)?;
        describe(name, &made, &mut table);
        if options.check {
            let shipped = shipped.join(format!("{name}.nft"));
            if fs::read(&shipped).ok() != Some(fs::read(&path)?) {
                different.push(format!("{name}.nft"));
            } else if !same(&info(&program, &shipped)?.sidecar, &made.sidecar) {
                different.push(format!("{name}.toml"));
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

/// What a tile's file and its sidecar say.
struct Made {
    bytes: u64,
    sidecar: Sidecar,
}

fn info(program: &Path, path: &Path) -> Result<Made> {
    let json = run::read(run::command(program).args(["info", "--json"]).arg(path))?;
    let Info { bytes, sidecar } = serde_json::from_str(&json).context("fsot info --json is not as expected")?;
    let sidecar = sidecar.with_context(|| format!("{} has no sidecar that describes it", path.display()))?;
    Ok(Made { bytes, sidecar })
}

/// Whether two sidecars say the same, but for the version and the last digits of what was measured.
fn same(a: &Sidecar, b: &Sidecar) -> bool {
    a.command == b.command
        && a.seed == b.seed
        && a.kernel == b.kernel
        && a.sha256 == b.sha256
        && a.iterations == b.iterations
        && a.quality.integrands == b.quality.integrands
        && a.quality.rows().count() == b.quality.rows().count()
        && a.quality.rows().zip(b.quality.rows()).all(|(a, b)| close(a, b))
}

fn close(a: &Row, b: &Row) -> bool {
    let energies = |row: &Row| [row.filtered, row.perceptual, row.raw].concat();
    (a.spp, a.axes, a.alpha) == (b.spp, b.axes, b.alpha)
        && energies(a).iter().zip(energies(b)).all(|(a, b)| (a - b).abs() <= TOLERANCE * a.abs())
}

fn describe(name: &str, made: &Made, table: &mut String) {
    table.push_str(&format!("{name}, {} bytes\n", made.bytes));
    for row in made.sidecar.quality.rows() {
        let axes = row.axes.map_or(String::new(), |[a, b]| format!(", dims {a} and {b}"));
        let alpha = row.alpha.map_or(String::new(), |alpha| format!(", after EMA {alpha}"));
        let case = format!("{} spp{axes}{alpha}", row.spp);
        let ([a, b], [c, d]) = (row.filtered, row.raw);
        table.push_str(&format!("  {case:<28}filtered {a:<8} / {b:<10} raw {c:<8} / {d}\n"));
    }
}
