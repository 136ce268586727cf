//! The table of a nested-net tile, and the points that a renderer draws from it.
//!
//! Point i of a pixel is that of Sobol's first two dimensions, each digit xored with a bit that depends on the digits
//! before it (A. Owen, "Randomly permuted (t,m,s)-nets and (t,s)-sequences", 1995): the first 2^m points of a pixel are
//! a (0, m, 2)-net for every m, and the sequence does not end. The first `bits` digits' bits are stored.

use crate::error::{Error, Result};
pub use noisefloor::sampler::table::{fine, net};

/// Bits of a stored coordinate's offset.
pub const OFFSET_BITS: u32 = 16;

/// The offsets of all pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SamplerTable {
    /// Pixels along each side.
    pub size: usize,
    /// Each pixel has 2^bits offsets for each axis.
    pub bits: u32,
    /// `[y][x][offset][axis]`
    pub offsets: Vec<[u16; 2]>,
}

impl SamplerTable {
    /// Point `index` of a pixel, each coordinate a fraction of 2^32.
    pub fn point(&self, pixel: usize, index: u32) -> [u32; 2] {
        let offsets = &self.offsets[pixel << self.bits..];
        let mut point = net(index);
        for (axis, value) in point.iter_mut().enumerate() {
            let offset = offsets[leading(*value, self.bits)][axis];
            *value = fine(*value ^ (u32::from(offset) << OFFSET_BITS), pixel as u32, axis);
        }
        point
    }

    /// The file: for each pixel, row by row, 2^bits texels of 32 bits, little endian: the first axis' offset in the
    /// low half, the second's in the high half.
    pub fn bytes(&self) -> Vec<u8> {
        self.offsets.iter().flat_map(|[x, y]| (u32::from(*x) | u32::from(*y) << 16).to_le_bytes()).collect()
    }

    /// The table of such a file, if it is as long as one of this size.
    ///
    /// # Errors
    /// The length is another.
    pub fn from_bytes(size: usize, bits: u32, bytes: &[u8]) -> Result<SamplerTable> {
        let wanted = (size * size) << (bits + 2);
        if bytes.len() != wanted {
            return Err(Error::Input(format!(
                "a sampler's table of {size} x {size} pixels and {bits} bits has {wanted} bytes, this has {}",
                bytes.len()
            )));
        }
        let offsets =
            bytes.chunks_exact(4).map(|b| [u16::from_le_bytes([b[0], b[1]]), u16::from_le_bytes([b[2], b[3]])]);
        Ok(SamplerTable { size, bits, offsets: offsets.collect() })
    }
}

/// The leading bits of a number.
#[inline]
pub(crate) fn leading(value: u32, bits: u32) -> usize {
    (u64::from(value) >> (32 - bits)) as usize
}
