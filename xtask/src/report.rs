//! Starts the report's program, which is a crate of its own: what it is made of takes a minute to compile.

use crate::outcome::{NOT_RUN, Outcome};
use crate::{paths, run};
use anyhow::{Context, Result, bail};
use std::ffi::OsString;
use std::process::Command;

fn program() -> Command {
    let mut program = run::cargo();
    program
        .args(["run", "--profile", "xtask", "--manifest-path"])
        .arg(paths::root().join("report/Cargo.toml"))
        .arg("--");
    program
}

/// Runs `cargo xtask COMMAND ARGUMENTS` in this process's place: its errors, its exit status and what an interruption
/// does are its own.
pub fn start(command: &str, arguments: &[OsString]) -> Result<()> {
    println!("building what measures and draws (about a minute, once)");
    let mut program = program();
    program.arg(command).args(arguments);
    // What the arguments name is where this process was started.
    program.current_dir(std::env::current_dir()?);
    #[cfg(unix)]
    return Err(std::os::unix::process::CommandExt::exec(&mut program)).context("cannot start cargo");
    #[cfg(not(unix))]
    run::check(&mut program)
}

/// Runs a step of the tests.
pub fn check(step: &str) -> Result<Outcome> {
    let output = program().args(["check", step]).stderr(std::process::Stdio::piped()).spawn()?.wait_with_output()?;
    let errors = String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(NOT_RUN.into()) {
        return Ok(Outcome::NotRun(errors.lines().last().unwrap_or_default().to_owned()));
    }
    if !output.status.success() {
        bail!("{errors}");
    }
    Ok(Outcome::Passed)
}
