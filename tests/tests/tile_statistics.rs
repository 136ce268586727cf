//! That domains are unrelated, and what is unbiased over what.
//!
//! Seeds are fixed. Each test states the probability that it fails by chance; all statistics are two-sided normal
//! deviates, at
//! |z| < 4.75 (2e-6) unless it says otherwise.

use noisefloor::tile::{Sampler, Shape, Tile};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::statistics::{Moments, chi_square, wilson_hilferty};
use noisefloor_tests::tile::{file, noise, ordered};
use std::collections::HashMap;

const Z_LIMIT: f64 = 4.75;

/// Domains of a path: siblings, a chain, both with small keys.
fn domains<'a>(root: Sampler<'a>) -> Vec<Sampler<'a>> {
    let mut all: Vec<_> = (0..12).map(|key| root.domain(key)).collect();
    let mut parent = root;
    for bounce in 0..12 {
        parent = parent.domain(bounce % 2);
        all.push(parent.domain(7));
        all.push(parent.domain(8));
    }
    all.push(root);
    all
}

/// Correlation of every pair of 37 domains over the pixels of a tile of noise, coordinate by coordinate: 2,664
/// deviates.
///
/// Their squares sum to a chi-square; two domains at the same place of the tile, of chance 666 / 131072, would fail the
/// test too.
#[test]
fn domains_are_uncorrelated() {
    let bytes = noise(Shape { size: 128, spp: 1, dims: 2, frames: 1, bits: 16, progressive: false }, 21);
    let tile = Tile::from_bytes(&bytes).unwrap();
    let n = 128 * 128;
    let mut columns: Vec<Vec<[f64; 2]>> = Vec::new();
    for pixel in 0..n {
        let all = domains(Sampler::pixel(&tile, pixel % 128, pixel / 128, 0, 0));
        columns.resize(all.len(), Vec::new());
        for (column, domain) in columns.iter_mut().zip(all) {
            // In units of the standard deviation of a uniform number.
            column.push(domain.draw::<2>().map(|u| (f64::from(u) - 0.5) * 12_f64.sqrt()));
        }
    }
    let mut squares = Moments::default();
    for (i, a) in columns.iter().enumerate() {
        for b in &columns[..i] {
            for (p, q) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let z = a.iter().zip(b).map(|(a, b)| a[p] * b[q]).sum::<f64>() / f64::from(n).sqrt();
                assert!(z.abs() < 5.5, "{i}: {z}");
                squares.add(z * z);
            }
        }
    }
    assert_eq!(squares.count(), 37.0 * 36.0 / 2.0 * 4.0);
    assert!(squares.z(1.0).abs() < Z_LIMIT, "{} {}", squares.mean(), squares.z(1.0));
}

/// Joint histograms of the stratum of a sample in one domain and in another, over pixels and samples, for tiles whose
/// sample j always lies in stratum j, and for the whole pixel and each octave of a progressive tile: 80 deviates.
///
/// Each pixel contributes permutations, so a statistic of k strata is `k / (k - 1)` times a chi-square of `(k - 1)^2`
/// degrees.
#[test]
fn samples_of_two_domains_meet_at_random() {
    for (spp, progressive) in [(4, false), (16, false), (16, true)] {
        let bytes = ordered(64, spp, progressive, 22);
        let tile = Tile::from_bytes(&bytes).unwrap();
        let side = spp.isqrt();
        let stratum = |sampler: Sampler<'_>| {
            let cell = sampler.draw::<2>().map(|u| (u * side as f32) as u32);
            cell[0] + side * cell[1]
        };
        for keys in 0..20 {
            // The strata of an octave are those of its samples.
            let octaves: Vec<(u32, u32)> = if progressive { vec![(4, 8), (8, 16)] } else { vec![(0, spp)] };
            let mut counts: HashMap<(u32, u32), f64> = HashMap::new();
            for pixel in 0..4096 {
                let root = Sampler::pixel(&tile, pixel % 64, pixel / 64, 0, 0);
                let (a, b) = (root.domain(keys), root.domain(keys + 1).domain(keys));
                for index in 0..spp {
                    let pair = (stratum(a.moved(0, 0, index)), stratum(b.moved(0, 0, index)));
                    *counts.entry(pair).or_default() += 1.0;
                }
            }
            for (from, to) in octaves {
                let k = to - from;
                let observed: Vec<f64> =
                    (0..k * k).map(|i| counts.get(&(from + i / k, from + i % k)).copied().unwrap_or(0.0)).collect();
                let expected = 4096.0 / f64::from(k);
                let statistic =
                    chi_square(&observed, &vec![expected; observed.len()]).0 * f64::from(k - 1) / f64::from(k);
                let freedom = f64::from((k - 1) * (k - 1));
                let z = wilson_hilferty(statistic, freedom);
                assert!(z.abs() < Z_LIMIT, "{spp} {progressive} {keys} {from}: {z}");
            }
        }
    }
}

