//! Measurement programs of the package noisefloor-bench: building one, running it, reading the tables it leaves.

use super::Report;
use crate::measure::interrupt;
use crate::{paths, run};
use anyhow::{Context, Result, anyhow, bail};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::str::FromStr;
use std::time::Duration;

/// Compiles a bench target as `cargo bench` does, and returns the program.
pub(super) fn build(name: &str) -> Result<PathBuf> {
    let mut cargo = run::cargo();
    cargo.args(["build", "--quiet", "--profile", "bench", "--package", "noisefloor-bench", "--bench", name]);
    let messages = run::read(cargo.arg("--message-format=json").stderr(Stdio::inherit()))?;
    let artifact = |line: &str| -> Option<PathBuf> {
        let message: Value = serde_json::from_str(line).ok()?;
        let is_it = message["reason"] == "compiler-artifact" && message["target"]["name"] == name;
        is_it.then(|| message["executable"].as_str().map(PathBuf::from))?
    };
    messages.lines().filter_map(artifact).next_back().ok_or_else(|| anyhow!("cargo built no program `{name}`"))
}

/// Ends the program when this one goes on without it.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Runs a measurement program as long as the report is, and returns the folder with what it wrote.
pub(super) fn measure(report: &Report, program: &Path) -> Result<tempfile::TempDir> {
    let folder = tempfile::tempdir_in(paths::target()).context("cannot create a temporary folder")?;
    let mut command = run::command(program);
    command.arg("--output").arg(folder.path()).args(report.plan.option());
    // It names what it measures on standard error; its tables are what this reads.
    let child = command.stdin(Stdio::null()).stdout(Stdio::null()).spawn();
    let mut running = Running(child.with_context(|| format!("cannot start {}", program.display()))?);
    loop {
        interrupt::check(&report.interrupted)?;
        match running.0.try_wait().with_context(|| format!("cannot wait for {}", program.display()))? {
            Some(status) if status.success() => return Ok(folder),
            Some(status) => bail!("failed ({status}): {}", program.display()),
            None => std::thread::sleep(Duration::from_millis(50)),
        }
    }
}

/// A table with named columns.
pub(super) struct Csv {
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
    name: String,
}

/// A row of it.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    table: &'a Csv,
    cells: &'a [String],
}

impl Csv {
    pub(super) fn read(path: &Path) -> Result<Self> {
        let name = path.display().to_string();
        let text = fs::read_to_string(path).with_context(|| format!("cannot read {name}"))?;
        Self::parse(&text, &name)
    }

    fn parse(text: &str, name: &str) -> Result<Self> {
        let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
        let mut lines = text.lines().map(cells);
        let columns = lines.next().with_context(|| format!("{name} is empty"))?;
        let rows: Vec<Vec<String>> = lines.collect();
        if let Some((line, row)) = (2..).zip(&rows).find(|(_, row)| row.len() != columns.len()) {
            bail!("{name}, line {line}: {} cells for {} columns", row.len(), columns.len());
        }
        Ok(Self { columns, rows, name: name.to_owned() })
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        self.rows.iter().map(|cells| Row { table: self, cells })
    }

    /// The values of a column, each once, in the order in which they come.
    pub(super) fn distinct(&self, column: &str) -> Result<Vec<String>> {
        let mut all = Vec::new();
        for row in self.rows() {
            let text = row.text(column)?;
            if !all.iter().any(|seen| seen == text) {
                all.push(text.to_owned());
            }
        }
        Ok(all)
    }
}

impl<'a> Row<'a> {
    pub(super) fn text(&self, column: &str) -> Result<&'a str> {
        let index = self.table.columns.iter().position(|name| name == column);
        let index = index.with_context(|| format!("{} has no column `{column}`", self.table.name))?;
        Ok(&self.cells[index])
    }

    pub(super) fn number<T: FromStr>(&self, column: &str) -> Result<T> {
        let text = self.text(column)?;
        text.parse().map_err(|_| anyhow!("{}: `{text}` in column `{column}` is no number", self.table.name))
    }

    /// Whether the cells of these columns hold these values.
    pub(super) fn has(&self, wanted: &[(&str, &str)]) -> bool {
        wanted.iter().all(|(column, value)| self.text(column).is_ok_and(|text| text == *value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_read_and_damage_is_said() -> Result<()> {
        let table = Csv::parse("name,n,x\na,1,2.5e-1\nb,2,NaN\na,4,3\n", "t.csv")?;
        assert_eq!(table.distinct("name")?, ["a", "b"]);
        let numbers: Vec<f64> =
            table.rows().filter(|row| row.has(&[("name", "a")])).map(|row| row.number("x")).collect::<Result<_>>()?;
        assert_eq!(numbers, [0.25, 3.0]);
        assert!(table.distinct("y").is_err());
        let error = table.rows().next().expect("a row").number::<u32>("x").expect_err("no whole number");
        assert!(error.to_string().contains("`2.5e-1` in column `x`"), "{error}");
        assert!(Csv::parse("a,b\n1\n", "t.csv").is_err_and(|error| error.to_string().contains("line 2: 1 cells")));
        Ok(())
    }
}
