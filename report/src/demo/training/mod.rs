//! Trainers that draw their minibatches from noisefloor: each makes CSV, a table and plots.

pub(crate) mod curves;
pub(crate) mod data;
pub(crate) mod mlp;
pub(crate) mod photograph;
pub(crate) mod polynomial;
pub(crate) mod program;

use super::Options;
use crate::measure::output::Output;
use anyhow::Result;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use xtask::library;

/// What every trainer's part needs.
struct Training<'a> {
    quick: bool,
    /// The C library.
    archive: PathBuf,
    interrupted: &'a AtomicBool,
    output: &'a Output,
}

impl Training<'_> {
    /// For headings: less was run than documents quote.
    fn quick_note(&self) -> &'static str {
        if self.quick { " (--quick)" } else { "" }
    }
}

/// The trainers, in the order of their tables: each compiles its program, runs it, writes its files and returns its
/// table.
const TRAINERS: [fn(&Training) -> Result<String>; 3] = [mlp::run, polynomial::run, photograph::run];

pub(crate) fn run(options: &Options, interrupted: &AtomicBool, output: &Output) -> Result<String> {
    let training = Training { quick: options.quick, archive: library::build()?, interrupted, output };
    let tables: Vec<String> = TRAINERS.iter().map(|trainer| trainer(&training)).collect::<Result<_>>()?;
    Ok(tables.join("\n"))
}
