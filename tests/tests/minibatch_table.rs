//! Minibatch tables: what they hold, refuse and need; sums that do not drift; saved bytes.

use crate::table_support::{Borrowed, lognormal, memory, reloaded, saved, table};
use noisefloor::Error;
use noisefloor::minibatch::Table;
use noisefloor::minibatch::table::{
    DEFAULT_UNIFORM_FRACTION, Kernel, Portable, Shard, State, allocate, check_importances, importance_len, saved_items,
    saved_len, sums_len,
};
use noisefloor::rng::Rng;
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::tile::crc;

#[test]
fn memory_per_item() {
    for items in [60_000, 1_000_000, 100_000_000] {
        let bytes = 4 * importance_len(items) + 8 * sums_len(items);
        assert!(bytes as f64 <= 4.6 * f64::from(items), "{items}: {bytes}");
    }
    assert_eq!((importance_len(0), sums_len(0), saved_len(0)), (0, 0, 32));
    assert_eq!((importance_len(1), sums_len(1), saved_len(1)), (16, 16, 36));
    assert_eq!((importance_len(257), sums_len(257)), (272, 3 * 16));
    assert_eq!((importance_len(17), saved_len(1000)), (32, 4032));
    let most = 1 << 32;
    assert_eq!(importance_len(u32::MAX), most);
}

#[test]
fn a_new_table() {
    let (q, sums) = memory(100);
    let ones = Table::new(q, sums, 100, None).unwrap();
    assert_eq!((ones.items(), ones.capacity(), ones.total()), (100, 112, 100.0));
    assert_eq!(ones.state().uniform_fraction, DEFAULT_UNIFORM_FRACTION);
    assert!((0..100).all(|item| ones.importance(item) == 1.0 && ones.probability(item) == 0.01));
    assert_eq!((ones.importance(100), ones.probability(100)), (0.0, 0.0));
    let (mut index, mut weight) = ([0; 9], [0.0; 9]);
    ones.draw(&mut Rng::seed(1), &mut index, Some(&mut weight)).unwrap();
    assert!(weight.iter().all(|&w| (w - 1.0).abs() < 1e-6), "{weight:?}");
    // A negative zero is a zero.
    assert!(table(&[1.0, -0.0], 0.0).importance(1).is_sign_positive());
}

/// Updates are f32 arithmetic, in order.
#[test]
fn updates_in_order() {
    let mut table = table(&[1.0, 2.0, 3.0], 0.2);
    table.update(&[1, 1, 0, 1], &[10.0, 20.0, 5.0, 0.1], 0.3).unwrap();
    let mix = |old: f32, new: f32| 0.3 * old + (1.0 - 0.3_f32) * new;
    assert_eq!(table.importance(1), mix(mix(mix(2.0, 10.0), 20.0), 0.1));
    assert_eq!(table.importance(0), mix(1.0, 5.0));
    assert_eq!(table.importance(2), 3.0);
    table.update(&[2, 2], &[7.0, 8.0], 0.0).unwrap();
    assert_eq!(table.importance(2), 8.0);
    table.update(&[2], &[1.0], 1.0).unwrap();
    assert_eq!(table.importance(2), 8.0);
    table.update(&[0, 0], &[f32::MAX; 2], 0.5).unwrap();
    assert!(table.importance(0).is_finite());
    table.update(&[], &[], 0.5).unwrap();
}

