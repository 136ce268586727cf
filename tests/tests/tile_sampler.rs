//! What a sampler draws: the tile's values where it promises them, the same bits in any order, and never a 1.

use crate::tile_format::shapes;
use noisefloor::Error;
use noisefloor::tile::{Builtin, Sampler, Shape, Tile, fill, fill_len};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::statistics::chi_square;
use noisefloor_tests::tile::{file, noise, ordered};
use proptest::prelude::*;
use std::collections::HashSet;

const SHAPE: Shape = Shape { size: 8, spp: 4, dims: 3, frames: 1, bits: 16, progressive: false };

#[test]
fn the_root_draws_the_tile() {
    for bits in [8, 16] {
        let shape = Shape { bits, frames: 2, ..SHAPE };
        let bytes = noise(shape, 1);
        let tile = Tile::from_bytes(&bytes).unwrap();
        for (frame, x, y, sample) in (0..512).map(|i| (i / 256, i / 4 % 8, i / 32 % 8, i % 4)) {
            let sampler = Sampler::pixel(&tile, x, y, frame, sample);
            let stored = [0, 1, 2].map(|dim| tile.value(frame, y, x, sample, dim).unwrap());
            assert_eq!(sampler.draw::<3>(), stored);
            assert_eq!(sampler.draw::<1>(), [stored[0]]);
            assert_eq!(sampler.draw::<2>(), [stored[0], stored[1]]);
            assert_eq!(sampler.draw::<4>()[..3], stored);
            let mut u = [0.0; 2];
            assert!(sampler.draw_stored(&mut u) && u == stored[..2]);
            assert!(!sampler.moved(0, 0, 4).draw_stored(&mut u));
        }
    }
}

/// A progressive tile's first 1, 2, 4, ... samples remain those in every domain.
#[test]
fn progressive_prefixes_stay() {
    let shape = Shape { spp: 16, progressive: true, ..SHAPE };
    // The value says which sample it is; pixels do not differ.
    let bytes = file(shape, |_, _, sample, _| sample as f32 / 16.0);
    let tile = Tile::from_bytes(&bytes).unwrap();
    let mut orders = HashSet::new();
    for pixel in 0..64 {
        let sampler = Sampler::pixel(&tile, pixel % 8, pixel / 8, 0, 0).domain(5);
        let order: Vec<u32> = (0..16).map(|i| (sampler.moved(0, 0, i).draw::<1>()[0] * 16.0) as u32).collect();
        for len in [1, 2, 4, 8, 16] {
            let prefix: HashSet<u32> = order[..len].iter().copied().collect();
            assert_eq!(prefix, (0..len as u32).collect());
        }
        orders.insert(order);
    }
    assert!(orders.len() > 50, "each pixel has an order of its own");
}

#[test]
fn values_are_below_one_and_multiples_of_an_epsilon() {
    for bits in [8, 16] {
        let bytes = file(Shape { bits, ..SHAPE }, |_, _, _, _| 1.0);
        let tile = Tile::from_bytes(&bytes).unwrap();
        let mut rng = SplitMix64::new(4);
        for _ in 0..20_000 {
            let mut random = || rng.next_u64() as u32;
            let mut sampler = Sampler::pixel(&tile, random(), random(), random() % 3, random() >> (random() % 32));
            if random() % 2 == 0 {
                sampler = sampler.domain(random());
            }
            if random() % 2 == 0 {
                sampler = sampler.scramble(random());
            }
            for u in sampler.draw::<4>() {
                assert!((0.0..1.0).contains(&u));
                assert_eq!((u * 16_777_216.0).fract(), 0.0);
            }
        }
    }
}

