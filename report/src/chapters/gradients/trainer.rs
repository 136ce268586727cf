//! Compiling and running a trainer of `examples_c`.

use crate::measure::running;
use anyhow::{Context, Result};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use xtask::{examples, paths, run};

/// What a run wrote.
pub(super) struct Written {
    /// Standard output: CSV.
    pub(super) csv: String,
    /// Standard error: a summary, as Markdown.
    pub(super) summary: String,
}

/// A compiled trainer.
pub(super) struct Program {
    path: PathBuf,
}

impl Program {
    /// Compiles `examples_c/SOURCE` against the library, for this machine: what is measured is time. Without errno the
    /// compiler vectorises square roots.
    pub(super) fn compile(source: &str, archive: &Path) -> Result<Self> {
        let name = Path::new(source).file_stem().with_context(|| format!("{source} has no name"))?;
        let path = paths::output().join(name);
        let options = ["-O3", "-march=native", "-fno-math-errno", "-Wall", "-Wextra", "-Iinclude"];
        examples::compile(source, &options, archive, &path)?;
        Ok(Self { path })
    }

    /// Runs to the end.
    pub(super) fn run(&self, arguments: &[impl AsRef<OsStr>]) -> Result<Written> {
        let mut command = run::command(&self.path);
        command.args(arguments);
        let mut csv = String::new();
        let summary = running::run(command, |text| {
            csv += &format!("{text}\n");
            Ok(())
        })?;
        Ok(Written { csv, summary })
    }
}
