//! What the tests need besides cargo: found, installed where that is allowed, or named.

use crate::run;
use anyhow::{Result, bail, ensure};
use std::fmt;
use std::fs::File;
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

/// Fails unless every tool is there.
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

/// What C is compiled with.
pub const C: [Package; 2] = [Package { name: "build-essential", file: "cc" }, Package { name: "binutils", file: "ar" }];
const CPP: Package = Package { name: "g++", file: "c++" };

/// Fails unless there are C and C++ compilers, or $CC and $CXX name others, and binutils.
pub fn compilers() -> Result<()> {
    let is_named = |variable| std::env::var_os(variable).is_some_and(|name| !name.is_empty());
    let wanted = [(C[0], is_named("CC")), (CPP, is_named("CXX")), (C[1], false)];
    packages(&wanted.into_iter().filter(|(_, is_named)| !is_named).map(|(package, _)| package).collect::<Vec<_>>())
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

const DEBIAN: &str = "/etc/debian_version";

/// Debian's package manager is there and this user may use it.
pub fn can_install() -> bool {
    let user = run::read(run::command("id").arg("-u"));
    Path::new(DEBIAN).exists() && user.is_ok_and(|id| id.trim() == "0")
}

fn install(packages: &[&str]) -> Result<()> {
    // The steps that go on beside others install too, and `apt-get update` does not wait for another.
    let turn = File::open(DEBIAN)?;
    turn.lock()?;
    run::check(run::command("apt-get").args(["update", "-qq"]))?;
    let mut install = run::command("apt-get");
    install.env("DEBIAN_FRONTEND", "noninteractive").args(["-o", "DPkg::Lock::Timeout=600"]);
    install.args(["install", "-y", "-qq", "--no-install-recommends"]);
    // What it says of each package would hide what comes before and after.
    run::check(install.args(packages).stdout(Stdio::null()))
}

fn works(command: &mut Command) -> bool {
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}
