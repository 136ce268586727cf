//! What must hold before a version is published (CONTRIBUTING.md, "Releases"): the C header, generated from `capi/`,
//! the list of what its ABI promises, packages, licences, versions. `cargo xtask header`, `abi` and `licences` start
//! it.

mod abi;
mod declarations;
mod header;
mod licences;
mod packages;

use anyhow::{Result, bail};
use std::process::ExitCode;
use xtask::start;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    start::exit(run(&arguments.iter().map(String::as_str).collect::<Vec<_>>()))
}

fn run(arguments: &[&str]) -> Result<()> {
    match arguments {
        ["header"] => header::write(),
        ["abi"] => abi::write(false),
        ["abi", "--unreleased"] => abi::write(true),
        ["licences"] => licences::write(),
        ["check", "header"] => header::check(),
        ["check", "abi"] => abi::check(),
        ["check", "licences"] => licences::check(),
        ["check", "packages"] => packages::check(),
        ["check", "versions"] => packages::versions(),
        _ => bail!(
            "`{}`: it must be header, abi [--unreleased] or licences; or check and header, abi, licences, packages or \
             versions",
            arguments.join(" ")
        ),
    }
}
