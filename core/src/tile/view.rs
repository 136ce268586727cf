//! A view of a tile's values.

use super::format::Header;
use super::shape::Shape;
use crate::Error;

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
        if shape.check().is_err() {
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
    #[inline]
    pub(super) const fn place(&self, frame: u32, y: u32, x: u32, sample: u32) -> usize {
        let Shape { size, spp, dims, .. } = self.shape;
        let row = (frame as usize).wrapping_mul(size as usize).wrapping_add(y as usize);
        let pixel = row.wrapping_mul(size as usize).wrapping_add(x as usize);
        pixel.wrapping_mul(spp as usize).wrapping_add(sample as usize).wrapping_mul(dims as usize)
    }

    /// N consecutive stored integers, of `BYTES` bytes each; `None` beyond the payload.
    #[inline]
    fn stored<const BYTES: usize, const N: usize>(&self, place: usize) -> Option<&[[u8; BYTES]; N]> {
        let (values, _) = self.payload.get(place.wrapping_mul(BYTES)..)?.as_chunks();
        values.first_chunk()
    }

    /// Writes N consecutive coordinates, `(v + 1/2) / 2^bits`; false, and nothing, beyond the payload.
    // Without, a draw of stored values takes 23 % more instructions.
    #[inline(always)]
    pub(super) fn values<const N: usize>(&self, place: usize, u: &mut [f32; N]) -> bool {
        // Each width on its own, written where it belongs: twice as fast as by way of integers of either.
        if self.shape.bits == 16 {
            let Some(stored) = self.stored::<2, N>(place) else { return false };
            u.iter_mut().zip(stored).for_each(|(u, &v)| {
                *u = (2 * u32::from(u16::from_le_bytes(v)) + 1) as f32 * (1.0 / 131_072.0);
            });
        } else {
            let Some(stored) = self.stored::<1, N>(place) else { return false };
            u.iter_mut().zip(stored).for_each(|(u, &[v])| *u = (2 * u32::from(v) + 1) as f32 * (1.0 / 512.0));
        }
        true
    }

    /// N consecutive coordinates in 32-bit fixed point; zero beyond the payload.
    #[inline(always)]
    pub(super) fn fixed<const N: usize>(&self, place: usize) -> [u32; N] {
        if self.shape.bits == 16 {
            self.stored::<2, N>(place)
                .map_or([0; N], |stored| stored.map(|v| (2 * u32::from(u16::from_le_bytes(v)) + 1) << 15))
        } else {
            self.stored::<1, N>(place).map_or([0; N], |stored| stored.map(|[v]| (2 * u32::from(v) + 1) << 23))
        }
    }
}
