//! Ranks of projected points, in linear time.

/// Projected coordinates are integers of this many bits: all that a sum of single-precision coordinates carries.
pub(crate) const KEY_BITS: u32 = 23;

/// Memory for ranking; about 24 bytes per point.
#[derive(Default)]
pub(crate) struct Ranking {
    counts: Vec<u32>,
    ranks: Vec<u32>,
    elements: Vec<u64>,
    sorted: Vec<u64>,
}

impl Ranking {
    /// The most keys for [`Ranking::at_once`]: beyond, its buckets would not fit the cache.
    pub(crate) const MOST_AT_ONCE: usize = 16_384;

    /// The rank of every key. Keys in the same bucket, of at least two per key, are ranked in the order given.
    ///
    /// Where the keys are about uniform, few share a bucket, and the offsets of those that do are wrong by about a bin, which is little
    /// against what they are in a slice of random direction.
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

    /// The rank of every key, by a radix sort of two passes. Keys in the same bucket, of at least 1,024 per key (of all there are, for more
    /// than 8,192 keys), are ranked in the order given.
    pub(crate) fn sorted(&mut self, keys: &[u32]) -> &[u32] {
        let digit = (keys.len().max(2).ilog2().div_ceil(2) + 5).clamp(8, KEY_BITS.div_ceil(2));
        let drop = KEY_BITS.saturating_sub(2 * digit);
        let mask = (1usize << digit) - 1;
        let Ranking { counts, ranks, elements, sorted } = self;
        reset(counts, 2 << digit);
        let (low, high) = counts.split_at_mut(1 << digit);
        elements.clear();
        elements.extend((0u32..).zip(keys).map(|(place, &key)| {
            low[(key >> drop) as usize & mask] += 1;
            high[(key >> (drop + digit)) as usize & mask] += 1;
            u64::from(key) << 32 | u64::from(place)
        }));
        starts(low);
        starts(high);
        let sorted = room(sorted, keys.len());
        for &element in &*elements {
            let start = &mut low[(element >> (32 + drop)) as usize & mask];
            sorted[*start as usize] = element;
            *start += 1;
        }
        let ranks = room(ranks, keys.len());
        for &element in &*sorted {
            let start = &mut high[(element >> (32 + drop + digit)) as usize & mask];
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
