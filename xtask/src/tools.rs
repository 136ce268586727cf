//! What the tests need besides cargo: found, installed where that is allowed, or named.

use crate::run;
use anyhow::{Result, bail};
use std::path::Path;
use std::process::Stdio;

/// A program and how it is asked for its version.
struct Tool {
    program: String,
    arguments: &'static [&'static str],
}

/// Fails unless every tool is there; on Debian, as root, missing compilers are installed first.
pub fn ensure() -> Result<()> {
    let components: Vec<_> = ["fmt", "clippy"].into_iter().filter(|name| !works(&cargo_tool(name))).collect();
    if !components.is_empty() {
        bail!(
            "missing: cargo {}. The tests check formatting and lints: `rustup component add rustfmt clippy` (Debian's \
             own Rust: apt-get install rustfmt rust-clippy)",
            components.join(", cargo ")
        );
    }
    let missing = missing_compilers();
    if missing.is_empty() {
        return Ok(());
    }
    if can_install() {
        println!("missing: {}; installing gcc, g++ and binutils", missing.join(", "));
        install(&["gcc", "g++", "libc6-dev", "binutils"])?;
    }
    let missing = missing_compilers();
    if !missing.is_empty() {
        bail!(
            "missing: {}. The C and C++ tests need a C99 and a C++17 compiler and binutils (Debian: apt-get install \
             gcc g++ libc6-dev binutils); $CC and $CXX name other compilers",
            missing.join(", ")
        );
    }
    Ok(())
}

/// A Debian package, and a file that it brings: if that is there, the package or an equal of it is installed.
#[derive(Clone, Copy)]
pub struct Package {
    pub name: &'static str,
    pub file: &'static str,
}

/// Installs those that are missing where that is allowed; otherwise returns what is missing and what to do.
pub fn packages(wanted: &[Package]) -> Result<Option<String>> {
    let missing = |wanted: &[Package]| -> Vec<&str> {
        wanted.iter().filter(|package| !Path::new(package.file).exists()).map(|package| package.name).collect()
    };
    let before = missing(wanted);
    if before.is_empty() {
        return Ok(None);
    }
    if can_install() {
        println!("   installing {}", before.join(", "));
        install(&before)?;
        let after = missing(wanted);
        if !after.is_empty() {
            bail!("the packages {} were installed, but their files are not where Debian has them", after.join(", "));
        }
        return Ok(None);
    }
    Ok(Some(format!("missing: {0}. On Debian: apt-get install {0}", before.join(" "))))
}

/// Debian's package manager is there and this user may use it.
pub fn can_install() -> bool {
    Path::new("/etc/debian_version").exists() && is_root()
}

fn install(packages: &[&str]) -> Result<()> {
    run::check(run::command("apt-get").args(["update", "-qq"]))?;
    let mut install = run::command("apt-get");
    install.env("DEBIAN_FRONTEND", "noninteractive").args(["install", "-y", "-qq", "--no-install-recommends"]);
    run::check(install.args(packages))
}

fn missing_compilers() -> Vec<String> {
    let compiler = |variable: &str, default: &str| {
        std::env::var(variable).ok().filter(|name| !name.is_empty()).unwrap_or_else(|| default.to_owned())
    };
    let names = [compiler("CC", "cc"), compiler("CXX", "c++")];
    let binutils = ["ld", "ar", "nm", "objcopy"].map(str::to_owned);
    let tools = names.into_iter().chain(binutils).map(|program| Tool { program, arguments: &["--version"] });
    tools.filter(|tool| !works(tool)).map(|tool| tool.program).collect()
}

fn cargo_tool(name: &str) -> Tool {
    let arguments: &[&str] = if name == "fmt" { &["fmt", "--version"] } else { &["clippy", "--version"] };
    Tool { program: run::cargo().get_program().to_string_lossy().into_owned(), arguments }
}

fn works(tool: &Tool) -> bool {
    let mut command = run::command(&tool.program);
    command.args(tool.arguments).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

fn is_root() -> bool {
    run::read(run::command("id").arg("-u")).is_ok_and(|id| id.trim() == "0")
}
