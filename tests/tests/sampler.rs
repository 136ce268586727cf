//! The default sampler: its points are nets, its domains are unrelated, and what is unbiased over what.
//!
//! Seeds are fixed. Each test states the probability that it fails by chance.

use noisefloor::Error;
use noisefloor::sampler::{Sampler, fill, fill_len, table};
use noisefloor_tests::planar::{Blur, Planar};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::statistics::{Moments, chi_square, maximum};
use proptest::prelude::*;
use std::collections::HashSet;

const PIXELS: u32 = table::SIZE * table::SIZE;

fn root(pixel: u32) -> Sampler {
    Sampler::pixel(pixel % table::SIZE, pixel / table::SIZE, 0, 0)
}

/// The first n samples of all pixels.
fn first(n: u32) -> impl Iterator<Item = [f32; 2]> {
    (0..PIXELS).flat_map(move |pixel| (0..n).map(move |index| root(pixel).moved(0, 0, index).draw()))
}

/// The root, siblings, and chains with equal keys at each step.
fn domains(root: Sampler, count: u32) -> Vec<Sampler> {
    let half = count / 2;
    let siblings = (0..half).map(|key| root.domain(key));
    let chain = (0..half).scan(root, |parent, _| {
        *parent = parent.domain(0);
        Some(parent.domain(1))
    });
    siblings.chain(chain).collect()
}

/// Whether each elementary interval, of 2^cut[k] parts along axis k, has as many of the points as any other.
fn is_even<const N: usize>(points: &[[f32; N]], cut: [u32; N]) -> bool {
    let mut counts = vec![0; 1 << cut.iter().sum::<u32>()];
    for point in points {
        let cells = point.iter().zip(cut).map(|(u, bits)| ((u * (1 << bits) as f32) as usize, bits));
        counts[cells.fold(0, |sum, (cell, bits)| sum << bits | cell)] += 1;
    }
    counts.iter().all(|count| count * counts.len() == points.len())
}

/// The first 2^m points, and every later run of as many, are (0, m, 2)-nets: of all pixels, in the root, a domain, a
/// white one and a scrambled one.
#[test]
fn runs_are_nets() {
    for pixel in 0..PIXELS {
        let Sampler { x, y, .. } = root(pixel);
        let white = Sampler::white(x.into(), y.into(), 0, 0).domain(pixel);
        for sampler in [root(pixel), root(pixel).domain(pixel), white, root(pixel).scramble(pixel + 1)] {
            for m in [0, 1, 2, 3, 4, 6, 9] {
                let n = 1 << m;
                for first in [0, n, 5 * n] {
                    let points: Vec<[f32; 2]> = (first..first + n).map(|i| sampler.moved(0, 0, i).draw()).collect();
                    let nets = (0..=m).all(|a| is_even(&points, [a, m - a]));
                    assert!(nets, "{sampler:?}, {n} points from {first}");
                }
            }
        }
    }
}

/// All four numbers are nets together, of a t that grows slowly, and so are two of them, of a smaller one: of 2^m
/// points those intervals of 2^(t - m) that count.
#[test]
fn four_numbers_are_nets() {
    // Of 4 to 65,536 points, and of 1,024 to 65,536.
    let (strengths, of_pairs) = ([1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4, 4, 4, 5, 6], [3, 3, 3, 4, 4, 3, 3]);
    let points =
        |sampler: Sampler, m: u32| -> Vec<[f32; 4]> { (0..1 << m).map(|i| sampler.moved(0, 0, i).draw()).collect() };
    for pixel in (0..PIXELS).step_by(61) {
        for sampler in [root(pixel), root(pixel).domain(3), root(pixel).scramble(3)] {
            for (m, t) in (2..).zip(strengths).take(if pixel == 0 { strengths.len() } else { 8 }) {
                let (points, parts) = (points(sampler, m), m - t + 1);
                let cuts = (0..parts.pow(4)).map(|k| [0, 1, 2, 3].map(|axis| k / parts.pow(axis) % parts));
                for cut in cuts.filter(|cut| cut.iter().sum::<u32>() == m - t) {
                    assert!(is_even(&points, cut), "{sampler:?}, 2^{m}, {cut:?}");
                }
            }
        }
    }
    for (m, t) in (10..).zip(of_pairs) {
        let points = points(root(9).domain(3), m);
        for (first, last) in [(0, 2), (0, 3), (1, 2), (1, 3)] {
            for part in 0..=m - t {
                let mut cut = [0; 4];
                (cut[first], cut[last]) = (part, m - t - part);
                assert!(is_even(&points, cut), "2^{m}, {cut:?}");
            }
        }
    }
}

