//! Public samplers, as tables of points that a program of `bench/` writes from permissively licensed crates.

use crate::chapters::measurement::Measurement;
use crate::measure::renderer::{Sampler, table};
use anyhow::Result;
use xtask::{paths, run};

/// Compiles the program: before time counts.
pub(super) fn build() -> Result<()> {
    let mut cargo = run::cargo();
    cargo.args(["build", "--quiet", "--profile", "xtask", "--package", "noisefloor-bench", "--example", "points"]);
    run::check(&mut cargo)
}

/// The points of a sampler, as the program calls it, of so many samples and dimensions.
pub(super) fn points(measurement: &Measurement, name: &str, spp: u32, dims: u32) -> Result<Sampler> {
    let file = measurement.path(&format!("{name}-{spp}-{dims}.points"));
    if !file.exists() {
        let mut program = run::command(paths::target().join("xtask/examples/points"));
        run::check(program.args([name, &*spp.to_string(), &dims.to_string()]).arg(&file))?;
    }
    Ok(table(&file))
}
