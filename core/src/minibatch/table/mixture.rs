//! The two ways to an item, and what random bits make of them.

use super::kernel::positive;
use crate::Error;
use core::num::NonZeroU64;

/// The two ways to an item: by the tree, and uniformly.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mixture {
    /// The sum of the tree's weights.
    sum: i64,
    pub(super) items: u32,
    /// The probability of each way.
    pub(super) tree: f64,
    pub(super) uniform: f64,
}

impl Mixture {
    /// Every draw uniform.
    pub(super) fn uniform(items: u32) -> Mixture {
        Mixture { sum: 0, items, tree: 0.0, uniform: 1.0 }
    }

    /// # Errors
    /// [`Error::NoSamples`] if every weight is 0 and no draw uniform.
    pub(super) fn of(sum: i64, items: u32, uniform: f64) -> Result<Mixture, Error> {
        let (tree, uniform) = shares(sum > 0, uniform)?;
        Ok(Mixture { sum, items, tree, uniform })
    }

    /// The probability of an item of importance `q` in a block of sum `total` that weighs `weight`.
    pub(super) fn probability(&self, q: f32, total: f64, weight: i64) -> f64 {
        let (by_weight, by_item) = self.factors(1.0);
        if total > 0.0 { by_weight * weight as f64 * (positive(q) / total) + by_item } else { by_item }
    }

    /// What an item's weight in the tree, and what its mere existence adds to `factor` times its probability.
    pub(super) fn factors(&self, factor: f64) -> (f64, f64) {
        (factor * self.tree / self.sum.max(1) as f64, factor * self.uniform / f64::from(self.items))
    }

    /// The numbers of 64 bits, divided between the ways.
    pub(super) fn ways(&self) -> Ways {
        // In halves: converting a number above 2^63 raises FE_INVALID on some processors.
        let scaled = self.uniform * TWO_32;
        let high = scaled as i64;
        let uniform = ((high as u128) << 32) + ((scaled - high as f64) * TWO_32) as i64 as u128;
        Ways {
            last_uniform: uniform.checked_sub(1).map(|last| last as u64),
            scales: [
                Scale::new(uniform as u64, (1 << 64) - uniform, self.sum as u64),
                Scale::new(0, uniform, u64::from(self.items)),
            ],
        }
    }
}

/// The probability of each way: by importance, if there is any, and uniformly.
///
/// # Errors
/// [`Error::NoSamples`] if there is neither.
pub(super) fn shares(is_any_important: bool, uniform: f64) -> Result<(f64, f64), Error> {
    match (is_any_important, uniform > 0.0) {
        (true, _) => Ok((1.0 - uniform, uniform)),
        (false, true) => Ok((0.0, 1.0)),
        (false, false) => Err(Error::NoSamples),
    }
}

/// 64 random bits choose the way, and what remains of them the place.
pub(super) struct Ways {
    /// Draws of at most this are uniform; those above go by the tree.
    pub(super) last_uniform: Option<u64>,
    /// Over the sum of the tree's weights, and, uniformly, over the items.
    pub(super) scales: [Scale; 2],
}

/// Maps the numbers of a span to those below n, and what is left to a fraction.
pub(super) struct Scale {
    first: u64,
    left: u32,
    factor: u64,
    right: u32,
    last: u64,
}

impl Scale {
    /// For a span of at most 2^64 numbers from `first` on, and n below 2^63.
    fn new(first: u64, span: u128, n: u64) -> Scale {
        let Some(last) = span.checked_sub(1) else { return Scale { first, left: 0, factor: 0, right: 0, last: 0 } };
        // The span stretched to between 2^63 and 2^64, and n likewise, so that the factor has 62 bits however small n
        // is.
        let left = (last as u64).leading_zeros().min(63);
        let right = n.leading_zeros().clamp(2, 64) - 2;
        // Rounded up, so that the last number is reached.
        let factor = quotient(n << right, (span << left) as u64).saturating_add(1);
        Scale { first, left, factor, right, last: n.saturating_sub(1) }
    }

    /// The place, and the bits behind its point.
    pub(super) fn map(&self, x: u64) -> (u64, u64) {
        let product =
            (u128::from(x.wrapping_sub(self.first) << self.left) * u128::from(self.factor)) >> (self.right % 64);
        (((product >> 64) as u64).min(self.last), product as u64)
    }
}

/// 2^64 n / divisor, rounded down, for n below a divisor of at least 2^63; 0 stands for 2^64. In two digits of 32 bits
/// (Knuth, The Art of Computer Programming, 4.3.1): compilers leave 128 bits to a library that not all systems have.
fn quotient(n: u64, divisor: u64) -> u64 {
    let Some(high) = NonZeroU64::new(divisor >> 32) else { return n };
    let (low, mut rest, mut quotient) = (divisor & 0xffff_ffff, n, 0);
    for _ in 0..2 {
        // At most 2 too large, as the divisor's highest bit is set.
        let (mut digit, mut left) = (rest / high, rest % high);
        while left < 1 << 32 && (digit >= 1 << 32 || digit * low > left << 32) {
            (digit, left) = (digit - 1, left + high.get());
        }
        rest = (rest << 32).wrapping_sub(digit.wrapping_mul(divisor));
        quotient = (quotient << 32) + digit;
    }
    quotient
}

const TWO_32: f64 = 4_294_967_296.0;

#[cfg(test)]
#[path = "../../../tests/parts/mixture.rs"]
mod tests;