/// Products of centred numbers, and of their signs, of all pairs of 64 domains, summed over a pixel's samples: over the
/// table's pixels their mean is 0, and varies as that of domains which lie anywhere to each other, as one of each pair
/// does where it is moved over the table. Two domains at the same place, which one pair in 8,192 has, would fail; the
/// table beside itself, the largest of all other pairs, has 6.6. The means of their squares are 4.75 standard errors
/// apart with 2e-6.
#[test]
fn domains_are_uncorrelated() {
    for n in [1, 4] {
        let mut columns: Vec<Vec<[f64; 4]>> = vec![vec![]; 64];
        for (pixel, index) in (0..PIXELS).flat_map(|pixel| (0..n).map(move |index| (pixel, index))) {
            for (column, domain) in columns.iter_mut().zip(domains(root(pixel).moved(0, 0, index), 64)) {
                let [a, b]: [f64; 2] = domain.draw().map(|u: f32| f64::from(u) - 0.5);
                column.push([a, b, a.signum(), b.signum()]);
            }
        }
        let (mut rng, mut squares) = (SplitMix64::new(5), [Moments::default(); 2]);
        for (i, a) in columns.iter().enumerate() {
            for (j, b) in columns[..i].iter().enumerate() {
                let here = deviates(a, b, n, [0, 0]);
                assert!(here.iter().all(|z| z.abs() < 7.0), "{n}: domains {i} and {j}: {here:?}");
                // Not onto the same place.
                let mut moved = [f64::INFINITY; 8];
                while moved.iter().any(|z| z.abs() >= 7.0) {
                    moved = deviates(a, b, n, [0; 2].map(|_| rng.below(table::SIZE as usize)));
                }
                for (moments, deviates) in squares.iter_mut().zip([here, moved]) {
                    moments.add(deviates.iter().map(|z| z * z).sum::<f64>() / 8.0);
                }
            }
        }
        let [here, moved] = squares.map(|of| of.mean());
        let error = squares[0].standard_error().hypot(squares[1].standard_error());
        println!("{n}: variance {here:.3}, moved {moved:.3}, standard error {error:.4}");
        assert!((here - moved).abs() < 4.75 * error, "{n}: {here} and {moved}");
    }
}

/// Of the sums over pixels' samples of products of the first two and of the last two numbers of two domains, the second
/// moved over the table: over the pixels their mean in units of what their own spread makes of it.
fn deviates(a: &[[f64; 4]], b: &[[f64; 4]], n: u32, by: [usize; 2]) -> [f64; 8] {
    let (size, n) = (table::SIZE as usize, n as usize);
    let mut sums = [[0.0; 2]; 8];
    for (pixel, a) in a.chunks(n).enumerate() {
        let other = (pixel / size + by[1]) % size * size + (pixel + by[0]) % size;
        let mut products = [0.0; 8];
        for (a, b) in a.iter().zip(&b[other * n..]) {
            let pairs = [(0, 0), (0, 1), (1, 0), (1, 1), (2, 2), (2, 3), (3, 2), (3, 3)];
            products.iter_mut().zip(pairs).for_each(|(sum, (p, q))| *sum += a[p] * b[q]);
        }
        sums.iter_mut().zip(products).for_each(|(sums, x)| *sums = [sums[0] + x, sums[1] + x * x]);
    }
    sums.map(|[sum, squares]| sum / squares.sqrt())
}

/// A function of four numbers, and its integral.
type Integrand = (fn([f32; 4]) -> f64, f64);