/// Every way to draw, each sample drawn alone, in any order and in groups: the same bits.
#[test]
fn random_access() {
    for shape in [
        SHAPE,
        Shape { spp: 1, dims: 2, ..SHAPE },
        Shape { dims: 1, frames: 3, ..SHAPE },
        Shape { dims: 2, bits: 8, progressive: true, ..SHAPE },
        Shape { dims: 8, ..SHAPE },
    ] {
        let bytes = noise(shape, 5);
        let tile = Tile::from_bytes(&bytes).unwrap();
        let place = |i: u32| {
            let sampler = Sampler::pixel(&tile, i % 11, i / 11 % 7, i / 77 % 5, i * 3 % 17);
            match i % 4 {
                0 => sampler,
                1 => sampler.domain(i),
                2 => sampler.domain(1).scramble(i).domain(2),
                _ => sampler.scramble(i),
            }
        };
        let forward: Vec<[f32; 4]> = (0..2000).map(|i| place(i).draw()).collect();
        let mut rng = SplitMix64::new(6);
        for _ in 0..4000 {
            let i = rng.below(2000);
            let (sampler, all) = (place(i as u32), forward[i]);
            assert_eq!(sampler.draw::<4>(), all);
            assert_eq!(sampler.draw::<3>(), all[..3]);
            assert_eq!(sampler.draw::<2>(), all[..2]);
            assert_eq!(sampler.draw::<1>(), all[..1]);
            let mut stored = [0.0; 2];
            assert!(!sampler.draw_stored(&mut stored) || stored == all[..2]);
        }
    }
}

#[test]
fn fill_gives_the_same_bits() {
    let (bytes, others) = (noise(SHAPE, 7), noise(Shape { size: 4, dims: 2, frames: 2, ..SHAPE }, 8));
    let (tile, other) = (Tile::from_bytes(&bytes).unwrap(), Tile::from_bytes(&others).unwrap());
    let (width, height, samples) = (19, 5, 9);
    let at = |x: u32, y: u32, index: u32| {
        let root = Sampler::pixel(&tile, x, y, 2, index);
        [
            (root, 2),
            (root.domain(3), 4),
            (root.domain(3).scramble(9).domain(1), 1),
            (Sampler::pixel(&other, x, y, 3, index), 3),
        ]
    };
    let domains = at(1000, 6, 2);
    let len = fill_len(domains, width, height, samples).unwrap();
    assert_eq!(len, width * height * samples * 10);
    let mut u = vec![-1.0; len + 3];
    fill(domains, width, height, samples, &mut u).unwrap();
    assert_eq!(u[len..], [-1.0; 3]);
    let mut drawn = u.iter();
    for (y, x, sample) in (0..height * width * samples).map(|i| (i / samples / width, i / samples % width, i % samples))
    {
        for (sampler, dims) in at(1000 + x as u32, 6 + y as u32, 2 + sample as u32) {
            let single = sampler.draw::<4>();
            single[..dims].iter().for_each(|u| assert_eq!(Some(u), drawn.next()));
        }
    }

    u.fill(-1.0);
    assert_eq!(fill(domains, width, height, samples, &mut u[..len - 1]), Err(Error::Memory));
    assert_eq!(fill([(domains[0].0, 5)], 1, 1, 1, &mut u), Err(Error::Range));
    assert_eq!(fill([(domains[0].0, 0)], 1, 1, 1, &mut u), Err(Error::Range));
    assert_eq!(fill(domains, usize::MAX, 2, 1, &mut u), Err(Error::Range));
    assert!(u.iter().all(|&u| u == -1.0));
    assert_eq!(fill(domains, 0, 5, 5, &mut []), Ok(()));
    assert_eq!(fill([domains[0]; 0], 5, 5, 5, &mut []), Ok(()));
}

/// Samples that share their hashes are the samples drawn one by one: of each kind of tile, from any first index, to
/// beyond the tile's.
#[test]
fn samples_of_a_pixel_give_the_same_bits() {
    for (spp, dims, bits, progressive) in [
        (1, 2, 8, false),
        (4, 2, 16, false),
        (16, 2, 16, false),
        (16, 3, 8, false),
        (64, 2, 8, false),
        (8, 2, 16, true),
        (32, 1, 8, true),
    ] {
        let bytes = noise(Shape { size: 4, spp, dims, frames: 2, bits, progressive }, 9);
        let tile = Tile::from_bytes(&bytes).unwrap();
        for first in [0, spp - 1, spp, u32::MAX - 3] {
            let root = Sampler::pixel(&tile, 7, 2, 1, first);
            for sampler in [
                root,
                root.domain(5),
                root.domain(5).domain(6),
                root.scramble(3),
                Sampler::pixel(&tile, 3, 3, 9, first),
            ] {
                for (dims, stride) in [(1, 1), (2, 5), (3, 3), (4, 6)] {
                    let mut u = vec![-1.0; (spp as usize + 9) * stride];
                    sampler.draw_samples(dims, stride, &mut u);
                    for (k, u) in u.chunks(stride).enumerate() {
                        assert_eq!(
                            u[..dims],
                            sampler.moved(0, 0, k as u32).draw::<4>()[..dims],
                            "{spp} spp, {first}, sample {k}"
                        );
                        assert!(u[dims..].iter().all(|&u| u == -1.0));
                    }
                }
            }
        }
        let mut u = [-1.0; 9];
        for dims in [0, 5, usize::MAX] {
            Sampler::pixel(&tile, 0, 0, 0, 0).draw_samples(dims, 5, &mut u);
        }
        assert_eq!(u, [-1.0; 9]);
        // A stride below the count of numbers is that count.
        let (mut u, mut dense) = ([-1.0; 31], [-1.0; 31]);
        Sampler::pixel(&tile, 1, 2, 0, 0).draw_samples(3, 1, &mut u);
        Sampler::pixel(&tile, 1, 2, 0, 0).draw_samples(3, 3, &mut dense);
        assert_eq!(u, dense);
    }
}

