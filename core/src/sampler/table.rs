//! The table of the default sampler, for ports to other languages.

/// Pixels along each side; they repeat.
pub const SIZE: u32 = 32;
/// Each pixel has 2^BITS entries.
pub const BITS: u32 = 6;
/// Entries of all pixels.
pub const ENTRIES: usize = ((SIZE * SIZE) << BITS) as usize;

/// For each pixel, row by row, and each value of the leading bits of a coordinate: in the low half what the first
/// coordinate's leading 16 bits are exclusive-or, in the high half what the second's are. Made by `fsot sampler`.
pub static TABLE: [u32; ENTRIES] = entries(include_bytes!("../../tiles/nested_32.bin"));

const fn entries(bytes: &[u8; 4 * ENTRIES]) -> [u32; ENTRIES] {
    let (chunks, _) = bytes.as_chunks();
    let (mut all, mut i) = ([0; ENTRIES], 0);
    while i < ENTRIES {
        all[i] = u32::from_le_bytes(chunks[i]);
        i += 1;
    }
    all
}
