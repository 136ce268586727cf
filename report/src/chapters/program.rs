//! Measurement programs of the package noisefloor-bench: building them, running them, their tables.

use super::plan::Plan;
use super::prelude::*;
use crate::measure::running;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tempfile::TempDir;
use xtask::{library, run};

/// A chapter that is its description.
pub(super) fn write(report: &Report) -> Result<Chapter> {
    let tables = measure(report)?;
    let mut chapter = report.described(&|name| tables.read(name))?;
    chapter.judge();
    Ok(chapter)
}

/// Compiles targets of noisefloor-bench, each behind the option `kind`, and returns the programs in the order of the
/// names. One call: so they compile side by side.
pub(super) fn build(kind: &str, names: &[String], plan: &Plan) -> Result<Vec<PathBuf>> {
    // The programs link it, so that what ships is what is measured.
    library::build()?;
    let mut cargo = run::cargo();
    cargo.arg("build").args(plan.compiled());
    names.iter().for_each(|name| _ = cargo.args([kind, name]));
    let messages = run::read(cargo.args(["--message-format", "json-render-diagnostics"]).stderr(Stdio::inherit()))?;
    let artifacts: Vec<Value> = messages.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    let find = |name: &String| -> Result<PathBuf> {
        let artifact =
            artifacts.iter().find(|message| message["target"]["name"] == **name && !message["executable"].is_null());
        let path = artifact.and_then(|message| message["executable"].as_str());
        Ok(PathBuf::from(path.with_context(|| format!("cargo built no program `{name}`"))?))
    };
    names.iter().map(find).collect()
}

/// The folder that programs write their tables to.
pub(super) struct Tables(TempDir);

impl Tables {
    pub(super) fn new() -> Result<Self> {
        Ok(Self(tempfile::tempdir().context("cannot create a temporary folder")?))
    }

    pub(super) fn folder(&self) -> &Path {
        self.0.path()
    }

    /// As large as the report is to be. What a program prints is for people; what is needed is in the tables.
    pub(super) fn run(&self, mut program: Command, plan: &Plan) -> Result<()> {
        program.arg("--output").arg(self.folder()).args(plan.option());
        running::run(program, |_| Ok(())).map(drop)
    }

    pub(super) fn read(&self, name: &str) -> Result<Table> {
        Table::read(self.folder(), name)
    }
}

/// Compiles and runs the chapter's programs.
pub(super) fn measure(report: &Report) -> Result<Tables> {
    let programs = build("--bench", &report.description.programs, report.plan)?;
    report.compiled();
    let tables = Tables::new()?;
    programs.iter().try_for_each(|program| tables.run(run::command(program), report.plan))?;
    Ok(tables)
}