/// Other samples, domains, seeds and frames, also beyond the tile's, draw other numbers; so do domains in another
/// order.
#[test]
fn places_differ() {
    for frames in [1, 2] {
        let bytes = noise(Shape { frames, ..SHAPE }, 2);
        let tile = Tile::from_bytes(&bytes).unwrap();
        let s = Sampler::pixel(&tile, 3, 5, 0, 1);
        let frame = |frame| Sampler::pixel(&tile, 3, 5, frame, 1);
        let [sample, chains] = [Sampler::pixel(&tile, 3, 5, 0, 5), s.domain(1).domain(2)];
        let all = [s, frame(1), frame(2), frame(3), sample, s.domain(0), s.scramble(1), chains, s.domain(2).domain(1)];
        assert_eq!(HashSet::from(all.map(|s| s.draw::<3>().map(f32::to_bits))).len(), all.len());
        // Cycle 1 of the frames, seed 1 and key 1 make three domains.
        assert_eq!(HashSet::from([frame(frames), s.scramble(1), s.domain(1)].map(|s| s.domain)).len(), 3);
    }
}

/// Beyond the tile's dims come other places of the tile, not repetitions.
#[test]
fn further_dimensions_are_others() {
    let bytes = noise(Shape { dims: 1, spp: 1, size: 64, ..SHAPE }, 9);
    let tile = Tile::from_bytes(&bytes).unwrap();
    for pixel in 0..100 {
        let u = Sampler::pixel(&tile, pixel, 3, 0, 0).draw::<4>().map(f32::to_bits);
        assert_eq!(HashSet::from(u).len(), 4);
    }
}

/// Of a shipped tile: in every pixel and domain each further number has one sample in each stratum, and over the pixels
/// each sample is in each stratum equally often (chi-square with 15 degrees of freedom; the 32 limits of 4.5 together
/// fail one time in 9,000).
#[test]
fn further_dimensions_are_stratified() {
    let tile = Builtin::Size128Spp16Dims2.tile().unwrap();
    for domain in [None, Some(3)] {
        for dim in [2, 3] {
            let mut counts = [[0_u32; 16]; 16];
            for (x, y) in (0..128).flat_map(|y| (0..128).map(move |x| (x, y))) {
                let mut seen = 0_u32;
                for index in 0..16 {
                    let sampler = Sampler::pixel(&tile, x, y, 0, index);
                    let sampler = domain.map_or(sampler, |key| sampler.domain(key));
                    let stratum = (sampler.draw::<4>()[dim] * 16.0) as usize;
                    seen |= 1 << stratum;
                    counts[index as usize][stratum] += 1;
                }
                assert_eq!(seen, 0xffff, "pixel ({x}, {y})");
            }
            for counts in &counts[..8] {
                let (_, z) = chi_square(&counts.map(f64::from), &[1024.0; 16]);
                assert!(z < 4.5, "{counts:?}: z = {z}");
            }
        }
    }
}

