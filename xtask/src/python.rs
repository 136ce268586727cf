//! `python/`: the wheel, and its tests in an environment of their own.

use crate::outcome::Outcome;
use crate::tools::{self, Package};
use crate::{c_tests, paths, run};
use anyhow::{Context, Result};
use std::fs;
use std::path::PathBuf;
use std::process::Command;

/// What a wheel is built with.
pub const BUILD: [Package; 4] = [
    c_tests::PYTHON,
    Package { name: "python3-venv", file: "/usr/share/doc/python3-venv" },
    Package { name: "cmake", file: "/usr/bin/cmake" },
    Package { name: "make", file: "/usr/bin/make" },
];
const TESTED_WITH: [Package; 4] = [
    Package { name: "python3-pytest", file: "/usr/lib/python3/dist-packages/pytest/__init__.py" },
    Package { name: "python3-hypothesis", file: "/usr/lib/python3/dist-packages/hypothesis/__init__.py" },
    Package { name: "python3-scipy", file: "/usr/lib/python3/dist-packages/scipy/__init__.py" },
    Package { name: "python3-torch", file: "/usr/lib/python3/dist-packages/torch/__init__.py" },
];

/// Runs python/tests with the package installed.
pub fn test() -> Result<Outcome> {
    let python = match environment()? {
        Ok(python) => python,
        Err(missing) => return Ok(Outcome::NotRun(missing)),
    };
    let wheel = wheel()?;
    let mut test = run::command("timeout");
    test.arg("600").arg(&python).args(["-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", "python/tests"]);
    run::check(test.env("NOISEFLOOR_WHEEL", &wheel).env("PYTHONDONTWRITEBYTECODE", "1"))?;
    Ok(Outcome::Passed)
}

/// A Python in which the package is installed from a new wheel, beside Debian's packages; or what is missing.
pub fn environment() -> Result<Result<PathBuf, String>> {
    if let Some(missing) = tools::packages(&[&BUILD[..], &TESTED_WITH].concat())? {
        return Ok(Err(missing));
    }
    let wheel = match build()? {
        Ok(wheel) => wheel,
        Err(why) => return Ok(Err(why)),
    };
    run::read(pip(&["install", "--no-deps", "--force-reinstall"]).arg(wheel))?;
    Ok(Ok(interpreter()))
}

/// A new wheel, or why there is none. The packages of `BUILD` must be there.
pub fn build() -> Result<Result<PathBuf, String>> {
    let (folder, python) = (paths::output().join("venv"), interpreter());
    // Debian's Python: another does not see Debian's packages.
    run::read(run::command("/usr/bin/python3").args(["-m", "venv", "--system-site-packages"]).arg(&folder))?;
    if run::read(run::command(&python).args(["-c", "import scikit_build_core"])).is_err()
        && let Err(error) = run::read(&mut pip(&["install", "scikit-build-core"]))
    {
        return Ok(Err(format!("scikit-build-core, which builds the wheel, is not to be had: {error:#}")));
    }
    if wheels().exists() {
        fs::remove_dir_all(wheels()).with_context(|| format!("cannot remove {}", wheels().display()))?;
    }
    let cargo = format!("cmake.define.NOISEFLOOR_CARGO={}", run::cargo().get_program().to_string_lossy());
    let target = format!("cmake.define.NOISEFLOOR_CARGO_TARGET_DIR={}", paths::target().display());
    let mut build = pip(&["wheel", "./python", "--no-deps", "--no-build-isolation"]);
    build.args(["--config-settings", &cargo, "--config-settings", &target, "--wheel-dir"]);
    run::read(build.arg(wheels()))?;
    Ok(Ok(wheel()?))
}

fn interpreter() -> PathBuf {
    paths::output().join("venv/bin/python")
}

fn pip(arguments: &[&str]) -> Command {
    let mut command = run::command(interpreter());
    command.args(["-m", "pip", "--disable-pip-version-check", "--quiet"]).args(arguments);
    // So that a second build has the same bytes.
    command.env("SOURCE_DATE_EPOCH", "1700000000");
    command
}

fn wheels() -> PathBuf {
    paths::output().join("wheel")
}

/// The one that `environment` has built.
pub fn wheel() -> Result<PathBuf> {
    paths::list(wheels())?.pop().context("pip made no wheel")
}
