//! The order of a pixel's samples, which says where they are.
//!
//! Bit 0 of a sample's number tells the half of the pixel's samples by the first coordinate, bits 0 and 1 added, modulo
//! 2, the half of those by the second, bits 2 and 3 the same of quarters, and so on; all bits are exclusive-or a
//! constant of the pixel's, a hash of its samples. So every prefix of 2^k samples has one in each of 2^k cells (two are
//! on a diagonal), the samples of one number are spread over all cells, and what `noisefloor` draws beyond a tile's
//! dimensions is stratified together with them. A tile that is not progressive is as good in any order.

use super::TileSamples;
use crate::random::stream;

/// What is compared: as many bits as the finest files hold, so that a file's samples are in order whatever was rounded.
fn key(coordinate: f32) -> u16 {
    noisefloor::tile::quantize(coordinate, 16)
}

impl TileSamples {
    /// The same samples, those of each pixel in the order above. Nothing happens to pixels whose number of samples is
    /// no power of two, or whose samples have one coordinate.
    pub fn ordered(mut self) -> TileSamples {
        let (spp, dims) = (self.spp, self.dims);
        if spp < 2 || !spp.is_power_of_two() || dims < 2 {
            return self;
        }
        let mut numbers: Vec<usize> = Vec::with_capacity(spp);
        let mut pixel = Vec::with_capacity(spp * dims);
        for samples in self.coordinates.chunks_exact_mut(spp * dims) {
            numbers.clear();
            numbers.extend(0..spp);
            split(&mut numbers, 0, |sample, axis| key(samples[sample * dims + axis]));
            // Of the samples and not of the place: other tiles have others, so that two can be used together.
            let hash = numbers.iter().fold(0, |hash, &number| {
                let point = u64::from(key(samples[number * dims])) << 16 | u64::from(key(samples[number * dims + 1]));
                stream(hash, point, 0).next_u64()
            });
            let constant = hash as usize & (spp - 1);
            pixel.clear();
            for index in 0..spp {
                let number = numbers[cell(index ^ constant, spp.trailing_zeros())];
                pixel.extend_from_slice(&samples[number * dims..][..dims]);
            }
            samples.copy_from_slice(&pixel);
        }
        self
    }
}

/// The cell, as [`split`] numbers them, of a sample's number, both of `bits` bits.
fn cell(number: usize, bits: u32) -> usize {
    let odd = usize::MAX / 3 * 2;
    let sides = number ^ (number << 1 & odd);
    (sides & ((1 << bits) - 1)).reverse_bits() >> (usize::BITS - bits)
}

/// Sorts into halves by the first and the second coordinate in turn, down to single samples; of equal ones the earlier
/// is the smaller.
fn split(samples: &mut [usize], level: usize, key: impl Fn(usize, usize) -> u16 + Copy) {
    if samples.len() < 2 {
        return;
    }
    samples.sort_unstable_by_key(|&sample| (key(sample, level % 2), sample));
    let (low, high) = samples.split_at_mut(samples.len() / 2);
    split(low, level + 1, key);
    split(high, level + 1, key);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random(size: usize, spp: usize, dims: usize) -> TileSamples {
        let mut rng = stream(1, 2, 3);
        let coordinates = (0..size * size * spp * dims).map(|_| rng.uniform_f32()).collect();
        TileSamples { size, spp, dims, frames: 1, coordinates }
    }

    fn points(samples: &TileSamples, place: usize) -> Vec<&[f32]> {
        samples.coordinates.chunks_exact(samples.dims).skip(place * samples.spp).take(samples.spp).collect()
    }

    #[test]
    fn pixels_keep_their_samples() {
        for (spp, dims) in [(1, 2), (2, 2), (4, 3), (16, 2), (32, 4), (3, 2), (4, 1)] {
            let (before, after) = (random(4, spp, dims), random(4, spp, dims).ordered());
            for place in 0..16 {
                let sorted = |samples: &TileSamples| {
                    let mut points: Vec<Vec<u32>> =
                        points(samples, place).iter().map(|p| p.iter().map(|v| v.to_bits()).collect()).collect();
                    points.sort();
                    points
                };
                assert_eq!(sorted(&before), sorted(&after));
            }
        }
    }

    /// In each pixel the numbers, exclusive-or one constant, are those that halving by each coordinate in turn gives;
    /// all constants occur.
    #[test]
    fn numbers_tell_the_cell() {
        let samples = random(16, 16, 2).ordered();
        let mut constants = [0; 16];
        for place in 0..256 {
            let points = points(&samples, place);
            // Bits, by definition: each split sorts those that agree so far.
            let mut cells = vec![0_usize; 16];
            for level in 0..4 {
                for path in 0..1 << level {
                    let mut group: Vec<usize> = (0..16).filter(|&i| cells[i] & ((1 << level) - 1) == path).collect();
                    group.sort_by(|&a, &b| key(points[a][level % 2]).cmp(&key(points[b][level % 2])));
                    for &i in &group[group.len() / 2..] {
                        cells[i] |= 1 << level;
                    }
                }
            }
            // The second of each pair of bits says whether both sides differ.
            let number = |cell: usize| cell ^ ((cell & 0b0101) << 1);
            let constant = number(cells[0]);
            assert!((0..16).all(|i| number(cells[i]) ^ i == constant), "{cells:?}");
            constants[constant] += 1;
        }
        // 256 draws of 16 equally likely ones: below 2 or above 38 has chance 1e-4 for all together.
        assert!(constants.iter().all(|count| (2..=38).contains(count)), "{constants:?}");
    }

    #[test]
    fn ordering_twice_changes_nothing() {
        let once = random(4, 16, 2).ordered();
        assert_eq!(once.clone().ordered(), once);
    }
}
