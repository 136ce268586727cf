//! The C tests under valgrind's memcheck, and threads under its detectors of races: valgrind also sees what the library, compiled without sanitizers, does.

use crate::test::Outcome;
use crate::tools::{self, Package};
use crate::{c_tests, run};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const PACKAGES: [Package; 1] = [Package { name: "valgrind", file: "/usr/bin/valgrind" }];
/// What valgrind exits with for its own findings, whatever the program's status.
const FOUND: i32 = 99;
/// What a test exits with whose checks failed.
const CHECKS_FAILED: i32 = 1;
/// Tests that pass NaN to the functions that have AVX2 versions: where valgrind takes NaN for finite, calls succeed that must
/// not, and change what they must not.
const TESTS_WITH_NAN: [&str; 4] = ["batch", "block", "image", "table"];

pub(crate) fn run(archive: &Path) -> Result<Outcome> {
    if let Some(missing) = tools::packages(&PACKAGES)? {
        return Ok(Outcome::NotRun(missing));
    }
    detects()?;
    let compares_nan = compares_nan()?;
    c_tests::each(&c_tests::sources()?, |source| {
        let name = source.file_stem().unwrap_or_default().to_string_lossy();
        let output = memcheck(&compile(source, Some(archive))?)?;
        let said = String::from_utf8_lossy(&output.stderr);
        match output.status.code() {
            Some(0) => Ok(()),
            Some(CHECKS_FAILED) if !compares_nan && TESTS_WITH_NAN.contains(&&*name) => {
                if let Some(line) = unexplained(&said) {
                    bail!(
                        "{}: under valgrind a check failed that its comparisons with NaN do not explain: {line}",
                        name
                    )
                }
                println!(
                    "   {name}: memory without a finding; its checks of NaN left out, which this valgrind takes for finite"
                );
                Ok(())
            }
            _ => bail!("{}: {} under valgrind\n{}", name, output.status, said.trim()),
        }
    })?;
    Ok(Outcome::Passed)
}

/// The header's rules for threads under the detectors of data races, which must find what breaks them.
pub(crate) fn threads(archive: &Path) -> Result<Outcome> {
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

/// The first failed check that is about something else than calls that were to refuse NaN, and what they left alone.
fn unexplained(said: &str) -> Option<&str> {
    let mut refused = false;
    said.lines().find(|line| {
        let is_returned = line.starts_with("    returned");
        if is_returned {
            refused = true;
            return !line.ends_with("returned 0 (success), not -3");
        }
        // What the call was, or, after one that succeeded, what it changed.
        let is_call = line.contains("tests/c/") && !line.contains(": failed: ");
        let is_change = refused && (line.contains(": failed: outputs untouched: ") || line.contains("memcmp(before"));
        !(is_call || is_change)
    })
}

/// Fails unless valgrind finds a read of memory that nothing wrote.
fn detects() -> Result<()> {
    let output = memcheck(&compile(Path::new("tests/valgrind/undefined.c"), None)?)?;
    if output.status.code() != Some(FOUND) {
        bail!("valgrind did not find the undefined value in tests/valgrind/undefined.c ({})", output.status);
    }
    Ok(())
}

/// Whether this valgrind's `x != y` of vectors is false with NaN, as the processor's.
fn compares_nan() -> Result<bool> {
    let program = compile(Path::new("tests/valgrind/comparisons.c"), None)?;
    run::read(&mut run::command(&program)).context("this processor compares with NaN in a way of its own")?;
    let output = memcheck(&program)?;
    match output.status.code() {
        Some(0) => Ok(true),
        Some(CHECKS_FAILED) => Ok(false),
        _ => bail!("{}\n{}", output.status, String::from_utf8_lossy(&output.stderr).trim()),
    }
}

fn compile(source: &Path, archive: Option<&Path>) -> Result<PathBuf> {
    let program = c_tests::output("valgrind_test")?;
    let mut compiler = run::compiler("CC", "cc");
    compiler.arg("-std=c99").args(c_tests::STRICT).args(["-g", "-Iinclude", "-Itests/c"]);
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

#[cfg(test)]
mod tests {
    use super::unexplained;

    const REFUSED: &str = "tests/c/block.c:105: nf_cv_block_estimate(u)\n    returned 0 (success), not -3\n";

    #[test]
    fn only_failures_with_nan_are_explained() {
        let change = "tests/c/block.c:105: failed: outputs untouched: nf_cv_block_estimate(u)";
        assert_eq!(unexplained(&[REFUSED, change].concat()), None);
        assert_eq!(unexplained(change), Some(change));
        let other = "tests/c/block.c:9: failed: x == 1";
        assert_eq!(unexplained(&[REFUSED, other].concat()), Some(other));
        let status = "    returned -4 (out of range), not -3";
        assert_eq!(unexplained(&["tests/c/block.c:9: f(u)\n", status].concat()), Some(status));
    }
}