/// Of the same tile: within each stratum further numbers lie anywhere, over the pixels no quarter of it is shunned, and
/// a pixel's first two samples do not lie alike in theirs.
#[test]
fn strata_of_further_dimensions_are_filled() {
    let tile = Builtin::Size128Spp16Dims2.tile().unwrap();
    // All 256 pairs of the third and the fourth number's strata occur: by chance one is missing with probability 256
    // e^-64.
    let pairs = (0..128 * 128).map(|pixel| {
        let [_, _, third, fourth] = Sampler::pixel(&tile, pixel % 128, pixel / 128, 0, 0).domain(3).draw();
        [third, fourth].map(|u: f32| (u * 16.0) as u32)
    });
    assert_eq!(pairs.collect::<HashSet<_>>().len(), 256);
    for dim in [2, 3] {
        let (mut counts, mut alike) = ([[0_u32; 4]; 16], 0);
        for (x, y) in (0..128).flat_map(|y| (0..128).map(move |x| (x, y))) {
            let within: [f32; 16] = std::array::from_fn(|index| {
                let value = Sampler::pixel(&tile, x, y, 0, index as u32).domain(3).draw::<4>()[dim] * 16.0;
                counts[value as usize][(value.fract() * 4.0) as usize] += 1;
                value.fract()
            });
            alike += u32::from((within[0] - within[1]).abs() < 1.0 / 64.0);
        }
        // Nine standard deviations of independent values; two of these are as near in 1 of 32 pixels, 508 of them, and
        // twice as many are 23 standard deviations more.
        println!("{dim}: {counts:?}, {alike} alike");
        assert!(counts.as_flattened().iter().all(|count| count.abs_diff(4096) < 500), "{dim}: {counts:?}");
        assert!(alike < 1024, "{dim}: {alike}");
    }
}

/// By ranks among a pixel's samples, halves of the first number by eighths of the third have one each.
#[test]
fn a_third_dimension_makes_a_net() {
    let tile = Builtin::Size128Spp16Dims2.tile().unwrap();
    let ranks = |values: [f32; 16]| values.map(|value| values.iter().filter(|&&other| other < value).count());
    let mut evenness = [0_u32; 2];
    for (x, y) in (0..16).flat_map(|y| (0..16).map(move |x| (x, y))) {
        let samples: [[f32; 3]; 16] =
            std::array::from_fn(|i| Sampler::pixel(&tile, x, y, 0, i as u32).domain(1).draw());
        let first = ranks(samples.map(|u| u[0]));
        // Halves of the first number: eight each, and in each of them one sample in each eighth of the third.
        for side in 0..2 {
            let mut seen = 0_u32;
            for i in (0..16).filter(|&i| first[i] / 8 == side) {
                seen |= 1 << (samples[i][2] * 8.0) as u32;
            }
            evenness[usize::from(seen == 0xff)] += 1;
        }
    }
    assert_eq!(evenness, [0, 512]);
}

#[test]
fn seed_zero_scrambles_nothing() {
    let bytes = noise(SHAPE, 10);
    let tile = Tile::from_bytes(&bytes).unwrap();
    let sampler = Sampler::pixel(&tile, 1, 2, 3, 4).domain(5);
    assert_eq!(sampler.scramble(0), sampler);
    assert_ne!(sampler.scramble(1).draw::<2>(), sampler.draw());
    assert_ne!(sampler.scramble(1).draw::<2>(), sampler.scramble(2).draw());
}

/// A scrambled sampler shifts each number by a hash of its own, those beyond the tile's dims, too: of a tile whose
/// values are all the same, differences of two numbers are hardly ever equal for two seeds.
#[test]
fn shifts_are_of_each_number() {
    let bytes = file(Shape { dims: 2, ..SHAPE }, |_, _, _, _| 0.0);
    let tile = Tile::from_bytes(&bytes).unwrap();
    let points: Vec<_> = (1..=256).map(|seed| Sampler::pixel(&tile, 1, 2, 0, 3).scramble(seed).draw::<4>()).collect();
    for (a, b) in (0..4).flat_map(|a| (0..a).map(move |b| (a, b))) {
        // Modulo a quarter, the width of a stratum. Of 256 random differences more than 15 repeat for one of the six
        // pairs with probability 3e-9.
        let differences = points.iter().map(|u| ((u[a] - u[b]).rem_euclid(1.0) * 65_536.0) as u32 % 16_384);
        assert!(differences.collect::<HashSet<_>>().len() > 240, "{a}, {b}");
    }
}

