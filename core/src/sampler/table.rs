//! The table of the default sampler, as it is stored and as ports to other languages need it.

/// Pixels along each side; they repeat.
pub const SIZE: u32 = 32;
/// Each pixel has 2^BITS entries.
pub const BITS: u32 = 6;
/// Bytes of the table.
pub const BYTES: usize = ((SIZE * SIZE) << (BITS + 2)) as usize;

/// For each pixel, row by row, and each value of the leading bits of a coordinate: what the first coordinate's leading
/// 16 bits are exclusive-or, then what the second's are; each 16 bits, little endian. Made by `fsot sampler`.
pub(super) static TABLE: [[u8; 4]; BYTES / 4] = *as_entries(include_bytes!("../../tiles/sampler.bin"));

const fn as_entries(bytes: &'static [u8; BYTES]) -> &'static [[u8; 4]; BYTES / 4] {
    match bytes.as_chunks().0.first_chunk() {
        Some(entries) => entries,
        None => panic!("the table has another size"),
    }
}

/// Its bytes.
pub const fn bytes() -> &'static [u8] {
    TABLE.as_flattened()
}
