//! How much is measured: sizes, seeds, samples.

/// Sizes that decide how long the report takes, and how narrow its intervals are.
#[derive(Clone, Copy)]
pub(crate) struct Plan {
    /// Renderings of everything that is compared, with as many seeds: at least eight for a report.
    pub(crate) seeds: u32,
    /// Pixels on a side where estimators are compared.
    pub(crate) size: u32,
    /// Pixels on a side where samplers are: filtered errors and spectra need an image, tiles repeat after 128 pixels.
    pub(crate) tile_size: u32,
    /// Pixels on a side where many samples, many dimensions or many seeds are the point.
    pub(crate) small: u32,
    /// Multiplies and divides the samples per pixel of references.
    pub(crate) reference_factor: u32,
    pub(crate) reference_divisor: u32,
    /// Samples per pixel of the comparison of estimators.
    pub(crate) spp: &'static [u32],
    /// Samples per pixel where polynomials have 100 terms and more, or the thesis has as many.
    pub(crate) many: u32,
    /// Seeds of the statistics of single pixels.
    pub(crate) pixel_seeds: u32,
    /// Frames of the test of biases.
    pub(crate) frames: u32,
    /// Last frames of the animations: figures 5.23 and 5.24.
    pub(crate) animation: [u32; 2],
    /// Seeds of the animations: what is seen is one image for each, and its errors vary much.
    pub(crate) animation_seeds: u32,
    /// What it is called in the index.
    name: &'static str,
    /// The first of several scenes and settings instead of all.
    few: bool,
}

impl Plan {
    pub(crate) fn new(quick: bool, full: bool) -> Self {
        let normal = Self {
            seeds: 8,
            size: 52,
            tile_size: 128,
            small: 32,
            reference_factor: 1,
            reference_divisor: 1,
            spp: &[16, 64, 256],
            many: 256,
            pixel_seeds: 256,
            frames: 504,
            animation: [16, 10],
            animation_seeds: 32,
            name: "default",
            few: false,
        };
        if quick {
            return Self {
                name: "quick",
                seeds: 2,
                size: 16,
                tile_size: 32,
                small: 12,
                reference_factor: 1,
                reference_divisor: 16,
                spp: &[16],
                many: 64,
                pixel_seeds: 8,
                frames: 36,
                animation: [3, 2],
                animation_seeds: 2,
                few: true,
            };
        }
        if full {
            return Self {
                name: "full",
                seeds: 16,
                size: 128,
                tile_size: 256,
                small: 64,
                reference_factor: 2,
                many: 512,
                pixel_seeds: 1024,
                frames: 4004,
                ..normal
            };
        }
        normal
    }

    /// As the index calls it.
    pub(crate) fn name(&self) -> &'static str {
        self.name
    }

    /// Time matters less than what is measured.
    pub(crate) fn is_full(&self) -> bool {
        self.name == "full"
    }

    /// What measurement programs are compiled with. A quick report tests the report: most of its time would go into
    /// link-time optimisation, and with this profile the dependencies are those of the tests.
    pub(crate) fn profile(&self) -> &'static str {
        if self.name == "quick" { "suite" } else { "bench" }
    }

    /// The same for a measurement program.
    pub(crate) fn option(&self) -> Option<&'static str> {
        match self.name {
            "quick" => Some("--quick"),
            "full" => Some("--full"),
            _ => None,
        }
    }

    /// Those of `all` that are measured.
    pub(crate) fn some<'a, T>(&self, all: &'a [T]) -> &'a [T] {
        if self.few { &all[..all.len().min(1)] } else { all }
    }

    /// The samples per pixel at which pictures and tables with one number of samples are made: 64, or what there is.
    pub(crate) fn middle(&self) -> u32 {
        self.spp[self.spp.len() / 2]
    }
}
