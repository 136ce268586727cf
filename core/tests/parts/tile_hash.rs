//! The permutation of a pixel's samples: what only the crate itself can see.

use super::*;

/// Over all affine maps of the field, each pair of samples takes each pair of places equally often.
#[test]
fn permutations_are_doubly_transitive() {
    for bits in 1..=8 {
        let n = 1_u32 << bits;
        let mut seen = [0_u8; 65536];
        for a in 0..n - 1 {
            // The middle of the 16-bit values that give this factor.
            let high = ((u64::from(a) << 16) + (1 << 15)) / u64::from(n - 1);
            for b in 0..n {
                let random = (high as u32) << 16 | b;
                let (first, second) = (permute(0, n, random), permute(n - 1, n, random));
                assert!(first < n && second < n && first != second);
                seen[(first * n + second) as usize] += 1;
            }
        }
        let pairs = seen.iter().filter(|&&count| count > 0);
        assert_eq!(pairs.clone().count() as u32, n * (n - 1), "{bits} bits");
        assert!(pairs.clone().all(|&count| count == 1));
    }
}

#[test]
fn octaves_stay() {
    for random in [0, 1, 0x1234_5678, u32::MAX] {
        let mut seen = [false; 256];
        for index in 0..256_u32 {
            let to = permute_octave(index, random);
            assert_eq!(to.checked_ilog2(), index.checked_ilog2());
            assert!(!core::mem::replace(&mut seen[to as usize], true));
        }
    }
}
