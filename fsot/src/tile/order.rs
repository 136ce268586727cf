//! The order of a pixel's samples, which says where they are.
//!
//! Bit 0 of a sample's number tells the half of the pixel's samples by the first coordinate, bits 0 and 1 added, modulo 2, the half of
//! those by the second, bits 2 and 3 the same of quarters, and so on; all bits are exclusive-or a constant of the pixel's, random over
//! the pixels. So every prefix of 2^k samples has one in each of 2^k cells (two are on a diagonal), the samples of one number are spread over
//! all cells, and what `noisefloor` draws beyond a tile's dimensions is stratified together with them. A tile that is not progressive is as
//! good in any order.

use super::TileSamples;
use crate::random::stream;

/// Keeps the constants apart from the optimiser's random numbers.
const ORDER_STREAM: u64 = 0x6f72_6465_7273;

/// What is compared: as many bits as the finest files hold, so that a file's samples are in order whatever was rounded.
fn key(coordinate: f32) -> u16 {
    noisefloor::tile::quantize(coordinate, 16)
}

impl TileSamples {
    /// The same samples, those of each pixel in the order above. Nothing happens to pixels whose number of samples is no power of two,
    /// or whose samples have one coordinate.
    pub fn ordered(mut self) -> TileSamples {
        let (spp, dims) = (self.spp, self.dims);
        if spp < 2 || !spp.is_power_of_two() || dims < 2 {
            return self;
        }
        let mut numbers: Vec<usize> = Vec::with_capacity(spp);
        let mut pixel = Vec::with_capacity(spp * dims);
        for (place, samples) in self.coordinates.chunks_exact_mut(spp * dims).enumerate() {
            numbers.clear();
            numbers.extend(0..spp);
            split(&mut numbers, 0, |sample, axis| key(samples[sample * dims + axis]));
            let constant = stream(ORDER_STREAM, place as u64, 0).next_u64() as usize & (spp - 1);
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

/// Sorts into halves by the first and the second coordinate in turn, down to single samples; of equal ones the earlier is the smaller.
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
        TileSamples::new(size, spp, dims, 1, coordinates).unwrap()
    }

    fn points(samples: &TileSamples, place: usize) -> Vec<&[f32]> {
        samples.pixel(place % samples.size, place / samples.size, 0).chunks_exact(samples.dims).collect()
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

    /// Bit 0 decides the side of the first median, and the sum of bits 0 and 1 that of the second; which is which, the pixel's constant.
    #[test]
    fn numbers_tell_the_cell() {
        let samples = random(8, 16, 2).ordered();
        let mut first_is_low = 0;
        for place in 0..64 {
            let points = points(&samples, place);
            let half = |bit: usize, of: &[usize]| -> Vec<f32> {
                of.iter().filter(|&&i| i & 1 == bit).map(|&i| points[i][0]).collect()
            };
            let all: Vec<usize> = (0..16).collect();
            let [even, odd] = [half(0, &all), half(1, &all)];
            let below = |a: &[f32], b: &[f32]| a.iter().all(|x| b.iter().all(|y| x <= y));
            assert!(below(&even, &odd) || below(&odd, &even));
            first_is_low += usize::from(below(&even, &odd));
            for side in 0..2 {
                let [low, high] = [0, 1].map(|bit| -> Vec<f32> {
                    all.iter().filter(|&&i| i & 1 == side && (i ^ i >> 1) & 1 == bit).map(|&i| points[i][1]).collect()
                });
                assert!(below(&low, &high) || below(&high, &low));
            }
        }
        // 64 fair coins: 12 or fewer heads, or 52 or more, have chance 5e-7.
        assert!((13..52).contains(&first_is_low), "{first_is_low}");
    }

    #[test]
    fn ordering_twice_changes_nothing() {
        let once = random(4, 16, 2).ordered();
        assert_eq!(once.clone().ordered(), once);
    }
}
