//! The C tests under valgrind's memcheck, and threads under its detectors of races: valgrind also sees what the
//! library, compiled without sanitizers, does.

use crate::outcome::Outcome;
use crate::tools::{self, Package};
use crate::{c_tests, run};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const PACKAGES: [Package; 1] = [Package { name: "valgrind", file: "/usr/bin/valgrind" }];
/// What valgrind exits with for its own findings, whatever the program's status.
const FOUND: i32 = 99;
/// What tests/valgrind/comparisons.c exits with where NaN compares wrongly.
const WRONG: i32 = 1;
/// Has tests/c leave out the single checks that need it right (tests/c/check.h).
const WITHOUT_NAN: &str = "-DNAN_TAKEN_FOR_FINITE";

pub fn run(archive: &Path) -> Result<Outcome> {
    if let Some(missing) = tools::packages(&PACKAGES)? {
        return Ok(Outcome::NotRun(missing));
    }
    detects()?;
    let options: &[&str] = if compares_nan()? { &[] } else { &[WITHOUT_NAN] };
    if !options.is_empty() {
        println!("   this valgrind takes NaN for finite: the checks of tests/c that say so are left out");
    }
    c_tests::each(&c_tests::sources()?, |source| {
        let output = memcheck(&compile(source, options, Some(archive))?)?;
        print!("   {}", String::from_utf8_lossy(&output.stdout));
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr);
            bail!("{}: {} under valgrind\n{}", source.display(), output.status, said.trim())
        }
        Ok(())
    })?;
    Ok(Outcome::Passed)
}

/// The header's rules for threads under the detectors of data races, which must find what breaks them.
pub fn threads(archive: &Path) -> Result<Outcome> {
    if let Some(missing) = tools::packages(&PACKAGES)? {
        return Ok(Outcome::NotRun(missing));
    }
    let program = c_tests::output("threads_test")?;
    let mut compiler = run::compiler("CXX", "c++");
    compiler.arg("-std=c++17").args(c_tests::STRICT).args(["-g", "-pthread", "-Iinclude"]);
    run::check(compiler.arg("tests/valgrind/threads.cpp").arg(archive).arg("-o").arg(&program))?;
    for tool in ["helgrind", "drd"] {
        let output = valgrind(tool).arg(&program).output().context("cannot start valgrind")?;
        if !output.status.success() {
            bail!(
                "{tool}, an accumulator for each thread: {}\n{}",
                output.status,
                String::from_utf8_lossy(&output.stderr)
            );
        }
        let output = valgrind(tool).arg(&program).arg("race").output().context("cannot start valgrind")?;
        if output.status.code() != Some(FOUND) {
            bail!("{tool} did not find that threads share an accumulator ({})", output.status);
        }
    }
    Ok(Outcome::Passed)
}

/// Fails unless valgrind finds a read of memory that nothing wrote.
fn detects() -> Result<()> {
    let output = memcheck(&compile(Path::new("tests/valgrind/undefined.c"), &[], None)?)?;
    if output.status.code() != Some(FOUND) {
        bail!("valgrind did not find the undefined value in tests/valgrind/undefined.c ({})", output.status);
    }
    Ok(())
}

/// Whether this valgrind's `x != y` of vectors is false with NaN, as the processor's.
fn compares_nan() -> Result<bool> {
    let program = compile(Path::new("tests/valgrind/comparisons.c"), &[], None)?;
    run::read(&mut run::command(&program)).context("this processor compares with NaN in a way of its own")?;
    let output = memcheck(&program)?;
    match output.status.code() {
        Some(0) => Ok(true),
        Some(WRONG) => Ok(false),
        _ => bail!("{}\n{}", output.status, String::from_utf8_lossy(&output.stderr).trim()),
    }
}

fn compile(source: &Path, options: &[&str], archive: Option<&Path>) -> Result<PathBuf> {
    let program = c_tests::output("valgrind_test")?;
    let mut compiler = run::compiler("CC", "cc");
    compiler.arg("-std=c99").args(c_tests::STRICT).args(["-g", "-Iinclude", "-Itests/c"]).args(options);
    run::check(compiler.arg(source).args(archive).args(["-lm", "-o"]).arg(&program))?;
    Ok(program)
}

fn memcheck(program: &Path) -> Result<Output> {
    valgrind("memcheck").arg("--leak-check=full").arg(program).output().context("cannot start valgrind")
}

fn valgrind(tool: &str) -> Command {
    let mut command = run::command("valgrind");
    command.arg("--quiet").arg(format!("--tool={tool}")).arg(format!("--error-exitcode={FOUND}"));
    command
}
