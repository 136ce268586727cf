//! Dimensions beyond the tile's: each is stratified by itself, and with the tile's two first.
//!
//! A tile's samples come in an order that tells where they are: bit 0 of the index says in which half of the pixel's
//! points one is by the first coordinate, bits 0 and 1 together, added, in which half of those by the second, bits 2
//! and 3 the same of quarters, and so on, all exclusive-or a constant of the pixel's. A further coordinate's stratum,
//! one of spp, is a linear function of those bits over the field of two elements, so chosen that the *ranks* of the
//! points are a digital net (Niederreiter 1992, chapter 4), as far as the order knows them: halves for 2 to 8 samples,
//! quarters for 16. The points themselves are near it.

use super::hash::permute;

/// For 2, 4, 8, 16 samples: for the first and the second further dimension, which bits of the index add up to the bits
/// of the stratum, from the most significant. With the first, every elementary interval of ranks in three dimensions
/// has its point; with the second, every one in two of the four, though some three are then aliased. None exists for
/// the second below 8 samples.
static ROWS: [[[u32; 4]; 2]; 5] = [
    [[0; 4]; 2],
    [[1, 0, 0, 0], [0; 4]],
    [[2, 1, 0, 0], [0; 4]],
    [[7, 2, 1, 0], [6, 2, 1, 0]],
    [[8, 6, 2, 1], [9, 2, 4, 1]],
];

/// The stratum, of 2^bits, that sample `index` of a pixel has in further dimension `number`, 0 or 1: a bijection of the
/// index for each `random`.
#[inline]
pub(super) fn stratum(index: u32, bits: u32, number: u32, random: u32) -> u32 {
    if number > 0 && bits < 3 {
        return permute(index, 1 << (bits & 3), random);
    }
    let top = if bits < 4 { bits } else { 4 };
    let leading = LEADING.get((number << 3 | top) as usize).map_or(0, |of| u32::from(of[index as usize & 15]));
    let rest = bits.saturating_sub(top);
    let mask = (1_u32 << (bits & 15)) - 1;
    ((leading << (rest & 15) | index >> (top & 7)) ^ random) & mask
}

/// What ROWS makes of the last four bits of the index: of 2^k samples and a further dimension at 8 times the
/// dimension + k.
static LEADING: [[u8; 16]; 13] = {
    let mut leading = [[0; 16]; 13];
    let mut number = 0;
    while number < 2 {
        let mut bits = 0;
        while bits < 5 {
            let mut index = 0;
            while index < 16 {
                let (mut sum, mut row) = (0, 0);
                while row < bits {
                    sum = sum << 1 | (index & ROWS[bits][number][row]).count_ones() as u8 & 1;
                    row += 1;
                }
                leading[number << 3 | bits][index as usize] = sum;
                index += 1;
            }
            bits += 1;
        }
        number += 1;
    }
    leading
};

#[cfg(test)]
#[path = "../../tests/parts/tile_net.rs"]
mod tests;
