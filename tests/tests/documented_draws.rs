//! What docs/minibatch.md and docs/tiles.md say in words of any table, shard, shuffle and tile, held against random
//! ones. What needs a slow model or statistics is in the other tests of tables and tiles.

use crate::table_support::{saved, table};
use noisefloor::minibatch::shuffle;
use noisefloor::minibatch::table::{Shard, allocate};
use noisefloor::rng::Rng;
use noisefloor::tile::{Sampler, Shape, Tile, fill, fill_len};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::tile::noise;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(3), failure_persistence: None, ..ProptestConfig::default() }
}

/// From the smallest f32 to the largest, and 0.
fn importance() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => 0.0_f32..10.0,
        2 => (-45.0_f32..38.5).prop_map(|e| 10f32.powf(e).min(f32::MAX)),
        2 => Just(0.0),
        1 => prop::sample::select(vec![f32::from_bits(1), f32::MIN_POSITIVE, f32::MAX]),
    ]
}

fn fraction() -> impl Strategy<Value = f32> {
    prop_oneof![2 => Just(0.2_f32), 1 => Just(0.0), 1 => Just(1.0), 4 => 0.0_f32..1.0]
}

proptest! {
    #![proptest_config(cases(1000))]

    /// minibatch.md: p_i = (1 - d) q_i / sum q + d / N are probabilities, and the weight 1 / (N p_i) is at most 1 / d,
    /// drawn independently or stratified.
    #[test]
    fn probabilities_sum_to_one(
        q in prop::collection::vec(importance(), 1..400),
        fraction in fraction(),
        seed in any::<u64>(),
    ) {
        let (table, items) = (table(&q, fraction), q.len());
        let sum: f64 = (0..items).map(|item| f64::from(table.probability(item as u32))).sum();
        let possible = fraction > 0.0 || q.iter().any(|&q| q > 0.0);
        prop_assert!((sum - f64::from(u8::from(possible))).abs() < 1e-6, "{sum}");
        let (mut index, mut weight) = ([0; 70], [0.0; 70]);
        for stratified in [false, true] {
            let drawn = match stratified {
                true => table.draw_stratified(&mut Rng::seed(seed), &mut index, Some(&mut weight)),
                false => table.draw(&mut Rng::seed(seed), &mut index, Some(&mut weight)),
            };
            prop_assert_eq!(drawn.is_ok(), possible);
            for (&item, &weight) in index.iter().zip(&weight).filter(|_| possible) {
                prop_assert!(f64::from(weight) * f64::from(fraction) <= 1.0 + 1e-6, "{} {}", fraction, weight);
                let product = f64::from(weight) * f64::from(table.probability(item)) * items as f64;
                prop_assert!((product - 1.0).abs() < 1e-6 || table.probability(item) < 1e-36, "{}", product);
            }
        }
    }

    /// minibatch.md: sums do not depend on the order of updates of different items, and only ratios of importances
    /// count.
    #[test]
    fn order_and_unit_of_importances_do_not_matter(
        q in prop::collection::vec(prop_oneof![4 => 1e-6_f32..1e6, 1 => Just(0.0)], 2..300),
        new in prop::collection::vec(prop_oneof![4 => 1e-6_f32..1e6, 1 => Just(0.0)], 2..300),
        momentum in 0.0_f32..1.0,
        exponent in -60..60_i32,
        seed in any::<u64>(),
    ) {
        let changed = q.len().min(new.len());
        let mut rng = SplitMix64::new(seed);
        let mut order: Vec<u32> = (0..q.len() as u32).collect();
        order.sort_by_cached_key(|_| rng.next_u64());
        order.truncate(changed);
        let (mut forward, mut backward) = (table(&q, 0.2), table(&q, 0.2));
        let unit = 2f32.powi(exponent);
        let scale = |values: &[f32]| values.iter().map(|q| q * unit).collect::<Vec<f32>>();
        let mut scaled = table(&scale(&q), 0.2);
        forward.update(&order, &new[..changed], momentum).unwrap();
        scaled.update(&order, &scale(&new[..changed]), momentum).unwrap();
        let (order, new): (Vec<u32>, Vec<f32>) = order.iter().zip(&new).rev().map(|(&item, &q)| (item, q)).unzip();
        backward.update(&order, &new, momentum).unwrap();
        prop_assert!(saved(&forward) == saved(&backward));
        let draw = |table: &crate::table_support::Owned| {
            let (mut index, mut weight) = ([0; 40], [0.0; 40]);
            table.draw(&mut Rng::seed(seed), &mut index, Some(&mut weight)).unwrap();
            (index, weight)
        };
        prop_assert_eq!(draw(&forward), draw(&backward));
        prop_assert_eq!(draw(&forward), draw(&scaled));
    }

    /// minibatch.md, shards: the counts are those of the whole batch, each its share rounded up or down.
    #[test]
    fn shards_share_out_the_batch(
        shards in prop::collection::vec(
            (prop_oneof![4 => 0.0..1e3_f64, 1 => Just(0.0), 1 => 0.0..1e30_f64], 0..1000_u64),
            1..20,
        ),
        fraction in fraction(),
        batch in 0..5000_u32,
        seed in any::<u64>(),
    ) {
        let shards: Vec<Shard> = shards.into_iter()
            .map(|(importance, items)| Shard { importance: if items > 0 { importance } else { 0.0 }, items }).collect();
        let mut counts = vec![0; shards.len()];
        if allocate(shards.iter().copied(), fraction, &mut Rng::seed(seed), batch, &mut counts).is_err() {
            let importance: f64 = shards.iter().map(|shard| shard.importance).sum();
            prop_assert!(shards.iter().all(|shard| shard.items == 0) || importance == 0.0 && fraction == 0.0);
            return Ok(());
        }
        prop_assert_eq!(counts.iter().sum::<u32>(), batch);
        let all = Shard::sum(shards.iter().copied()).unwrap();
        let d = if all.importance > 0.0 { f64::from(fraction) } else { 1.0 };
        for (shard, &count) in shards.iter().zip(&counts) {
            let by_importance = if all.importance > 0.0 { shard.importance / all.importance } else { 0.0 };
            let share = f64::from(batch) * ((1.0 - d) * by_importance + d * shard.items as f64 / all.items as f64);
            prop_assert!((f64::from(count) - share).abs() < 1.0 + 1e-6, "{} of {}", count, share);
        }
    }

    /// minibatch.md: the initial epoch visits every item once; positions count modulo the items.
    #[test]
    fn a_shuffle_is_a_permutation(items in 1..600_u32, seed in any::<u64>(), turn in 0..1000_u32) {
        let mut order: Vec<u32> = (0..items).map(|position| shuffle(seed, items, position)).collect();
        prop_assert_eq!(shuffle(seed, items, turn * items), order[0]);
        order.sort_unstable();
        prop_assert!(order.into_iter().eq(0..items));
    }
}

