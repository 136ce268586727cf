//! Public samplers, as tables of points that a program of `bench/` writes from permissively licensed crates.

use crate::chapters::measurement::Measurement;
use crate::measure::renderer::Sampler;
use anyhow::Result;
use std::path::PathBuf;
use xtask::{paths, run};

/// What the program is told, and how tables name it.
const SAMPLERS: [(&str, &str); 4] = [
    ("heitz", "Heitz 2019"),
    ("openqmc-sobol-bn", "OpenQMC Sobol"),
    ("openqmc-pmj-bn", "OpenQMC PMJ"),
    ("openqmc-lattice-bn", "OpenQMC lattice"),
];

/// Compiles the program: before time counts.
pub(super) fn build() -> Result<()> {
    let mut cargo = run::cargo();
    cargo.args(["build", "--quiet", "--profile", "xtask", "--package", "noisefloor-bench", "--example", "points"]);
    run::check(&mut cargo)
}

/// Where the program's files go.
pub(super) struct Public(PathBuf);

impl Public {
    pub(super) fn new(measurement: &Measurement) -> Self {
        Self(measurement.path("points"))
    }

    /// Of so many samples and dimensions; None: it is no public sampler.
    pub(super) fn file(&self, sampler: &str, spp: u32, dims: u32) -> Result<Option<Sampler>> {
        let Some((name, _)) = SAMPLERS.iter().find(|(_, label)| *label == sampler) else { return Ok(None) };
        std::fs::create_dir_all(&self.0)?;
        let file = self.0.join(format!("{name}-{spp}-{dims}.points"));
        if !file.exists() {
            let mut program = run::command(paths::target().join("xtask/examples/points"));
            run::check(program.args([name, &*spp.to_string(), &dims.to_string()]).arg(&file))?;
        }
        Ok(Some(Sampler::Table(file)))
    }
}