/// Sums beyond the range of their integers that would wrap around to numbers within it: five blocks of .9 times the
/// range, also among the first of more changes than go up the tree together.
#[test]
fn sums_do_not_wrap_around() {
    for (way, items) in [80, 80, 80, 80, 2048].into_iter().enumerate() {
        // Room for what is appended: 4 or 90.
        let (q, sums) = memory(items + 90);
        let mut grown = Table::new(q, sums, items, None).unwrap();
        grown.set_uniform_fraction(0.0).unwrap();
        let range = (2f64.powi(62) / grown.state().scale) as f32;
        let index = [&[0, 16, 32, 48, 64], &[1; 60][..]].concat();
        let importance = [&[0.9 * range; 5], &[1.0; 60][..]].concat();
        match way {
            0 => grown.update(&index[..5], &importance[..5], 0.0).unwrap(),
            1 => grown.update(&index, &importance, 0.0).unwrap(),
            2 => grown.add_epsilon(0.9 * range / 16.0).unwrap(),
            3 => grown.append(&[f32::MAX; 4]).unwrap(),
            _ => {
                let large = |item: usize| item < 80 && item.is_multiple_of(16);
                let added: Vec<f32> = (0..90).map(|item| if large(item) { 0.9 * range } else { item as f32 }).collect();
                grown.append(&added).unwrap();
                assert!((0..90).all(|item| grown.importance(items + item) == added[item as usize]));
            }
        }
        let sum: f64 = (0..grown.items()).map(|item| f64::from(grown.importance(item))).sum();
        assert!((grown.total() / sum - 1.0).abs() < 1e-9, "{way}: {} {sum}", grown.total());
        let expected = f64::from(grown.importance(64)) / sum;
        assert!((f64::from(grown.probability(64)) - expected).abs() < 1e-6 * expected + 1e-14, "{way}");
    }
}

/// After random updates over many orders of magnitude the table is, sum by sum, the one that its bytes give.
fn drift(updates: usize, items: u32, spread: f64, seed: u64) {
    let mut rng = SplitMix64::new(seed);
    let values = lognormal(1 << 16, spread, seed);
    let (mut q, mut sums) = memory(items);
    let mut table = Borrowed::new(&mut q, &mut sums, items, None).unwrap();
    let (mut index, mut importance) = ([0; 64], [0.0; 64]);
    for batch in 0..updates / 64 {
        for (index, importance) in index.iter_mut().zip(&mut importance) {
            let bits = rng.next_u64();
            *index = (((bits >> 32) * u64::from(items)) >> 32) as u32;
            *importance = values[bits as usize % values.len()];
        }
        table.update(&index, &importance, if batch % 2 == 0 { 0.0 } else { 0.3 }).unwrap();
    }
    let (fresh, fresh_q, fresh_sums) = reloaded(&table);
    assert_eq!(fresh.total().to_bits(), table.total().to_bits());
    assert_eq!(fresh.state(), table.state());
    let (mut index, mut again) = ([0; 1000], [0; 1000]);
    table.draw(&mut Rng::seed(1), &mut index, None).unwrap();
    fresh.draw(&mut Rng::seed(1), &mut again, None).unwrap();
    assert_eq!(index, again);
    let sum: f64 = q.iter().map(|&q| f64::from(q)).sum();
    assert!((fresh.total() / sum - 1.0).abs() < 1e-5, "{} {sum}", fresh.total());
    assert!(q == fresh_q && sums == fresh_sums);
}

#[test]
fn a_hundred_million_updates_do_not_drift() {
    drift(100_000_000, 60_000, 1.5, 21);
}

#[test]
fn updates_over_many_orders_of_magnitude_do_not_drift() {
    drift(5_000_000, 60_000, 6.0, 22);
    drift(1_000_000, 1000, 15.0, 23);
    drift(1_000_000, 17, 20.0, 24);
}

