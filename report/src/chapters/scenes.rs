//! The scenes: what the report knows of them beyond what the program says.

use anyhow::{Context, Result};

/// One scene of the program.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    /// Numbers of a sample.
    pub(crate) dims: u32,
    /// Direct light of one source, without motion or lens.
    pub(crate) one_light: bool,
    /// Samples per pixel of each half of the reference.
    pub(crate) reference_spp: u32,
    /// Roughly what a sample costs, in nanoseconds: only the progress bar uses it.
    pub(crate) cost: f64,
}

const fn scene(name: &'static str, dims: u32, one_light: bool, reference_spp: u32, cost: f64) -> Scene {
    Scene { name, dims, one_light, reference_spp, cost }
}

pub(crate) const SCENES: &[Scene] = &[
    scene("killeroos", 3, true, 1024, 500.0),
    scene("bathroom", 3, false, 1024, 500.0),
    scene("dining", 2, true, 1024, 400.0),
    scene("duck", 15, false, 1024, 2500.0),
    scene("dragon", 2, true, 1024, 400.0),
    scene("chopper", 2, true, 1024, 400.0),
    scene("lens", 4, false, 1024, 600.0),
    scene("plane_1", 2, true, 1024, 300.0),
    scene("plane_4", 3, false, 1024, 300.0),
    scene("plane_16", 3, false, 1024, 300.0),
    scene("plane_64", 3, false, 1024, 300.0),
    scene("microcity", 2, true, 1024, 500.0),
    scene("animation", 2, true, 256, 400.0),
    scene("glass", 12, false, 1024, 1500.0),
    scene("veach", 2, false, 1024, 500.0),
];

pub(crate) fn find(name: &str) -> Result<&'static Scene> {
    let found = SCENES.iter().find(|scene| scene.name == name);
    found.with_context(|| format!("the report knows no scene `{name}`: it is missing in report/src/chapters/scenes.rs"))
}
