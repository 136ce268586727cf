//! Ranks of projected points, in linear time.

use std::ops::RangeInclusive;

/// Projected coordinates are integers of this many bits: all that a sum of single-precision coordinates carries.
pub(crate) const KEY_BITS: u32 = 23;

/// Fewer keys than these are sorted by comparisons.
const FEW: usize = 512;

/// Memory for ranking; about 24 bytes per point.
#[derive(Debug, Default)]
pub(crate) struct Ranking {
    counts: Vec<u32>,
    ranks: Vec<u32>,
    elements: Vec<u64>,
    sorted: Vec<u64>,
}

impl Ranking {
    /// The numbers of keys for [`Ranking::at_once`]: of fewer, a wrong bin is a large error; the buckets of more would
    /// not fit the cache.
    pub(crate) const AT_ONCE: RangeInclusive<usize> = FEW..=16_384;

    /// The rank of every key. Keys in the same bucket, of at least two per key, are ranked in the order given.
    ///
    /// Where the keys are about uniform, few share a bucket, and the offsets of those that do are wrong by about a bin,
    /// which is little against what they are in a slice of random direction.
    pub(crate) fn at_once(&mut self, keys: &[u32]) -> &[u32] {
        let bits = keys.len().max(2).next_power_of_two().ilog2() + 1;
        let shift = KEY_BITS - bits;
        let Ranking { counts, ranks, .. } = self;
        reset(counts, 1 << bits);
        let ranks = room(ranks, keys.len());
        // The number of buckets is a power of two: the mask spares the check of every access.
        let mask = counts.len() - 1;
        for key in keys {
            counts[(key >> shift) as usize & mask] += 1;
        }
        starts(counts);
        for (rank, key) in ranks.iter_mut().zip(keys) {
            let start = &mut counts[(key >> shift) as usize & mask];
            *rank = *start;
            *start += 1;
        }
        ranks
    }

    /// The rank of every key, by a radix sort of two passes; few keys, by comparisons. Equal keys are ranked in the
    /// order given.
    pub(crate) fn sorted(&mut self, keys: &[u32]) -> &[u32] {
        const DIGIT: u32 = KEY_BITS.div_ceil(2);
        const MASK: usize = (1 << DIGIT) - 1;
        let Ranking { counts, ranks, elements, sorted } = self;
        let ranks = room(ranks, keys.len());
        elements.clear();
        elements.extend((0u32..).zip(keys).map(|(place, &key)| u64::from(key) << 32 | u64::from(place)));
        if keys.len() < FEW {
            elements.sort_unstable();
            for (rank, &element) in (0..).zip(&*elements) {
                ranks[element as u32 as usize] = rank;
            }
            return ranks;
        }
        reset(counts, 2 << DIGIT);
        let (low, high) = counts.split_at_mut(1 << DIGIT);
        for &key in keys {
            low[key as usize & MASK] += 1;
            high[(key >> DIGIT) as usize & MASK] += 1;
        }
        starts(low);
        starts(high);
        let sorted = room(sorted, keys.len());
        for &element in &*elements {
            let start = &mut low[(element >> 32) as usize & MASK];
            sorted[*start as usize] = element;
            *start += 1;
        }
        for &element in &*sorted {
            let start = &mut high[(element >> (32 + DIGIT)) as usize & MASK];
            ranks[element as u32 as usize] = *start;
            *start += 1;
        }
        ranks
    }
}

fn reset(counts: &mut Vec<u32>, buckets: usize) {
    counts.clear();
    counts.resize(buckets, 0);
}

/// The first `len` places of a buffer, made longer if need be.
fn room<T: Copy + Default>(buffer: &mut Vec<T>, len: usize) -> &mut [T] {
    if buffer.len() < len {
        buffer.resize(len, T::default());
    }
    &mut buffer[..len]
}

/// Replaces counts by the sums of those before.
fn starts(counts: &mut [u32]) {
    let mut sum = 0;
    for count in counts.as_chunks_mut::<4>().0 {
        let [a, b, c, d] = *count;
        let pair = a + b;
        *count = [sum, sum + a, sum + pair, sum + (pair + c)];
        sum += pair + (c + d);
    }
}
