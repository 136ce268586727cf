//! A random permutation, one element at a time.

/// The element at `position` of a random permutation of `0..items`, which `seed` chooses: the first epoch's order
/// (Algorithm 4), and minibatches drawn uniformly without replacement, without an array of indices.
///
/// A position beyond the last counts from the start again; 0 where there are no items. Any seed is good.
///
/// A Feistel network over the next power of two, walked until it arrives in `0..items` (J. Black and P. Rogaway,
/// "Ciphers with Arbitrary Finite Domains", 2002): up to two networks on average. Not for cryptography.
///
/// ```
/// let mut order: Vec<u32> = (0..10).map(|k| noisefloor::minibatch::shuffle(1, 10, k)).collect();
/// order.sort();
/// assert_eq!(order, [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]);
/// ```
pub fn shuffle(seed: u64, items: u32, position: u32) -> u32 {
    let Some(mut start) = position.checked_rem(items) else { return 0 };
    // At least two bits, so that both halves have one.
    let bits = (u32::BITS - (items - 1).leading_zeros()).max(2);
    let low_bits = bits / 2;
    let low_mask = (1u32 << low_bits) - 1;
    let high_mask = (1u32 << (bits - low_bits)) - 1;
    let rounds = if bits < 12 { SHORT_ROUNDS } else { ROUNDS };
    // Networks alone are even permutations of 16 items and more: here the first two change places or not.
    if start < 2 && items > 1 {
        start ^= noise(seed, 2 * rounds, 0) >> 31;
    }
    let mut at = start;
    loop {
        let (mut low, mut high) = (at & low_mask, at >> low_bits);
        for round in 0..rounds {
            high ^= noise(seed, 2 * round, low) & high_mask;
            low ^= noise(seed, 2 * round + 1, high) & low_mask;
        }
        at = (high << low_bits) | low;
        // The network is a permutation of the power of two: its cycle through a start below `items` returns there.
        if at < items {
            return at;
        }
    }
}

/// Pairs of half rounds.
const ROUNDS: u64 = 6;
/// Halves of a few bits need more of them: a round has few functions to choose from.
const SHORT_ROUNDS: u64 = 16;

fn noise(seed: u64, round: u64, half: u32) -> u32 {
    let mut z = seed.wrapping_add((round + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15))
        ^ u64::from(half).wrapping_mul(0xd6e8_feb8_6659_fd93);
    z = (z ^ (z >> 32)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 29)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z >> 32) as u32
}
