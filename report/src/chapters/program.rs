//! Measurement programs of the package noisefloor-bench: building them, running them.

use super::Report;
use super::plan::Plan;
use crate::measure::running;
use anyhow::{Context, Result};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use xtask::{library, run};

/// Compiles bench targets, all in one call so that they compile side by side, and returns the programs, in the order of
/// the names.
pub(super) fn build(names: &[&str], plan: &Plan) -> Result<Vec<PathBuf>> {
    // The programs link it, so that what ships is what is measured.
    library::build()?;
    let mut cargo = run::cargo();
    cargo.args(["build", "--profile", plan.profile(), "--package", "noisefloor-bench"]);
    names.iter().for_each(|name| _ = cargo.args(["--bench", name]));
    let messages = run::read(cargo.args(["--message-format", "json-render-diagnostics"]).stderr(Stdio::inherit()))?;
    let artifacts: Vec<Value> = messages.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    let find = |name: &&str| -> Result<PathBuf> {
        let artifact =
            artifacts.iter().find(|message| message["target"]["name"] == **name && !message["executable"].is_null());
        let path = artifact.and_then(|message| message["executable"].as_str());
        Ok(PathBuf::from(path.with_context(|| format!("cargo built no program `{name}`"))?))
    };
    names.iter().map(find).collect()
}

/// Runs a program, as large as the report is to be; it writes its tables to `folder`.
pub(super) fn measure(report: &Report, program: &Path, folder: &Path) -> Result<()> {
    let mut command = run::command(program);
    command.arg("--output").arg(folder).args(report.plan.option());
    // Its output is for people; what is needed is in the tables.
    running::run(command, |_| Ok(())).map(|_| ())
}
