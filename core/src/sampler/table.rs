//! The table of the default sampler, for ports to other languages.

/// Pixels along each side; they repeat.
pub const SIZE: u32 = 32;
/// Each pixel has 2^BITS entries.
pub const BITS: u32 = 6;
/// Entries of all pixels.
pub const ENTRIES: usize = ((SIZE * SIZE) << BITS) as usize;

/// For each pixel, row by row, and each value of the leading bits of a coordinate: in the low half what the first
/// coordinate's leading 16 bits are exclusive-or, in the high half what the second's are. Made by `fsot sampler`.
pub static TABLE: [u32; ENTRIES] = {
    let bytes: &[u8; 4 * ENTRIES] = include_bytes!("../../tiles/nested_32.bin");
    let (chunks, _) = bytes.as_chunks();
    let (mut all, mut i) = ([0; ENTRIES], 0);
    while i < ENTRIES {
        all[i] = u32::from_le_bytes(chunks[i]);
        i += 1;
    }
    all
};

/// Sobol's first two dimensions at an index: its reversed bits, and Pascal's matrix modulo 2 times these.
#[inline]
pub const fn net(index: u32) -> [u32; 2] {
    let first = index.reverse_bits();
    [first, pascal(first)]
}

/// The second of these by the first: by table where a pixel has no more than 256 samples.
#[inline]
pub(super) const fn pascal(first: u32) -> u32 {
    if first << 8 == 0 { (PASCAL[(first >> 24) as usize] as u32) << 24 } else { product(first) }
}

static PASCAL: [u8; 256] = {
    let (mut all, mut first) = ([0; 256], 0);
    while first < 256 {
        all[first as usize] = (product(first << 24) >> 24) as u8;
        first += 1;
    }
    all
};

/// Pascal's matrix times the digits.
const fn product(first: u32) -> u32 {
    let mut second = first ^ first << 16;
    second ^= (second & 0x00ff_00ff) << 8;
    second ^= (second & 0x0f0f_0f0f) << 4;
    second ^= (second & 0x3333_3333) << 2;
    second ^ (second & 0x5555_5555) << 1
}

/// How the finer digits of each axis depend on the leading eight.
const FINE: [u32; 2] = [0x9e37_79b9, 0xc13f_a9a9];

/// A coordinate with its offset, whose 24 bits below the leading 8 are exclusive-or a hash of these, of the pixel (row
/// times side plus column) and of the axis, 0 or 1: without it, all points that share an offset would share their finer
/// digits.
#[inline]
pub const fn fine(value: u32, pixel: u32, axis: usize) -> u32 {
    value ^ (pixel << 8 | value >> 24).wrapping_mul(FINE[axis & 1]) >> 8
}
