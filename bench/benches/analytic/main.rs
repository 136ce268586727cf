//! What can be told only where integrals and gradients are known exactly: shared fits, tiles beyond their samples,
//! optimal MIS. `cargo bench --package noisefloor-bench --bench analytic`.
//!
//! Errors, no times: seeds are fixed, so that every run of a build has the same figures, on a busy machine too. Tests
//! assert bounds for what is measured here.

mod continued;
mod gradients;
mod shared;
mod size;

use anyhow::Result;
use clap::Parser;
use size::Size;
use std::path::PathBuf;

/// Measures on known integrands and gradients, and writes tables.
#[derive(Parser)]
struct Options {
    /// Few repetitions: whether everything works, not the figures.
    #[arg(long)]
    quick: bool,
    /// Four times the repetitions.
    #[arg(long, conflicts_with = "quick")]
    full: bool,
    /// Where the tables go; columns are divided by semicolons.
    #[arg(long, default_value_os_t = noisefloor_bench::output("analytic"))]
    output: PathBuf,
    /// What cargo adds.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> Result<()> {
    let options = Options::parse();
    let size = match (options.quick, options.full) {
        (true, _) => Size::Quick,
        (_, true) => Size::Full,
        _ => Size::Default,
    };
    let tables = [
        ("tiles", shared::tiles(size)),
        ("hard", shared::hard(size)),
        ("bias", shared::bias(size)),
        ("continued", continued::table(size)?),
        ("polynomial", gradients::polynomial(size)),
        ("classifier", gradients::classifier(size)),
        ("gradient_bias", gradients::bias(size)),
    ];
    for (name, text) in &tables {
        noisefloor_bench::write(&options.output.join(format!("{name}.csv")), text)?;
    }
    println!("{} tables: {}", tables.len(), options.output.display());
    Ok(())
}
