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
    /// Make them elsewhere, and fail if a byte differs from those in core/tiles, or a sidecar says another thing
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
/// What a measured energy may differ by, relatively: its last digits depend on the Fourier transform.
const TOLERANCE: f64 = 0.02;

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
    Ok(())
}

/// Makes the table of the default sampler by its sidecar's command; its file, if it differs from the one that ships.
fn sampler(program: &Path, shipped: &Path, folder: &Path, threads: Option<&str>) -> Result<Option<String>> {
    let [file, sidecar] = ["bin", "toml"].map(|ending| format!("{SAMPLER}.{ending}"));
    let text = fs::read_to_string(shipped.join(&sidecar)).with_context(|| format!("cannot read {sidecar}"))?;
    let command = text.lines().find_map(|line| line.strip_prefix("command = \"fsot ")?.strip_suffix('"'));
    let arguments = command.with_context(|| format!("{sidecar} has no command"))?.split_whitespace();
    let mut make = run::command(program);
    make.args(arguments.filter(|argument| *argument != file)).arg(folder.join(&file)).arg("--quiet");
    run::check(make.args(threads))?;
    let is_same = fs::read(shipped.join(&file)).ok() == Some(fs::read(folder.join(&file))?);
    Ok((!is_same).then_some(file))
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

/// Whether two sidecars say the same, and say it at all, but for the version and the last digits of what was measured.
fn same(a: &Value, b: &Value) -> bool {
    SAME.iter().all(|key| a.pointer(key).is_some_and(|value| Some(value) == b.pointer(key)))
        && rows(a).count() == rows(b).count().max(1)
        && rows(a).zip(rows(b)).all(|(a, b)| close(a, b))
}

fn close(a: &Value, b: &Value) -> bool {
    let both = ENERGIES.iter().flat_map(|energy| [0, 1].map(|i| (a[energy][i].as_f64(), b[energy][i].as_f64())));
    CASE.iter().all(|key| a[key] == b[key])
        && both.into_iter().all(|pair| matches!(pair, (Some(a), Some(b)) if (a - b).abs() <= TOLERANCE * a.abs()))
}

#[cfg(test)]
mod tests {
    use super::{rows, same};
    use serde_json::json;

    #[test]
    fn sidecars_differ_in_more_than_last_digits() {
        let row =
            |energy: f64| json!({"spp": 4, "filtered": [energy, 1.0], "perceptual": [1.0, 1.0], "raw": [1.0, 1.0]});
        let sidecar = |seed: u32, energy: f64| {
            let quality = json!({"energy": [row(energy)], "integrands": 9});
            json!({"command": "c", "seed": seed, "kernel": "k", "iterations": 1, "sha256": "0", "quality": quality})
        };
        assert_eq!(rows(&sidecar(1, 0.5)).count(), 1);
        assert!(same(&sidecar(1, 0.5), &sidecar(1, 0.505)));
        assert!(!same(&sidecar(1, 0.5), &sidecar(1, 0.52)));
        assert!(!same(&sidecar(1, 0.5), &sidecar(2, 0.5)));
        assert!(!same(&json!({}), &json!({})));
    }
}
