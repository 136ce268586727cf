//! `cargo xtask install`: what capi/CMakeLists.txt describes, with cargo's target folder shared.

use crate::c_tests::CMAKE;
use crate::{library, paths, run, tools};
use anyhow::{Context, Result};
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
    tools::packages(&[tools::C, CMAKE].concat())?;
    // A relative prefix is the caller's, not the workspace's.
    let prefix = std::path::absolute(&options.prefix)
        .with_context(|| format!("cannot install into {}", options.prefix.display()))?;
    let build = paths::output().join("install");
    let mut configure = run::command("cmake");
    // A former choice of the library folder does not stay.
    configure.args(["-S", "capi", "-DCMAKE_BUILD_TYPE=Release", "-UCMAKE_INSTALL_LIBDIR", "-B"]).arg(&build);
    configure.arg(format!("-DCMAKE_INSTALL_PREFIX={}", prefix.display()));
    configure.args(library::settings().map(|setting| format!("-D{setting}")));
    configure.args(options.libdir.iter().map(|libdir| format!("-DCMAKE_INSTALL_LIBDIR={}", libdir.display())));
    run::read(&mut configure)?;
    run::compile(run::command("cmake").arg("--build").arg(&build).args(["--parallel", "2"]))?;
    run::check(run::command("cmake").arg("--install").arg(&build))
}
