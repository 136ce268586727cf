//! The tiles in `core/tiles`, made by `fsot` from their presets.

use crate::paths::{self, elements};
use crate::run;
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// What `cargo xtask tiles` is asked for.
#[derive(Args)]
pub struct Options {
    /// Which tiles, such as 64_1SPP_2D [default: all]
    names: Vec<String>,
    /// Make them elsewhere, and fail if a byte differs from those in core/tiles, or a sidecar says another thing;
    /// without names, run fsot's longest tests too
    #[arg(long)]
    check: bool,
    /// Threads to work on [default: one per core]
    #[arg(long)]
    threads: Option<usize>,
}

/// The table of the default sampler.
const SAMPLER: &str = "nested_32";
/// What two sidecars must agree in. The version need not change a tile.
const SAME: [&str; 6] = ["/command", "/seed", "/kernel", "/iterations", "/sha256", "/quality/integrands"];
/// What says of a row which case was measured.
const CASE: [&str; 3] = ["spp", "axes", "alpha"];
const ENERGIES: [&str; 3] = ["filtered", "perceptual", "raw"];
/// Digits of a measured energy in a sidecar. The last may differ by one: it depends on the Fourier transform's sines.
const DIGITS: f64 = 4.0;
/// Point sets of high quality and of many points: minutes of one core.
const LONGEST: [&str; 4] = ["--test=fsot", "points_quality::", "--", "--ignored"];

/// Makes the tiles, or checks them; the sidecars say what they are worth.
pub fn run(options: &Options) -> Result<()> {
    run::check(run::cargo().args(["build", "--quiet", "--profile", "fsot", "--package", "noisefloor-fsot"]))?;
    let program = paths::target().join("fsot/fsot").with_extension(std::env::consts::EXE_EXTENSION);
    let known = info(&program, None)?;
    let presets: Vec<_> =
        elements(&known["presets"]).iter().filter_map(Value::as_str).chain([SAMPLER]).map(str::to_owned).collect();
    if let Some(unknown) = options.names.iter().find(|name| !presets.contains(name)) {
        bail!("there is no tile {unknown}; there are {}", presets.join(", "));
    }
    let names = if options.names.is_empty() { &presets } else { &options.names };
    let shipped = paths::root().join("core/tiles");
    let folder = if options.check { paths::target().join("tiles") } else { shipped.clone() };
    fs::create_dir_all(&folder).with_context(|| format!("cannot create {}", folder.display()))?;
    let (threads, mut different) = (options.threads.map(|threads| format!("--threads={threads}")), Vec::new());
    for name in names {
        eprintln!("{name}");
        let ending = if name == SAMPLER { "bin" } else { "nft" };
        if options.check {
            // What another program began is not what this one makes.
            fs::remove_file(folder.join(format!("{name}.{ending}.checkpoint"))).ok();
        }
        if name == SAMPLER {
            let file = sampler(&program, &shipped, &folder, threads.as_deref())?;
            different.extend(file.filter(|_| options.check));
            continue;
        }
        let path = folder.join(format!("{name}.nft"));
        let mut command = run::command(&program);
        command.args(["tile", "--preset", name, "--quiet", "--out"]).arg(&path).args(&threads);
        run::check(&mut command)?;
        if options.check {
            let shipped = shipped.join(format!("{name}.nft"));
            if fs::read(&shipped).ok() != Some(fs::read(&path)?) {
                different.push(format!("{name}.nft"));
            } else if !same(&info(&program, Some(&shipped))?["sidecar"], &info(&program, Some(&path))?["sidecar"]) {
                different.push(format!("{name}.toml"));
            }
        }
    }
    let is_same = different.is_empty();
    ensure!(is_same, "not what is made now: {}. `cargo xtask tiles` writes them anew", different.join(", "));
    if options.check && options.names.is_empty() {
        eprintln!("fsot's longest tests");
        let test = ["test", "--quiet", "--profile", "fsot", "--package", "noisefloor-fsot"];
        run::check(run::cargo().args(test).args(LONGEST))?;
    }
    Ok(())
}

