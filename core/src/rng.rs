//! Random numbers for minibatches, examples and tests: PCG32, the same stream on every target.
//!
//! M. E. O'Neill, "PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms for Random Number
//! Generation", 2014: a 64-bit linear congruential generator whose output is the XSH-RR permutation of its state. Not
//! for cryptography.

/// The version whose traits [`Rng`] implements.
pub use rand_core;

use core::convert::Infallible;
use core::num::NonZeroU32;
use rand_core::{SeedableRng, TryRng, utils};

const MULTIPLIER: u64 = 6_364_136_223_846_793_005;

/// A PCG32 generator: 16 bytes, period 2^64, one of 2^63 streams.
///
/// Deliberately not `Copy`: a silent copy repeats the numbers it has yet to give.
///
/// ```
/// let mut rng = noisefloor::rng::Rng::seed(1);
/// let mut again = rng.clone();
/// assert_eq!(rng.next_u32(), again.next_u32());
/// assert!(rng.uniform_f32() < 1.0 && rng.below(6) < 6);
/// ```
#[derive(Clone, Debug, Eq)]
pub struct Rng {
    /// Where the generator is; any value.
    pub state: u64,
    /// Which stream; its lowest bit counts as set, so any value is valid.
    pub increment: u64,
}

impl Rng {
    /// The generator of the published code's `srandom(state, stream)`; only the low 63 bits of `stream` count.
    pub const fn new(state: u64, stream: u64) -> Rng {
        let increment = (stream << 1) | 1;
        // From state 0, one step gives `increment`; then the seed is added and another step taken.
        Rng { state: step(increment.wrapping_add(state), increment), increment }
    }

    /// A generator for a seed of any value.
    ///
    /// Neighbouring seeds (pixel numbers, say) give unrelated state and stream: both come from SplitMix64. Seeding
    /// state alone would leave all generators on one cycle, and seeds that differ in high bits only visibly correlated.
    pub const fn seed(seed: u64) -> Rng {
        Rng::new(split_mix(seed, 1), split_mix(seed, 2))
    }

    /// The next 32 random bits.
    #[inline]
    pub const fn next_u32(&mut self) -> u32 {
        let old = self.state;
        self.state = step(old, self.increment | 1);
        let xorshifted = (((old >> 18) ^ old) >> 27) as u32;
        xorshifted.rotate_right((old >> 59) as u32)
    }

    /// The next 64 random bits: two outputs, the lower half first.
    #[inline]
    pub const fn next_u64(&mut self) -> u64 {
        let low = self.next_u32() as u64;
        let high = self.next_u32() as u64;
        (high << 32) | low
    }

    /// Uniform in [0, 1): a multiple of 2^-24, from one output.
    #[inline]
    pub const fn uniform_f32(&mut self) -> f32 {
        unit(self.next_u32())
    }

    /// Uniform in [0, 1): a multiple of 2^-53, from two outputs.
    #[inline]
    pub const fn uniform_f64(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// Uniform in `0..n`, every value exactly equally likely; 0 for `n = 0`.
    ///
    /// D. Lemire, "Fast Random Integer Generation in an Interval", 2019: the high half of a product, redrawn where the
    /// low half shows that a value would come once too often.
    #[inline]
    pub fn below(&mut self, n: u32) -> u32 {
        let Some(divisor) = NonZeroU32::new(n) else { return 0 };
        let mut product = u64::from(self.next_u32()) * u64::from(n);
        if (product as u32) < n {
            let surplus = n.wrapping_neg() % divisor;
            while (product as u32) < surplus {
                product = u64::from(self.next_u32()) * u64::from(n);
            }
        }
        (product >> 32) as u32
    }
}

/// Equal generators give the same numbers.
impl PartialEq for Rng {
    fn eq(&self, other: &Rng) -> bool {
        (self.state, self.increment | 1) == (other.state, other.increment | 1)
    }
}

impl TryRng for Rng {
    type Error = Infallible;

    #[inline]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok(Rng::next_u32(self))
    }

    #[inline]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        Ok(Rng::next_u64(self))
    }

    fn try_fill_bytes(&mut self, destination: &mut [u8]) -> Result<(), Infallible> {
        utils::fill_bytes_via_next_word(destination, || Ok(Rng::next_u32(self)))
    }
}

impl SeedableRng for Rng {
    /// State then stream, both little-endian.
    type Seed = [u8; 16];

    fn from_seed(seed: [u8; 16]) -> Rng {
        let both = u128::from_le_bytes(seed);
        Rng::new(both as u64, (both >> 64) as u64)
    }

    /// The same generator as [`Rng::seed`].
    fn seed_from_u64(seed: u64) -> Rng {
        Rng::seed(seed)
    }
}

/// 32-bit fixed point as a float: the upper 24 bits, so always below 1.
#[inline]
pub(crate) const fn unit(fixed: u32) -> f32 {
    (fixed >> 8) as f32 * (1.0 / 16_777_216.0)
}

const fn step(state: u64, increment: u64) -> u64 {
    state.wrapping_mul(MULTIPLIER).wrapping_add(increment)
}

/// The `index`-th output (from 1) of SplitMix64 seeded with `seed`.
#[inline]
pub(crate) const fn split_mix(seed: u64, index: u64) -> u64 {
    let mut z = seed.wrapping_add(index.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
