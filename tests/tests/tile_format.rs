//! The `.nft` format: what is written can be read, and nothing else.

use noisefloor::Error;
use noisefloor::tile::{
    Builtin, HEADER_BYTES, Header, KERNEL_BYTES, MAX_DIMS, MAX_FRAMES, MAX_SIZE, MAX_SPP, Shape, Tile, quantize,
};
use noisefloor_tests::tile::{crc, file, noise};
use proptest::prelude::*;

const SHAPE: Shape = Shape { size: 4, spp: 2, dims: 3, frames: 2, bits: 16, progressive: true };

/// Puts the checksum right after a deliberate change.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let checksum = crc(bytes[..12].iter().chain(&bytes[16..]).copied());
    bytes[12..16].copy_from_slice(&checksum.to_le_bytes());
    bytes
}

/// The table of core/tiles/README.md, field by field.
#[test]
fn layout() {
    let payload: Vec<u8> = (0..SHAPE.payload_bytes()).map(|i| i as u8).collect();
    let header = Header::new(SHAPE, 0x0123_4567_89ab_cdef, "perceptual").unwrap();
    let bytes = header.encode(&payload).unwrap();
    assert_eq!(bytes.len(), HEADER_BYTES);
    assert_eq!(bytes[..8], *b"\x8eNFT\r\n\x1a\n");
    assert_eq!(bytes[8..12], [1, 0, 128, 0]);
    assert_eq!(bytes[16..24], (4 * 4 * 2 * 3 * 2 * 2_u64).to_le_bytes());
    assert_eq!(bytes[24..32], [0xef, 0xcd, 0xab, 0x89, 0x67, 0x45, 0x23, 0x01]);
    assert_eq!(bytes[32..40], [4, 0, 2, 0, 2, 0, 3, 16]);
    assert_eq!(bytes[40..48], [1, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(bytes[48..58], *b"perceptual");
    assert!(bytes[58..].iter().all(|&byte| byte == 0));
    let all = [&bytes[..], &payload].concat();
    assert_eq!(sealed(all.clone()), all, "the checksum is that of all other bytes");

    let (read, values) = Header::decode(&all).unwrap();
    assert_eq!((read, values), (header, &payload[..]));
    assert_eq!((read.shape(), read.seed(), read.kernel()), (SHAPE, 0x0123_4567_89ab_cdef, "perceptual"));
    let tile = Tile::from_bytes(&all).unwrap();
    assert_eq!((tile.shape(), tile.payload()), (SHAPE, &payload[..]));
    assert_eq!((Tile::new(SHAPE, &payload), Tile::resume(SHAPE, &payload)), (Ok(tile), tile));
    assert_eq!(Tile::new(SHAPE, &payload[1..]), Err(Error::Length));
    assert_eq!(Tile::new(SHAPE, &all), Err(Error::Length));
    assert_eq!(Tile::new(Shape { spp: 3, ..SHAPE }, &payload), Err(Error::Range));
}

#[test]
fn values_are_in_the_middle_of_their_steps() {
    for bits in [8, 16] {
        let shape = Shape { bits, ..SHAPE };
        let place = |frame, pixel, sample, dim| ((frame * 16 + pixel) * 2 + sample) * 3 + dim;
        let value = |index: u32| index as f32 / 192.0;
        let bytes = file(shape, |frame, pixel, sample, dim| value(place(frame, pixel, sample, dim)));
        let tile = Tile::from_bytes(&bytes).unwrap();
        for frame in 0..2 {
            for (pixel, sample, dim) in (0..16).flat_map(|p| (0..6).map(move |i| (p, i / 3, i % 3))) {
                let stored = tile.value(frame, pixel / 4, pixel % 4, sample, dim).unwrap();
                let levels = (1 << bits) as f32;
                assert!((stored - value(place(frame, pixel, sample, dim))).abs() <= 0.5 / levels);
                assert_eq!((stored * levels).fract(), 0.5);
            }
        }
        for outside in [(2, 0, 0, 0, 0), (0, 4, 0, 0, 0), (0, 0, 4, 0, 0), (0, 0, 0, 2, 0), (0, 0, 0, 0, 3)] {
            let (frame, y, x, sample, dim) = outside;
            assert_eq!(tile.value(frame, y, x, sample, dim), None);
        }
    }
    assert_eq!(quantize(0.0, 8), 0);
    assert_eq!(
        [quantize(1.0, 8), quantize(f32::INFINITY, 8), quantize(0.999, 8), quantize(1.0, 16)],
        [255, 255, 255, 65535]
    );
    assert_eq!([quantize(-1.0, 16), quantize(f32::NAN, 16)], [0, 0]);
    assert_eq!([quantize(0.5, 8), quantize(0.5, 16)], [128, 32768]);
}

#[test]
fn a_shape_out_of_range_is_refused() {
    for wrong in [
        Shape { size: 0, ..SHAPE },
        Shape { size: 3, ..SHAPE },
        Shape { size: 2 * MAX_SIZE, ..SHAPE },
        Shape { spp: 0, ..SHAPE },
        Shape { spp: 6, ..SHAPE },
        Shape { spp: 2 * MAX_SPP, ..SHAPE },
        Shape { dims: 0, ..SHAPE },
        Shape { dims: MAX_DIMS + 1, ..SHAPE },
        Shape { frames: 0, ..SHAPE },
        Shape { frames: MAX_FRAMES + 1, ..SHAPE },
        Shape { bits: 12, ..SHAPE },
        Shape { bits: 0, ..SHAPE },
    ] {
        assert_eq!(Header::new(wrong, 0, ""), Err(Error::Range), "{wrong:?}");
    }
    assert!(SHAPE.check().is_ok() && Shape { spp: 3, ..SHAPE }.check().is_err());
    let shape = Shape { size: 64, spp: 4, dims: 2, frames: 1, bits: 16, progressive: false };
    assert_eq!((shape.coordinates(), shape.payload_bytes()), (64 * 64 * 4 * 2, 64 * 64 * 4 * 2 * 2));
    let longest = "x".repeat(KERNEL_BYTES);
    assert_eq!(Header::new(SHAPE, 0, &longest).unwrap().kernel(), longest);
    for text in [&"x".repeat(KERNEL_BYTES + 1), "line\n", "é", "zero\0"] {
        assert_eq!(Header::new(SHAPE, 0, text), Err(Error::Range), "{text:?}");
    }
    assert_eq!(Header::new(SHAPE, 0, "").unwrap().encode(&[0; 383]), Err(Error::Length));
}

#[test]
fn each_error() {
    let good = noise(SHAPE, 3);
    assert!(Tile::from_bytes(&good).is_ok());
    let error = |bytes: &[u8]| Tile::from_bytes(bytes).unwrap_err();
    let changed = |at: usize, byte: u8| {
        let mut bytes = good.clone();
        bytes[at] = byte;
        bytes
    };
    assert_eq!(error(&[]), Error::Foreign);
    assert_eq!(error(b"\x89PNG\r\n\x1a\n"), Error::Foreign);
    assert_eq!(error(&changed(0, 0x8f)), Error::Foreign);
    assert_eq!(error(&good[..1]), Error::Length);
    assert_eq!(error(&good[..HEADER_BYTES]), Error::Length);
    assert_eq!(error(&good[..good.len() - 1]), Error::Length);
    assert_eq!(error(&[&good[..], &[0]].concat()), Error::Length);
    assert_eq!(error(&changed(8, 2)), Error::Version);
    assert_eq!(error(&changed(9, 1)), Error::Version);
    assert_eq!(error(&sealed(changed(8, 0))), Error::Corrupt);
    assert_eq!(error(&changed(12, good[12] ^ 1)), Error::Corrupt);
    assert_eq!(error(&changed(good.len() - 1, good[good.len() - 1] ^ 128)), Error::Corrupt);
    // Fields that make no sense, though the checksum is right: header length, payload length, size, spp, frames, dims,
    // bits, flags, reserved, and text behind its end.
    for at in [10, 16, 23, 32, 34, 36, 38, 39, 43, 44, 47, 127] {
        let refused = error(&sealed(changed(at, good[at] ^ 9)));
        assert!(matches!(refused, Error::Corrupt | Error::Length), "byte {at}: {refused:?}");
    }
    for error in [Error::Foreign, Error::Version, Error::Length, Error::Corrupt] {
        assert!(!error.to_string().is_empty());
    }
    let error: Box<dyn std::error::Error> = Error::Range.into();
    assert!(error.to_string().contains("outside its documented range"));
    assert_eq!(Error::NotFinite.to_string(), "an input value, of an array or an argument, is NaN or infinite");
}

#[test]
fn every_truncation_and_every_changed_bit_is_refused() {
    let good = noise(Shape { size: 2, spp: 1, dims: 1, frames: 1, bits: 8, progressive: false }, 4);
    for len in 0..good.len() {
        let expected = if len == 0 { Error::Foreign } else { Error::Length };
        assert_eq!(Tile::from_bytes(&good[..len]), Err(expected), "{len} bytes");
    }
    for bit in 0..8 * good.len() {
        let mut bytes = good.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        let error = Tile::from_bytes(&bytes).unwrap_err();
        let is_right = match bit / 8 {
            0..8 => error == Error::Foreign,
            8..12 => matches!(error, Error::Version | Error::Corrupt),
            // Another shape may ask for another length.
            32..40 => matches!(error, Error::Corrupt | Error::Length),
            _ => error == Error::Corrupt,
        };
        assert!(is_right, "bit {bit}: {error:?}");
    }
}

/// The tiles that come with the library are whole, and have the shape that their names say.
#[test]
fn built_in_tiles() {
    let mut present = 0;
    for tile in Builtin::ALL {
        let Some(bytes) = tile.bytes() else {
            assert_eq!(tile.tile(), Err(Error::Unsupported));
            continue;
        };
        present += 1;
        assert_eq!(Tile::from_bytes(bytes), tile.tile(), "{}", tile.name());
        let Shape { size, spp, dims, frames, progressive, .. } = tile.tile().unwrap().shape();
        let variant = if progressive { "_PROGRESSIVE" } else { "" };
        assert!(tile.name().starts_with(&format!("{size}_{spp}SPP_{dims}D{variant}")), "{}", tile.name());
        assert_eq!(frames > 1, tile.name().ends_with("_TEMPORAL"));
    }
    assert!(present > 0);
    assert_eq!(Builtin::Size64Spp1Dims2.name(), "64_1SPP_2D");
}

/// Of 1, 2, 4, ... pixels on a side: so many sizes.
pub(crate) fn shapes(sizes: u32) -> impl Strategy<Value = Shape> {
    (0..sizes, 0_u32..4, 1_u32..=8, 1_u32..4, any::<bool>(), any::<bool>()).prop_map(
        |(size, spp, dims, frames, wide, progressive)| Shape {
            size: 1 << size,
            spp: 1 << spp,
            dims,
            frames,
            bits: if wide { 16 } else { 8 },
            progressive,
        },
    )
}

proptest! {
    #![proptest_config(crate::cases(300, 5))]

    #[test]
    fn what_is_written_is_read(shape in shapes(4), seed in any::<u64>(), text in "[ -~]{0,80}") {
        let payload: Vec<u8> = (0..shape.payload_bytes()).map(|i| (i * i) as u8).collect();
        let header = Header::new(shape, seed, &text).unwrap();
        let bytes = [&header.encode(&payload).unwrap()[..], &payload].concat();
        prop_assert_eq!(Header::decode(&bytes), Ok((header, &payload[..])));
        prop_assert_eq!(header.kernel(), text);
        // Any alignment will do.
        let shifted = [&[0][..], &bytes].concat();
        prop_assert_eq!(Tile::from_bytes(&shifted[1..]), Tile::from_bytes(&bytes));
    }

    #[test]
    fn any_changed_byte_is_refused(shape in shapes(4), at in any::<prop::sample::Index>(), xor in 1_u8..) {
        let mut bytes = noise(shape, 6);
        let at = at.index(bytes.len());
        bytes[at] ^= xor;
        prop_assert!(Tile::from_bytes(&bytes).is_err());
    }

    #[test]
    fn any_bytes_are_refused(mut bytes in prop::collection::vec(any::<u8>(), 0..400), start in 0_usize..48) {
        // The start of a real one, so that more than the magic is looked at.
        let good = noise(SHAPE, 7);
        let start = start.min(bytes.len());
        bytes[..start].copy_from_slice(&good[..start]);
        prop_assert!(Tile::from_bytes(&bytes).is_err());
    }
}
