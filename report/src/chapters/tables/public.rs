//! Public samplers, as tables of points that a program of `bench/` writes from permissively licensed crates.

use crate::chapters::measurement::Measurement;
use anyhow::Result;
use std::path::PathBuf;
use xtask::{paths, run};

/// What the program is told, and how the tables name it.
const SAMPLERS: [(&str, &str); 4] = [
    ("heitz", "Heitz 2019"),
    ("openqmc-sobol-bn", "OpenQMC Sobol"),
    ("openqmc-pmj-bn", "OpenQMC PMJ"),
    ("openqmc-lattice-bn", "OpenQMC lattice"),
];

/// The program, and where its files go.
pub(super) struct Public {
    program: PathBuf,
    folder: PathBuf,
}

/// Compiles the program: before time counts.
pub(crate) fn build() -> Result<()> {
    let mut cargo = run::cargo();
    cargo.args(["build", "--quiet", "--profile", "xtask", "--package", "noisefloor-bench", "--example", "points"]);
    run::check(&mut cargo)
}

impl Public {
    pub(super) fn new(measurement: &Measurement) -> Self {
        Self { program: paths::target().join("xtask/examples/points"), folder: measurement.path("points") }
    }

    pub(super) fn labels(&self) -> impl Iterator<Item = String> + use<> {
        SAMPLERS.iter().map(|(_, label)| (*label).to_owned())
    }

    /// One file for each sampler, of so many samples and dimensions.
    pub(super) fn files(&self, spp: u32, dims: u32) -> Result<Vec<String>> {
        std::fs::create_dir_all(&self.folder)?;
        let (spp, dims) = (spp.to_string(), dims.to_string());
        let file = |name: &str| -> Result<String> {
            let file = self.folder.join(format!("{name}-{spp}-{dims}.points")).display().to_string();
            if !std::path::Path::new(&file).exists() {
                run::check(run::command(&self.program).args([name, &spp, &dims, &file]))?;
            }
            Ok(file)
        };
        SAMPLERS.iter().map(|(name, _)| file(name)).collect()
    }
}
