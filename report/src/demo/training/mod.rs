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
pub(super) struct Training<'a> {
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

/// Compiles its program, runs it, writes its files and returns its table.
pub(super) type Trainer = fn(&Training) -> Result<String>;

/// The trainers and what they learn.
pub(super) const TRAINERS: [(&str, Trainer); 3] = [
    ("Minibatches: digits", mlp::run),
    ("Minibatches: a polynomial", polynomial::run),
    ("Minibatches: a photograph", photograph::run),
];

pub(super) fn run(options: &Options, interrupted: &AtomicBool, output: &Output, trainer: Trainer) -> Result<String> {
    trainer(&Training { quick: options.quick, archive: library::build()?, interrupted, output })
}
