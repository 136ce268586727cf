//! The chapter of the Python package: what python/bench measures.

use super::Report;
use super::chapter::{Cell, Chapter};
use crate::measure::running;
use anyhow::{Context, Result, bail};
use std::fs;
use xtask::{python, run};

/// Tables, as the programs name their files: section, and columns that are aligned left.
const TABLES: [(&str, &str, usize); 5] = [
    ("draws", "Draw and update", 1),
    ("steps", "A step of training", 1),
    ("integrals", "Many integrals", 1),
    ("integration", "Integration", 1),
    ("training", "Training", 3),
];

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let python = match python::environment(&[python::FASHION])? {
        Ok(python) => python,
        Err(missing) => bail!("the chapter needs Python's packages. {missing}"),
    };
    // A peer, of which the chapter says nothing where it is not to be had.
    let vegas = run::read(run::command(&python).args(["-m", "pip", "install", "--quiet", "numpy<2", "vegas"]));
    report.compiled();
    let folder = tempfile::tempdir().context("cannot create a temporary folder")?;
    for program in ["overhead", "integration", "training"] {
        let mut command = run::command(&python);
        command.arg(format!("python/bench/{program}.py")).arg("--output").arg(folder.path());
        command.args(report.plan.option());
        running::run(command, |_| Ok(()))?;
    }
    let mut chapter = Chapter::new("Python");
    if let Err(error) = vegas {
        println!("without vegas: {error:#}");
    }
    for (name, section, words) in TABLES {
        let text = fs::read_to_string(folder.path().join(format!("{name}.csv"))).with_context(|| name.to_owned())?;
        let mut lines = text.lines().map(|line| line.split(';').map(str::to_owned).collect::<Vec<_>>());
        let columns = lines.next().with_context(|| format!("{name}.csv is empty"))?;
        chapter.section(section, "");
        chapter.table(name, &columns, words, lines.map(|row| row.into_iter().map(Cell::from).collect()).collect());
    }
    Ok(chapter)
}
