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
pub(crate) fn ensure() -> Result<()> {
    let components: Vec<_> = ["fmt", "clippy"].into_iter().filter(|name| !works(&cargo_tool(name))).collect();
    if !components.is_empty() {
        bail!(
            "missing: cargo {}. The tests check formatting and lints: `rustup component add rustfmt clippy` (Debian's own \
             Rust: apt-get install rustfmt rust-clippy)",
            components.join(", cargo ")
        );
    }
    let missing = missing_compilers();
    if missing.is_empty() {
        return Ok(());
    }
    if Path::new("/etc/debian_version").exists() && is_root() {
        println!("missing: {}; installing gcc, g++ and binutils", missing.join(", "));
        run::check(run::command("apt-get").args(["update", "-qq"]))?;
        run::check(run::command("apt-get").env("DEBIAN_FRONTEND", "noninteractive").args([
            "install",
            "-y",
            "-qq",
            "--no-install-recommends",
            "gcc",
            "g++",
            "libc6-dev",
            "binutils",
        ]))?;
    }
    let missing = missing_compilers();
    if !missing.is_empty() {
        bail!(
            "missing: {}. The C and C++ tests need a C99 and a C++17 compiler and binutils (Debian: apt-get install gcc g++ \
             libc6-dev binutils); $CC and $CXX name other compilers",
            missing.join(", ")
        );
    }
    Ok(())
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
