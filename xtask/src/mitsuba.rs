//! Mitsuba 3 as the Python package index has it, and the tests of integrations/mitsuba with it.

use crate::outcome::Outcome;
use crate::tools::{self, Package};
use crate::{paths, python, run};
use anyhow::{Context, Result};
use std::fs;
use std::path::PathBuf;
use std::process::Command;

/// Dr.Jit compiles with it.
const LLVM: Package = Package { name: "libllvm19", file: "/usr/lib/x86_64-linux-gnu/libLLVM.so.19.1" };
const REQUIREMENTS: &str = "integrations/mitsuba/requirements.txt";

/// A Python that has Mitsuba and noisefloor from a new wheel; or why there is none.
pub fn environment() -> Result<Result<PathBuf, String>> {
    if let Some(missing) = tools::packages(&[&[LLVM], &python::BUILD[..]].concat())? {
        return Ok(Err(missing));
    }
    let wheel = match python::build()? {
        Ok(wheel) => wheel,
        Err(why) => return Ok(Err(why)),
    };
    let folder = paths::target().join("mitsuba");
    let (interpreter, installed) = (folder.join("bin/python"), folder.join("requirements.txt"));
    let wanted = paths::read(REQUIREMENTS)?;
    if fs::read_to_string(&installed).ok().as_deref() != Some(&wanted) {
        println!("   installing Mitsuba into {}", folder.display());
        let install = || -> Result<()> {
            run::read(run::command("python3").args(["-m", "venv"]).arg(&folder))?;
            let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--requirement", REQUIREMENTS];
            run::read(run::command(&interpreter).args(pip))?;
            Ok(())
        };
        if let Err(error) = install() {
            return Ok(Err(format!("Mitsuba cannot be installed: {error:#}")));
        }
        fs::write(&installed, wanted).with_context(|| format!("cannot write {}", installed.display()))?;
    }
    let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--force-reinstall"];
    run::read(run::command(&interpreter).args(pip).arg(wheel))?;
    Ok(Ok(interpreter))
}

/// A command of this Python.
pub fn command(interpreter: PathBuf) -> Command {
    let mut command = run::command(interpreter);
    command.env("PYTHONDONTWRITEBYTECODE", "1").env("DRJIT_LIBLLVM_PATH", LLVM.file);
    command
}

pub fn test() -> Result<Outcome> {
    let interpreter = match environment()? {
        Ok(interpreter) => interpreter,
        Err(why) => return Ok(Outcome::NotRun(why)),
    };
    run::check(command(interpreter).arg("integrations/mitsuba/test_mitsuba.py"))?;
    Ok(Outcome::Passed)
}