#[test]
fn bad_input_is_refused() {
    let new = |items: u32, values: Option<&[f32]>| {
        let (q, sums) = memory(items);
        Table::new(q, sums, items, values).map(|table| table.items())
    };
    assert_eq!(new(0, None), Err(Error::Range));
    assert_eq!(new(2, Some(&[1.0])), Err(Error::Length));
    assert_eq!(new(2, Some(&[1.0, -1.0])), Err(Error::Range));
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(new(2, Some(&[1.0, bad])), Err(Error::NotFinite));
    }
    assert_eq!(new(2, Some(&[0.0, -0.0])), Err(Error::NoSamples));
    assert_eq!(Table::new([0.0; 15], [0; 16], 1, None).unwrap_err(), Error::Memory);
    assert_eq!(Table::new([0.0; 16], [0; 15], 1, None).unwrap_err(), Error::Memory);
    assert_eq!(Table::new([0.0; 16], [0; 16], 17, None).unwrap_err(), Error::Memory);

    let state = |scale, items, uniform_fraction| {
        Table::resume([0.0; 16], [0; 16], State { scale, items, uniform_fraction }).map(|table| table.items())
    };
    assert_eq!(state(1.0, 16, 0.5), Ok(16));
    assert_eq!(state(1.0, 17, 0.5), Err(Error::Memory));
    for (scale, items, fraction) in [
        (1.0, 0, 0.5),
        (1.5, 1, 0.5),
        (0.0, 1, 0.5),
        (-1.0, 1, 0.5),
        (f64::NAN, 1, 0.5),
        (2f64.powi(301), 1, 0.5),
        (1.0, 1, 1.5),
        (1.0, 1, f32::NAN),
    ] {
        assert_eq!(state(scale, items, fraction), Err(Error::Range));
    }

    let mut table = table(&[1.0, 0.0, 2.0, 0.0], 0.0);
    let before = saved(&table);
    let mut rng = Rng::seed(5);
    let (mut index, mut weight, mut p) = ([7; 4], [7.0; 4], [7.0; 4]);
    assert_eq!(table.draw(&mut rng, &mut index, Some(&mut weight[..3])), Err(Error::Length));
    assert_eq!(table.draw_stratified(&mut rng, &mut index, Some(&mut weight[..3])), Err(Error::Length));
    assert_eq!(table.draw_distinct(&mut rng, &mut index[..2], Some(&mut weight[..3])), Err(Error::Length));
    assert_eq!(table.draw_distinct(&mut rng, &mut [0; 5], None), Err(Error::Range));
    assert_eq!(table.draw_distinct(&mut rng, &mut index[..3], None), Err(Error::NoSamples));
    assert_eq!(table.probabilities(&[0, 4], &mut p), Err(Error::Range));
    assert_eq!(table.probabilities(&[0, 1], &mut p[..1]), Err(Error::Length));
    for bad in [f32::NAN, f32::INFINITY] {
        assert_eq!(table.update(&[0, 1], &[1.0, bad], 0.0), Err(Error::NotFinite));
        assert_eq!(table.update(&[0, 1], &[1.0, 1.0], bad), Err(Error::NotFinite));
        assert_eq!(table.append(&[1.0, bad]), Err(Error::NotFinite));
        assert_eq!(table.add_epsilon(bad), Err(Error::NotFinite));
        assert_eq!(table.set_uniform_fraction(bad), Err(Error::NotFinite));
    }
    assert_eq!(table.update(&[0, 4], &[1.0, 1.0], 0.0), Err(Error::Range));
    assert_eq!((table.check_items(&[0, 3]), table.check_items(&[4])), (Ok(()), Err(Error::Range)));
    assert_eq!((check_importances(&[0.0, 1.0]), check_importances(&[-1.0])), (Ok(()), Err(Error::Range)));
    assert_eq!(table.update(&[0, 1], &[1.0, -1.0], 0.0), Err(Error::Range));
    assert_eq!(table.update(&[0, 1], &[1.0], 0.0), Err(Error::Length));
    for bad in [-0.1, 1.1] {
        assert_eq!(table.update(&[0, 1], &[1.0, 1.0], bad), Err(Error::Range));
        assert_eq!(table.set_uniform_fraction(bad), Err(Error::Range));
    }
    assert_eq!(table.add_epsilon(-1.0), Err(Error::Range));
    assert_eq!(table.append(&[1.0, -1.0]), Err(Error::Range));
    assert_eq!(table.append(&[1.0; 13]), Err(Error::Memory));
    assert_eq!((table.save(&mut [0; 5]), table.save(&mut [0; 49])), (Err(Error::Length), Err(Error::Length)));
    assert_eq!((index, weight, p), ([7; 4], [7.0; 4], [7.0; 4]));
    assert_eq!(rng, Rng::seed(5));
    assert!(saved(&table) == before);

    // Nothing can be drawn, but by the uniform fraction.
    table.update(&[0, 2], &[0.0, 0.0], 0.0).unwrap();
    assert_eq!(table.draw(&mut rng, &mut index, None), Err(Error::NoSamples));
    assert_eq!(table.draw_stratified(&mut rng, &mut index, None), Err(Error::NoSamples));
    assert_eq!(table.draw_distinct(&mut rng, &mut index, None), Err(Error::NoSamples));
    assert_eq!(table.probabilities(&[0], &mut p), Err(Error::NoSamples));
    assert_eq!((table.probability(0), table.total()), (0.0, 0.0));
    table.set_uniform_fraction(0.01).unwrap();
    table.draw(&mut rng, &mut index, Some(&mut weight)).unwrap();
    assert_eq!((weight, table.probability(3)), ([1.0; 4], 0.25));
}

