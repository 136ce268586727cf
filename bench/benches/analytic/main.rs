//! What can be told only where integrals and gradients are known exactly: shared fits, tiles beyond their samples,
//! optimal MIS. `cargo bench --package noisefloor-bench --bench analytic`.
//!
//! Errors, no times: seeds are fixed, so that every run of a build has the same figures, on a busy machine too. Tests
//! assert bounds for what is measured here.

mod continued;
mod gradients;
mod shared;

use anyhow::Result;
use clap::Parser;
use noisefloor_bench::Options;

fn main() -> Result<()> {
    let options = Options::parse();
    let size = options.extent();
    options.write(
        "analytic",
        &[
            ("tiles.csv", shared::tiles(size)),
            ("hard.csv", shared::hard(size)),
            ("bias.csv", shared::bias(size)),
            ("continued.csv", continued::table(size)?),
            ("polynomial.csv", gradients::polynomial(size)),
            ("classifier.csv", gradients::classifier(size)),
            ("gradient_bias.csv", gradients::bias(size)),
        ],
    )
}
