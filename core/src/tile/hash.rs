//! The permutation of a pixel's samples.

use crate::hash::{GOLDEN, mix};

/// Where sample `index` of `samples` goes, a power of two up to 256: `a * index + b` in the field of as many elements,
/// for random b and a != 0. Of all affine bijections each is equally likely (to 2^-16), so that any two samples go to
/// any two places with the same probability: what it takes for sums of products of two sampled domains to have the mean
/// and the variance of random pairing.
#[inline]
pub(super) fn permute(index: u32, samples: u32, random: u32) -> u32 {
    permute_few(index, samples, random).unwrap_or_else(|| {
        let (mask, scale) = mask_and_scale(samples, random);
        (product(scale, index, samples.trailing_zeros()) ^ random) & mask
    })
}

/// [`permute`] by a look-up, for at most 16 samples.
// Without, a draw in a domain takes 7 % more instructions.
#[inline(always)]
pub(super) fn permute_few(index: u32, samples: u32, random: u32) -> Option<u32> {
    let (mask, scale) = mask_and_scale(samples, random);
    let product = PRODUCTS.get(samples.trailing_zeros() as usize)?.get((scale << 4 | index) as usize)?;
    Some((u32::from(*product) ^ random) & mask)
}

#[inline]
const fn mask_and_scale(samples: u32, random: u32) -> (u32, u32) {
    let mask = samples.wrapping_sub(1) & 255;
    (mask, ((random >> 16).wrapping_mul(mask) >> 16).wrapping_add(1))
}

/// The product in the field of 2^bits elements.
// Apart, so that callers stay small.
#[inline(never)]
const fn product(a: u32, b: u32, bits: u32) -> u32 {
    // x^bits = POLYNOMIAL(x): irreducible.
    let polynomial = POLYNOMIALS[if bits < 8 { bits } else { 8 } as usize];
    let (mut product, mut power, mut bit) = (0, a, 0);
    while bit < bits {
        product ^= power & (b >> (bit & 7) & 1).wrapping_neg();
        power = (power << 1) ^ (polynomial & (power >> (bits.wrapping_sub(1) & 7) & 1).wrapping_neg());
        bit += 1;
    }
    product
}

/// An irreducible polynomial over the field of two elements for each degree, x^degree included.
static POLYNOMIALS: [u32; 9] = [0, 0b11, 0b111, 0b1011, 0b1_0011, 0b10_0101, 0b100_0011, 0b1000_0011, 0b1_0001_1011];

/// All products in the fields of 1, 2, 4, 8 and 16 elements: of a and b at 16 a + b.
static PRODUCTS: [[u8; 256]; 5] = {
    let mut products = [[0; 256]; 5];
    let mut bits = 1;
    while bits < 5 {
        let (elements, mut a) = (1 << bits, 0);
        while a < elements {
            let mut b = 0;
            while b < elements {
                products[bits as usize][(a << 4 | b) as usize] = product(a, b, bits) as u8;
                b += 1;
            }
            a += 1;
        }
        bits += 1;
    }
    products
};

/// As [`permute`], within each octave `[2^k, 2^(k + 1))`: the first 1, 2, 4, ... samples remain those.
#[inline]
pub(super) fn permute_octave(index: u32, random: u32) -> u32 {
    octave(index, random).map_or(index, |(first, random)| first | permute(index ^ first, first, random))
}

/// [`permute_octave`] by a look-up, for indices below 32.
#[inline(always)]
pub(super) fn permute_octave_few(index: u32, random: u32) -> Option<u32> {
    let Some((first, random)) = octave(index, random) else { return Some(index) };
    Some(first | permute_few(index ^ first, first, random)?)
}

/// The first index of an octave, which is as many as the octave has, and its random bits: octaves are permuted
/// independently.
#[inline]
fn octave(index: u32, random: u32) -> Option<(u32, u32)> {
    let bits = index.checked_ilog2()?;
    Some((1 << (bits & 7), mix(random.wrapping_add(GOLDEN.wrapping_mul(bits)))))
}

#[cfg(test)]
#[path = "../../tests/parts/tile_hash.rs"]
mod tests;