#[test]
fn bad_shards_are_refused() {
    let shard = |importance, items| Shard { importance, items };
    let mut rng = Rng::seed(1);
    let mut call = |shards: &[Shard], fraction, len| {
        let mut counts = vec![9; len];
        let result = allocate(shards.iter().copied(), fraction, &mut rng, 10, &mut counts);
        assert!(result.is_ok() || counts.iter().all(|&count| count == 9));
        result
    };
    let good = [shard(1.0, 4), shard(0.0, 5)];
    assert_eq!((Shard::sum(good), Shard::sum([])), (Ok(shard(1.0, 9)), Err(Error::NoSamples)));
    assert_eq!(Shard::sum([shard(-1.0, 10)]), Err(Error::Range));
    assert_eq!(Shard::sum([shard(1.0, 4), shard(5.0, 0)]), Err(Error::Range));
    assert_eq!(table(&[1.0, 2.0, 3.0, 4.0], 0.2).shard(), shard(10.0, 4));
    assert_eq!(call(&good, 0.2, 2), Ok(()));
    assert_eq!(call(&good, 0.2, 3), Err(Error::Length));
    assert_eq!(call(&good, 1.2, 2), Err(Error::Range));
    assert_eq!(call(&good, -0.2, 2), Err(Error::Range));
    assert_eq!(call(&good, f32::NAN, 2), Err(Error::NotFinite));
    assert_eq!(call(&[shard(-1.0, 4)], 0.2, 1), Err(Error::Range));
    assert_eq!(call(&[shard(1.0, 1 << 53)], 0.2, 1), Err(Error::Range));
    assert_eq!(call(&[shard(1.0, u64::MAX), shard(1.0, u64::MAX)], 0.2, 2), Err(Error::Range));
    assert_eq!(call(&[shard(f64::NAN, 1)], 0.2, 1), Err(Error::NotFinite));
    assert_eq!(call(&[shard(1e308, 1), shard(1e308, 1)], 0.2, 2), Err(Error::NotFinite));
    assert_eq!(call(&[], 0.2, 0), Err(Error::NoSamples));
    assert_eq!(call(&[shard(0.0, 0)], 0.2, 1), Err(Error::NoSamples));
    assert_eq!(call(&[shard(0.0, 4)], 0.0, 1), Err(Error::NoSamples));

    let own = table(&[1.0; 4], 0.2);
    let (mut index, mut weight) = ([7; 3], [7.0; 3]);
    let mut draw = |all: Shard, weights: usize| {
        let result = own.draw_shard(&all, &mut rng, &mut index, Some(&mut weight[..weights]));
        assert!(result.is_ok() || index == [7; 3] && weight == [7.0; 3]);
        result
    };
    assert_eq!(draw(shard(3.0, 9), 3), Err(Error::Range));
    assert_eq!(draw(shard(9.0, 3), 3), Err(Error::Range));
    assert_eq!(draw(shard(9.0, 1 << 53), 3), Err(Error::Range));
    assert_eq!(draw(shard(f64::INFINITY, 9), 3), Err(Error::NotFinite));
    assert_eq!(draw(shard(9.0, 9), 2), Err(Error::Length));
    assert_eq!(draw(shard(9.0, 9), 3), Ok(()));
    let empty = table(&[0.0; 4], 0.0);
    assert_eq!(empty.draw_shard(&shard(9.0, 9), &mut Rng::seed(1), &mut index, None), Err(Error::NoSamples));
    assert_eq!(empty.draw_shard(&shard(9.0, 9), &mut Rng::seed(1), &mut [], None), Ok(()));
    assert_eq!(empty.draw_shard(&shard(9.0, 9), &mut Rng::seed(1), &mut [], Some(&mut [0.0])), Err(Error::Length));
}

