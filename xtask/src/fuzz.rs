//! `cargo xtask fuzz`: every target of fuzz/ for a while, first on what once crashed it.

use crate::outcome::Outcome;
use crate::{paths, run};
use anyhow::{Context, Result, bail};
use clap::Args;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

/// Longer inputs are slower, and reach nothing more.
const MAX_BYTES: u32 = 8192;
/// The targets that the fuzz package builds with this feature alone.
const FSOT: (&str, &str) = ("fsot_files", "fsot");

#[derive(Args)]
pub struct Options {
    /// How long each target runs
    #[arg(long, default_value_t = 60)]
    seconds: u64,
    /// Only this target; fsot_files, which takes minutes to compile, runs only if asked for
    #[arg(long)]
    target: Option<String>,
    /// What the targets are built with; `address` is slower, and finds what wrong `unsafe` code reads or writes
    #[arg(long, value_parser = ["none", "address"], default_value = "none")]
    sanitizer: String,
}

impl Options {
    /// Where the sanitizer's programs are, so that the other's stay compiled.
    fn folder(&self) -> PathBuf {
        let target = paths::root().join("fuzz/target");
        if self.sanitizer == "none" { target } else { target.join(&self.sanitizer) }
    }
}

pub fn run(options: &Options) -> Result<()> {
    if options.seconds == 0 {
        bail!("--seconds 0 is for ever; at least 1");
    }
    let targets = targets(options.target.as_deref())?;
    build(options)?;
    let mut crashed = Vec::new();
    for target in &targets {
        match fuzz(target, options) {
            Ok(executions) => println!("{target:20} {executions:>12} executions"),
            Err(error) => {
                println!("{target:20} {error:#}");
                crashed.push(target.as_str());
            }
        }
    }
    if crashed.is_empty() {
        Ok(())
    } else {
        bail!("{} of {} targets failed: {}", crashed.len(), targets.len(), crashed.join(", "))
    }
}

/// Those that run: one that was asked for, or all that build quickly.
fn targets(wanted: Option<&str>) -> Result<Vec<String>> {
    let mut list = cargo_fuzz();
    let output = list.arg("list").output().context("cannot start cargo")?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        bail!(
            "`cargo fuzz list` failed; if cargo-fuzz is not there, `cargo install --locked cargo-fuzz`: {}",
            said.trim()
        );
    }
    let all: Vec<String> = String::from_utf8_lossy(&output.stdout).lines().map(str::to_owned).collect();
    match wanted {
        None => Ok(all.into_iter().filter(|name| name != FSOT.0).collect()),
        Some(name) if all.iter().any(|target| target == name) => Ok(vec![name.to_owned()]),
        Some(name) => bail!("there is no fuzz target `{name}`; there are {}", all.join(", ")),
    }
}

fn cargo_fuzz() -> Command {
    let mut command = run::cargo();
    // A stable compiler refuses the flags of the instrumentation otherwise.
    command.arg("fuzz").env("RUSTC_BOOTSTRAP", "1");
    command
}

/// Builds all targets but `fsot_files`, not instrumented and not optimised, and runs the committed inputs through them:
/// seeds, and what once crashed.
pub fn replay() -> Result<Outcome> {
    let (folder, target) = (paths::root().join("fuzz"), paths::target().join("fuzz"));
    let mut build = run::cargo();
    build.args(["build", "--quiet", "--locked", "--manifest-path"]).arg(folder.join("Cargo.toml"));
    build.arg("--target-dir").arg(&target).env("CARGO_PROFILE_DEV_DEBUG", "false");
    run::check(build.env("RUSTFLAGS", "--cfg fuzzing -D warnings"))?;
    for seeds in paths::list("fuzz/seeds")? {
        let name = seeds.file_name().context("a folder of seeds has no name")?;
        let mut inputs = paths::list(&seeds)?;
        let regressions = folder.join("regressions").join(name);
        if regressions.is_dir() {
            inputs.extend(paths::list(&regressions)?);
        }
        let program = target.join("debug").join(name);
        let output = run::command(&program)
            .arg("-timeout=25")
            .args(&inputs)
            .output()
            .with_context(|| format!("cannot start {}", program.display()))?;
        judge(&output, &format!("{}: a committed input crashes it", name.display()))?;
        println!("   {}: {} inputs", name.display(), inputs.len());
    }
    Ok(Outcome::Passed)
}

/// Instrumented.
fn build(options: &Options) -> Result<()> {
    let target = options.target.as_deref();
    let mut build = cargo_fuzz();
    build.args(["build", "--sanitizer", &options.sanitizer, "--target-dir"]).arg(options.folder());
    if target == Some(FSOT.0) {
        build.args(["--features", FSOT.1]);
    }
    run::check(build.args(target))
}

/// Runs one target on its regressions and then on new inputs; how many it executed, or what crashed it.
fn fuzz(target: &str, options: &Options) -> Result<u64> {
    let folder = paths::root().join("fuzz");
    let program = options.folder().join(host()?).join("release").join(target);
    let regressions = folder.join("regressions").join(target);
    let corpus = folder.join("corpus").join(target);
    let seeds = folder.join("seeds").join(target);
    for path in [&regressions, &corpus] {
        fs::create_dir_all(path).with_context(|| format!("cannot create {}", path.display()))?;
    }
    let known = paths::list(&regressions)?;
    if !known.is_empty() {
        let output =
            run::command(&program).arg("-timeout=25").args(known).output().context("cannot start the fuzz target")?;
        judge(&output, "an input that crashed it before crashes it again")?;
    }
    let mut command = run::command(&program);
    command.arg(format!("-max_total_time={}", options.seconds)).arg(format!("-max_len={MAX_BYTES}"));
    command.args(["-print_final_stats=1", "-timeout=25"]);
    // Files are named after what they hold, and the prefix is a folder only with the slash.
    command.arg(format!("-artifact_prefix={}/", regressions.display())).arg(corpus);
    command.args(seeds.is_dir().then_some(seeds));
    let output = command.output().context("cannot start the fuzz target")?;
    judge(&output, "crashed")?;
    // Empty unless something crashed; then it stays, to be committed.
    fs::remove_dir(&regressions).ok();
    let count = executions(&String::from_utf8_lossy(&output.stderr));
    match count.context("the fuzz target did not say how many inputs it ran")? {
        0 => bail!("the fuzz target `{target}` ran no input in {} s", options.seconds),
        count => Ok(count),
    }
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

/// What libFuzzer says at its end.
fn executions(said: &str) -> Option<u64> {
    said.lines().find_map(|line| line.strip_prefix("stat::number_of_executed_units:")?.trim().parse().ok())
}

/// The triple that cargo and cargo-fuzz build for.
pub fn host() -> Result<String> {
    let version = run::read(run::command("rustc").arg("-vV"))?;
    version.lines().find_map(|line| line.strip_prefix("host: ")).map(str::to_owned).context("rustc -vV names no host")
}

#[cfg(test)]
mod tests {
    use super::executions;

    #[test]
    fn the_count_is_read() {
        let said =
            "Done 12 runs in 1 second(s)\nstat::number_of_executed_units: 1234\nstat::average_exec_per_sec:     617\n";
        assert_eq!(executions(said), Some(1234));
        assert_eq!(executions("Done"), None);
    }
}
