//! Starts the crates `release` and `report`, which stand apart because what they are made of takes long to compile.

use crate::tools::{self, Missing};
use crate::{paths, run};
use anyhow::{Context, Result, bail};
use std::ffi::OsString;
use std::process::{Command, ExitCode, Stdio};

/// The exit status of a program that is a step of the tests and cannot run here.
const NOT_RUN: u8 = 77;

/// These packages, which do not measure; and all others. The tests always name them so: packages that are compiled
/// together decide with which features those are that they share, and with others these would be compiled again.
pub const TOOLS: [&str; 6] =
    ["--package", "xtask", "--package", "noisefloor-release", "--package", "noisefloor-report"];
pub const OTHERS: [&str; 7] =
    ["--workspace", "--exclude", "xtask", "--exclude", "noisefloor-release", "--exclude", "noisefloor-report"];

/// What is built of a crate.
fn program(folder: &str) -> Command {
    run::command(paths::target().join("xtask").join(format!("noisefloor-{folder}")))
}

/// Runs `cargo xtask COMMAND ARGUMENTS` in this process's place: its errors, its exit status and what an interruption
/// does are its own.
pub fn start(folder: &str, command: &str, arguments: &[OsString]) -> Result<()> {
    // Before a minute of compiling.
    tools::compilers()?;
    println!("building {folder}/ (about a minute, once)");
    let package = format!("noisefloor-{folder}");
    run::compile(run::cargo().args(["build", "--profile", "xtask", "--package", &package]))?;
    let mut program = program(folder);
    // What the arguments name is where this process was started.
    program.arg(command).args(arguments).current_dir(std::env::current_dir()?);
    #[cfg(unix)]
    return Err(std::os::unix::process::CommandExt::exec(&mut program)).context("cannot start it");
    #[cfg(not(unix))]
    run::check(&mut program)
}

/// How a program that was started ends.
pub fn exit(result: Result<()>) -> ExitCode {
    let Err(error) = result else { return ExitCode::SUCCESS };
    eprintln!("error: {error:#}");
    if error.is::<Missing>() { ExitCode::from(NOT_RUN) } else { ExitCode::FAILURE }
}

/// Runs a step of the tests.
pub fn check(folder: &str, step: &str) -> Result<()> {
    run::check(run::cargo().args(["build", "--quiet", "--profile", "xtask"]).args(TOOLS))?;
    let output = program(folder).args(["check", step]).stderr(Stdio::piped()).spawn()?.wait_with_output()?;
    let errors = String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(NOT_RUN.into()) {
        let why = errors.lines().last().unwrap_or_default();
        bail!(Missing(why.trim_start_matches("error: ").to_owned()));
    }
    if !output.status.success() {
        bail!("{errors}");
    }
    Ok(())
}