/// Makes the table of the default sampler by its sidecar's command; the file that differs from the one that ships.
fn sampler(program: &Path, shipped: &Path, folder: &Path, threads: Option<&str>) -> Result<Option<String>> {
    let [file, sidecar] = ["bin", "toml"].map(|ending| format!("{SAMPLER}.{ending}"));
    let text = fs::read_to_string(shipped.join(&sidecar)).with_context(|| format!("cannot read {sidecar}"))?;
    let command = text.lines().find_map(|line| line.strip_prefix("command = \"fsot ")?.strip_suffix('"'));
    let arguments = command.with_context(|| format!("{sidecar} has no command"))?.split_whitespace();
    let mut make = run::command(program);
    make.args(arguments.filter(|argument| *argument != file)).arg(folder.join(&file)).arg("--quiet");
    run::check(make.args(threads))?;
    if fs::read(shipped.join(&file)).ok() != Some(fs::read(folder.join(&file))?) {
        return Ok(Some(file));
    }
    let made = fs::read_to_string(folder.join(&sidecar))?;
    Ok((!same_text(&text, &made)).then_some(sidecar))
}

/// Whether two sidecars of a table say the same, but for the version: its energies are computed alike everywhere.
fn same_text(a: &str, b: &str) -> bool {
    let said = |text: &str| -> Vec<String> {
        text.lines().filter(|line| !line.starts_with("version = ")).map(str::to_owned).collect()
    };
    said(a) == said(b)
}

/// What fsot says of its presets, or of a tile and its sidecar.
fn info(program: &Path, tile: Option<&Path>) -> Result<Value> {
    let json = run::read(run::command(program).args(["info", "--json"]).args(tile))?;
    serde_json::from_str(&json).context("`fsot info --json` wrote no JSON")
}

fn rows(sidecar: &Value) -> impl Iterator<Item = &Value> {
    let tables = ["energy", "marginal", "temporal"].into_iter();
    tables.flat_map(|table| elements(&sidecar["quality"][table]))
}

/// Whether two sidecars say the same, and say it at all, but for the version and the last digit of what was measured.
fn same(a: &Value, b: &Value) -> bool {
    SAME.iter().all(|key| a.pointer(key).is_some_and(|value| Some(value) == b.pointer(key)))
        && rows(a).count() == rows(b).count().max(1)
        && rows(a).zip(rows(b)).all(|(a, b)| close(a, b))
}

fn close(a: &Value, b: &Value) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() < 1.5 * 10f64.powf(a.abs().log10().floor() + 1.0 - DIGITS);
    let both = ENERGIES.iter().flat_map(|energy| [0, 1].map(|i| (a[energy][i].as_f64(), b[energy][i].as_f64())));
    CASE.iter().all(|key| a[key] == b[key])
        && both.into_iter().all(|pair| matches!(pair, (Some(a), Some(b)) if a == b || near(a, b)))
}

#[cfg(test)]
mod tests {
    use super::{rows, same};
    use serde_json::json;

    #[test]
    fn sidecars_differ_in_more_than_last_digits() {
        assert!(super::same_text("version = \"1\"\nraw = 0.5\n", "version = \"2\"\nraw = 0.5\n"));
        assert!(!super::same_text("raw = 0.5\n", "raw = 0.5001\n"));
        let row =
            |energy: f64| json!({"spp": 4, "filtered": [energy, 1.0], "perceptual": [1.0, 1.0], "raw": [1.0, 1.0]});
        let sidecar = |seed: u32, energy: f64| {
            let quality = json!({"energy": [row(energy)], "integrands": 9});
            json!({"command": "c", "seed": seed, "kernel": "k", "iterations": 1, "sha256": "0", "quality": quality})
        };
        assert_eq!(rows(&sidecar(1, 0.5)).count(), 1);
        for (energy, other, is_same) in [
            (0.5, 0.5, true),
            (0.5, 0.5001, true),
            (0.5, 0.5002, false),
            (1.0, 0.9999, true),
            (0.002_212, 0.002_213, true),
            (0.002_212, 0.002_214, false),
            (0.0, 0.0, true),
            (0.0, 1e-9, false),
        ] {
            assert_eq!(same(&sidecar(1, energy), &sidecar(1, other)), is_same, "{energy} {other}");
        }
        assert!(!same(&sidecar(1, 0.5), &sidecar(2, 0.5)));
        assert!(!same(&json!({}), &json!({})));
    }
}
