//! `cargo xtask fuzz`: every target of fuzz/ for a while, first on what once crashed it.

use crate::{paths, run};
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use std::fs;
use std::process::{Command, Output};

/// Longer inputs are slower, and reach nothing more.
const MAX_BYTES: u32 = 8192;
/// The targets that the fuzz package builds with this feature alone.
const FSOT: (&str, &str) = ("fsot_files", "fsot");

#[derive(Args)]
pub struct Options {
    /// How long each target runs
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u64).range(1..))]
    seconds: u64,
    /// Only this target; fsot_files, which takes minutes to compile, runs only if asked for
    #[arg(long)]
    target: Option<String>,
    /// What the targets are built with; `address` is slower, and finds what wrong `unsafe` code reads or writes
    #[arg(long, value_parser = ["none", "address"], default_value = "none")]
    sanitizer: String,
}

pub fn run(options: &Options) -> Result<()> {
    let targets = targets(options.target.as_deref())?;
    // Instrumented, all at once.
    let one = options.target.as_deref();
    run::check(cargo_fuzz("build", options, one.unwrap_or_default()).args(one))?;
    let mut crashed = Vec::new();
    for target in &targets {
        match fuzz(target, options) {
            Ok(done) => println!("{target:20} {done}"),
            Err(error) => {
                println!("{target:20} {error:#}");
                crashed.push(target.as_str());
            }
        }
    }
    ensure!(crashed.is_empty(), "{} of {} targets failed: {}", crashed.len(), targets.len(), crashed.join(", "));
    Ok(())
}

/// Those that run: one that was asked for, or all that build quickly.
fn targets(wanted: Option<&str>) -> Result<Vec<String>> {
    let said = run::read(run::cargo().args(["fuzz", "list"]));
    let said = said.context("without cargo-fuzz: `cargo install --locked cargo-fuzz`")?;
    let is_wanted = |name: &&str| wanted.map_or(*name != FSOT.0, |wanted| *name == wanted);
    let targets: Vec<String> = said.lines().filter(is_wanted).map(str::to_owned).collect();
    ensure!(!targets.is_empty(), "there is no such fuzz target; there are\n{said}");
    Ok(targets)
}

fn cargo_fuzz(command: &str, options: &Options, target: &str) -> Command {
    let mut cargo = run::cargo();
    // The sanitizer's programs have a folder, so that the other's stay compiled.
    let folder = if options.sanitizer == "none" { "fuzz/target" } else { "fuzz/target/address" };
    cargo.args(["fuzz", command, "--sanitizer", &options.sanitizer, "--target-dir"]).arg(paths::root().join(folder));
    cargo.args((target == FSOT.0).then_some(["--features", FSOT.1]).into_iter().flatten());
    // A stable compiler refuses the flags of the instrumentation otherwise.
    cargo.env("RUSTC_BOOTSTRAP", "1");
    cargo
}

/// Builds all targets but `fsot_files`, not instrumented and not optimised, and runs the committed inputs through them:
/// seeds, and what once crashed.
pub fn replay() -> Result<()> {
    let (folder, target) = (paths::root().join("fuzz"), paths::target().join("fuzz"));
    let mut build = run::cargo();
    build.args(["build", "--quiet", "--locked", "--manifest-path"]).arg(folder.join("Cargo.toml"));
    build.arg("--target-dir").arg(&target).env("CARGO_PROFILE_DEV_DEBUG", "false");
    run::check(build.env("RUSTFLAGS", "--cfg fuzzing -D warnings"))?;
    for source in paths::of_kind("fuzz/fuzz_targets", "rs")? {
        let name = source.file_stem().context("a fuzz target has no name")?;
        let places = ["seeds", "regressions"].map(|kind| folder.join(kind).join(name));
        let inputs =
            places.iter().filter(|place| place.is_dir()).map(paths::list).collect::<Result<Vec<_>>>()?.concat();
        // Without an input the program would make some.
        if inputs.is_empty() || name == FSOT.0 {
            continue;
        }
        let program = target.join("debug").join(name);
        let mut replay = run::command(&program);
        let output = replay.arg("-timeout=25").args(&inputs).output();
        let output = output.with_context(|| format!("cannot start {}", program.display()))?;
        judge(&output, &format!("{}: a committed input crashes it", name.display()))?;
        println!("   {}: {} inputs", name.display(), inputs.len());
    }
    Ok(())
}

/// Runs one target on its regressions and seeds, and then on new inputs; how many these were, or what crashed it.
fn fuzz(target: &str, options: &Options) -> Result<String> {
    let place = |kind: &str| paths::root().join("fuzz").join(kind).join(target);
    let (regressions, corpus, seeds) = (place("regressions"), place("corpus"), place("seeds"));
    for path in [&regressions, &corpus] {
        fs::create_dir_all(path).with_context(|| format!("cannot create {}", path.display()))?;
    }
    // New inputs go to the first folder.
    let mut command = cargo_fuzz("run", options, target);
    command.arg(target).args([&corpus, &regressions]).args(seeds.is_dir().then_some(seeds)).arg("--");
    command.arg(format!("-max_total_time={}", options.seconds)).arg(format!("-max_len={MAX_BYTES}"));
    command.arg("-timeout=25");
    // Files are named after what they hold, and the prefix is a folder only with the slash.
    command.arg(format!("-artifact_prefix={}/", regressions.display()));
    let output = command.output().context("cannot start the fuzz target")?;
    judge(&output, "crashed, perhaps by an input that crashed it before")?;
    // Empty unless something crashed; then it stays, to be committed.
    fs::remove_dir(&regressions).ok();
    let said = String::from_utf8_lossy(&output.stderr);
    let done = said.lines().find(|line| line.starts_with("Done ") && !line.starts_with("Done 0 "));
    Ok(done.context("the fuzz target ran no input")?.to_owned())
}

fn judge(output: &Output, what: &str) -> Result<()> {
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    let wanted = ["panicked at", "ERROR:", "Test unit written", "assertion", "Running:"];
    let lines: Vec<&str> = said.lines().filter(|line| wanted.iter().any(|word| line.contains(word))).collect();
    bail!("{what} ({}):\n    {}", output.status, lines.join("\n    "))
}
