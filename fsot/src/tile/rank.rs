//! Sorting the few samples of a slice.

/// Bits of a projected coordinate.
pub(super) const POSITION_BITS: u32 = 24;

/// Up to this many samples, counting the smaller ones is faster than moving them.
const FEW: usize = 48;

/// Sorts the samples of a slice by position; keeps its memory from slice to slice.
pub(super) struct Sorter {
    /// A sample's position, then its number, in 31 bits.
    keys: Vec<i32>,
    sorted: Vec<i32>,
    starts: Vec<u32>,
    /// Bits of a number.
    number_bits: u32,
}

impl Sorter {
    /// For at most `longest` samples, up to 2^16.
    pub(super) fn new(longest: usize) -> Sorter {
        let number_bits = longest.max(2).next_power_of_two().trailing_zeros();
        let room = longest.next_multiple_of(8).max(8);
        Sorter {
            keys: vec![i32::MAX; room],
            sorted: vec![0; room],
            starts: vec![0; 2 * room.next_power_of_two()],
            number_bits,
        }
    }

    /// Calls `place(rank, number)` for every sample; equal positions (of 31 bits less those of a number) are in the order of their numbers.
    #[inline]
    pub(super) fn sort(&mut self, positions: &[u32], place: impl FnMut(usize, usize)) {
        let drop = POSITION_BITS - self.position_bits();
        let bits = self.number_bits;
        for (number, (key, position)) in self.keys.iter_mut().zip(positions).enumerate() {
            *key = (((position >> drop) << bits) | number as u32) as i32;
        }
        if positions.len() <= FEW { self.count(positions.len(), place) } else { self.spread(positions.len(), place) }
    }

    /// Bits of a position in a key.
    fn position_bits(&self) -> u32 {
        POSITION_BITS.min(31 - self.number_bits)
    }

    /// A sample's rank is the number of smaller keys.
    #[inline]
    fn count(&mut self, length: usize, mut place: impl FnMut(usize, usize)) {
        let padded = length.next_multiple_of(8);
        self.keys[length..padded].fill(i32::MAX);
        let keys = &self.keys[..padded];
        for (number, &key) in keys[..length].iter().enumerate() {
            let smaller: i32 = keys.iter().map(|&other| i32::from(other < key)).sum();
            place(smaller as usize, number);
        }
    }

    /// Into as many buckets as there are samples, then by insertion: the projected density varies little.
    #[inline]
    fn spread(&mut self, length: usize, mut place: impl FnMut(usize, usize)) {
        let buckets = length.next_power_of_two();
        let shift = self.position_bits() + self.number_bits - buckets.trailing_zeros();
        let keys = &self.keys[..length];
        let starts = &mut self.starts[..buckets + 1];
        starts.fill(0);
        for &key in keys {
            starts[(key >> shift) as usize + 1] += 1;
        }
        let mut sum = 0;
        for start in starts.iter_mut() {
            sum += *start;
            *start = sum;
        }
        let sorted = &mut self.sorted[..length];
        for &key in keys {
            let start = &mut starts[(key >> shift) as usize];
            sorted[*start as usize] = key;
            *start += 1;
        }
        for index in 1..length {
            let key = sorted[index];
            let mut to = index;
            while to > 0 && sorted[to - 1] > key {
                sorted[to] = sorted[to - 1];
                to -= 1;
            }
            sorted[to] = key;
        }
        let mask = (1i32 << self.number_bits) - 1;
        for (rank, &key) in sorted.iter().enumerate() {
            place(rank, (key & mask) as usize);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use noisefloor::rng::Rng;

    /// Lengths on both sides of [`FEW`], with many equal positions, against the standard sort.
    #[test]
    fn ranks_are_those_of_a_stable_sort() {
        let mut rng = Rng::seed(3);
        for length in [1, 2, 7, 8, 9, 47, 48, 49, 113, 256, 1808, 40_000] {
            let mut sorter = Sorter::new(length);
            for bits in [3, 17, POSITION_BITS] {
                let positions: Vec<u32> =
                    (0..length).map(|_| rng.next_u32() >> (32 - bits) << (POSITION_BITS - bits)).collect();
                // What is too fine for the keys does not count.
                let coarse = POSITION_BITS - POSITION_BITS.min(31 - sorter.number_bits);
                let mut expected: Vec<usize> = (0..length).collect();
                expected.sort_by_key(|&number| positions[number] >> coarse);
                let mut found = vec![usize::MAX; length];
                sorter.sort(&positions, |rank, number| found[rank] = number);
                assert_eq!(found, expected, "{length} positions of {bits} bits");
            }
        }
    }

    #[test]
    fn the_largest_position_is_not_lost() {
        let mut sorter = Sorter::new(60);
        let positions = vec![(1 << POSITION_BITS) - 1; 60];
        let mut found = Vec::new();
        sorter.sort(&positions, |rank, number| found.push((rank, number)));
        assert_eq!(found, (0..60).map(|i| (i, i)).collect::<Vec<_>>());
    }
}