/// Over seeds every value is uniform: the means of four integrands, of 1 and 4 samples. |z| < 4.75 by chance with
/// probability 2e-6, of 32 deviates.
#[test]
fn unbiased_over_scrambles() {
    let integrands: [Integrand; 4] = [
        (|[x, y, ..]| f64::from(x * x * y), 1.0 / 6.0),
        (|[x, y, ..]| f64::from(u8::from(x + y < 0.7)), 0.245),
        (|[x, _, z, w]| f64::from(u8::from(x < 0.25)) * f64::from(z * w), 0.0625),
        (|[_, y, z, _]| f64::from(y * z), 0.25),
    ];
    for sampler in [root(77), root(77).domain(5), root(900), Sampler::white(3, 4, 1, 0)] {
        for n in [1, 4] {
            let mut means = [Moments::default(); 4];
            for seed in 1..=40_000 {
                let points = (0..n).map(|i| sampler.scramble(seed).moved(0, 0, i).draw::<4>());
                let points: Vec<[f32; 4]> = points.collect();
                for (moments, (f, _)) in means.iter_mut().zip(&integrands) {
                    moments.add(points.iter().map(|&u| f(u)).sum::<f64>() / f64::from(n));
                }
            }
            for (k, (moments, (_, truth))) in means.iter().zip(integrands).enumerate() {
                assert!(moments.z(truth).abs() < 4.75, "{n}, integrand {k}: {}", moments.z(truth));
            }
        }
    }
}

/// As many values as uniform numbers would have lie near each border, over the table, of the first 1, 4 and 16 samples:
/// no part of the square is avoided.
#[test]
fn borders_are_sampled() {
    for n in [1, 4, 16] {
        for axis in 0..2 {
            for near in [|u: f32| u < 1.0 / 64.0, |u: f32| u >= 63.0 / 64.0] {
                let count = first(n).filter(|u| near(u[axis])).count() as f64;
                let density = count * 64.0 / f64::from(n * PIXELS);
                assert!((0.9..=1.1).contains(&density), "{n} samples, axis {axis}: {density}");
            }
        }
    }
}

/// Values gather nowhere: the numbers of them in parts of each axis, over the table, vary less than those of random
/// points in 512 parts, of one sample at most 1.4 times as much, and in 4,096 parts at most 2.4 times as much. On a
/// comb that was 54 times.
#[test]
fn values_are_even() {
    let uneven = |n, parts: usize| {
        let mut counts = [0, 1].map(|_| vec![0.0; parts]);
        for value in first(n) {
            let part = |value: f32| (value * parts as f32) as usize;
            counts.iter_mut().zip(value).for_each(|(counts, value)| counts[part(value)] += 1.0);
        }
        let expected = vec![f64::from(n * PIXELS) / parts as f64; parts];
        maximum(counts.map(|counts| chi_square(&counts, &expected).0 / parts as f64))
    };
    for n in [1, 2, 4, 8, 16, 32, 64] {
        let [coarse, fine] = [512, 4096].map(|parts| uneven(n, parts));
        assert!(coarse < if n == 1 { 1.4 } else { 0.75 }, "{n} samples: {coarse} of random points' variance");
        assert!(fine < 2.4, "{n} samples: {fine} of random points' variance");
    }
}

/// Within the strata of 1, 2, 4, ... 64 samples, which the table is made for, values lie anywhere, over the table: no
/// eighth of them is shunned by all pixels. Of 128 and 256 samples, too, but less evenly.
#[test]
fn strata_are_filled() {
    for n in (0..=8).map(|m| 1 << m) {
        let mut counts = [[0; 8]; 2];
        for value in first(n) {
            for (counts, value) in counts.iter_mut().zip(value) {
                counts[((value * n as f32).fract() * 8.0) as usize] += 1;
            }
        }
        for count in counts.as_flattened() {
            let density = f64::from(8 * count) / f64::from(n * PIXELS);
            let tolerance = if n > 64 { 0.25 } else { 0.1 };
            assert!((density - 1.0).abs() <= tolerance, "{n} samples: {density}, of {counts:?}");
        }
    }
}

/// A domain's last two numbers say nothing of its first two, whatever its key: over the table their correlations are
/// those of pixels that lie anywhere. Of 16,384 normal deviates of variance 1.2 the largest is beyond 6.5 with
/// probability 5e-5.
#[test]
fn last_numbers_are_not_the_first() {
    for key in 0..4096 {
        let mut sums = [0.0; 4];
        for pixel in 0..PIXELS {
            let sample = root(pixel).moved(0, 0, pixel % 4).domain(key);
            let [a, b, c, d]: [f64; 4] = sample.draw().map(|u: f32| f64::from(u) - 0.5);
            sums.iter_mut().zip([a * c, a * d, b * c, b * d]).for_each(|(sum, product)| *sum += product);
        }
        // The standard deviation of a product of uniform numbers is 1/12.
        let deviates = sums.map(|sum| sum * 12.0 / f64::from(PIXELS).sqrt());
        assert!(deviates.iter().all(|z| z.abs() < 6.5), "{key}: {deviates:?}");
    }
}

