//! Pinned draws, to the bit: `tests/vectors/tile.txt` and the tiles beside it, which the C tests read too.
//!
//! A change of any figure is a change of every renderer's images: rewrite the files with
//! `NOISEFLOOR_WRITE_VECTORS=1 cargo test -p noisefloor-tests --test noisefloor tile_vectors::`, and say why in
//! CHANGELOG.md.

use noisefloor::tile::{Sampler, Shape, Tile};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::tile::noise;
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

const HEAD: &str = "\
# Draws of the sampler, to the bit. Written by tests/tests/tile_vectors.rs; read by it and by tests/c/tile_vectors.c.
#
# file x y frame index keys scramble key[0] key[1] key[2] : u[4], floats as hexadecimal bits
# The first `keys` of the three keys are followed, one below the other; before the last, or at the root, \
the sampler is scrambled.
";

const FILES: [(&str, Shape); 4] = [
    ("plain.nft", Shape { size: 8, spp: 4, dims: 3, frames: 1, bits: 16, progressive: false }),
    ("progressive.nft", Shape { size: 4, spp: 8, dims: 2, frames: 3, bits: 8, progressive: true }),
    ("single.nft", Shape { size: 16, spp: 1, dims: 1, frames: 1, bits: 16, progressive: false }),
    ("further.nft", Shape { size: 4, spp: 16, dims: 2, frames: 2, bits: 8, progressive: false }),
];

/// A file of tests/vectors, first rewritten if that is asked for.
fn pinned(name: &str, bytes: &[u8]) -> Vec<u8> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("vectors").join(name);
    if std::env::var_os("NOISEFLOOR_WRITE_VECTORS").is_some() {
        fs::write(&path, bytes).unwrap();
    }
    fs::read(&path).unwrap()
}

#[test]
fn draws_are_the_pinned_ones() {
    let mut text = HEAD.to_owned();
    let mut rng = SplitMix64::new(31);
    for (name, shape) in FILES {
        let bytes = noise(shape, 30);
        assert!(pinned(name, &bytes) == bytes, "{name}");
        let tile = Tile::from_bytes(&bytes).unwrap();
        for case in 0..100_u32 {
            let mut random = |case: u32| (rng.next_u64() as u32).checked_shr(case % 5 * 8).unwrap_or(0);
            let (x, y, frame) = (random(case), random(case + 1), if case % 3 == 0 { 0 } else { random(4) % 7 });
            let index = if case % 2 == 0 { case / 2 % (2 * shape.spp) } else { random(case) };
            let (keys, seed) = (case % 4, if case % 7 == 0 { random(2) } else { 0 });
            let key = [random(4), random(3), random(0)];
            let mut sampler = Sampler::pixel(&tile, x, y, frame, index);
            for (number, &key) in key.iter().take(keys as usize).enumerate() {
                if number + 1 == keys as usize {
                    sampler = sampler.scramble(seed);
                }
                sampler = sampler.domain(key);
            }
            if keys == 0 {
                sampler = sampler.scramble(seed);
            }
            let [a, b, c] = key;
            write!(text, "{name} {x} {y} {frame} {index} {keys} {seed} {a} {b} {c} :").unwrap();
            sampler.draw::<4>().iter().for_each(|u| write!(text, " {:08x}", u.to_bits()).unwrap());
            text.push('\n');
        }
    }
    let pinned = String::from_utf8(pinned("tile.txt", text.as_bytes())).unwrap();
    for (number, (pinned, actual)) in pinned.lines().zip(text.lines()).enumerate() {
        assert_eq!(pinned, actual, "line {}; see the head of tests/tests/tile_vectors.rs", number + 1);
    }
    assert_eq!(pinned.lines().count(), text.lines().count());
}
