//! The tiles that come with noisefloor: their names and everything they are made from.

use super::kernel::{Kernel, RECONSTRUCTION_SIGMA};
use super::problem::{ClassShare, Projections, TileProblem};
use super::temporal::TemporalKernel;

/// The names of all shipped tiles: `<size>_<spp>SPP_<dims>D[_VARIANT]`.
pub const NAMES: [&str; 11] = [
    "128_1SPP_2D",
    "128_4SPP_2D",
    "128_16SPP_2D",
    "128_16SPP_2D_PROGRESSIVE",
    "128_1SPP_4D",
    "128_4SPP_4D",
    "128_1SPP_2D_GAUSSIAN",
    "128_4SPP_2D_GAUSSIAN",
    "128_1SPP_2D_TEMPORAL",
    "64_1SPP_2D",
    "64_4SPP_2D",
];

/// What a shipped tile is made from; None if no tile has this name.
pub fn preset(name: &str) -> Option<TileProblem> {
    let problem = match name {
        "128_1SPP_2D" => plane(128, 1),
        "128_4SPP_2D" => plane(128, 4),
        "128_16SPP_2D" => plane(128, 16),
        "128_16SPP_2D_PROGRESSIVE" => progressive(128, 16),
        "128_1SPP_4D" => space(128, 1, 0.4),
        "128_4SPP_4D" => space(128, 4, 0.1),
        "128_1SPP_2D_GAUSSIAN" => gaussian(plane(128, 1)),
        "128_4SPP_2D_GAUSSIAN" => gaussian(plane(128, 4)),
        "128_1SPP_2D_TEMPORAL" => temporal(plane(128, 1)),
        "64_1SPP_2D" => plane(64, 1),
        "64_4SPP_2D" => plane(64, 4),
        _ => return None,
    };
    Some(problem)
}

/// Two dimensions.
fn plane(size: usize, spp: usize) -> TileProblem {
    TileProblem { iterations: 4096, ..TileProblem::new(size, spp, 2) }
}

/// Two dimensions, every power-of-two prefix a tile.
fn progressive(size: usize, spp: usize) -> TileProblem {
    TileProblem { progressive: true, box_class: ClassShare { share: 0.2, weight: 1.0 }, ..plane(size, spp) }
}

/// Four dimensions; `plane` is the share of directions in the plane of two axes.
fn space(size: usize, spp: usize, plane: f32) -> TileProblem {
    TileProblem {
        iterations: 4096,
        projections: Projections { axis: 0.0, plane },
        directions: 4,
        ..TileProblem::new(size, spp, 4)
    }
}

/// For a renderer that reconstructs with a Gaussian.
fn gaussian(problem: TileProblem) -> TileProblem {
    let kernel = Kernel::Convolution(Box::new(Kernel::Perceptual), Box::new(Kernel::Gaussian(RECONSTRUCTION_SIGMA)));
    TileProblem { kernel, ..problem }
}

/// For temporal anti-aliasing.
fn temporal(problem: TileProblem) -> TileProblem {
    TileProblem { frames: 16, temporal: Some(TemporalKernel::Ema(0.2)), frame_share: 0.3, iterations: 1024, ..problem }
}
