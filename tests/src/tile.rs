//! Small tiles for the tests of the sampler.

use crate::random::SplitMix64;
use noisefloor::tile::{Header, Shape, quantize};

/// CRC-32 of IEEE 802.3, bit by bit: the checksum of tiles and of saved tables.
pub fn crc(bytes: impl IntoIterator<Item = u8>) -> u32 {
    !bytes.into_iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 })
    })
}

/// The bytes of a file of this shape, each coordinate by `value(frame, pixel, sample, dim)`.
pub fn file(shape: Shape, mut value: impl FnMut(u32, u32, u32, u32) -> f32) -> Vec<u8> {
    let mut payload = Vec::new();
    for frame in 0..shape.frames {
        for pixel in 0..shape.size * shape.size {
            for sample in 0..shape.spp {
                for dim in 0..shape.dims {
                    let stored = quantize(value(frame, pixel, sample, dim), shape.bits);
                    payload.extend(&stored.to_le_bytes()[..shape.bits as usize / 8]);
                }
            }
        }
    }
    let mut bytes = Header::new(shape, 1, "test").unwrap().encode(&payload).unwrap().to_vec();
    bytes.append(&mut payload);
    bytes
}

/// Independent uniform values.
pub fn noise(shape: Shape, seed: u64) -> Vec<u8> {
    let mut rng = SplitMix64::new(seed);
    file(shape, |_, _, _, _| rng.uniform_f32())
}

/// In each pixel, sample j lies anywhere in part j of [0, 1)^2: as ordered as samples can be. `spp` is a power of 4,
/// dims is 2.
pub fn ordered(size: u32, spp: u32, progressive: bool, seed: u64) -> Vec<u8> {
    let side = spp.isqrt();
    assert_eq!(side * side, spp);
    let shape = Shape { size, spp, dims: 2, frames: 1, bits: 16, progressive };
    let mut rng = SplitMix64::new(seed);
    file(shape, |_, _, sample, dim| {
        let cell = if dim == 0 { sample % side } else { sample / side };
        (cell as f32 + rng.uniform_f32()) / side as f32
    })
}