/// White samplers' pixels near each other have the same place of 1,024 as often as any: of 304 Poisson numbers of mean
/// 256, one is beyond 6 standard deviations with probability 1e-6.
#[test]
fn white_places_are_independent() {
    const SIDE: u32 = 512;
    let place = |x, y| Sampler::white(x, y, 0, 0).draw::<2>().map(f32::to_bits);
    let places: Vec<_> = (0..SIDE * SIDE).map(|pixel| place(pixel % SIDE, pixel / SIDE)).collect();
    let at = |x: u32, y: u32| places[(y % SIDE * SIDE + x % SIDE) as usize];
    for (right, down) in (0..=8).flat_map(|down| (0..=16).map(move |x| (x, down))).skip(1) {
        for right in [right, SIDE - right] {
            let all = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
            let equal = all.filter(|&(x, y)| at(x, y) == at(x + right, y + down)).count() as f64;
            assert!((equal - 256.0).abs() < 6.0 * 16.0, "{right}, {down}: {equal}");
        }
    }
}

/// Children of different domains are different, but for the coincidences of 32 bits, which are scattered over the
/// domains: of 4,096 parents with 1,024 children each no two share more than 16. They come in twos at least, as keys
/// are exclusive-or the parent.
#[test]
fn children_are_scattered() {
    let parents = (0..4096).map(|seed| root(0).scramble(seed + 1));
    let mut children: Vec<_> =
        parents.zip(0..).flat_map(|(parent, p)| (0..1024).map(move |key| (parent.domain(key).domain, p))).collect();
    children.sort_unstable();
    let mut pairs: Vec<(i32, i32)> =
        children.windows(2).filter(|two| two[0].0 == two[1].0).map(|two| (two[0].1, two[1].1)).collect();
    // Expected: 2,048, with a standard deviation of some 70.
    assert!((1700..2400).contains(&pairs.len()), "{}", pairs.len());
    pairs.sort_unstable();
    let most = pairs.chunk_by(|a, b| a == b).map(<[_]>::len).max();
    assert!(most <= Some(16), "{most:?}");
}

/// The error of half-planes, the same in all pixels, through a Gaussian of 2.1 pixels, over that of white noise: of the
/// first samples, and of one or three that are no power of two of a domain.
#[test]
fn half_planes_vanish_through_a_filter() {
    let blur = Blur::new(table::SIZE as usize);
    type Make = fn(Sampler) -> Sampler;
    let (own, child): (Make, Make) = (|sampler| sampler, |sampler| sampler.domain(3));
    let all = [(0..1, 0.145), (0..4, 0.082), (0..16, 0.052)].map(|(indices, most)| (own, indices, most));
    let apart = [(5..6, 0.65), (100..101, 0.65), (0..3, 0.25)].map(|(indices, most)| (child, indices, most));
    for (make, indices, most) in all.into_iter().chain(apart) {
        let mut rng = SplitMix64::new(7);
        let samples = |pixel| indices.clone().map(move |index| make(root(pixel).moved(0, 0, index)).draw());
        let points: Vec<[f32; 2]> = (0..PIXELS).flat_map(samples).collect();
        let n = indices.len();
        let (mut sum, mut white) = (0.0, 0.0);
        for _ in 0..400 {
            let plane = Planar::half_plane(&mut rng);
            let [mean, variance] = plane.integral();
            let value = |point: &[f32; 2]| plane.at(point.map(f64::from)) - mean;
            let error = |points: &[[f32; 2]]| points.iter().map(value).sum::<f64>() / n as f64;
            let image = blur.apply(&points.chunks(n).map(error).collect::<Vec<_>>());
            sum += image.iter().map(|error| error * error).sum::<f64>() / f64::from(PIXELS);
            white += variance / n as f64 * blur.of_noise();
        }
        println!("{indices:?}: {:.4}", sum / white);
        assert!(sum / white < most, "samples {indices:?}: {}", sum / white);
    }
}

