//! The C library for another target, as cargo's archive.

use crate::{paths, run};
use anyhow::{Result, bail};
use std::path::PathBuf;

/// Builds it with Debian's compiler: rustup's has only the targets that its user installed, and not always a way to get more.
pub(crate) fn archive(triple: &str) -> Result<PathBuf> {
    let folder = paths::target().join("cross");
    let mut cargo = run::command("/usr/bin/cargo");
    // `-Z build-std` is not stable; this lets a stable compiler accept it. What rustup's cargo set for us is not for this one.
    cargo.env("RUSTC_BOOTSTRAP", "1").env("RUSTC", "/usr/bin/rustc").env_remove("RUSTUP_TOOLCHAIN").env_remove("CARGO");
    cargo.args(["rustc", "--quiet", "--package", "noisefloor-capi", "--release", "--crate-type", "staticlib"]);
    cargo.args(["-Z", "build-std=core", "--target", triple, "--target-dir"]).arg(&folder);
    run::check(&mut cargo)?;
    let archive = folder.join(triple).join("release/libnoisefloor.a");
    if !archive.exists() {
        bail!("cargo wrote no {}", archive.display());
    }
    Ok(archive)
}
