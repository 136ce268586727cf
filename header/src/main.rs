//! What `cargo xtask header` and `abi` start: the C header, generated from `capi/`, and the list of what its ABI
//! promises.

mod abi;
mod banner;
mod declarations;
mod header;

use anyhow::{Result, bail};
use std::process::ExitCode;
use xtask::outcome::{NOT_RUN, Outcome};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments.iter().map(String::as_str).collect::<Vec<_>>()) {
        Ok(Outcome::Passed) => ExitCode::SUCCESS,
        Ok(Outcome::NotRun(why)) => {
            eprintln!("{why}");
            ExitCode::from(NOT_RUN)
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &[&str]) -> Result<Outcome> {
    match arguments {
        ["header"] => header::write()?,
        ["abi"] => abi::write(false)?,
        ["abi", "--unreleased"] => abi::write(true)?,
        ["check", "header"] => header::check()?,
        ["check", "abi"] => return abi::check(),
        _ => bail!("`{}`: it must be header, abi [--unreleased], check header or check abi", arguments.join(" ")),
    }
    Ok(Outcome::Passed)
}