/// Neighbours' values differ more than those of pixels at random; white samplers' do not. Of one sample, the mean
/// square of differences between pixels beside each other, over 1/6.
#[test]
fn neighbours_differ() {
    let spread = |make: fn(u32, u32, u32, u32) -> Sampler| {
        let mut moments = Moments::default();
        for (x, y) in (0..table::SIZE).flat_map(|y| (0..table::SIZE).map(move |x| (x, y))) {
            let at = |x, y| make(x, y, 0, 0).draw::<2>();
            for other in [at(x + 1, y), at(x, y + 1)] {
                at(x, y).iter().zip(other).for_each(|(a, b)| moments.add(6.0 * f64::from((a - b).powi(2))));
            }
        }
        moments
    };
    let (blue, white) = (spread(Sampler::pixel), spread(Sampler::white));
    println!("blue {:.3}, white {:.3}", blue.mean(), white.mean());
    assert!(blue.mean() > 1.15, "{}", blue.mean());
    assert!(white.z(1.0).abs() < 4.75, "{}", white.mean());
}

/// Bits that never change.
#[test]
fn pinned_values() {
    let bits = |sampler: Sampler| sampler.draw::<4>().map(|u| (u * 16_777_216.0) as u32);
    let mut hash = 0_u64;
    let mut rng = SplitMix64::new(1);
    for _ in 0..10_000 {
        let mut word = || rng.next_u64() as u32;
        let sampler = Sampler::pixel(word(), word(), word() % 2, word() >> (word() % 32)).scramble(word() % 2);
        let sampler = if word().is_multiple_of(2) { sampler } else { sampler.domain(word()) };
        for value in bits(sampler) {
            hash = (hash ^ u64::from(value)).wrapping_mul(0x0100_0000_01b3);
        }
    }
    assert_eq!(bits(Sampler::pixel(0, 0, 0, 0)), PINNED);
    assert_eq!(hash, PINNED_HASH);
}

const PINNED: [u32; 4] = [7_610_915, 13_897_400, 1_615_489, 16_714_429];
const PINNED_HASH: u64 = 11_717_367_165_471_733_490;

#[test]
fn filled_at_once() {
    let samplers = [(root(5).domain(1), 2), (Sampler::white(7, 8, 9, 10).scramble(3), 3)];
    let mut u = vec![-1.0; 4 * 3 * 5 * 5 + 1];
    fill(samplers, 4, 3, 5, &mut u).unwrap();
    assert_eq!(u.pop(), Some(-1.0));
    for (at, drawn) in u.chunks(5).enumerate() {
        let [x, y, sample] = [at / 5 % 4, at / 20, at % 5].map(|value| value as u32);
        let [a, b] = samplers.map(|(sampler, _)| sampler.moved(x, y, sample));
        assert_eq!(drawn, [&a.draw::<2>()[..], &b.draw::<3>()].concat());
    }
    assert_eq!(fill(samplers, 4, 3, 5, &mut u[1..]), Err(Error::Memory));
    assert_eq!(fill([(root(0), 5)], 1, 1, 1, &mut u), Err(Error::Range));
    assert_eq!(fill([(root(0), 0)], 1, 1, 1, &mut u), Err(Error::Range));
    assert_eq!(fill(samplers, usize::MAX, 3, 5, &mut u), Err(Error::Range));
    assert_eq!(fill([samplers[0]; 0], usize::MAX, usize::MAX, 1, &mut u), Err(Error::Range));
    assert_eq!(fill(samplers, 0, 3, 5, &mut []), Ok(()));
    assert_eq!(fill(samplers, usize::MAX, 1, 0, &mut []), Ok(()));
    assert_eq!(fill(samplers, 0, usize::MAX, 5, &mut []), Ok(()));
    assert_eq!(fill_len([(root(0), 1)], isize::MAX as usize, 1, 1), None);
    // A stride below the count of numbers is that count.
    let (mut u, mut dense) = ([-1.0; 31], [-1.0; 31]);
    root(3).draw_samples(3, 1, &mut u);
    root(3).draw_samples(3, 3, &mut dense);
    assert_eq!(u, dense);
}

/// The table repeats; other pixels, frames, samples, domains, kinds and seeds draw other numbers.
#[test]
fn places() {
    let s = Sampler::pixel(3, 5, 0, 1);
    let far = Sampler::pixel(3 + table::SIZE, 5_u32.wrapping_sub(table::SIZE), 0, 1);
    assert_eq!((s.draw::<3>(), s), (far.draw(), s.scramble(0)));
    let [pixel, frame, sample] = [Sampler::pixel(4, 5, 0, 1), Sampler::pixel(3, 5, 1, 1), Sampler::pixel(3, 5, 0, 5)];
    let domains = [s.domain(0), s.domain(1).domain(2), s.domain(2).domain(1)];
    let white = Sampler::white(3, 5, 0, 1);
    let all = [&[s, pixel, frame, sample, white, s.scramble(1), white.scramble(1)][..], &domains].concat();
    let drawn: HashSet<_> = all.iter().map(|s| s.draw::<3>().map(f32::to_bits)).collect();
    assert_eq!(drawn.len(), all.len());
    // Frame 1, seed 1 and key 1 make three domains.
    assert_eq!(HashSet::from([frame, s.scramble(1), s.domain(1)].map(|s| s.domain)).len(), 3);
}

