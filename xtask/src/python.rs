//! `python/`: the wheel, and its tests in an environment of their own.

use crate::c_tests::{CMAKE, PYTHON};
use crate::tools::{self, Missing, Package};
use crate::{library, paths, run};
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// What a wheel is built with.
pub const BUILD: [Package; 4] =
    [PYTHON, Package { name: "python3-venv", file: "/usr/share/doc/python3-venv" }, CMAKE[0], CMAKE[1]];
const TESTED_WITH: [Package; 5] = [
    Package { name: "python3-pytest", file: "/usr/lib/python3/dist-packages/pytest/__init__.py" },
    Package { name: "python3-hypothesis", file: "/usr/lib/python3/dist-packages/hypothesis/__init__.py" },
    Package { name: "python3-scipy", file: "/usr/lib/python3/dist-packages/scipy/__init__.py" },
    Package { name: "python3-mypy", file: "/usr/lib/python3/dist-packages/mypy/__init__.py" },
    Package { name: "python3-torch", file: "/usr/lib/python3/dist-packages/torch/__init__.py" },
];

/// Runs python/tests with the package installed; [`Missing`] where some of them could not run.
pub fn test() -> Result<()> {
    let python = environment()?;
    let mut test = run::command("timeout");
    test.arg("600").arg(python).args(["-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", "python/tests"]);
    let (said, result) = run::hear(test.env("NOISEFLOOR_WHEEL", wheel()?).env("PYTHONDONTWRITEBYTECODE", "1"))?;
    println!("{said}");
    result?;
    all_ran(&said)
}

/// What pytest skipped it says by `-rs`, a line for each reason.
fn all_ran(said: &str) -> Result<()> {
    let skipped: Vec<&str> = said.lines().filter(|line| line.starts_with("SKIPPED ")).collect();
    ensure!(skipped.is_empty(), Missing(format!("some of them, the others passed: {}", skipped.join("; "))));
    Ok(())
}

/// A Python in which the package is installed from a new wheel, beside Debian's packages; made once.
pub fn environment() -> Result<PathBuf> {
    static MADE: OnceLock<PathBuf> = OnceLock::new();
    if let Some(python) = MADE.get() {
        return Ok(python.clone());
    }
    tools::packages(&[&BUILD[..], &TESTED_WITH].concat())?;
    let python = build()?;
    install(&python)?;
    Ok(MADE.get_or_init(|| python).clone())
}

/// Builds a new wheel, with the Python that it returns. The packages of `BUILD` must be there.
pub fn build() -> Result<PathBuf> {
    let folder = paths::output().join("venv");
    let python = folder.join("bin/python");
    if run::read(run::command(&python).args(["-c", "import pip, scikit_build_core"])).is_err() {
        create(&folder, &["--system-site-packages"])?;
        fetch(&python, &["scikit-build-core"])?;
    }
    if wheels().exists() {
        fs::remove_dir_all(wheels()).with_context(|| format!("cannot remove {}", wheels().display()))?;
    }
    let [cargo, target] = library::settings().map(|setting| format!("--config-settings=cmake.define.{setting}"));
    // As docs/python.md says.
    let tags = format!("--config-settings=wheel.tags=py3-none-manylinux_2_17_{}", std::env::consts::ARCH);
    let folder = format!("--wheel-dir={}", wheels().display());
    pip(&python, &["wheel", "./python", "--no-deps", "--no-build-isolation", &cargo, &target, &tags, &folder])?;
    Ok(python)
}

/// A new environment of Debian's Python: another does not see Debian's packages.
pub fn create(folder: &Path, options: &[&str]) -> Result<PathBuf> {
    run::read(run::command("/usr/bin/python3").args(["-m", "venv"]).args(options).arg(folder))?;
    Ok(folder.join("bin/python"))
}

/// Installs the wheel that was built.
pub fn install(python: &Path) -> Result<()> {
    pip(python, &["install", "--no-deps", "--force-reinstall", &wheel()?.to_string_lossy()])
}

/// Installs what pip fetches; [`Missing`] where it is out of reach.
pub fn fetch(python: &Path, arguments: &[&str]) -> Result<()> {
    let fetched = pip(python, &[&["install"], arguments].concat());
    fetched.map_err(|error| Missing(format!("not to be had: {error:#}").replace('\n', " ")).into())
}

fn pip(python: &Path, arguments: &[&str]) -> Result<()> {
    let mut command = run::command(python);
    command.args(["-m", "pip", "--disable-pip-version-check", "--quiet"]).args(arguments);
    // So that a second build has the same bytes.
    run::read(command.env("SOURCE_DATE_EPOCH", "1700000000")).map(drop)
}

fn wheels() -> PathBuf {
    paths::output().join("wheel")
}

/// The one that was built.
pub fn wheel() -> Result<PathBuf> {
    paths::list(wheels())?.pop().context("pip made no wheel")
}

#[cfg(test)]
mod tests {
    use super::{Missing, all_ran};

    #[test]
    fn what_is_skipped_has_not_run() {
        let error = all_ran("..ss [100%]\nSKIPPED [2] test_jax.py:53: JAX is not to be had\n2 passed, 2 skipped\n");
        let error = error.expect_err("JAX's tests did not run");
        assert!(error.is::<Missing>() && error.to_string().ends_with("JAX is not to be had"), "{error}");
        assert!(all_ran("..\n2 passed in 0.1s\n").is_ok());
    }
}
