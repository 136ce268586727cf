//! A CMake project that compiles the library as a part of itself (tests/package/subproject), cross-compiled, and its
//! programs run.

use super::build;
use super::platform::Platform;
use anyhow::{Context, Result};
use std::fs;
use xtask::{paths, run};

/// Whether there is a toolchain file for the target.
pub(crate) fn run(platform: &Platform) -> Result<bool> {
    if !platform.triple.starts_with("aarch64") {
        return Ok(false);
    }
    let (root, folder) = (paths::root(), paths::output().join("test/cross-compiled project"));
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| format!("cannot remove {}", folder.display()))?;
    }
    let mut configure = run::command("cmake");
    configure.args(["-S", "tests/package/subproject", "-B"]).arg(&folder).args([
        format!("-DNOISEFLOOR_SOURCE={}", root.display()),
        format!("-DNOISEFLOOR_CARGO={}", build::CARGO),
        format!("-DNOISEFLOOR_CARGO_TARGET_DIR={}", build::folder(platform).display()),
        format!("-DNOISEFLOOR_CARGO_OPTIONS={}", build::BUILD_CORE.join(";")),
        // CMake takes a relative path for one in the build folder.
        format!("-DCMAKE_TOOLCHAIN_FILE={}", root.join("tests/package/aarch64.cmake").display()),
    ]);
    run::read(&mut configure)?;
    let mut compile = run::command("cmake");
    run::read(build::environment(compile.arg("--build").arg(&folder).args(["--parallel", "2"])))?;
    let mut test = run::command("ctest");
    test.arg("--test-dir").arg(&folder).args(["--quiet", "--output-on-failure", "--no-tests=error"]);
    run::check(&mut test)?;
    println!("   a CMake project with a toolchain file: shared and static under {}", platform.emulator);
    Ok(true)
}
