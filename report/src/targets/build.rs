//! The C library for another target, as cargo's archive.

use super::platform::Platform;
use anyhow::{Result, bail};
use std::path::PathBuf;
use std::process::Command;
use xtask::{paths, run};

/// Debian's compiler, as rustup's has only the targets that its user installed, and not always a way to get more.
pub(crate) const CARGO: &str = "/usr/bin/cargo";
pub(crate) const RUSTC: &str = "/usr/bin/rustc";
/// Compiles what the target needs of Rust itself.
pub(crate) const BUILD_CORE: [&str; 2] = ["-Z", "build-std=core"];

/// Builds it.
pub(crate) fn archive(platform: &Platform) -> Result<PathBuf> {
    let folder = folder(platform);
    let mut cargo = run::command(CARGO);
    environment(&mut cargo).env("CARGO_PROFILE_RELEASE_OPT_LEVEL", &platform.opt_level);
    cargo.args(["rustc", "--quiet", "--package", "noisefloor-capi", "--release", "--crate-type", "staticlib"]);
    if platform.float_alone {
        cargo.arg("--no-default-features");
    }
    run::check(cargo.args(BUILD_CORE).args(["--target", &platform.triple, "--target-dir"]).arg(&folder))?;
    let archive = folder.join(&platform.triple).join("release/libnoisefloor.a");
    if !archive.exists() {
        bail!("cargo wrote no {}", archive.display());
    }
    Ok(archive)
}

/// Cargo's target folder: one for each, so that several may be built at a time and none undoes what another made.
pub(crate) fn folder(platform: &Platform) -> PathBuf {
    paths::target().join("cross").join(platform.id())
}

/// `-Z` is not stable; this lets a stable compiler accept it. What rustup's cargo set for us is not for this one.
pub(crate) fn environment(command: &mut Command) -> &mut Command {
    command.env("RUSTC_BOOTSTRAP", "1").env("RUSTC", RUSTC).env_remove("RUSTUP_TOOLCHAIN").env_remove("CARGO")
}
