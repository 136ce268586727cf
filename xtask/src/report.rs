//! Starts the report's program, which is a crate of its own: what it is made of takes a minute to compile.

use crate::outcome::{NOT_RUN, Outcome};
use crate::run;
use anyhow::{Result, bail};
use std::ffi::OsString;
use std::process::Command;

fn program() -> Command {
    let mut program = run::cargo();
    program.args(["run", "--profile", "xtask", "--package", "noisefloor-report", "--"]);
    program
}

/// Runs `cargo xtask COMMAND ARGUMENTS`.
pub fn start(command: &str, arguments: &[OsString]) -> Result<()> {
    println!("building what measures and draws (about a minute, once)");
    let status = program().arg(command).args(arguments).status()?;
    if !status.success() {
        bail!("cargo xtask {command} ended with {status}");
    }
    Ok(())
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
