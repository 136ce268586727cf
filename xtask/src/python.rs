//! examples_c/python: the ctypes declarations against the header, its tests, and a short training run.

use crate::c_tests::output;
use crate::outcome::Outcome;
use crate::tools::{self, Package};
use crate::{paths, run};
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const FOLDER: &str = "examples_c/python";

pub fn run(archive: &Path) -> Result<Outcome> {
    if !works() {
        let wanted = [Package { name: "python3", file: "/usr/bin/python3" }];
        if let Some(missing) = tools::packages(&wanted)? {
            return Ok(Outcome::NotRun(missing));
        }
    }
    check_declarations()?;
    let library = shared(archive)?;
    for arguments in [&["test_noisefloor.py"][..], &["train_digits.py", "2", "1"]] {
        let mut command = python();
        command.current_dir(paths::root().join(FOLDER)).env("NOISEFLOOR_LIBRARY", &library);
        run::check(command.args(["-W", "error::SyntaxWarning"]).args(arguments))?;
    }
    Ok(Outcome::Passed)
}

/// noisefloor.py prints its declarations as C; a compiler that sees the header's beside them refuses those that differ.
fn check_declarations() -> Result<()> {
    let text = run::read(python().arg(format!("{FOLDER}/noisefloor.py")))?;
    let source = output("python_declarations.c")?;
    fs::write(&source, text).with_context(|| format!("cannot write {}", source.display()))?;
    let mut compiler = run::compiler("CC", "cc");
    compiler.args(["-std=c11", "-Wall", "-Wextra", "-pedantic", "-Werror", "-fsyntax-only", "-Iinclude"]);
    run::check(compiler.arg(&source))
        .with_context(|| format!("{FOLDER}/noisefloor.py does not declare what noisefloor.h does"))
}

/// The archive as a shared library.
fn shared(archive: &Path) -> Result<PathBuf> {
    let library = output("libnoisefloor.so")?;
    let mut compiler = run::compiler("CC", "cc");
    compiler.args(["-shared", "-nostdlib", "-Wl,--whole-archive"]).arg(archive);
    run::check(compiler.args(["-Wl,--no-whole-archive", "-lc", "-o"]).arg(&library))?;
    Ok(library)
}

fn python() -> Command {
    let mut command = run::command("python3");
    // No bytecode beside the sources.
    command.env("PYTHONDONTWRITEBYTECODE", "1");
    command
}

fn works() -> bool {
    let mut command = python();
    command.args(["-c", "import ctypes, unittest"]).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}
