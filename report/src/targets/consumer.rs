//! A CMake project that compiles the library as a part of itself, cross-compiled, and its programs run.

use super::build;
use super::platform::Platform;
use anyhow::Result;
use xtask::install::subproject::Subproject;
use xtask::paths;

/// Whether there is a toolchain file for the target.
pub(crate) fn run(platform: &Platform) -> Result<bool> {
    if !platform.triple.starts_with("aarch64") {
        return Ok(false);
    }
    let mut project = Subproject::new("cross-compiled project", &build::folder(platform), build::CARGO.as_ref())?;
    // CMake takes a relative path for one in the build folder.
    let toolchain = paths::root().join("tests/package/aarch64.cmake");
    project.option("CMAKE_TOOLCHAIN_FILE", &toolchain.display().to_string());
    project.option("NOISEFLOOR_CARGO_OPTIONS", &build::BUILD_CORE.join(";"));
    project.run(|command| {
        build::environment(command);
    })?;
    println!("   a CMake project with a toolchain file: shared and static under {}", platform.emulator);
    Ok(true)
}
