//! What our side of the patch says of settings that it refuses: their names as they are set, and what they may be.

use super::build::bridge;
use super::ours;
use anyhow::{Context, Result, bail};
use std::path::Path;
use std::process::Command;
use xtask::c_tests::output;
use xtask::run;

/// By the rest of their names, and their values.
type Settings = &'static [(&'static str, &'static str)];

/// Settings that are refused, and words of what is said of them.
const REFUSED: [(Settings, &[&str]); 8] = [
    (&[("_ORDER", "7"), ("_ESTIMATOR", "robust")], &["dims 4, order 7", "NOISEFLOOR_ORDER"]),
    (&[("_ORDER", "7"), ("_ESTIMATOR", "accumulator")], &["dims 4, order 7", "NOISEFLOOR_ORDER"]),
    (&[("_ORDER", "8")], &["NOISEFLOOR_ORDER=8", "0 to 7"]),
    (&[("_ESTIMATOR", "slices")], &["NOISEFLOOR_ESTIMATOR=slices", "recommended, accumulator, mc, robust"]),
    (&[("_SAMPLER", "table")], &["NOISEFLOOR_SAMPLER=table", "tile, sobol, random, grid"]),
    (&[("_TILE", "nonsense")], &["`nonsense`", "128_16SPP_2D"]),
    (&[("_SPP", "many")], &["NOISEFLOOR_SPP=many", "1 to 65536"]),
    (&[("_TILES", "128_1SPP_2D")], &["NOISEFLOOR_TILES", "README.md"]),
];

/// Compiles our side, and a program that begins a block with it.
pub(super) fn check(archive: &Path) -> Result<()> {
    let program = output("povray_bridge")?;
    let mut compiler = run::compiler("CXX", "c++");
    compiler.args(["-std=c++17", "-Wall", "-Wextra", "-pedantic", "-Werror"]).arg(ours().join("begin.cpp"));
    run::check(compiler.arg(bridge()?).arg(archive).args(["-pthread", "-o"]).arg(&program))?;
    run::check(&mut settings(&program, &[]))?;
    for (refused, words) in REFUSED {
        let result = settings(&program, refused).output().context("cannot start the bridge's test")?;
        let message = String::from_utf8_lossy(&result.stderr);
        // The path tracer's command line is not POV-Ray's.
        if result.status.success() || message.contains("--") || words.iter().any(|word| !message.contains(word)) {
            bail!("with {refused:?} the bridge says `{}`, {}", message.trim(), result.status);
        }
    }
    println!("   {} settings are refused by their names", REFUSED.len());
    Ok(())
}

fn settings(program: &Path, settings: Settings) -> Command {
    let mut command = run::command(program);
    command.env("NOISEFLOOR", "estimate");
    command.envs(settings.iter().map(|(name, value)| (format!("NOISEFLOOR{name}"), value)));
    command
}
