//! A trainer of `examples_c`, compiled strictly for a test: what it computes, and what it refuses.

use crate::c_tests::{SANITIZERS, has_sanitizers, output};
use crate::{examples, run};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Stdio;

const STRICT: [&str; 5] = ["-Wall", "-Wextra", "-pedantic", "-Werror", "-Iinclude"];

/// A compiled trainer.
pub struct Program {
    name: &'static str,
    path: PathBuf,
}

impl Program {
    /// `examples_c/NAME.EXTENSION`, as `executable`.
    pub fn compile(
        name: &'static str,
        extension: &str,
        executable: &str,
        options: &[&str],
        archive: &Path,
    ) -> Result<Self> {
        let path = output(executable)?;
        examples::compile(&format!("{name}.{extension}"), &[&STRICT[..], options].concat(), archive, &path)?;
        Ok(Self { name, path })
    }

    /// None: the compiler has no sanitizers.
    pub fn sanitized(name: &'static str, extension: &str, archive: &Path) -> Result<Option<Self>> {
        if !has_sanitizers()? {
            return Ok(None);
        }
        println!("   under the sanitizers");
        let executable = format!("{name}_sanitized");
        Self::compile(name, extension, &executable, &[&["-O1"], &SANITIZERS[..]].concat(), archive).map(Some)
    }

    /// Runs to the end; returns the CSV.
    pub fn run(&self, arguments: &[&str]) -> Result<String> {
        run::read(run::command(&self.path).args(arguments).stderr(Stdio::null()))
    }

    /// Fails unless the program exits as programs do after an error, with a message that contains `word`.
    pub fn refuses(&self, arguments: &[&str], word: &str) -> Result<()> {
        let mut command = run::command(&self.path);
        let output = command.args(arguments).stdin(Stdio::null()).output().context("cannot start the program")?;
        let message = String::from_utf8_lossy(&output.stderr);
        let last = message.lines().last().unwrap_or_default();
        let start = format!("{}: ", self.name);
        if output.status.code() != Some(1) || !last.starts_with(&start) || !last.contains(word) {
            bail!("`{}`: {}, and it says `{}`", arguments.join(" "), output.status, message.trim());
        }
        Ok(())
    }
}

/// A path as an argument.
pub fn text(path: &Path) -> Result<&str> {
    path.to_str().with_context(|| format!("{} is not Unicode", path.display()))
}

/// All rows of a CSV, but the column of seconds.
pub fn without_seconds(csv: &str) -> Vec<Vec<&str>> {
    let seconds = csv.lines().next().and_then(|header| header.split(',').position(|name| name == "seconds"));
    let rows = csv.lines().map(|line| line.split(',').enumerate());
    rows.map(|row| row.filter(|&(column, _)| Some(column) != seconds).map(|(_, cell)| cell).collect()).collect()
}
