//! The sequence beyond a tile's samples: what only the crate itself can see.

use super::*;

/// The points of the plain sequence, as fractions of 2^32.
fn sobol(index: u32, dim: usize) -> u32 {
    let set = (0..32).filter(|bit| index >> bit & 1 == 1);
    set.fold(0, |point, bit| point ^ DIRECTIONS[dim][bit]).reverse_bits()
}

/// In each dimension every run of 2^k points has one in each of 2^k equal intervals; the first two are a (0,
/// 2)-sequence.
#[test]
fn points_are_nets() {
    for bits in 0..=8 {
        let n = 1_u32 << bits;
        for start in [0, 3 * n, 1000 * n] {
            for dim in 0..8 {
                let mut seen = [false; 256];
                (start..start + n).for_each(|i| seen[(u64::from(sobol(i, dim)) << bits >> 32) as usize] = true);
                assert_eq!(seen.iter().filter(|&&s| s).count() as u32, n);
            }
            for wide in 0..=bits {
                let mut seen = [false; 256];
                for i in start..start + n {
                    let x = u64::from(sobol(i, 0)) << wide >> 32;
                    let y = u64::from(sobol(i, 1)) << (bits - wide) >> 32;
                    seen[(x << (bits - wide) | y) as usize] = true;
                }
                assert_eq!(seen.iter().filter(|&&s| s).count() as u32, n, "{bits} {wide}");
            }
        }
    }
}

#[test]
fn shuffled_octaves_are_permutations_of_aligned_runs() {
    for seed in [0, 7, 0x8765_4321] {
        let mut seen = [false; 1024];
        for index in 0..1024_u32 {
            let to = shuffle(index, seed);
            assert_eq!(to.checked_ilog2(), index.checked_ilog2());
            assert!(!core::mem::replace(&mut seen[to as usize], true));
            if index >= 2 {
                assert_eq!(shuffle(index ^ 1, seed), to ^ 1, "neighbours stay neighbours");
            }
        }
    }
    assert!((0..16).any(|seed| shuffle(2, mix(seed)) == 3) && (0..16).any(|seed| shuffle(2, mix(seed)) == 2));
    assert_eq!(shuffle(u32::MAX, 3) >> 31, 1);
}
