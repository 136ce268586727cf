//! `cargo xtask playground`: the page to play with, one file with its WebAssembly module inside.

use crate::c_tests::PYTHON;
use crate::tools::{self, Package};
use crate::{paths, run};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::PathBuf;

const COMPILER: [Package; 4] = [
    Package { name: "rustc-web", file: run::DEBIANS[1] },
    Package { name: "cargo-web", file: run::DEBIANS[0] },
    Package { name: "rust-web-src", file: "/usr/share/doc/rust-web-src" },
    Package { name: "lld-19", file: "/usr/bin/wasm-ld-19" },
];
const BROWSER: [Package; 2] = [Package { name: "chromium", file: "chromium" }, PYTHON];
const MANIFEST: &str = "docs/playground/Cargo.toml";

/// Makes target/demo/playground.html.
pub fn build() -> Result<PathBuf> {
    tools::packages(&COMPILER)?;
    println!("building the page to play with");
    let (target, triple) = (paths::target().join("playground"), "wasm32-unknown-unknown");
    let mut cargo = run::command(run::DEBIANS[0]);
    run::with_debians(&mut cargo).env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", COMPILER[3].file);
    cargo.args(["rustc", "--quiet", "--release", "--lib", "--crate-type", "cdylib", "--manifest-path", MANIFEST]);
    run::compile(cargo.args(["-Z", "build-std=core", "--target", triple, "--target-dir"]).arg(&target))?;
    let module = target.join(triple).join("release/noisefloor_playground.wasm");
    run::check(run::command("gzip").args(["--best", "--no-name", "--keep", "--force"]).arg(&module))?;
    let module = run::read(run::command("base64").arg("--wrap=0").arg(module.with_extension("wasm.gz")))?;
    let (place, page) = ("const embedded = \"", paths::read("docs/playground/page.html")?);
    if page.matches(place).count() != 1 {
        bail!("docs/playground/page.html has no one place `{place}` for the module");
    }
    let folder = paths::target().join("demo");
    fs::create_dir_all(&folder).with_context(|| format!("cannot create {}", folder.display()))?;
    let out = folder.join("playground.html");
    fs::write(&out, page.replace(place, &(place.to_owned() + &module)))
        .with_context(|| format!("cannot write {}", out.display()))?;
    Ok(out)
}

/// The page in headless Chromium, beside the same program compiled for this machine.
pub fn test() -> Result<()> {
    tools::packages(&BROWSER)?;
    let page = build()?;
    let mut cargo = run::cargo();
    cargo.args(["build", "--quiet", "--manifest-path", MANIFEST, "--target-dir"]);
    let folder = paths::target().join("playground");
    run::check(cargo.arg(&folder))?;
    let mut python = run::command("python3");
    python.args(["-B", "tests/programs/playground.py"]).arg(page).arg(folder.join("debug/numbers"));
    run::check(python.arg(paths::target().join("demo/playground.png")))
}
