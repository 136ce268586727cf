//! Further dimensions' strata: what only the crate itself can see.

use super::*;

#[test]
fn each_stratum_has_one_sample() {
    for bits in 0..=8 {
        for (number, random) in [(0, 0), (1, 0), (0, 0xdead_beef), (1, 0x1234_5678)] {
            let mut seen = [false; 256];
            for index in 0..1 << bits {
                assert!(!core::mem::replace(&mut seen[stratum(index, bits, number, random) as usize], true));
            }
        }
    }
}

/// The cell of a sample along each of the two coordinates that order the tile, and both further ones: of 2^bits
/// each, as far as the order says.
fn cells(index: u32, bits: u32) -> [u32; 4] {
    let side = |split: u32| match split % 2 {
        0 => index >> split & 1,
        _ => (index >> split ^ index >> (split - 1)) & 1,
    };
    let along = |axis: u32| {
        let splits = (0..bits.div_ceil(2)).map(|k| 2 * k + axis).filter(|&split| split < bits);
        splits.fold(0, |sum, split| sum << 1 | side(split))
    };
    [along(0), along(1), stratum(index, bits, 0, 0), stratum(index, bits, 1, 0)]
}

#[test]
fn elementary_intervals_have_one_sample_each() {
    for bits in 2..=4_u32 {
        let digits = [bits.div_ceil(2), bits / 2, bits, bits];
        // How many bits each coordinate's cells are cut by: their sum is `bits`.
        for cut in 0..5_u32.pow(4) {
            let cut = [cut % 5, cut / 5 % 5, cut / 25 % 5, cut / 125];
            let used = cut.iter().filter(|&&k| k > 0).count();
            let kept = (cut[3] == 0 && used <= 3) || (bits > 2 && used <= 2);
            if cut.iter().sum::<u32>() != bits || cut.iter().zip(digits).any(|(&k, digits)| k > digits) || !kept {
                continue;
            }
            let mut seen = [false; 16];
            for index in 0..1 << bits {
                let cell = cells(index, bits)
                    .iter()
                    .zip(cut)
                    .zip(digits)
                    .fold(0, |sum, ((cell, k), digits)| sum << k | cell >> (digits - k));
                assert!(!core::mem::replace(&mut seen[cell as usize], true), "{bits} bits, {cut:?}");
            }
        }
    }
}