/// Every damaged bit and every other length of a saved table is noticed.
#[test]
fn damaged_bytes_are_refused() {
    let good = saved(&table(&lognormal(40, 1.0, 1), 0.3));
    assert_eq!(saved_items(&good), Ok(40));
    let load = |bytes: &[u8]| {
        let (mut q, mut sums) = (vec![7.0; 48], vec![7; 16]);
        let result = Borrowed::load(&mut q, &mut sums, bytes).map(|table| table.items());
        assert!(result.is_ok() || q.iter().all(|&q| q == 7.0) && sums.iter().all(|&sum| sum == 7));
        result
    };
    assert_eq!(load(&good), Ok(40));
    for bit in 0..8 * good.len() {
        let mut bytes = good.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        let error = load(&bytes).unwrap_err();
        let expected = match bit / 8 {
            0..8 => Error::Foreign,
            8..12 if bit > 64 => Error::Version,
            12..16 => Error::Length,
            _ => Error::Corrupt,
        };
        assert_eq!(error, expected, "bit {bit}");
    }
    for len in 0..good.len() {
        assert_eq!(load(&good[..len]), Err(Error::Length), "{len} bytes");
    }
    assert_eq!(load(&[&good[..], &[0]].concat()), Err(Error::Length));
    let small = Borrowed::load(&mut [0.0; 32], &mut [0; 16], &good).map(|table| table.items());
    assert_eq!(small, Err(Error::Memory));
    assert_eq!((saved_items(&good[..15]), saved_items(b"PK\x03\x04")), (Err(Error::Length), Err(Error::Foreign)));
    // No library has written version 0, as after bit 64, nor a table of no items.
    assert_eq!(load(&[&good[..12], &[0; 4], &good[16..]].concat()), Err(Error::Corrupt));
    // Nor fields that make no sense, though the checksum is right: scales, fractions, importances.
    assert_eq!(load(&sealed(good.clone())), Ok(40));
    let doubles = [(16, 1.5), (16, -1.0), (16, 0.0), (16, f64::NAN)].map(|(at, x): (usize, f64)| (at, x.to_bits(), 8));
    let floats = [(24, 1.5), (24, f32::NAN), (32, -1.0), (36, -0.0), (40, f32::NAN), (44, f32::INFINITY)];
    for (at, bits, len) in doubles.into_iter().chain(floats.map(|(at, x): (usize, f32)| (at, x.to_bits().into(), 4))) {
        let mut bytes = good.clone();
        bytes[at..at + len].copy_from_slice(&bits.to_le_bytes()[..len]);
        assert_eq!(load(&sealed(bytes)), Err(Error::Corrupt), "byte {at}: {bits:x}");
    }
}

/// Puts the checksum right after a deliberate change.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let checksum = crc(bytes[..28].iter().chain(&bytes[32..]).copied());
    bytes[28..32].copy_from_slice(&checksum.to_le_bytes());
    bytes
}

/// Bytes that are whole, at a scale that a table of these importances never has: it draws the same, all the same.
#[test]
fn another_scale_loses_nothing() {
    let importance: Vec<f32> = (0..32).map(|item| if item < 16 { 1e6 } else { 1.0 }).collect();
    let mut bytes = saved(&table(&importance, 0.2));
    for scale in [2f64.powi(-300), 1.0, 2f64.powi(300)] {
        bytes[16..24].copy_from_slice(&scale.to_le_bytes());
        bytes = sealed(bytes);
        let (q, sums) = memory(32);
        let table = Table::load(q, sums, &bytes).unwrap();
        let p = [0, 31].map(|item| f64::from(table.probability(item)));
        let expected = [0, 31].map(|item| 0.8 * f64::from(importance[item]) / 16_000_016.0 + 0.2 / 32.0);
        assert!(p.iter().zip(&expected).all(|(p, e)| (p / e - 1.0).abs() < 1e-5), "{scale:e}: {p:?}, not {expected:?}");
    }
}