/// As above for what follows the tile: strata of sample pairs of two domains over indices and pixels. A run of 256
/// indices is a net in either domain, so only the pairing is at random; neighbouring indices are paired alike, which
/// the count of pixels (each its own) makes up for: the mean over 64 pairs of domains of each cell, against its own
/// spread.
#[test]
fn continued_samples_of_two_domains_cover_the_product() {
    let bytes = noise(Shape { size: 64, spp: 1, dims: 2, frames: 1, bits: 16, progressive: false }, 23);
    let tile = Tile::from_bytes(&bytes).unwrap();
    let mut cells = vec![Moments::default(); 16];
    for keys in 0..64 {
        let mut counts = [0.0; 16];
        for pixel in 0..64 {
            let root = Sampler::pixel(&tile, pixel * 9 % 64, pixel * 5 % 64, 0, 0);
            let (a, b) = (root.domain(keys), root.domain(keys + 1000));
            for index in 0..256 {
                let stratum = |sampler: Sampler<'_>| {
                    let [x, y] = sampler.moved(0, 0, index).draw::<2>();
                    (x * 2.0) as usize * 2 + (y * 2.0) as usize
                };
                counts[stratum(a) * 4 + stratum(b)] += 1.0;
            }
        }
        cells.iter_mut().zip(counts).for_each(|(cell, count)| cell.add(count / (64.0 * 256.0)));
    }
    for cell in cells {
        assert!(cell.z(1.0 / 16.0).abs() < Z_LIMIT, "{} {}", cell.mean(), cell.z(1.0 / 16.0));
        // Two orders of the same net could put all of a stratum's partners into one: 1/4 and 0 instead of 1/16.
        assert!(cell.variance().sqrt() < 0.01, "{}", cell.variance().sqrt());
    }
}

/// Integrands over the square, and their integrals: smooth, discontinuous, and one that a tile knows nothing of.
type Integrand = (fn([f32; 2]) -> f64, f64);
const INTEGRANDS: [Integrand; 4] = [
    (|[x, y]| f64::from(x * x * y), 1.0 / 6.0),
    (|[x, y]| f64::from(u8::from(x + y < 0.7)), 0.245),
    (|[x, y]| (-f64::from(x + 2.0 * y)).exp(), 0.273_291_174_8),
    (|[x, y]| f64::from(u8::from(x < 0.01 || y > 0.99)), 0.0199),
];

/// The estimate of one pixel from `n` samples.
fn estimate(sampler: Sampler<'_>, n: u32, f: fn([f32; 2]) -> f64) -> f64 {
    (0..n).map(|index| f(sampler.moved(0, 0, index).draw())).sum::<f64>() / f64::from(n)
}

/// A pixel's estimate over 20,000 random shifts (frames, and domains) has the tile's mean: 24 deviates.
#[test]
fn over_random_shifts_the_mean_is_the_tiles() {
    let bytes = ordered(32, 4, false, 25);
    let tile = Tile::from_bytes(&bytes).unwrap();
    for (f, _) in INTEGRANDS {
        let pixels = (0..1024).map(|pixel| estimate(Sampler::pixel(&tile, pixel % 32, pixel / 32, 0, 0), 4, f));
        let own = pixels.sum::<f64>() / 1024.0;
        for pixel in [0, 5, 900] {
            let root = |frame| Sampler::pixel(&tile, pixel % 32, pixel / 32, frame, 0);
            let frames: Moments = (1..20_001).map(|frame| estimate(root(frame), 4, f)).collect();
            assert!(frames.z(own).abs() < Z_LIMIT, "{}", frames.z(own));
            let keys: Moments = (0..20_000).map(|key| estimate(root(0).domain(key), 4, f)).collect();
            assert!(keys.z(own).abs() < Z_LIMIT, "{}", keys.z(own));
        }
    }
}

/// Scrambled, an estimate has no bias at all, even from a tile whose values are all wrong, within or beyond its spp, in
/// the root or in a child, in one pixel or in one that each seed draws at random: 72 deviates over 5,000 seeds.
#[test]
fn scrambled_estimates_are_unbiased() {
    let shape = Shape { size: 32, spp: 4, dims: 2, frames: 1, bits: 16, progressive: false };
    let files = [
        ordered(32, 4, false, 26),
        // Every value in the lowest quarter.
        file(shape, |_, pixel, sample, dim| ((pixel * 7 + sample * 3 + dim) % 64) as f32 / 256.0),
        file(shape, |_, _, _, _| 0.0),
    ];
    let mut rng = SplitMix64::new(27);
    for bytes in &files {
        let tile = Tile::from_bytes(bytes).unwrap();
        for (f, integral) in INTEGRANDS {
            for (n, key, moving) in [
                (4, None, false),
                (4, Some(3), true),
                (3, Some(9), false),
                (20, None, true),
                (20, Some(3), false),
                (1, None, true),
            ] {
                let estimates: Moments = (1..5001)
                    .map(|seed| {
                        let pixel = if moving { rng.next_u64() as u32 } else { 77 };
                        let root = Sampler::pixel(&tile, pixel % 32, pixel >> 9, 0, 0).scramble(seed);
                        estimate(key.map_or(root, |key| root.domain(key)), n, f)
                    })
                    .collect();
                assert!(estimates.z(integral).abs() < Z_LIMIT, "{n} {key:?}: {}", estimates.z(integral));
            }
        }
    }
}

/// Two scrambled domains are unrelated: products of their numbers average to the product of the averages, over 20,000
/// seeds in one pixel of a constant tile, where nothing else is random: 12 deviates.
#[test]
fn scrambled_domains_are_uncorrelated() {
    let bytes = file(Shape { size: 1, spp: 1, dims: 2, frames: 1, bits: 8, progressive: false }, |_, _, _, _| 0.3);
    let tile = Tile::from_bytes(&bytes).unwrap();
    for (a, b) in [(0, 1), (1, 2), (5, 500)] {
        for (p, q) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let products: Moments = (1..20_001)
                .map(|seed| {
                    let root = Sampler::pixel(&tile, 0, 0, 0, 0).scramble(seed);
                    let (a, b) = (root.domain(a).draw::<2>(), root.domain(b).draw::<2>());
                    (f64::from(a[p]) - 0.5) * (f64::from(b[q]) - 0.5)
                })
                .collect();
            assert!(products.z(0.0).abs() < Z_LIMIT, "{}", products.z(0.0));
        }
    }
}
