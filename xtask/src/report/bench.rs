//! Programs of the package of benchmarks, which measure and write tables, and those tables.

use super::Report;
use crate::run;
use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Compiles the programs, and returns where they are, in the order of the names.
pub(super) fn build<const N: usize>(names: [&str; N]) -> Result<[PathBuf; N]> {
    let mut cargo = run::cargo();
    cargo.args(["build", "--quiet", "--profile", "bench", "--package", "noisefloor-bench"]);
    names.iter().for_each(|name| _ = cargo.args(["--bench", name]));
    let messages = run::read(cargo.args(["--message-format", "json-render-diagnostics"]))?;
    let artifacts: Vec<Value> = messages.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    let find = |name: &&str| -> Result<PathBuf> {
        let artifact =
            artifacts.iter().find(|message| message["target"]["name"] == **name && !message["executable"].is_null());
        let path = artifact.and_then(|message| message["executable"].as_str());
        Ok(PathBuf::from(path.with_context(|| format!("cargo built no program `{name}`"))?))
    };
    let paths: Vec<PathBuf> = names.iter().map(find).collect::<Result<_>>()?;
    paths.try_into().ok().context("as many programs as names")
}

/// Runs a program, as large as the report is to be; it writes its tables to `folder`.
pub(super) fn measure(report: &Report, program: &Path, folder: &Path) -> Result<()> {
    let mut command = run::command(program);
    command.arg("--output").arg(folder);
    match report.plan.name() {
        "quick" => _ = command.arg("--quick"),
        "full" => _ = command.arg("--full"),
        _ => {}
    }
    run::read(&mut command).map(|_| ())
}

/// A table in a file: a line of headings, then lines of cells.
pub(super) struct Table {
    name: String,
    headings: Vec<String>,
    rows: Vec<Vec<String>>,
}

/// One of its rows.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    table: &'a Table,
    cells: &'a [String],
}

impl Table {
    /// Cells are divided by `separator` and hold none.
    pub(super) fn read(path: &Path, separator: char) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
        let cells = |line: &str| line.split(separator).map(str::to_owned).collect::<Vec<_>>();
        let mut lines = text.lines();
        let headings = cells(lines.next().with_context(|| format!("{} is empty", path.display()))?);
        let rows: Vec<_> = lines.map(cells).collect();
        if let Some(row) = rows.iter().find(|row| row.len() != headings.len()) {
            bail!("{}: {} cells under {} headings: {row:?}", path.display(), row.len(), headings.len());
        }
        Ok(Self { name: path.display().to_string(), headings, rows })
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        self.rows.iter().map(|cells| Row { table: self, cells })
    }
}

impl<'a> Row<'a> {
    /// The cell under a heading.
    pub(super) fn word(&self, heading: &str) -> Result<&'a str> {
        let column = self.table.headings.iter().position(|name| name == heading);
        let cell = column.and_then(|column| self.cells.get(column));
        Ok(cell.with_context(|| format!("{} has no column `{heading}`", self.table.name))?)
    }

    pub(super) fn number(&self, heading: &str) -> Result<f64> {
        let word = self.word(heading)?;
        word.parse().with_context(|| format!("{}: `{word}` under `{heading}` is no number", self.table.name))
    }

    /// None for an empty cell.
    pub(super) fn optional(&self, heading: &str) -> Result<Option<f64>> {
        if self.word(heading)?.is_empty() { Ok(None) } else { self.number(heading).map(Some) }
    }

    pub(super) fn count(&self, heading: &str) -> Result<usize> {
        let word = self.word(heading)?;
        word.parse().with_context(|| format!("{}: `{word}` under `{heading}` is no count", self.table.name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_found_by_their_headings() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("table.csv");
        std::fs::write(&path, "name,n,ratio\nmean,16,1e-3\nrobust,64,\n").expect("writable");
        let table = Table::read(&path, ',').expect("a table");
        let rows: Vec<_> = table.rows().collect();
        assert_eq!(rows[0].word("name").expect("a cell"), "mean");
        assert_eq!((rows[0].count("n").expect("a count"), rows[0].number("ratio").expect("a number")), (16, 1e-3));
        assert_eq!(rows[1].optional("ratio").expect("a column"), None);
        assert!(rows[1].number("ratio").is_err() && rows[0].word("time").is_err());
        std::fs::write(&path, "name,n\nmean\n").expect("writable");
        assert!(Table::read(&path, ',').is_err());
    }
}
