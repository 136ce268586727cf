//! Versions that are said in several places: they must be the same.

use crate::outcome::Outcome;
use crate::{paths, run};
use anyhow::{Context, Result, bail};
use std::fs;

/// Texts that name the oldest Rust that compiles the project.
const NAME_RUST: [&str; 2] = ["README.md", "docs/install.md"];

/// The declared Rust version is what the texts say and compiles the libraries; CHANGELOG.md knows the project's
/// version.
pub fn check() -> Result<Outcome> {
    let metadata = run::read(run::cargo().args(["metadata", "--no-deps", "--format-version", "1"]))?;
    let metadata: serde_json::Value = serde_json::from_str(&metadata).context("cargo metadata wrote no JSON")?;
    let packages = metadata["packages"].as_array().map_or(&[][..], Vec::as_slice);
    let core = packages.iter().find(|package| package["name"] == "noisefloor").context("there is no `noisefloor`")?;
    let rust = core["rust_version"].as_str().context("`noisefloor` has no rust-version")?;
    for package in packages {
        if package["rust_version"] != rust {
            bail!("{} has the rust-version {}, `noisefloor` {rust}", package["name"], package["rust_version"]);
        }
    }
    let read = |name: &str| fs::read_to_string(paths::root().join(name)).with_context(|| format!("cannot read {name}"));
    for name in NAME_RUST {
        let text = read(name)?;
        let said: Vec<_> = text.split("Rust 1.").skip(1).map(minor).collect();
        if said.is_empty() || said.iter().any(|minor| format!("1.{minor}") != rust) {
            bail!("{name} says Rust 1.{}, Cargo.toml {rust}", said.join(" and 1."));
        }
    }
    let version = core["version"].as_str().context("`noisefloor` has no version")?;
    if !read("CHANGELOG.md")?.lines().any(|line| line.split(' ').take(2).eq(["##", version])) {
        bail!("CHANGELOG.md has no section `## {version}`, which is the version in Cargo.toml");
    }
    compiles(rust)
}

/// Compiles what is published with the declared version, if that is at hand.
fn compiles(rust: &str) -> Result<Outcome> {
    let version = run::read(run::command("rustc").arg("--version"))?;
    if version.split_whitespace().nth(1).is_some_and(|version| version.starts_with(&format!("{rust}."))) {
        println!("   this is Rust {rust}, so all tests are with the declared version");
        return Ok(Outcome::Passed);
    }
    if run::read(run::command("rustup").args(["run", rust, "cargo", "--version"])).is_err() {
        return Ok(Outcome::NotRun(format!(
            "the texts agree, but Rust {rust} is not installed to compile with: `rustup toolchain install {rust}`"
        )));
    }
    let mut check = run::command("rustup");
    check.args(["run", rust, "cargo", "check", "--quiet", "--locked", "--package", "noisefloor", "--package"]);
    run::check(check.args(["noisefloor-capi", "--target-dir"]).arg(paths::target().join("declared")))?;
    Ok(Outcome::Passed)
}

/// The digits at the beginning.
fn minor(text: &str) -> &str {
    text.split(|c: char| !c.is_ascii_digit()).next().unwrap_or_default()
}
