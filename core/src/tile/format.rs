//! The `.nft` format, version 1: a header of 128 bytes, then the values; `core/tiles/README.md` has the table.

use super::shape::Shape;
use crate::checksum::crc;
use crate::error::{Error, ensure};
use crate::matrix::{chunk, first, from, is_same};

/// Bytes of the header.
pub const HEADER_BYTES: usize = 128;
/// Bytes of the description of the kernel.
pub const KERNEL_BYTES: usize = 80;
/// The version this library reads and writes.
pub const VERSION: u16 = 1;
/// How a tile begins. As in PNG, the line ends and the byte above 127 show files that were transferred as text.
pub const MAGIC: [u8; 8] = *b"\x8eNFT\r\n\x1a\n";

/// Where the checksum of all other bytes stands.
const CHECKSUM: usize = 12;
const PROGRESSIVE: u32 = 1;

/// What a tile's file says about it.
///
/// ```
/// use noisefloor::tile::{Header, Shape, Tile};
///
/// let shape = Shape { size: 2, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false };
/// let payload = [0, 64, 128, 192, 64, 0, 192, 128];
/// let mut file = Header::new(shape, 1, "perceptual")?.encode(&payload)?.to_vec();
/// file.extend(payload);
/// assert_eq!(Tile::from_bytes(&file)?.shape(), shape);
/// assert_eq!(Header::decode(&file)?.0.kernel(), "perceptual");
/// # Ok::<(), noisefloor::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    shape: Shape,
    seed: u64,
    kernel: [u8; KERNEL_BYTES],
}

impl Header {
    /// A header to [`encode`](Header::encode).
    ///
    /// `seed` is the one the tile was made with. `kernel` says what for, such as `perceptual` or `gaussian:1.5`: at
    /// most [`KERNEL_BYTES`] printable ASCII characters and spaces.
    ///
    /// # Errors
    /// [`Error::Range`] for a shape or text outside these limits.
    pub fn new(shape: Shape, seed: u64, kernel: &str) -> Result<Header, Error> {
        let mut text = [0; KERNEL_BYTES];
        text.iter_mut().zip(kernel.bytes()).for_each(|(to, from)| *to = from);
        let header = Header { shape, seed, kernel: text };
        let is_whole = kernel.len() <= KERNEL_BYTES && !kernel.contains('\0');
        ensure(shape.check().is_ok() && header.text_is_valid() && is_whole, Error::Range)?;
        Ok(header)
    }

    /// How many values, and how they are stored.
    pub const fn shape(&self) -> Shape {
        self.shape
    }

    /// The seed the tile was made with.
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// What the tile was optimised for.
    pub fn kernel(&self) -> &str {
        let text = self.kernel.split(|&byte| byte == 0).next();
        text.and_then(|text| core::str::from_utf8(text).ok()).unwrap_or("")
    }

    /// The bytes to write before `payload`, which is what [`Tile::new`](super::Tile::new) takes.
    ///
    /// # Errors
    /// [`Error::Length`] if the payload has not the bytes that the shape says.
    pub fn encode(&self, payload: &[u8]) -> Result<[u8; HEADER_BYTES], Error> {
        ensure(payload.len() as u64 == self.shape.payload_bytes(), Error::Length)?;
        let rest = self.bytes(0);
        Ok(self.bytes(crc([first(&rest, CHECKSUM), from(&rest, CHECKSUM + 4), payload])))
    }

    /// The header of a file's bytes, and its payload; all bytes are checked.
    ///
    /// # Errors
    /// As for [`Tile::from_bytes`](super::Tile::from_bytes).
    pub fn decode(bytes: &[u8]) -> Result<(Header, &[u8]), Error> {
        ensure(is_same(bytes, &MAGIC) && !bytes.is_empty(), Error::Foreign)?;
        let (head, payload) = bytes.split_first_chunk::<HEADER_BYTES>().ok_or(Error::Length)?;
        let version = u16::from_le_bytes([head[8], head[9]]);
        ensure(version <= VERSION, Error::Version)?;
        let (seed, kernel) =
            (u64::from_le_bytes(chunk(from(head, 24))), chunk(from(head, HEADER_BYTES - KERNEL_BYTES)));
        let header = Header { shape: shape(head), seed, kernel };
        let is_valid = version == VERSION && header.shape.check().is_ok() && header.text_is_valid();
        ensure(is_valid, Error::Corrupt)?;
        // The header says nothing but its fields: all of its bytes are those it would be written with.
        ensure(is_same(head, &header.encode(payload)?), Error::Corrupt)?;
        Ok((header, payload))
    }

    /// With this checksum.
    fn bytes(&self, checksum: u32) -> [u8; HEADER_BYTES] {
        let Shape { size, spp, dims, frames, bits, progressive } = self.shape;
        let flags = if progressive { PROGRESSIVE } else { 0 };
        let fields = [
            &MAGIC[..],
            &VERSION.to_le_bytes(),
            &(HEADER_BYTES as u16).to_le_bytes(),
            &checksum.to_le_bytes(),
            &self.shape.payload_bytes().to_le_bytes(),
            &self.seed.to_le_bytes(),
            &(size as u16).to_le_bytes(),
            &(spp as u16).to_le_bytes(),
            &(frames as u16).to_le_bytes(),
            &[dims as u8, bits as u8],
            &flags.to_le_bytes(),
            // Reserved.
            &[0; 4],
            &self.kernel,
        ];
        let mut bytes = [0; HEADER_BYTES];
        bytes.iter_mut().zip(fields.into_iter().flatten()).for_each(|(to, &from)| *to = from);
        bytes
    }

    /// Printable ASCII, then zeros.
    fn text_is_valid(&self) -> bool {
        self.kernel.iter().skip_while(|byte| (b' '..=b'~').contains(byte)).all(|&byte| byte == 0)
    }
}

/// The shape that a header says, in range or not.
pub(super) const fn shape(b: &[u8; HEADER_BYTES]) -> Shape {
    Shape {
        size: u16::from_le_bytes([b[32], b[33]]) as u32,
        spp: u16::from_le_bytes([b[34], b[35]]) as u32,
        frames: u16::from_le_bytes([b[36], b[37]]) as u32,
        dims: b[38] as u32,
        bits: b[39] as u32,
        progressive: u32::from_le_bytes([b[40], b[41], b[42], b[43]]) & PROGRESSIVE != 0,
    }
}

/// The stored integer of `bits` (8 or 16) whose value, `(v + 1/2) / 2^bits`, is nearest to u in [0, 1); u outside, or
/// NaN, is clamped.
pub fn quantize(u: f32, bits: u32) -> u16 {
    let levels = 1_u32 << (bits & 31).min(16);
    // The conversion saturates, and rounds down what is positive.
    ((u * levels as f32) as u32).min(levels - 1) as u16
}
