//! Pinned batches, to the bit: `tests/vectors/table.txt`, which a C test reads too and draws with the vector unit's
//! code.
//!
//! A change of any figure is a change of every training run: rewrite the file with
//! `NOISEFLOOR_WRITE_VECTORS=1 cargo test -p noisefloor-tests --test noisefloor minibatch_table_vectors::`, and say why
//! in CHANGELOG.md.

use crate::table_support::{Owned, memory, saved};
use noisefloor::rng::Rng;
use noisefloor_tests::random::SplitMix64;
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

const HEAD: &str = "\
# Batches drawn from tables of importances, to the bit. Written by tests/tests/minibatch_table_vectors.rs; \
read by it and by
# tests/c/table_vectors.c, which say how the tables are made.
#
# items seed draws uniform_fraction : item weight item weight of the first two draws, then FNV-1a of all that is \
drawn: with
# replacement, after updates stratified, with epsilon added, without replacement; total, FNV-1a of the saved bytes.
# Floats and hashes as hexadecimal bits.
";

/// Sizes around those of blocks and nodes.
const SIZES: [u32; 8] = [1, 15, 16, 17, 256, 257, 4097, 60_000];
const DRAWS: [usize; 4] = [1, 64, 65, 1000];
const FRACTIONS: [f32; 3] = [0.2, 0.0, 1.0];

/// An importance from 32 random bits: 2^-12 to 2^19, or 0.
fn importance(bits: u32) -> f32 {
    let exponent = (bits & 31) as i32 - 12;
    if bits & 0xe0 == 0 { 0.0 } else { (1.0 + (bits >> 9) as f32 / 8_388_608.0) * 2f32.powi(exponent) }
}

/// Importances of a table: the first item has one, of every fifth block no other.
fn importances(rng: &mut Rng, items: u32) -> Vec<f32> {
    let value = |item: u32| {
        let q = importance(rng.next_u32());
        match (item, item / 16 % 5) {
            (0, _) => 1.0,
            (_, 2) => 0.0,
            _ => q,
        }
    };
    (0..items).map(value).collect()
}

/// FNV-1a, 64 bits.
fn hash(bytes: impl IntoIterator<Item = u8>) -> u64 {
    bytes
        .into_iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

fn hash_batch(index: &[u32], weight: &[f32]) -> u64 {
    hash(index.iter().zip(weight).flat_map(|(i, w)| [i.to_le_bytes(), w.to_bits().to_le_bytes()]).flatten())
}

fn case(items: u32, seed: u64, draws: usize, fraction: f32) -> String {
    let mut rng = Rng::seed(seed);
    let values = importances(&mut rng, items);
    let (q, sums) = memory(items);
    let mut table = Owned::new(q, sums, items, Some(&values)).unwrap();
    table.set_uniform_fraction(fraction).unwrap();
    let (mut index, mut weight) = (vec![0; draws], vec![0.0; draws]);
    let mut hashes = Vec::new();

    table.draw(&mut rng, &mut index, Some(&mut weight)).unwrap();
    hashes.push(hash_batch(&index, &weight));
    let second = 1.min(draws - 1);
    let first = [(index[0], weight[0]), (index[second], weight[second])];

    // Every third item comes twice in a row.
    for k in (1..draws).step_by(3) {
        index[k] = index[k - 1];
    }
    let mut fresh: Vec<f32> = index.iter().map(|_| importance(rng.next_u32())).collect();
    fresh[0] = 3.0;
    table.update(&index, &fresh, 0.3).unwrap();
    table.draw_stratified(&mut rng, &mut index, Some(&mut weight)).unwrap();
    hashes.push(hash_batch(&index, &weight));

    table.add_epsilon(0.001).unwrap();
    table.draw(&mut rng, &mut index, Some(&mut weight)).unwrap();
    hashes.push(hash_batch(&index, &weight));

    let distinct = draws.min(items as usize);
    table.draw_distinct(&mut rng, &mut index[..distinct], Some(&mut weight[..distinct])).unwrap();
    hashes.push(hash_batch(&index[..distinct], &weight[..distinct]));
    hashes.push(table.total().to_bits());
    hashes.push(hash(saved(&table)));

    let mut line = format!("{items} {seed} {draws} {:08x} :", fraction.to_bits());
    first.iter().for_each(|(item, weight)| write!(line, " {item} {:08x}", weight.to_bits()).unwrap());
    hashes.iter().for_each(|hash| write!(line, " {hash:016x}").unwrap());
    line + "\n"
}

#[test]
fn batches_are_the_pinned_ones() {
    let mut text = HEAD.to_owned();
    let mut seeds = SplitMix64::new(71);
    for (number, items) in SIZES.into_iter().enumerate() {
        for (k, draws) in DRAWS.into_iter().enumerate() {
            text += &case(items, seeds.next_u64() >> 32, draws, FRACTIONS[(number + k) % 3]);
        }
    }
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("vectors/table.txt");
    if std::env::var_os("NOISEFLOOR_WRITE_VECTORS").is_some() {
        fs::write(&path, &text).unwrap();
    }
    let pinned = fs::read_to_string(&path).unwrap();
    for (number, (pinned, actual)) in pinned.lines().zip(text.lines()).enumerate() {
        assert_eq!(pinned, actual, "line {}; see the head of tests/tests/minibatch_table_vectors.rs", number + 1);
    }
    assert_eq!(pinned.lines().count(), text.lines().count());
}

/// The same without a file.
#[test]
fn a_small_batch_is_the_pinned_one() {
    let (q, sums) = memory(5);
    let table = Owned::new(q, sums, 5, Some(&[1.0, 0.0, 4.0, 2.0, 1.0])).unwrap();
    let (mut index, mut weight) = ([0; 8], [0.0; 8]);
    table.draw(&mut Rng::seed(1), &mut index, Some(&mut weight)).unwrap();
    // By hand: p = .8 q / 8 + .04.
    let expected = [1.0, 0.0, 4.0, 2.0, 1.0].map(|q| 1.0 / (5.0 * (0.1 * q + 0.04)));
    for (&item, &weight) in index.iter().zip(&weight) {
        assert!((f64::from(weight) / expected[item as usize] - 1.0).abs() < 1e-6);
    }
    assert_eq!(index, [2, 2, 0, 3, 2, 2, 0, 0]);
}
