//! Mitsuba 3 as the Python package index has it, and the tests of integrations/mitsuba with it.

use crate::tools::{self, Package};
use crate::{paths, python, run};
use anyhow::{Context, Result};
use std::fs;
use std::process::Command;

/// Dr.Jit compiles with it.
const LLVM: Package = Package { name: "libllvm19", file: "/usr/lib/x86_64-linux-gnu/libLLVM.so.19.1" };
const REQUIREMENTS: &str = "integrations/mitsuba/requirements.txt";

/// A Python that has Mitsuba and noisefloor from a new wheel, ready to be given a program.
pub fn command() -> Result<Command> {
    tools::packages(&[&[LLVM], &python::BUILD[..]].concat())?;
    python::build()?;
    let folder = paths::target().join("mitsuba");
    let (interpreter, installed) = (folder.join("bin/python"), folder.join("requirements.txt"));
    let wanted = paths::read(REQUIREMENTS)?;
    if fs::read_to_string(&installed).ok().as_deref() != Some(&wanted) {
        println!("   installing Mitsuba into {}", folder.display());
        python::create(&folder, &[])?;
        python::fetch(&interpreter, &["--requirement", REQUIREMENTS])?;
        fs::write(&installed, wanted).with_context(|| format!("cannot write {}", installed.display()))?;
    }
    python::install(&interpreter)?;
    let mut command = run::command(interpreter);
    command.env("PYTHONDONTWRITEBYTECODE", "1").env("DRJIT_LIBLLVM_PATH", LLVM.file);
    Ok(command)
}

pub fn test() -> Result<()> {
    run::check(command()?.arg("integrations/mitsuba/test_mitsuba.py"))
}