#[test]
fn samples_never_repeat() {
    let bytes = ordered(8, 4, false, 11);
    let tile = Tile::from_bytes(&bytes).unwrap();
    for sampler in [Sampler::pixel(&tile, 2, 3, 0, 0), Sampler::pixel(&tile, 4, 5, 0, 0).domain(9).scramble(7)] {
        let points: HashSet<_> = (0..1 << 16).map(|i| sampler.moved(0, 0, i).draw::<2>().map(f32::to_bits)).collect();
        assert_eq!(points.len(), 1 << 16);
        // Nor the last ones.
        let last: HashSet<_> =
            (0..1 << 12).map(|i| sampler.moved(0, 0, u32::MAX - i).draw::<2>().map(f32::to_bits)).collect();
        assert_eq!(last.len(), 1 << 12);
        assert!(last.is_disjoint(&points));
    }
}

/// With a tile of 1 spp, any aligned run of 2^k indices has one point in each elementary interval of area 2^-k.
#[test]
fn what_follows_the_tile_is_a_net() {
    let bytes = noise(Shape { spp: 1, dims: 2, ..SHAPE }, 12);
    let tile = Tile::from_bytes(&bytes).unwrap();
    let bits = 6;
    for pixel in 0..20 {
        let root = Sampler::pixel(&tile, pixel, 3, 0, 0);
        for sampler in [root, root.domain(pixel)] {
            for (first, wide) in [0, 64, 128, 1 << 20].into_iter().flat_map(|first| (0..=bits).map(move |w| (first, w)))
            {
                let mut cells = HashSet::new();
                for index in first..first + (1 << bits) {
                    let [x, y] = sampler.moved(0, 0, index).draw::<2>();
                    cells.insert(((x * (1 << wide) as f32) as u32, (y * (1 << (bits - wide)) as f32) as u32));
                }
                assert_eq!(cells.len(), 1 << bits);
            }
        }
    }
}

/// The sequence that follows a tile's samples is another in every domain and dimension: of a tile whose values are all
/// the same, which shows it alone. With random values each limit fails with probability below 1e-15.
#[test]
fn what_follows_the_tile_is_scrambled() {
    let bytes = file(Shape { spp: 1, dims: 4, ..SHAPE }, |_, _, _, _| 0.0);
    let tile = Tile::from_bytes(&bytes).unwrap();
    for index in [1, 2, 5] {
        let domains = (0..256).map(|key| Sampler::pixel(&tile, 0, 0, 0, index).domain(key).draw::<4>());
        let points: Vec<[u32; 4]> = domains.map(|u| u.map(f32::to_bits)).collect();
        for axis in 0..4 {
            assert!(points.iter().map(|u| u[axis]).collect::<HashSet<_>>().len() > 250, "sample {index}, {axis}");
            let equal = points.iter().filter(|u| u[axis] == u[(axis + 1) % 4]).count();
            assert!(equal < 3, "sample {index}, {axis}: {equal}");
        }
    }
}

/// Tiles that no one should make draw numbers in [0, 1) and nothing worse.
#[test]
fn nonsense_is_harmless() {
    let payload = [0x5a; 64];
    for shape in [
        Shape { size: 0, spp: 0, dims: 0, frames: 0, bits: 0, progressive: false },
        Shape { size: 5, spp: 3, dims: 9, frames: 7, bits: 16, progressive: true },
        Shape { size: u32::MAX, spp: u32::MAX, dims: u32::MAX, frames: u32::MAX, bits: u32::MAX, progressive: false },
        Shape { size: 1024, spp: 256, dims: 8, frames: 256, bits: 16, progressive: true },
    ] {
        let tile = Tile::resume(shape, &payload);
        for index in [0, 1, 2, 255, 256, u32::MAX] {
            let sampler = Sampler::pixel(&tile, u32::MAX, 7, 9, index);
            for sampler in [sampler, sampler.domain(1), sampler.scramble(2)] {
                assert!(sampler.draw::<4>().iter().all(|u| (0.0..1.0).contains(u)));
                assert!(sampler.draw::<1>().iter().all(|u| (0.0..1.0).contains(u)));
            }
        }
    }
}

/// A sampler of any place, by a path through the tree of domains; every other step scrambles.
fn walk<'a>(tile: &'a Tile<'a>, [x, y, frame, index]: [u32; 4], path: &[u32]) -> Sampler<'a> {
    let step =
        |sampler: Sampler<'a>, &key: &u32| if key % 2 == 0 { sampler.domain(key) } else { sampler.scramble(key) };
    path.iter().fold(Sampler::pixel(tile, x, y, frame, index), step)
}

