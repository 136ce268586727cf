//! Running other programs, with errors that name the program and what to do.

use anyhow::{Context, Result, bail};
use std::ffi::OsStr;
use std::io::{self, Read};
use std::process::{Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// A command that runs in the workspace root.
pub fn command(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    command.current_dir(crate::paths::root());
    command
}

/// The cargo that runs this program.
pub fn cargo() -> Command {
    command(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Debian's cargo and compiler of Rust, since rustup's have only the targets that their user installed.
pub const DEBIANS: [&str; 2] = ["/usr/bin/cargo", "/usr/bin/rustc"];

/// Lets a command compile with Debian's, also with unstable options. What rustup's cargo set for us is not for these.
pub fn with_debians(command: &mut Command) -> &mut Command {
    command.env("RUSTC_BOOTSTRAP", "1").env("RUSTC", DEBIANS[1]).env_remove("RUSTUP_TOOLCHAIN").env_remove("CARGO")
}

/// The C or C++ compiler: `$CC` / `$CXX`, or the system's.
pub fn compiler(variable: &str, default: &str) -> Command {
    command(std::env::var_os(variable).filter(|name| !name.is_empty()).unwrap_or_else(|| default.into()))
}

/// Runs to the end; a failure is an error that shows the command line.
pub fn check(command: &mut Command) -> Result<()> {
    judge(command.status().with_context(|| missing(command))?, command)
}

/// As [`check`], and says every ten seconds that a compiler is still at work.
pub fn compile(command: &mut Command) -> Result<()> {
    let (mut child, start) = (command.spawn().with_context(|| missing(command))?, Instant::now());
    let mut next = 10;
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        thread::sleep(Duration::from_millis(20));
        if start.elapsed() > Duration::from_secs(next) {
            println!("   compiling for {next} s");
            next += 10;
        }
    };
    judge(status, command)
}

fn judge(status: ExitStatus, command: &Command) -> Result<()> {
    if !status.success() {
        bail!("failed ({status}): {}", line(command));
    }
    Ok(())
}

/// As [`check`], and returns what the command said instead of showing it.
pub fn hear(command: &mut Command) -> Result<(String, Result<()>)> {
    let (mut reader, writer) = io::pipe()?;
    let mut child = command.stdout(writer.try_clone()?).stderr(writer).spawn().with_context(|| missing(command))?;
    // The pipe ends where nobody can write to it.
    command.stdout(Stdio::null()).stderr(Stdio::null());
    let mut said = Vec::new();
    reader.read_to_end(&mut said)?;
    Ok((String::from_utf8_lossy(&said).into_owned(), judge(child.wait()?, command)))
}

/// As [`check`], and returns what the command wrote to standard output.
pub fn read(command: &mut Command) -> Result<String> {
    let output = command.output().with_context(|| missing(command))?;
    if !output.status.success() {
        bail!("failed ({}): {}\n{}", output.status, line(command), String::from_utf8_lossy(&output.stderr));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// What cargo says of the workspace's packages.
pub fn packages() -> Result<Vec<serde_json::Value>> {
    metadata(&["--no-deps"])
}

/// What cargo says of the packages that the workspace needs, with these options.
pub fn metadata(options: &[&str]) -> Result<Vec<serde_json::Value>> {
    let metadata = read(cargo().args(["metadata", "--format-version", "1"]).args(options))?;
    let metadata: serde_json::Value = serde_json::from_str(&metadata).context("cargo metadata wrote no JSON")?;
    Ok(metadata["packages"].as_array().context("cargo metadata names no packages")?.clone())
}

fn missing(command: &Command) -> String {
    let program = command.get_program().to_string_lossy();
    format!("cannot start `{program}`: is it installed? (Debian: apt-get install build-essential)")
}

fn line(command: &Command) -> String {
    let mut words = vec![command.get_program().to_string_lossy()];
    words.extend(command.get_args().map(|argument| argument.to_string_lossy()));
    words.join(" ")
}
