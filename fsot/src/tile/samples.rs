//! The samples of a tile.

/// The samples of a tile: every coordinate in `[0, 1)`.
#[derive(Clone, Debug, PartialEq)]
pub struct TileSamples {
    /// Pixels along each side.
    pub size: usize,
    /// Samples of each pixel of a frame.
    pub spp: usize,
    /// Coordinates of each sample.
    pub dims: usize,
    /// Frames; 1 for a still tile.
    pub frames: usize,
    /// All coordinates, `[frame][y][x][sample][dim]`.
    pub coordinates: Vec<f32>,
}