/// A sign stands for items that are taken out: none may come in from outside.
#[test]
fn zeros_have_no_sign() {
    let mut table = table(&[1.0, 2.0, 3.0], 0.2);
    table.update(&[0, 1], &[-0.0, -0.0], -0.0).unwrap();
    table.set_uniform_fraction(-0.0).unwrap();
    let signed = [table.importance(0), table.importance(1), table.state().uniform_fraction];
    assert!(signed.iter().all(|zero| zero.is_sign_positive()), "{signed:?}");
    table.set_uniform_fraction(0.2).unwrap();
    let loaded = Borrowed::load(&mut [0.0; 16], &mut [0; 16], &saved(&table)).map(|table| table.items());
    assert_eq!(loaded, Ok(3));
    let mut index = [0; 3];
    table.draw_distinct(&mut Rng::seed(1), &mut index, None).unwrap();
    index.sort_unstable();
    assert_eq!(index, [0, 1, 2]);
}

/// More memory of one kind than of the other is no reason to refuse.
#[test]
fn memory_need_not_match() {
    let made = |importance, sums| Table::new(vec![0.0; importance], vec![0; sums], 1000, None).map(|t| t.capacity());
    let (importance, sums) = (importance_len(1000), sums_len(1000));
    assert_eq!(made(importance, sums), Ok(1008));
    // Sums of one node more than the 63 blocks of 1000 items need are still those of at most 64 blocks.
    assert_eq!(made(2000, sums), Ok(1024));
    assert_eq!(made(importance, 4000), Ok(1008));
    assert_eq!(made(importance, sums - 1), Err(Error::Memory));
    // Behind the items there may be anything: what does not exist has importance 0.
    let mut longer = [[1.0; 16], [5.0; 16]].concat();
    let state = Borrowed::new(&mut longer[..16], &mut [0; 16], 16, None).unwrap().state();
    assert_eq!(Table::resume(&longer[..], &[0; 16][..], state).unwrap().importance(20), 0.0);
}

/// An item or child of no weight is never found, not even at the border between others.
#[test]
fn borders_belong_to_what_has_weight() {
    let mut q = [0.0; 16];
    (q[3], q[4], q[9]) = (1.0, 2.0, 5.0);
    for (u, item) in [(0.0, 4), (0.249, 4), (0.25, 9), (0.874, 9), (0.875, 3), (0.999, 3)] {
        assert_eq!(Portable::find_item(&q, u), (item, 8.0), "{u}");
    }
    let node = [0, 0, 2, 2, 5, 5, 5, 9, 9, 9, 9, 9, 9, 9, 9, 9];
    assert_eq!([0, 1, 2, 4, 5, 8].map(|r| Portable::find_child(&node, r)), [2, 2, 4, 4, 7, 7]);
}

/// A kernel that is named is the one that a table has from the start.
#[test]
fn the_portable_kernel() {
    assert_eq!(Portable::total(&[0.5; 16]), 8.0);
    let seed = || Rng::seed(1);
    let (mut table, mut again) =
        (table(&[1.0, 2.0, 3.0, 4.0], 0.2), table(&[1.0, 2.0, 3.0, 4.0], 0.2).with_kernel::<Portable>());
    let (mut a, mut b) = ([0; 8], [0; 8]);
    table.draw(&mut seed(), &mut a, None).unwrap();
    again.draw(&mut seed(), &mut b, None).unwrap();
    assert_eq!(a, b);
    table.draw_stratified(&mut seed(), &mut a, None).unwrap();
    again.draw_stratified(&mut seed(), &mut b, None).unwrap();
    assert_eq!(a, b);
    table.draw_shard(&table.shard(), &mut seed(), &mut a, None).unwrap();
    again.draw_shard(&again.shard(), &mut seed(), &mut b, None).unwrap();
    assert_eq!(a, b);
    table.draw_distinct(&mut seed(), &mut a[..3], None).unwrap();
    again.draw_distinct(&mut seed(), &mut b[..3], None).unwrap();
    assert_eq!(a, b);
    table.update(&[0], &[5.0], 0.3).unwrap();
    again.update(&[0], &[5.0], 0.3).unwrap();
    table.add_epsilon(0.5).unwrap();
    again.add_epsilon(0.5).unwrap();
    assert_eq!((table.importance(0), table.total()), (again.importance(0), again.total()));
}
