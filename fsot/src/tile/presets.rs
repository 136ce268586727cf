//! The tiles that come with noisefloor: everything they are made from.

use super::kernel::{Kernel, RECONSTRUCTION_SIGMA};
use super::problem::{ClassShare, Projections, TileProblem};
use super::temporal::TemporalKernel;
use noisefloor::tile::Builtin;

/// What a shipped tile is made from.
pub fn preset(tile: Builtin) -> TileProblem {
    match tile {
        Builtin::Size128Spp1Dims2 => plane(128, 1, 2048),
        Builtin::Size128Spp4Dims2 => plane(128, 4, 8192),
        Builtin::Size128Spp16Dims2 => plane(128, 16, 2048),
        Builtin::Size128Spp16Dims2Progressive => progressive(plane(128, 16, 4096)),
        Builtin::Size128Spp1Dims4 => space(128, 1, 0.4),
        Builtin::Size128Spp4Dims4 => space(128, 4, 0.12),
        Builtin::Size128Spp1Dims2Gaussian => gaussian(plane(128, 1, 2048), 0.0),
        Builtin::Size128Spp4Dims2Gaussian => gaussian(plane(128, 4, 4096), 0.3),
        Builtin::Size128Spp1Dims2Temporal => temporal(plane(128, 1, 1024), 0.5, ClassShare { share: 0.1, weight: 1.0 }),
        Builtin::Size64Spp1Dims2 => plane(64, 1, 2048),
        Builtin::Size64Spp4Dims2 => plane(64, 4, 8192),
        // The pixel's own integral counts more over frames, as it does within them from a few samples on.
        Builtin::Size64Spp4Dims2Temporal => temporal(plane(64, 4, 2048), 0.65, ClassShare { share: 0.15, weight: 2.5 }),
    }
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