fn shapes() -> impl Strategy<Value = Shape> {
    (0..5_u32, 0..4_u32, 1..=8_u32, 1..4_u32, any::<bool>(), any::<bool>()).prop_map(
        |(size, spp, dims, frames, bits, progressive)| Shape {
            size: 1 << size,
            spp: 1 << spp,
            dims,
            frames,
            bits: if bits { 16 } else { 8 },
            progressive,
        },
    )
}

/// A sampler of any place, by a path through the tree of domains; every other step scrambles.
fn walk<'a>(tile: &'a Tile<'a>, [x, y, frame, index]: [u32; 4], path: &[u32]) -> Sampler<'a> {
    let step =
        |sampler: Sampler<'a>, &key: &u32| if key % 2 == 0 { sampler.domain(key) } else { sampler.scramble(key) };
    path.iter().fold(Sampler::pixel(tile, x, y, frame, index), step)
}

proptest! {
    #![proptest_config(cases(1000))]

    /// tiles.md: x and y modulo `size`, any 32-bit values, negative ones as C converts them; in every domain, frame and
    /// sample, those beyond the tile's too. What is drawn is a multiple of 2^-24 in [0, 1).
    #[test]
    fn tile_draws_wrap(
        shape in shapes(), place in any::<[u32; 4]>(), turns in any::<[i32; 2]>(), small in any::<bool>(),
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
            prop_assert_eq!(walk(&tile, [x, y, frame, index], &path).draw::<4>(), u);
        }
        prop_assert!(u.iter().all(|u| (0.0..1.0).contains(u) && (u * 16_777_216.0).fract() == 0.0), "{:?}", u);
    }

    /// tiles.md, what is unbiased: over the pixels, the sets of a domain's first `spp` samples are those of the tile,
    /// so that the mean of any estimate is exactly the tile's.
    #[test]
    fn domains_are_toroidal_shifts(
        shape in shapes(),
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

    /// tiles.md: a rectangle of pixels in one call, wherever it lies, is the same bits as single draws.
    #[test]
    fn filling_is_drawing(
        shape in shapes(), place in any::<[u32; 4]>(), size in (1..6_usize, 1..6_usize, 1..5_usize),
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
