//! What follows a tile's samples: a Sobol sequence, shuffled and scrambled for each domain.

use super::shape::MAX_DIMS;
use crate::hash::{GOLDEN, mix};

/// Moves a pixel's first sample to where its sample `index`, at least 1, belongs.
///
/// That is exclusive or with point `index` of a sequence that all pixels share: S. Joe and F. Kuo's Sobol sequence
/// (2008) in an order shuffled within each octave of indices, Owen-scrambled, and shifted so that its first point is
/// the origin. With the pixel's first sample at index 0, any aligned run of 2^k indices is a digital net.
#[inline]
pub(super) fn shift(domain: u32, index: u32, fixed: &mut [u32]) {
    let index = shuffle(index, mix(domain ^ SHUFFLE));
    for ((u, directions), dim) in fixed.iter_mut().zip(&DIRECTIONS).zip(1_u32..) {
        let seed = mix(domain ^ VALUES ^ dim.wrapping_mul(GOLDEN));
        let mut point = 0;
        let mut bits = index;
        while bits != 0 {
            point ^= directions[bits.trailing_zeros() as usize & 31];
            bits &= bits - 1;
        }
        *u ^= (scramble(point, seed) ^ scramble(0, seed)).reverse_bits();
    }
}

const SHUFFLE: u32 = 0x7368_7566;
const VALUES: u32 = 0x6f77_656e;

/// Owen's nested scrambling of the reversed bits of a number: whether a bit changes depends on those below it.
///
/// S. Laine and T. Karras, "Stratified Sampling for Stochastic Transparency", 2011, with N. Vegdahl's constants (2021).
#[inline]
const fn scramble(mut bits: u32, seed: u32) -> u32 {
    bits ^= bits.wrapping_mul(0x3d20_adea);
    bits = bits.wrapping_add(seed);
    bits = bits.wrapping_mul((seed >> 16) | 1);
    bits ^= bits.wrapping_mul(0x0552_6c56);
    bits ^ bits.wrapping_mul(0x53a2_2864)
}

/// A nested permutation within each octave `[2^k, 2^(k + 1))`: aligned runs of 2^j indices go to such runs.
#[inline]
fn shuffle(index: u32, seed: u32) -> u32 {
    match index.checked_ilog2() {
        Some(bits @ 1..) => {
            let first = 1 << (bits & 31);
            // The number of `bits` bits, its highest first.
            let reversed = (index ^ first).reverse_bits() >> ((32 - bits) & 31);
            let shuffled = scramble(reversed, seed.wrapping_add(bits.wrapping_mul(GOLDEN))) & (first - 1);
            first | shuffled.reverse_bits() >> ((32 - bits) & 31)
        }
        _ => index,
    }
}

/// The direction numbers of each dimension, their bits reversed: S. Joe and F. Kuo, "Constructing Sobol Sequences with
/// Better Two-Dimensional Projections", 2008, the table new-joe-kuo-6.
static DIRECTIONS: [[u32; 32]; MAX_DIMS as usize] = [
    // Bit k of the index is bit k of the reversed point.
    directions(0, &[1; 32]),
    directions(0, &[1]),
    directions(1, &[1, 3]),
    directions(1, &[1, 3, 1]),
    directions(2, &[1, 1, 1]),
    directions(1, &[1, 1, 3, 3]),
    directions(4, &[1, 3, 5, 13]),
    directions(2, &[1, 1, 5, 5, 17]),
];

/// From a primitive polynomial's inner coefficients, and the first numbers, as many as its degree.
const fn directions(coefficients: u32, initial: &[u32]) -> [u32; 32] {
    let degree = initial.len();
    // Number k is below 2^(k + 1).
    let mut numbers = [0_u32; 32];
    let mut k = 0;
    while k < 32 {
        numbers[k] = if k < degree {
            initial[k]
        } else {
            let mut number = numbers[k - degree] ^ (numbers[k - degree] << degree);
            let mut i = 1;
            while i < degree {
                if coefficients >> (degree - 1 - i) & 1 == 1 {
                    number ^= numbers[k - i] << i;
                }
                i += 1;
            }
            number
        };
        k += 1;
    }
    // As a fraction, number k is shifted up by 31 - k; reversed, that is down again.
    let mut k = 0;
    while k < 32 {
        numbers[k] = (numbers[k] << (31 - k)).reverse_bits();
        k += 1;
    }
    numbers
}

#[cfg(test)]
#[path = "../../tests/parts/tile_sequence.rs"]
mod tests;
