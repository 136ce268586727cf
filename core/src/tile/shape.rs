//! How large a tile is.

use crate::error::Invalid;

/// The largest side, in pixels.
pub const MAX_SIZE: u32 = 1024;
/// The most samples of a pixel.
pub const MAX_SPP: u32 = 256;
/// The most dimensions of a sample.
pub const MAX_DIMS: u32 = 8;
/// The most frames.
pub const MAX_FRAMES: u32 = 256;

/// How many values a tile has, and how they are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Pixels on a side: a power of two, 1 to [`MAX_SIZE`].
    pub size: u32,
    /// Samples of each pixel: a power of two, 1 to [`MAX_SPP`].
    pub spp: u32,
    /// Dimensions of each sample: 1 to [`MAX_DIMS`].
    pub dims: u32,
    /// Frames, which follow each other in time and then repeat: 1 to [`MAX_FRAMES`].
    pub frames: u32,
    /// Bits of each coordinate: 8 or 16.
    pub bits: u32,
    /// Whether the first 1, 2, 4, ... samples of a pixel are well distributed too, so that their order matters.
    pub progressive: bool,
}

impl Shape {
    /// Checks every field.
    ///
    /// # Errors
    /// The rule that is broken.
    pub const fn check(&self) -> Result<(), Invalid> {
        let rule = match self {
            Shape { size, .. } if !size.is_power_of_two() || *size > MAX_SIZE => {
                c"size must be a power of two, 1 to 1024"
            }
            Shape { spp, .. } if !spp.is_power_of_two() || *spp > MAX_SPP => c"spp must be a power of two, 1 to 256",
            Shape { dims: 0 | 9.., .. } => c"dims must be 1 to 8",
            Shape { frames: 0 | 257.., .. } => c"frames must be 1 to 256",
            Shape { bits: 8 | 16, .. } => return Ok(()),
            _ => c"bits must be 8 or 16",
        };
        Err(Invalid::range(rule))
    }

    /// How many coordinates a tile of this shape has; meaningless unless it passes [`check`](Shape::check).
    pub const fn coordinates(&self) -> u64 {
        // At most 2^(10 + 10 + 8 + 3 + 8) for a valid shape.
        (self.size as u64)
            .wrapping_mul(self.size as u64)
            .wrapping_mul(self.spp as u64)
            .wrapping_mul(self.dims as u64)
            .wrapping_mul(self.frames as u64)
    }

    /// How many bytes its payload has; meaningless unless it passes [`check`](Shape::check).
    pub const fn payload_bytes(&self) -> u64 {
        self.coordinates().wrapping_mul(self.bits as u64 / 8)
    }
}
