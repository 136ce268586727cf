//! Compiling and running a trainer of `examples_c`.

use crate::measure::interrupt;
use crate::{examples, paths, run};
use anyhow::{Context, Result, bail};
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::AtomicBool;
use std::thread;

/// What a run wrote.
pub(crate) struct Written {
    /// Standard output: CSV.
    pub(crate) csv: String,
    /// Standard error: a summary, as Markdown.
    pub(crate) summary: String,
}

/// A compiled trainer.
pub(crate) struct Program {
    path: PathBuf,
}

impl Program {
    /// Compiles `examples_c/SOURCE` against the library, for this machine: what is measured is time. Without errno the
    /// compiler vectorises square roots.
    pub(crate) fn compile(source: &str, archive: &Path) -> Result<Self> {
        let name = Path::new(source).file_stem().with_context(|| format!("{source} has no name"))?;
        let path = paths::output().join(name);
        let options = ["-O3", "-march=native", "-fno-math-errno", "-Wall", "-Wextra", "-Iinclude"];
        examples::compile(source, &options, archive, &path)?;
        Ok(Self { path })
    }

    /// Runs to the end. `line` sees each line of standard output as it comes, for progress.
    pub(crate) fn run(
        &self,
        arguments: &[&str],
        interrupted: &AtomicBool,
        mut line: impl FnMut(&str),
    ) -> Result<Written> {
        let mut command: Command = run::command(&self.path);
        command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().with_context(|| format!("cannot start {}", self.path.display()))?;
        let (stdout, stderr) = (child.stdout.take(), child.stderr.take());
        // Beside the other stream: a full pipe would stop the trainer.
        let reader = thread::spawn(move || {
            let mut text = String::new();
            stderr.map_or(Ok(0), |mut stderr| stderr.read_to_string(&mut text)).map(|_| text)
        });
        let mut csv = String::new();
        for text in stdout.into_iter().flat_map(|stdout| BufReader::new(stdout).lines()) {
            let text = text.with_context(|| format!("cannot read what {} says", self.path.display()))?;
            line(&text);
            csv += &text;
            csv.push('\n');
        }
        let summary = reader.join().ok().context("a thread was lost")?.context("cannot read the trainer's errors")?;
        let status = child.wait().context("the trainer was lost")?;
        interrupt::check(interrupted)?;
        if !status.success() {
            bail!("{} {} failed, {status}\n{}", self.path.display(), arguments.join(" "), summary.trim());
        }
        Ok(Written { csv, summary })
    }
}
