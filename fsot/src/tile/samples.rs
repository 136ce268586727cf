//! The samples of a tile.

use crate::counted;
use crate::{Error, error::Result};

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

impl TileSamples {
    /// Samples from their coordinates. An [`Error::Input`] if there are too few or too many, or one is not in `[0, 1)`.
    pub fn new(size: usize, spp: usize, dims: usize, frames: usize, coordinates: Vec<f32>) -> Result<TileSamples> {
        let needed = [size, size, spp, dims, frames].iter().try_fold(1usize, |product, &n| product.checked_mul(n));
        if needed != Some(coordinates.len()) {
            return Err(Error::input(format!(
                "{} cannot make {}",
                counted::counted(coordinates.len(), "coordinate"),
                counted::tile(size, spp, dims, frames)
            )));
        }
        if let Some(bad) = coordinates.iter().find(|value| !(0.0..1.0).contains(*value)) {
            return Err(Error::input(format!("a sample has the coordinate {bad}, which is not in [0, 1)")));
        }
        Ok(TileSamples { size, spp, dims, frames, coordinates })
    }

    /// The samples of a pixel, one after the other: `spp * dims` coordinates. Pixel and frame wrap around.
    pub fn pixel(&self, x: usize, y: usize, frame: usize) -> &[f32] {
        let length = self.spp * self.dims;
        let index = ((frame % self.frames) * self.size + y % self.size) * self.size + x % self.size;
        &self.coordinates[index * length..][..length]
    }

    /// Each coordinate as the integer that stands for it with `bits` bits, `floor(v * 2^bits)`: what reads it back as
    /// `(i + 0.5) / 2^bits` is off by at most half a step. An [`Error::Input`] unless `bits` is 1 to 16.
    pub fn quantise(&self, bits: u32) -> Result<Vec<u16>> {
        if !(1..=16).contains(&bits) {
            return Err(Error::input(format!("a coordinate is stored in 1 to 16 bits, not in {bits}")));
        }
        Ok(self.coordinates.iter().map(|&value| noisefloor::tile::quantize(value, bits)).collect())
    }

    /// The tile with `spp` samples per pixel, the first ones of each. An [`Error::Input`] if there are not as many.
    pub fn prefix(&self, spp: usize) -> Result<TileSamples> {
        if spp == 0 || spp > self.spp {
            return Err(Error::input(format!(
                "a tile with {} per pixel has no prefix of {spp}",
                counted::counted(self.spp, "sample")
            )));
        }
        let coordinates = self
            .coordinates
            .chunks_exact(self.spp * self.dims)
            .flat_map(|pixel| &pixel[..spp * self.dims])
            .copied()
            .collect();
        Ok(TileSamples { spp, coordinates, ..*self })
    }
}
