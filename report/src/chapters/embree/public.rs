//! Public samplers, as tables of points that a program of `bench/` writes from permissively licensed crates.

use crate::chapters::measurement::Measurement;
use crate::measure::renderer::{Sampler, table};
use anyhow::Result;
use std::path::Path;
use xtask::run;

/// The points of a sampler, as the program calls it, of so many samples and dimensions.
pub(super) fn points(program: &Path, measurement: &Measurement, name: &str, spp: u32, dims: u32) -> Result<Sampler> {
    let file = measurement.path(&format!("{name}-{spp}-{dims}.points"));
    if !file.exists() {
        run::check(run::command(program).args([name, &*spp.to_string(), &dims.to_string()]).arg(&file))?;
    }
    Ok(table(&file))
}
