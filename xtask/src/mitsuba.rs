//! Mitsuba 3 as the Python package index has it, and the tests of integrations/mitsuba with it.

use crate::outcome::Outcome;
use crate::tools::{self, Package};
use crate::{paths, run};
use anyhow::{Context, Result};
use std::fs;
use std::path::PathBuf;
use std::process::Command;

/// Dr.Jit compiles with it.
const LLVM: Package = Package { name: "libllvm19", file: "/usr/lib/x86_64-linux-gnu/libLLVM.so.19.1" };
const REQUIREMENTS: &str = "integrations/mitsuba/requirements.txt";

/// A Python that has Mitsuba, for programs that import noisefloor_mitsuba; or why there is none. The shared library
/// must be there.
pub fn python() -> Result<Result<PathBuf, String>> {
    if let Some(missing) = tools::packages(&[LLVM])? {
        return Ok(Err(missing));
    }
    let folder = paths::target().join("mitsuba");
    let (python, installed) = (folder.join("bin/python"), folder.join("requirements.txt"));
    let wanted = paths::read(REQUIREMENTS)?;
    if fs::read_to_string(&installed).ok().as_deref() != Some(&wanted) {
        println!("   installing Mitsuba into {}", folder.display());
        let install = || -> Result<()> {
            run::read(run::command("python3").args(["-m", "venv"]).arg(&folder))?;
            let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--requirement", REQUIREMENTS];
            run::read(run::command(&python).args(pip))?;
            Ok(())
        };
        if let Err(error) = install() {
            return Ok(Err(format!("Mitsuba cannot be installed: {error:#}")));
        }
        fs::write(&installed, wanted).with_context(|| format!("cannot write {}", installed.display()))?;
    }
    Ok(Ok(python))
}

/// A command of this Python.
pub fn command(python: PathBuf) -> Command {
    let mut command = run::command(python);
    command.env("NOISEFLOOR_LIBRARY", paths::target().join("release/libnoisefloor.so"));
    command.env("PYTHONPATH", paths::root().join("integrations/mitsuba")).env("PYTHONDONTWRITEBYTECODE", "1");
    command.env("DRJIT_LIBLLVM_PATH", LLVM.file);
    command
}

pub fn test() -> Result<Outcome> {
    let python = match python()? {
        Ok(python) => python,
        Err(why) => return Ok(Outcome::NotRun(why)),
    };
    run::check(command(python).arg("integrations/mitsuba/test_noisefloor_mitsuba.py"))?;
    Ok(Outcome::Passed)
}
