//! The C library for another target: as cargo's archive, and as a part of another project.

use super::platform::Platform;
use anyhow::{Context, Result};
use std::fs;
use std::path::PathBuf;
use xtask::{paths, run};

/// Compiles what the target needs of Rust itself.
pub(crate) const BUILD_CORE: [&str; 2] = ["-Z", "build-std=core"];

/// Builds it.
pub(crate) fn archive(platform: &Platform) -> Result<PathBuf> {
    let folder = folder(platform);
    let mut cargo = run::command(run::DEBIANS[0]);
    run::with_debians(&mut cargo).env("CARGO_PROFILE_RELEASE_OPT_LEVEL", &platform.opt_level);
    cargo.args(["rustc", "--quiet", "--package", "noisefloor-capi", "--release", "--crate-type", "staticlib"]);
    if platform.float_alone {
        cargo.arg("--no-default-features");
    }
    run::check(cargo.args(BUILD_CORE).args(["--target", &platform.triple, "--target-dir"]).arg(&folder))?;
    Ok(folder.join(&platform.triple).join("release/libnoisefloor.a"))
}

/// Cargo's target folder: one for each, so that several may be built at a time and none undoes what another made.
pub(crate) fn folder(platform: &Platform) -> PathBuf {
    paths::target().join("cross").join(platform.id())
}

/// tests/package/subproject, a CMake project that compiles the library as a part of itself, and its programs run there;
/// by a toolchain file.
pub(crate) fn consumer(platform: &Platform, toolchain: &str) -> Result<()> {
    let (root, project) = (paths::root(), paths::output().join("test/cross-compiled project"));
    if project.exists() {
        fs::remove_dir_all(&project).with_context(|| format!("cannot remove {}", project.display()))?;
    }
    let mut configure = run::command("cmake");
    configure.args(["-S", "tests/package/subproject", "-B"]).arg(&project).args([
        format!("-DNOISEFLOOR_SOURCE={}", root.display()),
        format!("-DNOISEFLOOR_CARGO={}", run::DEBIANS[0]),
        format!("-DNOISEFLOOR_CARGO_TARGET_DIR={}", folder(platform).display()),
        format!("-DNOISEFLOOR_CARGO_OPTIONS={}", BUILD_CORE.join(";")),
        // CMake takes a relative path for one in the build folder.
        format!("-DCMAKE_TOOLCHAIN_FILE={}", root.join(toolchain).display()),
    ]);
    run::read(&mut configure)?;
    let mut compile = run::command("cmake");
    run::read(run::with_debians(compile.arg("--build").arg(&project).args(["--parallel", "2"])))?;
    let mut test = platform.emulated("ctest");
    test.arg("--test-dir").arg(&project).args(["--quiet", "--output-on-failure", "--no-tests=error"]);
    run::check(&mut test)?;
    println!("   a CMake project with a toolchain file: shared and static under {}", platform.emulator);
    Ok(())
}
