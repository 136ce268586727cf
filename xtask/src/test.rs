//! `cargo xtask test`: everything that decides whether a change is right.

use crate::{header, library, run};
use anyhow::Result;
use clap::Args;

/// No options yet: the tests are all or nothing.
#[derive(Args)]
pub(crate) struct Options {}

pub(crate) fn run(_: &Options) -> Result<()> {
    step("the committed header is the generated one", header::check_committed)?;
    step("the headers compile alone", header::check_compiles)?;
    let archive = library::build()?;
    step("the C library cannot panic and needs nothing", || library::check(&archive))?;
    step("cargo test", || run::check(run::cargo().args(["test", "--workspace", "--quiet"])))?;
    Ok(())
}

fn step(what: &str, action: impl FnOnce() -> Result<()>) -> Result<()> {
    println!("== {what}");
    action()
}
