//! tests/package/subproject: a CMake project that compiles the library as a part of itself.

use super::test::folder;
use crate::{paths, run};
use anyhow::Result;
use std::path::{Path, PathBuf};
use std::process::Command;

/// How it is configured.
pub struct Subproject {
    build: PathBuf,
    options: Vec<String>,
}

impl Subproject {
    /// Built in a new folder of this name, with what `cargo` has made before in its target folder.
    pub fn new(name: &str, target: &Path, cargo: &Path) -> Result<Self> {
        let mut project = Self { build: folder(name)?, options: Vec::new() };
        project.option("NOISEFLOOR_SOURCE", &paths::root().display().to_string());
        project.option("NOISEFLOOR_CARGO", &cargo.display().to_string());
        project.option("NOISEFLOOR_CARGO_TARGET_DIR", &target.display().to_string());
        Ok(project)
    }

    pub fn option(&mut self, name: &str, value: &str) {
        self.options.push(format!("-D{name}={value}"));
    }

    /// Configures, builds and runs its programs; `prepare` sees the command that builds.
    pub fn run(&self, prepare: impl FnOnce(&mut Command)) -> Result<()> {
        let mut configure = run::command("cmake");
        configure.args(["-S", "tests/package/subproject", "-B"]).arg(&self.build).args(&self.options);
        run::read(&mut configure)?;
        let mut build = run::command("cmake");
        prepare(build.arg("--build").arg(&self.build).args(["--parallel", "2"]));
        run::read(&mut build)?;
        let mut test = run::command("ctest");
        run::check(test.arg("--test-dir").arg(&self.build).args(["--quiet", "--output-on-failure", "--no-tests=error"]))
    }
}

/// By add_subdirectory and by FetchContent.
pub(super) fn both() -> Result<()> {
    let cargo = run::cargo();
    for (name, fetch) in [("a subdirectory build", "OFF"), ("a fetched build", "ON")] {
        let mut project = Subproject::new(name, &paths::target(), cargo.get_program().as_ref())?;
        project.option("FETCH", fetch);
        project.run(|_| ())?;
    }
    Ok(())
}
