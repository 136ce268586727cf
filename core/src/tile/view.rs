//! What a tile is: its shape, and a view of its values.

use crate::Error;
use crate::tile::Header;

/// The largest side, in pixels.
pub const MAX_SIZE: u32 = 1024;
/// The most samples of a pixel.
pub const MAX_SPP: u32 = 256;
/// The most dimensions of a sample.
pub const MAX_DIMS: u32 = 8;
/// The most frames.
pub const MAX_FRAMES: u32 = 256;

/// How many values a tile has, and how they are stored.
///
/// ```
/// use noisefloor::tile::Shape;
/// let shape = Shape { size: 128, spp: 4, dims: 2, frames: 1, bits: 16, progressive: false };
/// assert!(shape.is_valid());
/// assert_eq!(shape.payload_bytes(), 128 * 128 * 4 * 2 * 2);
/// ```
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
    /// Whether every field is in its range.
    pub const fn is_valid(&self) -> bool {
        self.size.is_power_of_two()
            && self.size <= MAX_SIZE
            && self.spp.is_power_of_two()
            && self.spp <= MAX_SPP
            && 0 < self.dims
            && self.dims <= MAX_DIMS
            && 0 < self.frames
            && self.frames <= MAX_FRAMES
            && (self.bits == 8 || self.bits == 16)
    }

    /// How many coordinates a tile of this shape has; meaningless unless [`is_valid`](Shape::is_valid).
    pub const fn coordinates(&self) -> u64 {
        // At most 2^(10 + 10 + 8 + 3 + 8) for a valid shape.
        (self.size as u64)
            .wrapping_mul(self.size as u64)
            .wrapping_mul(self.spp as u64)
            .wrapping_mul(self.dims as u64)
            .wrapping_mul(self.frames as u64)
    }

    /// How many bytes its payload has; meaningless unless [`is_valid`](Shape::is_valid).
    pub const fn payload_bytes(&self) -> u64 {
        self.coordinates().wrapping_mul(self.bits as u64 / 8)
    }
}

/// A view of a tile: it owns nothing, and is as cheap to copy as a slice.
///
/// ```
/// use noisefloor::tile::{Shape, Tile};
///
/// // 2 x 2 pixels, one sample of two coordinates in each.
/// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
/// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
/// let tile = Tile::new(shape, &payload)?;
/// assert_eq!(tile.value(0, 0, 1, 0, 0), Some(128.5 / 256.0));
/// # Ok::<(), noisefloor::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile<'a> {
    shape: Shape,
    payload: &'a [u8],
}

impl<'a> Tile<'a> {
    /// The tile that a file's bytes hold, all of them checked.
    ///
    /// # Errors
    /// [`Error::Foreign`] for what is no tile, [`Error::Version`] for one of a newer format, [`Error::Length`] for
    /// missing or trailing bytes, [`Error::Corrupt`] for a damaged one.
    pub fn from_bytes(bytes: &'a [u8]) -> Result<Tile<'a>, Error> {
        let (header, payload) = Header::decode(bytes)?;
        Ok(Tile { shape: header.shape(), payload })
    }

    /// A tile of values in memory: `payload[frame][y][x][sample][dim]`, unsigned integers of `shape.bits`,
    /// little-endian.
    ///
    /// # Errors
    /// [`Error::Range`] for a shape out of range, [`Error::Length`] for a payload that is not exactly as long as it
    /// says.
    pub const fn new(shape: Shape, payload: &'a [u8]) -> Result<Tile<'a>, Error> {
        if !shape.is_valid() {
            return Err(Error::Range);
        }
        if payload.len() as u64 != shape.payload_bytes() {
            return Err(Error::Length);
        }
        Ok(Tile { shape, payload })
    }

    /// As [`Tile::new`], unchecked: for the parts of a tile that was checked before. Other parts draw wrong numbers,
    /// though still in [0, 1).
    #[inline]
    pub const fn resume(shape: Shape, payload: &'a [u8]) -> Tile<'a> {
        Tile { shape, payload }
    }

    /// How many values there are.
    #[inline]
    pub const fn shape(&self) -> Shape {
        self.shape
    }

    /// The stored values, as [`Tile::new`] takes them.
    #[inline]
    pub const fn payload(&self) -> &'a [u8] {
        self.payload
    }

    /// A stored coordinate, `(v + 1/2) / 2^bits` for the stored integer v; `None` outside the shape.
    pub fn value(&self, frame: u32, y: u32, x: u32, sample: u32, dim: u32) -> Option<f32> {
        let Shape { size, spp, dims, frames, .. } = self.shape;
        if frame >= frames || y >= size || x >= size || sample >= spp || dim >= dims {
            return None;
        }
        let mut value = [0.0];
        self.values(self.place(frame, y, x, sample).checked_add(dim as usize)?, &mut value);
        value.first().copied()
    }

    /// Where in the payload, counted in coordinates, a sample begins.
    #[inline(always)]
    pub(super) const fn place(&self, frame: u32, y: u32, x: u32, sample: u32) -> usize {
        let Shape { size, spp, dims, .. } = self.shape;
        let row = (frame as usize).wrapping_mul(size as usize).wrapping_add(y as usize);
        let pixel = row.wrapping_mul(size as usize).wrapping_add(x as usize);
        pixel.wrapping_mul(spp as usize).wrapping_add(sample as usize).wrapping_mul(dims as usize)
    }

    /// N consecutive stored integers; `None` beyond the payload.
    #[inline(always)]
    fn stored<const N: usize>(&self, place: usize) -> Option<[u32; N]> {
        if self.shape.bits == 16 {
            let (values, _) = self.payload.get(place.wrapping_mul(2)..)?.as_chunks::<2>();
            Some(values.first_chunk::<N>()?.map(|value| u32::from(u16::from_le_bytes(value))))
        } else {
            Some(self.payload.get(place..)?.first_chunk::<N>()?.map(u32::from))
        }
    }

    /// Writes N consecutive coordinates, `(v + 1/2) / 2^bits`; false, and nothing, beyond the payload.
    #[inline(always)]
    pub(super) fn values<const N: usize>(&self, place: usize, u: &mut [f32; N]) -> bool {
        // Each width on its own, written where it belongs: twice as fast as by way of `stored`.
        if self.shape.bits == 16 {
            let Some(rest) = self.payload.get(place.wrapping_mul(2)..) else { return false };
            let (values, _) = rest.as_chunks::<2>();
            let Some(values) = values.first_chunk::<N>() else { return false };
            u.iter_mut().zip(values).for_each(|(u, &v)| {
                *u = (2 * u32::from(u16::from_le_bytes(v)) + 1) as f32 * (1.0 / 131_072.0);
            });
        } else {
            let Some(values) = self.payload.get(place..).and_then(|rest| rest.first_chunk::<N>()) else { return false };
            u.iter_mut().zip(values).for_each(|(u, &v)| *u = (2 * u32::from(v) + 1) as f32 * (1.0 / 512.0));
        }
        true
    }

    /// N consecutive coordinates in 32-bit fixed point; `None` beyond the payload.
    #[inline(always)]
    pub(super) fn fixed<const N: usize>(&self, place: usize) -> Option<[u32; N]> {
        let shift = if self.shape.bits == 16 { 15 } else { 23 };
        Some(self.stored(place)?.map(|v| (2 * v + 1) << shift))
    }
}

/// 32-bit fixed point as a float: the upper 24 bits, so always below 1.
#[inline(always)]
pub(super) const fn unit(fixed: u32) -> f32 {
    (fixed >> 8) as f32 * (1.0 / 16_777_216.0)
}
