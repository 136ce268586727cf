//! What is rendered: scenes, estimators, sizes.

/// One of the path tracer's scenes and what the demo does with it.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    /// What its integral is over.
    pub(crate) domain: &'static str,
    /// Total degree of the fits. With 15 dimensions degree 2 means 136 terms, more than there are samples.
    pub(crate) order: u32,
    /// Samples per pixel of each of the two halves of the reference.
    pub(crate) reference_spp: u32,
    /// Roughly what a sample costs, in nanoseconds: only the progress bar uses it.
    pub(crate) cost: f64,
}

pub(crate) const SCENES: [Scene; 4] = [
    Scene { name: "direct", domain: "the light's surface (2 dims)", order: 2, reference_spp: 512, cost: 250.0 },
    Scene {
        name: "motion",
        domain: "time and the light's surface (3 dims)",
        order: 2,
        reference_spp: 512,
        cost: 600.0,
    },
    Scene {
        name: "lights",
        domain: "six lights' surfaces and their choice (3 dims)",
        order: 2,
        reference_spp: 512,
        cost: 350.0,
    },
    Scene { name: "global", domain: "three bounces (15 dims)", order: 1, reference_spp: 160, cost: 2900.0 },
];

/// The baseline: every ratio is to it.
pub(crate) const BASELINE: &str = "mc";

const ESTIMATORS: [&str; 7] =
    [BASELINE, "robust", "least_squares", "leave_one_out", "k_fold", "gradient_descent", "incremental"];

impl Scene {
    pub(crate) fn estimators(&self) -> Vec<&'static str> {
        let mut names = ESTIMATORS.to_vec();
        if self.name == "lights" {
            names.push("slices");
        }
        names
    }
}

/// Sizes that decide how long the demo takes.
pub(crate) struct Plan {
    /// Width and height of every image.
    pub(crate) size: u32,
    pub(crate) spp: [u32; 2],
    /// Renderings of the same image, for the median of their times.
    pub(crate) repetitions: u32,
    /// Divides the reference's samples.
    pub(crate) reference_divisor: u32,
}

impl Plan {
    pub(crate) fn new(quick: bool) -> Self {
        if quick {
            Self { size: 64, spp: [16, 64], repetitions: 1, reference_divisor: 4 }
        } else {
            Self { size: 128, spp: [16, 64], repetitions: 1, reference_divisor: 1 }
        }
    }

    pub(crate) fn reference_spp(&self, scene: &Scene) -> u32 {
        (scene.reference_spp / self.reference_divisor).max(1)
    }

    /// What rendering `spp` samples per pixel with `estimators` estimators adds to the progress bar.
    pub(crate) fn work(&self, scene: &Scene, spp: u32, estimators: usize) -> u64 {
        let samples = f64::from(self.size) * f64::from(self.size) * f64::from(spp);
        (samples * (scene.cost + 100.0 * estimators as f64) * 1e-3) as u64
    }
}
