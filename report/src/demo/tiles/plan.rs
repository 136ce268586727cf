//! What is rendered: scenes, samplers, sizes.

use crate::measure::samplers::Choice;

/// One of the path tracer's scenes.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    /// What its integral is over.
    pub(crate) domain: &'static str,
    /// Where the part is that the sheets show, half as wide and high as the image: its corner, in images.
    pub(crate) crop: [f64; 2],
    /// Total degree of the fits.
    pub(crate) order: u32,
    /// Renderings of each image with other samples: errors are averaged, times are medians.
    pub(crate) frames: u32,
    /// Samples per pixel of each of the two halves of the reference.
    pub(crate) reference_spp: u32,
    /// Roughly what a sample costs, in nanoseconds: only the progress bar uses it.
    pub(crate) cost: f64,
    pub(crate) samplers: &'static [Choice],
}

/// What each sampler is compared with.
pub(crate) const BASELINE: Choice = Choice::Random;

/// The plain mean; fits to each pixel's own samples, which for stratified samples is the plain mean again; and fits
/// shared by neighbouring pixels.
pub(crate) const ESTIMATORS: [&str; 3] = ["mc", "robust", "shared"];

const ALL_2D: &[Choice] = &[Choice::Random, Choice::Sobol, Choice::Tile(2)];

pub(crate) const SCENES: [Scene; 5] = [
    Scene {
        name: "direct",
        domain: "the light's surface (2 dims)",
        crop: [0.1, 0.45],
        order: 2,
        frames: 4,
        reference_spp: 150,
        cost: 300.0,
        samplers: &[Choice::Random, Choice::Sobol, Choice::Tile(2), Choice::Progressive],
    },
    Scene {
        name: "lens",
        domain: "the lens and the light's surface (4 dims)",
        crop: [0.1, 0.45],
        order: 2,
        frames: 1,
        reference_spp: 150,
        cost: 800.0,
        samplers: &[Choice::Random, Choice::Sobol, Choice::Tile(2), Choice::Tile(4)],
    },
    Scene {
        name: "motion",
        domain: "time and the light's surface (3 dims)",
        crop: [0.1, 0.45],
        order: 2,
        frames: 1,
        reference_spp: 150,
        cost: 600.0,
        samplers: ALL_2D,
    },
    Scene {
        name: "lights",
        domain: "six lights' surfaces and their choice (3 dims)",
        crop: [0.1, 0.45],
        order: 2,
        frames: 1,
        reference_spp: 150,
        cost: 350.0,
        samplers: ALL_2D,
    },
    // With 15 dimensions degree 2 means 136 terms, more than a pixel has samples.
    Scene {
        name: "global",
        domain: "three bounces (15 dims)",
        crop: [0.1, 0.45],
        order: 1,
        frames: 1,
        reference_spp: 60,
        cost: 2900.0,
        samplers: ALL_2D,
    },
];

/// The tile of the animation.
pub(crate) const TEMPORAL: &str = "128_1SPP_2D_TEMPORAL";

/// Sizes that decide how long this part takes.
pub(crate) struct Plan {
    /// Width and height of every image: tiles repeat after 128 pixels.
    pub(crate) size: u32,
    pub(crate) spp: [u32; 3],
    /// One frame of each scene, and short references.
    quick: bool,
}

impl Plan {
    pub(crate) fn new(quick: bool) -> Self {
        Self { size: if quick { 128 } else { 256 }, spp: [1, 4, 16], quick }
    }

    pub(crate) fn frames(&self, scene: &Scene) -> u32 {
        if self.quick { 1 } else { scene.frames }
    }

    pub(crate) fn reference_spp(&self, scene: &Scene) -> u32 {
        if self.quick { scene.reference_spp / 3 } else { scene.reference_spp }
    }

    /// What rendering `spp` samples per pixel with `estimators` estimators adds to the progress bar.
    pub(crate) fn work(&self, scene: &Scene, spp: u32, estimators: usize) -> u64 {
        let samples = f64::from(self.size) * f64::from(self.size) * f64::from(spp);
        (samples * (scene.cost + 1000.0 * estimators.saturating_sub(1) as f64) * 1e-3) as u64 + 1
    }
}