proptest! {
    #![proptest_config(crate::cases(1000, 3))]

    /// x and y modulo `size`, any 32-bit values, negative ones as C converts them; in every domain, frame and
    /// sample, those beyond the tile's too. What is drawn is a multiple of 2^-24 in [0, 1).
    #[test]
    fn tile_draws_wrap(
        shape in shapes(5), place in any::<[u32; 4]>(), turns in any::<[i32; 2]>(), small in any::<bool>(),
        path in prop::collection::vec(any::<u32>(), 0..4), seed in any::<u64>(),
    ) {
        let bytes = noise(shape, seed);
        let tile = Tile::from_bytes(&bytes).unwrap();
        let [x, y, frame, index] = place;
        // The tile's own samples and those that follow.
        let index = if small { index % (2 * shape.spp) } else { index };
        let here = walk(&tile, [x, y, frame, index], &path);
        let turn = |from: u32, turns: i32| from.wrapping_add_signed(turns.wrapping_mul(shape.size as i32));
        let inside = [x % shape.size, y % shape.size];
        let u = here.draw::<4>();
        for [x, y] in [inside, inside.map(|c| c.wrapping_sub(shape.size)), [turn(x, turns[0]), turn(y, turns[1])]] {
            prop_assert_eq!(walk(&tile, [x, y, frame, index], &path), here);
            prop_assert_eq!(walk(&tile, [x, y, frame, index], &path).draw::<4>(), u);
        }
        prop_assert!(u.iter().all(|u| (0.0..1.0).contains(u) && (u * 16_777_216.0).fract() == 0.0), "{:?}", u);
    }

    /// Over the pixels, the sets of a domain's first `spp` samples are those of the tile,
    /// so that the mean of any estimate is exactly the tile's.
    #[test]
    fn domains_are_toroidal_shifts(
        shape in shapes(5),
        frame in any::<u32>(),
        keys in prop::collection::vec(any::<u32>(), 0..3),
        seed in any::<u64>(),
    ) {
        let bytes = noise(shape, seed);
        let tile = Tile::from_bytes(&bytes).unwrap();
        let dims = shape.dims.min(4) as usize;
        let sets = |frame: u32, keys: &[u32]| {
            let set = |pixel: u32| {
                let sampler = Sampler::pixel(&tile, pixel % shape.size, pixel / shape.size, frame, 0);
                let sampler = keys.iter().fold(sampler, |sampler, &key| sampler.domain(key));
                let drawn = |i| sampler.moved(0, 0, i).draw::<4>().map(f32::to_bits)[..dims].to_vec();
                let mut set: Vec<_> = (0..shape.spp).map(drawn).collect();
                set.sort_unstable();
                set
            };
            let mut sets: Vec<_> = (0..shape.size * shape.size).map(set).collect();
            sets.sort_unstable();
            sets
        };
        prop_assert!(sets(frame, &keys) == sets(frame % shape.frames, &[]));
    }

    /// A rectangle of pixels in one call, wherever it lies, is the same bits as single draws.
    #[test]
    fn filling_is_drawing(
        shape in shapes(5), place in any::<[u32; 4]>(), size in (1..6_usize, 1..6_usize, 1..5_usize),
        path in prop::collection::vec(any::<u32>(), 0..3), dims in 1..=4_usize, at_the_end in any::<bool>(),
    ) {
        let bytes = noise(shape, 5);
        let tile = Tile::from_bytes(&bytes).unwrap();
        let [x, y, frame, index] = if at_the_end { place.map(|c| u32::MAX - c % 4) } else { place };
        let (width, height, samples) = size;
        let root = Sampler::pixel(&tile, x, y, frame, index);
        let domains = [(walk(&tile, [x, y, frame, index], &path), dims), (root, 2)];
        let mut u = vec![-1.0; fill_len(domains, width, height, samples).unwrap()];
        fill(domains, width, height, samples, &mut u).unwrap();
        let mut filled = u.chunks(dims + 2);
        for i in 0..height * width * samples {
            let [row, column, sample] = [i / samples / width, i / samples % width, i % samples].map(|k| k as u32);
            let place = [x.wrapping_add(column), y.wrapping_add(row), frame, index.wrapping_add(sample)];
            let own = walk(&tile, place, &path).draw::<4>();
            let expected = [&own[..dims], &walk(&tile, place, &[]).draw::<2>()].concat();
            prop_assert_eq!(filled.next(), Some(&expected[..]));
        }
    }
}
