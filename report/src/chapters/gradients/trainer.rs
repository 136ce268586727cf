//! The trainers of `examples_c`: compiling and running them, and their summaries, tables in Markdown.

use crate::chapters::chapter::{Cell, Chapter};
use crate::measure::running;
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};
use xtask::{paths, run};

/// A compiled trainer.
pub(super) struct Program(PathBuf);

impl Program {
    /// Compiles `examples_c/SOURCE` against the library, for this machine: what is measured is time. Without errno the
    /// compiler vectorises square roots.
    pub(super) fn compile(source: &str, archive: &Path) -> Result<Self> {
        let path = paths::output().join(Path::new(source).with_extension(""));
        let (mut compiler, standard) = match source.ends_with(".c") {
            true => (run::compiler("CC", "cc"), "-std=c99"),
            false => (run::compiler("CXX", "c++"), "-std=c++17"),
        };
        compiler.args([standard, "-O3", "-march=native", "-fno-math-errno", "-Wall", "-Wextra", "-Iinclude"]);
        compiler.arg(Path::new("examples_c").join(source)).arg(archive);
        run::check(compiler.args(["-lm", "-o"]).arg(&path))?;
        Ok(Self(path))
    }

    /// Runs to the end: its standard output, CSV, and its standard error, a summary.
    pub(super) fn run(&self, arguments: &[&str]) -> Result<(String, String)> {
        let mut command = run::command(&self.0);
        command.args(arguments);
        let mut csv = String::new();
        let summary = running::run(command, |text| {
            csv += &format!("{text}\n");
            Ok(())
        })?;
        Ok((csv, summary))
    }
}

/// One table's headings and rows.
pub(super) struct Summary {
    pub(super) columns: Vec<String>,
    pub(super) rows: Vec<Vec<String>>,
}

impl Summary {
    /// The first table of a text.
    pub(super) fn parse(text: &str) -> Result<Self> {
        let mut lines = text.lines().skip_while(|line| !line.starts_with('|')).take_while(|line| line.starts_with('|'));
        let cells = |line: &str| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect();
        let columns: Vec<String> = cells(lines.next().context("the trainer wrote no table")?);
        let rows = lines.skip(1).map(cells).collect();
        Ok(Self { columns, rows })
    }

    /// The first number of the cell in the row whose first cells are `keys`; and half of its interval, if it has one.
    /// Of columns with the same name it is the last.
    pub(super) fn number(&self, keys: &[&str], column: &str) -> Option<(f64, f64)> {
        let at = self.columns.iter().rposition(|name| name == column)?;
        let row = self.rows.iter().find(|row| keys.iter().zip(row.iter()).all(|(key, cell)| key == cell))?;
        let mut words = row.get(at)?.split(" +- ");
        let mut next = || words.next()?.trim().parse().ok();
        Some((next()?, next().unwrap_or(0.0)))
    }

    pub(super) fn write(&self, chapter: &mut Chapter, name: &'static str, words: usize) {
        let rows = self.rows.iter().map(|row| row.iter().map(|cell| Cell::from(cell.as_str())).collect());
        chapter.table(name, &self.columns, words, rows.collect());
    }
}
