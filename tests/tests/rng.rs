//! PCG32: published values, pinned values, and the uniformity of what is made from it.

use noisefloor::rng::Rng;
use noisefloor_tests::statistics::uniform_z;
use rand_core::{Rng as _, SeedableRng};

/// The first outputs of the published demonstration program, `pcg32_srandom(42, 54)`.
#[test]
fn published_values() {
    let mut rng = Rng::new(42, 54);
    for expected in [0xa15c02b7, 0x7b47f409, 0xba1d3330, 0x83d2f293, 0xbfa4784b, 0xcbed606e] {
        assert_eq!(rng.next_u32(), expected);
    }
}

#[test]
fn an_even_increment_counts_as_odd() {
    let (mut even, mut odd) = (Rng { state: 5, increment: 6 }, Rng { state: 5, increment: 7 });
    assert!(even == odd && even != Rng { state: 5, increment: 8 } && even != Rng { state: 6, increment: 6 });
    for _ in 0..10 {
        assert_eq!(even.next_u32(), odd.next_u32());
    }
    // A zeroed C struct is a valid generator too.
    let mut zero = Rng { state: 0, increment: 0 };
    let distinct: std::collections::HashSet<u32> = (0..100).map(|_| zero.next_u32()).collect();
    assert!(distinct.len() > 95);
}

/// State and stream are the first two outputs of SplitMix64, here those published for seed 0.
#[test]
fn seeds_are_expanded_by_split_mix() {
    assert_eq!(Rng::seed(0), Rng::new(0xe220_a839_7b1d_cdaf, 0x6e78_9e6a_a1b9_65f4));
}

/// Guards every stored result against a silent change of the stream.
#[test]
fn pinned_values() {
    let mut rng = Rng::seed(0);
    assert_eq!([(); 4].map(|()| rng.next_u32()), PINNED_SEED_0);
    let mut rng = Rng::seed(u64::MAX);
    assert_eq!([(); 4].map(|()| rng.next_u32()), PINNED_SEED_MAX);
    let mut rng = Rng::seed(1);
    let drawn = (rng.uniform_f32().to_bits(), rng.uniform_f64().to_bits(), rng.below(1000), rng.next_u64());
    assert_eq!(drawn, PINNED_SEED_1);
}

const PINNED_SEED_0: [u32; 4] = [0x90644221, 0x4618e85f, 0x8f5bd9cd, 0xaf2c0306];
const PINNED_SEED_MAX: [u32; 4] = [0x4df7fdf8, 0x74675b30, 0xa2f72031, 0x21affdbd];
const PINNED_SEED_1: (u32, u64, u32, u64) = (0x3ea4938a, 0x3fecf2eced2032b2, 343, 0x7efb0d93ec099420);

#[test]
fn the_traits_give_the_same_stream() {
    let (mut own, mut through) = (Rng::seed(7), Rng::seed_from_u64(7));
    assert_eq!(own.next_u32(), rand_core::Rng::next_u32(&mut through));
    assert_eq!(own.next_u64(), rand_core::Rng::next_u64(&mut through));
    let mut bytes = [0; 11];
    through.fill_bytes(&mut bytes);
    let words = [(); 3].map(|()| own.next_u32().to_le_bytes());
    assert_eq!(bytes, words.as_flattened()[..11]);

    let mut seed = [0; 16];
    seed[0] = 42;
    seed[8] = 54;
    assert_eq!(Rng::from_seed(seed), Rng::new(42, 54));
}

#[test]
fn next_u64_is_two_outputs_the_lower_first() {
    let (mut once, mut twice) = (Rng::seed(3), Rng::seed(3));
    let low = u64::from(twice.next_u32());
    assert_eq!(once.next_u64(), u64::from(twice.next_u32()) << 32 | low);
}

/// z beyond this has probability 1e-5, either way 2e-5.
const Z_LIMIT: f64 = 4.265;

#[test]
fn uniforms_are_uniform_and_below_one() {
    let mut rng = Rng::seed(11);
    let (mut single, mut double) = ([0; 256], [0; 256]);
    for _ in 0..1 << 20 {
        let (x, y) = (rng.uniform_f32(), rng.uniform_f64());
        assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y));
        assert_eq!((x * 16_777_216.0).fract(), 0.0);
        single[(x * 256.0) as usize] += 1;
        double[(y * 256.0) as usize] += 1;
    }
    for counts in [single, double] {
        assert!(uniform_z(&counts).abs() < Z_LIMIT, "{}", uniform_z(&counts));
    }
}

/// Counts that are the same but for chance. Of two or three cells, whose chi-square is no normal deviate, each count
/// is: binomial of so many draws.
fn assert_even(counts: &[u64]) {
    let (draws, share) = (counts.iter().sum::<u64>() as f64, 1.0 / counts.len() as f64);
    let deviation = (draws * share * (1.0 - share)).sqrt();
    let largest = counts.iter().map(|&count| (count as f64 - draws * share).abs() / deviation).fold(0.0, f64::max);
    let z = if counts.len() < 4 { largest } else { uniform_z(counts) };
    assert!(z.abs() < Z_LIMIT, "z = {z}: {counts:?}");
}

#[test]
fn below_is_unbiased() {
    let mut rng = Rng::seed(12);
    for n in [1_u32, 2, 3, 7, 100] {
        let mut counts = vec![0_u64; n as usize];
        for _ in 0..200_000 {
            counts[rng.below(n) as usize] += 1;
        }
        if n > 1 {
            assert_even(&counts);
        }
    }
    // With n = 3 * 2^30 a bare product would give every third value twice as often.
    let n = 3 << 30;
    let mut thirds = [0_u64; 3];
    for _ in 0..300_000 {
        let x = rng.below(n);
        assert!(x < n);
        thirds[(x % 3) as usize] += 1;
    }
    assert_even(&thirds);
    assert_eq!(rng.below(0), 0);
    assert_eq!(rng.below(1), 0);
}

/// Generators of neighbouring seeds, and of seeds that differ in one high bit, must not follow one another: the
/// correlation of n pairs of uniforms has standard deviation 1 / sqrt(n).
#[test]
fn neighbouring_seeds_are_uncorrelated() {
    let n = 20_000;
    for (a, b) in [(0, 1), (1, 2), (0, 1 << 63), (5, 5 + (1 << 60)), (0, u64::MAX), (1000, 1001)] {
        let (mut a, mut b) = (Rng::seed(a), Rng::seed(b));
        let products = (0..n).map(|_| 12.0 * (a.uniform_f64() - 0.5) * (b.uniform_f64() - 0.5));
        let z = products.sum::<f64>() / f64::from(n).sqrt();
        assert!(z.abs() < 4.417, "z = {z}");
    }
    // Across seeds: the first numbers of the generators 0..n are as good as one generator's.
    let mut counts = [0; 256];
    (0..1 << 18).for_each(|seed| counts[(Rng::seed(seed).next_u32() >> 24) as usize] += 1);
    assert!(uniform_z(&counts).abs() < Z_LIMIT);
}
