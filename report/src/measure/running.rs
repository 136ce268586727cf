//! Programs of examples_c, compiled; and a program that runs: its lines are read as they come.

use anyhow::{Context, Result, bail};
use std::io::{self, BufRead, BufReader, Seek};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use xtask::{library, paths};

/// Compiles `examples_c/SOURCE` against the library.
pub(crate) fn example(source: &str, options: &[&str]) -> Result<PathBuf> {
    let program = paths::output().join(Path::new(source).with_extension(""));
    let (mut compiler, standard) = match source.ends_with(".c") {
        true => (xtask::run::compiler("CC", "cc"), "-std=c99"),
        false => (xtask::run::compiler("CXX", "c++"), "-std=c++17"),
    };
    compiler.args([standard, "-Wall", "-Wextra", "-Iinclude"]).args(options);
    compiler.arg(Path::new("examples_c").join(source)).arg(library::build()?);
    xtask::run::compile(compiler.args(["-pthread", "-lm", "-o"]).arg(&program))?;
    Ok(program)
}

/// Runs a program to its end, and returns what it wrote to the standard error. `take` sees each line of the standard
/// output as it comes; where that fails, the program is ended.
pub(crate) fn run(mut command: Command, mut take: impl FnMut(&str) -> Result<()>) -> Result<String> {
    // A pipe that nobody empties would stop the program at 64 kB of errors.
    let mut errors = tempfile::tempfile()?;
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(errors.try_clone()?);
    let line = format!("{command:?}");
    let mut child = command.spawn().with_context(|| format!("cannot start {line}"))?;
    let mut lines = BufReader::new(child.stdout.take().context("the program has no output")?).lines();
    let taken = lines.try_for_each(|line| take(&line.context("cannot read the program's output")?));
    if taken.is_err() {
        // It may have ended by itself.
        let _ = child.kill();
    }
    let status = child.wait().context("the program was lost")?;
    taken?;
    errors.rewind()?;
    let errors = io::read_to_string(errors).context("cannot read the program's errors")?;
    if !status.success() {
        bail!("{line} failed, {status}\n{}", errors.trim());
    }
    Ok(errors)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shell(script: &str, take: impl FnMut(&str) -> Result<()>) -> Result<String> {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        run(command, take)
    }

    #[test]
    fn many_errors_do_not_stop_the_program_and_wrong_output_does() {
        // 300 kB of errors before the first line of output.
        let script = "i=0; while [ $i -lt 3000 ]; do printf '%0100d' 0 >&2; i=$((i + 1)); done; echo line";
        assert_eq!(shell(script, |_| Ok(())).expect("no failure").len(), 300_000);
        assert!(shell("echo line; exec sleep 60", |line| bail!("`{line}`")).is_err());
        let error = shell("echo reason >&2; exit 3", |_| Ok(())).expect_err("it failed").to_string();
        assert!(error.contains("\"sh\" \"-c\"") && error.contains("exit status: 3\nreason"), "{error}");
    }
}
