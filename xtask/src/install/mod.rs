//! `cargo xtask install`: what capi/CMakeLists.txt describes, with cargo's target folder shared.

mod one_kind;
pub mod subproject;
pub mod test;

use crate::{paths, run};
use anyhow::{Context, Result, bail};
use clap::Args;
use std::path::{Path, PathBuf};

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
    let missing = missing(&["cmake", "cc", "ld", "nm", "objcopy"]);
    if !missing.is_empty() {
        bail!("missing: {}. On Debian: apt-get install cmake gcc libc6-dev binutils", missing.join(", "));
    }
    // A relative prefix is the caller's, not the workspace's.
    let prefix = std::path::absolute(&options.prefix)
        .with_context(|| format!("cannot install into {}", options.prefix.display()))?;
    let build = paths::output().join("install");
    configure(&build, &prefix, options.libdir.as_deref(), &[])?;
    compile(&build)?;
    run::check(run::command("cmake").arg("--install").arg(&build))
}

/// Names the places; a former choice of the library folder does not stay.
fn configure(build: &Path, prefix: &Path, libdir: Option<&Path>, options: &[&str]) -> Result<()> {
    let define = |name: &str, value: &Path| format!("-D{name}={}", value.display());
    let cargo = run::cargo();
    let mut cmake = run::command("cmake");
    cmake.args(["-S", "capi", "-DCMAKE_BUILD_TYPE=Release", "-UCMAKE_INSTALL_LIBDIR", "-B"]);
    cmake.arg(build);
    cmake.arg(define("CMAKE_INSTALL_PREFIX", prefix));
    cmake.arg(define("NOISEFLOOR_CARGO", Path::new(cargo.get_program())));
    cmake.arg(define("NOISEFLOOR_CARGO_TARGET_DIR", &paths::target()));
    if let Some(libdir) = libdir {
        cmake.arg(define("CMAKE_INSTALL_LIBDIR", libdir));
    }
    run::read(cmake.args(options)).map(|_| ())
}

/// The libraries, both at once.
fn compile(build: &Path) -> Result<()> {
    run::read(run::command("cmake").arg("--build").arg(build).args(["--parallel", "2"])).map(|_| ())
}

/// The programs among these that cannot be started.
fn missing<'a>(programs: &[&'a str]) -> Vec<&'a str> {
    let works = |program: &&&str| run::read(run::command(program).arg("--version")).is_err();
    programs.iter().filter(works).copied().collect()
}
