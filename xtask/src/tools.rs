//! What the tests need besides cargo: found, installed where that is allowed, or named.

use crate::run;
use anyhow::{Result, bail, ensure};
use std::fmt;
use std::path::Path;
use std::process::{Command, Stdio};

/// An error that is no failure: something cannot run here, and this says why.
#[derive(Debug)]
pub struct Missing(pub String);

impl std::error::Error for Missing {}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Fails unless every tool is there; on Debian, as root, missing compilers are installed first.
pub fn ensure() -> Result<()> {
    let components: Vec<_> =
        ["fmt", "clippy"].into_iter().filter(|name| !works(run::cargo().args([name, "--version"]))).collect();
    ensure!(
        components.is_empty(),
        "missing: cargo {}. The tests check formatting and lints: `rustup component add rustfmt clippy` (Debian's own \
         Rust: apt-get install rustfmt rust-clippy)",
        components.join(", cargo ")
    );
    compilers()
}

/// Fails unless there are C and C++ compilers and binutils; on Debian, as root, missing ones are installed first.
pub fn compilers() -> Result<()> {
    let mut missing = missing_compilers();
    if !missing.is_empty() && can_install() {
        println!("missing: {}; installing gcc, g++ and binutils", missing.join(", "));
        install(&["gcc", "g++", "libc6-dev", "binutils"])?;
        missing = missing_compilers();
    }
    ensure!(
        missing.is_empty(),
        "missing: {}. What is compiled needs a C99 and a C++17 compiler and binutils (Debian: apt-get install gcc g++ \
         libc6-dev binutils); $CC and $CXX name other compilers",
        missing.join(", ")
    );
    Ok(())
}

/// A Debian package, and a file that it brings: if that is there, the package is installed. A name without folders is
/// that of a program in any folder of the path: its equal from elsewhere will do.
#[derive(Clone, Copy)]
pub struct Package {
    pub name: &'static str,
    pub file: &'static str,
}

/// Installs those that are missing where that is allowed; otherwise [`Missing`] says what to do.
pub fn packages(wanted: &[Package]) -> Result<()> {
    let missing = || -> Vec<&str> {
        wanted.iter().filter(|package| !is_there(package.file)).map(|package| package.name).collect()
    };
    let before = missing();
    if before.is_empty() {
        return Ok(());
    }
    if !can_install() {
        bail!(Missing(format!("missing: {0}. On Debian: apt-get install {0}", before.join(" "))));
    }
    println!("   installing {}", before.join(", "));
    install(&before)?;
    let after = missing();
    if !after.is_empty() {
        bail!("the packages {} were installed, but their files are not where Debian has them", after.join(", "));
    }
    Ok(())
}

fn is_there(file: &str) -> bool {
    // An absolute path stays as it is.
    std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()).any(|folder| folder.join(file).exists())
}

/// Debian's package manager is there and this user may use it.
pub fn can_install() -> bool {
    let user = run::read(run::command("id").arg("-u"));
    Path::new("/etc/debian_version").exists() && user.is_ok_and(|id| id.trim() == "0")
}

fn install(packages: &[&str]) -> Result<()> {
    run::check(run::command("apt-get").args(["update", "-qq"]))?;
    let mut install = run::command("apt-get");
    install.env("DEBIAN_FRONTEND", "noninteractive").args(["install", "-y", "-qq", "--no-install-recommends"]);
    // What it says of each package would hide what comes before and after.
    run::check(install.args(packages).stdout(Stdio::null()))
}

fn missing_compilers() -> Vec<String> {
    let compilers = [("CC", "cc"), ("CXX", "c++")].map(|(variable, default)| run::compiler(variable, default));
    missing(compilers.into_iter().chain(["ld", "ar", "nm", "objcopy"].map(run::command)))
}

/// Fails unless these programs start; `packages` of Debian have them.
pub fn need(programs: &[&str], packages: &str) -> Result<()> {
    let missing = missing(programs.iter().map(run::command)).join(", ");
    ensure!(missing.is_empty(), "missing: {missing} (Debian: apt-get install {packages})");
    Ok(())
}

/// The names of those that do not start.
fn missing(programs: impl IntoIterator<Item = Command>) -> Vec<String> {
    let mut missing: Vec<_> = programs.into_iter().collect();
    missing.retain_mut(|program| !works(program.arg("--version")));
    missing.iter().map(|program| program.get_program().to_string_lossy().into_owned()).collect()
}

fn works(command: &mut Command) -> bool {
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}