/// The four numbers are functions of their own: the last two are not the first two of some sample, have their own
/// digits beyond the ninth, and their own shifts. If values were random, fewer than 1e-12 for all limits together.
#[test]
fn numbers_have_their_own_values() {
    let bits = |s: Sampler| s.draw::<4>().map(|u| (u * 16_777_216.0) as u32);
    let equal = (0..PIXELS).map(|pixel| bits(root(pixel))).filter(|[a, b, c, d]| a == c || b == d).count();
    assert!(equal < 3, "{equal}");
    for axis in 0..4 {
        let values: HashSet<u32> = (0..4096).map(|i| bits(root(9).moved(0, 0, i))[axis]).collect();
        assert!(values.len() > 4080, "{axis}: {}", values.len());
        // Below the leading 16 bits, too, values lie anywhere.
        let fine: HashSet<u32> = (0..PIXELS).map(|pixel| bits(root(pixel))[axis] & 255).collect();
        assert!(fine.len() > 200, "{axis}: {}", fine.len());
    }
    let differences: [HashSet<u32>; 3] = [1, 2, 3].map(|axis| {
        let bits = (1..=20_000).map(|seed| bits(root(9).scramble(seed)));
        bits.map(|bits| bits[axis].wrapping_sub(bits[0]) & 0xff_ffff).collect()
    });
    assert!(differences.iter().all(|all| all.len() > 19_900), "{:?}", differences.map(|all| all.len()));
}

/// The first two samples of pixels 32 apart are the same numbers in all domains, later ones are not; white pixels share
/// theirs with others. As the documents say.
#[test]
fn first_two_samples_repeat() {
    let vector =
        |s: Sampler| [s.draw::<4>(), s.domain(7).draw(), s.domain(1).domain(0).draw()].map(|u| u.map(f32::to_bits));
    let distinct = |make: fn(u32, u32) -> Sampler, index: u32| {
        let all = (0..128 * 128).map(|pixel| vector(make(pixel % 128, pixel / 128).moved(0, 0, index)));
        all.collect::<HashSet<_>>().len()
    };
    for make in [|x, y| Sampler::pixel(x, y, 3, 0), |x, y| Sampler::pixel(x, y, 0, 0).scramble(5)] {
        assert_eq!([0, 1].map(|index| distinct(make, index)), [PIXELS as usize; 2]);
        assert!(distinct(make, 2) > 4 * PIXELS as usize && distinct(make, 5) > 12 * PIXELS as usize);
        for index in [0, 1] {
            assert_eq!(vector(make(3, 70).moved(0, 0, index)), vector(make(35, 6).moved(0, 0, index)));
        }
    }
    let white: fn(u32, u32) -> Sampler = |x, y| Sampler::white(x, y, 3, 0);
    assert_eq!([0, 1].map(|index| distinct(white, index)), [PIXELS as usize; 2]);
    assert!(distinct(white, 2) > 4 * PIXELS as usize);
}

proptest! {
    /// Whatever the fields: multiples of 2^-24 in [0, 1), the first of more numbers are those of fewer.
    #[test]
    fn anything_goes(domain: u32, index: u32, x: u16, y: u16, flags: u32, key: u32, seed: u32, moved: [u32; 3]) {
        let [across, down, further] = moved;
        let sampler = Sampler { domain, index, x, y, flags }.domain(key).scramble(seed).moved(across, down, further);
        let [a, b, c, d] = sampler.draw();
        prop_assert!([a, b, c, d].iter().all(|u| (0.0..1.0).contains(u) && (u * 16_777_216.0).fract() == 0.0));
        prop_assert_eq!([sampler.draw::<1>()[0], sampler.draw::<2>()[1], sampler.draw::<3>()[2]], [a, b, c]);
        let mut few = [9.0; 3];
        sampler.draw_into(&mut few);
        prop_assert_eq!(few, [a, b, c]);
    }
}
