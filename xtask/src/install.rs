//! `cargo xtask install`: what capi/CMakeLists.txt describes, with cargo's target folder shared.

use crate::{paths, run};
use anyhow::{Context, Result, bail};
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub struct Options {
    /// The folder to install into; $DESTDIR, if set, stands before it
    #[arg(long, default_value = "/usr/local")]
    prefix: PathBuf,
    /// Where libraries go under the prefix, instead of where the system's are (lib, lib64, lib/x86_64-linux-gnu)
    #[arg(long)]
    libdir: Option<PathBuf>,
}

pub fn run(options: &Options) -> Result<()> {
    let works = |program: &&str| run::read(run::command(program).arg("--version")).is_ok();
    let missing: Vec<_> =
        ["cmake", "cc", "ld", "nm", "objcopy"].into_iter().filter(|program| !works(program)).collect();
    if !missing.is_empty() {
        bail!("missing: {}. On Debian: apt-get install cmake gcc libc6-dev binutils", missing.join(", "));
    }
    // A relative prefix is the caller's, not the workspace's.
    let prefix = std::path::absolute(&options.prefix)
        .with_context(|| format!("cannot install into {}", options.prefix.display()))?;
    let build = paths::output().join("install");
    let mut configure = run::command("cmake");
    // A former choice of the library folder does not stay.
    configure.args(["-S", "capi", "-DCMAKE_BUILD_TYPE=Release", "-UCMAKE_INSTALL_LIBDIR", "-B"]).arg(&build);
    configure.arg(format!("-DCMAKE_INSTALL_PREFIX={}", prefix.display()));
    configure.arg(format!("-DNOISEFLOOR_CARGO={}", run::cargo().get_program().to_string_lossy()));
    configure.arg(format!("-DNOISEFLOOR_CARGO_TARGET_DIR={}", paths::target().display()));
    configure.args(options.libdir.iter().map(|libdir| format!("-DCMAKE_INSTALL_LIBDIR={}", libdir.display())));
    run::read(&mut configure)?;
    run::read(run::command("cmake").arg("--build").arg(&build).args(["--parallel", "2"]))?;
    run::check(run::command("cmake").arg("--install").arg(&build))
}

/// tests/package/subproject, a CMake project that compiles the library as a part of itself, for another target.
pub mod subproject {
    use crate::{paths, run};
    use anyhow::{Context, Result};
    use std::fs;
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
            let build = paths::output().join("test").join(name);
            if build.exists() {
                fs::remove_dir_all(&build).with_context(|| format!("cannot remove {}", build.display()))?;
            }
            let mut project = Self { build, options: Vec::new() };
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
            test.arg("--test-dir").arg(&self.build);
            run::check(test.args(["--quiet", "--output-on-failure", "--no-tests=error"]))
        }
    }
}
