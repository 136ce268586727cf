//! From a sample's number to its point.
//!
//! A pixel's sequence is Sobol's first two dimensions, each digit exclusive-or a bit that depends on the digits before
//! it (A. Owen, "Randomly permuted (t,m,s)-nets and (t,s)-sequences", 1995). The table holds the first digits' bits, a
//! hash makes those that follow.

use super::table::{BITS, SIZE, TABLE, fine, pascal};
use super::{Sampler, WHITE};
use crate::hash::{GOLDEN, mix};
use crate::matrix::chunk;

/// The point in 32-bit fixed point.
// See `Sampler::draw`.
#[inline(always)]
pub(super) fn point<const N: usize>(sampler: &Sampler) -> [u32; N] {
    let Sampler { domain, index, x, y, flags } = *sampler;
    // The row above the column, and then each alone: of these only the lowest bits count.
    let mut at = u32::from(x) | u32::from(y) << 16;
    let mut first = index.reverse_bits();
    if flags & WHITE != 0 {
        // Of two small numbers `mix` alone makes places that near pixels share too often.
        at = mix(at.wrapping_mul(GOLDEN));
    }
    let (mut x, mut y) = (at, at >> 16);
    if domain != 0 {
        first = reorder(first, domain, at);
        (x, y) = place(domain, x, y);
    }
    let [a, b] = pair(x, y, first);
    if N < 3 {
        return chunk(&[a, b, 0, 0]);
    }
    let [c, d] = pair(x.wrapping_add(APART[0]), y.wrapping_add(APART[1]), second(first));
    chunk(&[a, b, c, d])
}

/// How far in the table the last two numbers are from the first two: in all domains too far for one to say something of
/// the other.
const APART: [u32; 2] = [11, 5];

/// Where in the table a domain's pixel is: at another place, and mirrored and transposed or not, which keeps neighbours
/// neighbours.
#[inline]
const fn place(domain: u32, x: u32, y: u32) -> (u32, u32) {
    let (x, y) = if domain >> 31 == 0 { (x, y) } else { (y, x) };
    let (across, down) = ((domain >> 30 & 1).wrapping_neg(), (domain >> 29 & 1).wrapping_neg());
    ((x ^ across).wrapping_add(domain), (y ^ down).wrapping_add(domain >> 8))
}

/// Another order of a pixel's samples in each domain, of reversed numbers: one of those that keep the first 1, 2, 4 and
/// so on together, and each half of what follows them, and so on. Without it a sample's numbers in two domains would be
/// the same function of its number in all pixels. It is alike in all octaves: exchanges the halves of all, or of none.
///
/// Pixels of a block, 8 x 8 of them, share it, so that sample i of neighbours is as even as sample i of the table: what
/// is shown after a number of samples that is no power of two, or averaged with what came before, has less error once
/// it is filtered. The price: of products of two domains' numbers some blocks have more error than others. Larger ones
/// gain little more, and show.
///
/// Each digit is exclusive-or a function of the digits after it, as both steps take bits upwards only.
#[inline]
const fn reorder(first: u32, domain: u32, at: u32) -> u32 {
    // Where blocks begin is the domain's, too.
    let block = at.wrapping_add(domain) & 0xfff8_fff8;
    let mut random = domain.wrapping_add(block.wrapping_mul(0x2c1b_3c6d));
    random = (random ^ random >> 15).wrapping_mul(0x735a_2d97);
    random ^= random >> 15;
    let first = first ^ first.wrapping_mul(random << 1);
    first.wrapping_mul(random >> 15 | 1)
}

/// The point of a place, by the reversed number.
#[inline]
fn pair(x: u32, y: u32, first: u32) -> [u32; 2] {
    let pixel = (y & (SIZE - 1)) * SIZE + (x & (SIZE - 1));
    let second = pascal(first);
    let entry = |value: u32| TABLE[(pixel << BITS | value >> (32 - BITS)) as usize];
    [fine(first ^ entry(first) << 16, pixel, 0), fine(second ^ (entry(second) & 0xffff_0000), pixel, 1)]
}

/// The reversed number at which the third and the fourth number are drawn: the digits times a unit triangular matrix.
///
/// Its first nine columns were found by search: of points in four dimensions the first 4 to 512 are (t, m, 4)-nets, t
/// from 1 to 3, and of such matrices this one has the best projections on two of the four. Further digits are added to
/// those some places before them, in five steps: these have a small error of smooth functions, and projections on two
/// whose t is at most 4 up to 2^20 points. `noisefloor_sampler.h` and Python's sampler for Mitsuba have them, too.
#[inline]
fn second(first: u32) -> u32 {
    let mut further = first & 0x007f_ffff;
    for places in [6, 8, 9, 10, 16] {
        further ^= further << places;
    }
    further ^ u32::from(SECOND[(first >> 23) as usize]) << 16
}

/// The first nine digits, in the upper bits, by those of the first two numbers.
static SECOND: [u16; 512] = {
    // Column k holds which of the index' bits bit k adds to.
    let columns = [1_u32, 2, 5, 11, 22, 63, 78, 213, 467];
    let mut all = [0; 512];
    let mut digits = 0;
    while digits < 512 {
        let (mut sum, mut k) = (0, 0);
        while k < 9 {
            // Digit 0, the uppermost, is bit 0 of the index.
            sum ^= columns[k] * (digits >> (8 - k) & 1);
            k += 1;
        }
        all[digits as usize] = (sum.reverse_bits() >> 16) as u16;
        digits += 1;
    }
    all
};
