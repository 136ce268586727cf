//! The tiles that come with noisefloor: their names and everything they are made from.

use super::kernel::{Kernel, RECONSTRUCTION_SIGMA};
use super::problem::{ClassShare, Projections, TileProblem};
use super::temporal::TemporalKernel;

/// The names of all shipped tiles: `<size>_<spp>SPP_<dims>D[_VARIANT]`.
pub const NAMES: [&str; 12] = [
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
    "64_4SPP_2D_TEMPORAL",
];

/// What a shipped tile is made from; None if no tile has this name.
pub fn preset(name: &str) -> Option<TileProblem> {
    let problem = match name {
        "128_1SPP_2D" => plane(128, 1, 2048),
        "128_4SPP_2D" => plane(128, 4, 8192),
        "128_16SPP_2D" => plane(128, 16, 2048),
        "128_16SPP_2D_PROGRESSIVE" => progressive(plane(128, 16, 4096)),
        "128_1SPP_4D" => space(128, 1, 0.4),
        "128_4SPP_4D" => space(128, 4, 0.12),
        "128_1SPP_2D_GAUSSIAN" => gaussian(plane(128, 1, 2048), 0.0),
        "128_4SPP_2D_GAUSSIAN" => gaussian(plane(128, 4, 4096), 0.3),
        "128_1SPP_2D_TEMPORAL" => temporal(plane(128, 1, 1024), 0.5, ClassShare { share: 0.1, weight: 1.0 }),
        "64_1SPP_2D" => plane(64, 1, 2048),
        "64_4SPP_2D" => plane(64, 4, 8192),
        // The pixel's own integral counts more over frames, as it does within them from a few samples on.
        "64_4SPP_2D_TEMPORAL" => temporal(plane(64, 4, 2048), 0.65, ClassShare { share: 0.15, weight: 2.5 }),
        _ => return None,
    };
    Some(problem)
}

/// Two dimensions.
fn plane(size: usize, spp: usize, iterations: u64) -> TileProblem {
    let share = if spp < 16 { 0.0 } else { 0.03 };
    TileProblem { iterations, box_class: ClassShare { share, weight: 1.0 }, ..TileProblem::new(size, spp, 2) }
}

/// Every power-of-two prefix a tile.
fn progressive(problem: TileProblem) -> TileProblem {
    TileProblem { progressive: true, box_class: ClassShare { share: 0.1, weight: 1.0 }, ..problem }
}

/// Four dimensions; `plane` is the share of directions in the plane of two axes.
fn space(size: usize, spp: usize, plane: f32) -> TileProblem {
    let box_class = ClassShare { share: 0.0, weight: 1.0 };
    let projections = Projections { axis: 0.0, plane };
    TileProblem { iterations: 4096, projections, box_class, ..TileProblem::new(size, spp, 4) }
}

/// For a renderer that reconstructs with a Gaussian; `share` of the slices look at what it reconstructs.
fn gaussian(problem: TileProblem, share: f32) -> TileProblem {
    let reconstruction = Kernel::Gaussian(RECONSTRUCTION_SIGMA);
    let kernel = Kernel::Convolution(Box::new(Kernel::Perceptual), Box::new(reconstruction.clone()));
    TileProblem { kernel, reconstruction, box_class: ClassShare { share, weight: 1.0 }, ..problem }
}

/// For temporal anti-aliasing: the error is small in every frame, and in what the moving average makes of a pixel and
/// of the image; `frame_share` of the slices look at one frame.
fn temporal(problem: TileProblem, frame_share: f32, box_class: ClassShare) -> TileProblem {
    TileProblem { frames: 16, temporal: Some(TemporalKernel::Ema(0.2)), frame_share, box_class, ..problem }
}
