//! Estimates from weighted batches have the mean they should have, and where theory says so less variance.
//!
//! Seeds are fixed. Each z-test is at significance 1e-5.

use crate::table_support::{Owned, Z_LIMIT, lognormal, table};
use noisefloor::minibatch::table::{Shard, allocate};
use noisefloor::rng::Rng;
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::statistics::Moments;

/// Values about as large as the importances, but for noise.
fn values(importance: &[f32], seed: u64) -> Vec<f64> {
    let mut rng = SplitMix64::new(seed);
    importance.iter().map(|&q| f64::from(q) * (0.5 + rng.uniform()) + rng.uniform()).collect()
}

/// What batches estimate of values: the sum of those that can be drawn over the number of all.
fn mean(values: &[f64], importance: &[f32], fraction: f32) -> f64 {
    let drawn = values.iter().zip(importance).filter(|&(_, &q)| fraction > 0.0 || q > 0.0);
    drawn.map(|(value, _)| value).sum::<f64>() / values.len() as f64
}

fn estimate(index: &[u32], weight: &[f32], values: &[f64]) -> f64 {
    index.iter().zip(weight).map(|(&item, &weight)| f64::from(weight) * values[item as usize]).sum()
}

/// Importances, of some of which the table's are out of date or 0.
fn cases(items: usize) -> [(&'static str, Vec<f32>, f32); 6] {
    let spread = lognormal(items, 1.0, 5);
    let zeros: Vec<f32> = spread.iter().enumerate().map(|(i, &q)| if i % 3 == 0 { 0.0 } else { q }).collect();
    [
        ("lognormal", spread.clone(), 0.0),
        ("lognormal with uniform draws", spread.clone(), 0.2),
        ("zeros", zeros.clone(), 0.5),
        ("zeros, never drawn", zeros, 0.0),
        ("all zero", vec![0.0; items], 0.1),
        ("uniform", spread, 1.0),
    ]
}

#[test]
fn batches_are_unbiased() {
    const BATCH: usize = 24;
    for (number, (name, importance, fraction)) in cases(300).into_iter().enumerate() {
        let table = table(&importance, fraction);
        let values = values(&lognormal(300, 1.0, 5), 6);
        let [mean, whole] = [&values[..], &[1.0; 300]].map(|values| mean(values, &importance, fraction));
        let mut rng = Rng::seed(number as u64);
        let [mut plain, mut stratified, mut weights] = [(); 3].map(|()| Moments::default());
        let (mut index, mut weight) = ([0; BATCH], [0.0; BATCH]);
        for _ in 0..50_000 {
            table.draw(&mut rng, &mut index, Some(&mut weight)).unwrap();
            plain.add(estimate(&index, &weight, &values) / BATCH as f64);
            weights.add(weight.iter().map(|&w| f64::from(w)).sum::<f64>() / BATCH as f64);
            table.draw_stratified(&mut rng, &mut index, Some(&mut weight)).unwrap();
            stratified.add(estimate(&index, &weight, &values) / BATCH as f64);
        }
        for (way, z) in [("draw", plain.z(mean)), ("stratified", stratified.z(mean)), ("weights", weights.z(whole))] {
            assert!(z.abs() < Z_LIMIT, "{name}, {way}: z = {z:.2}");
        }
        println!("{name}: variance {:.4}, stratified {:.4}", plain.variance(), stratified.variance());
        // Stratified estimates are sums of independent terms, none of more variance than the plain one's. 50,000
        // values: the ratio's standard error is .6 % for normal values, 1 % for a kurtosis of 8, so 3 % is three of
        // them at least.
        assert!(stratified.variance() < 1.03 * plain.variance(), "{name}");
    }
}

/// Of sorted classes, each of whole blocks, a draw from each.
#[test]
fn stratified_draws_follow_the_data_set() {
    let table = table(&[1.0; 320], 0.0);
    let (mut rng, mut index) = (Rng::seed(3), [0; 10]);
    for _ in 0..1000 {
        table.draw_stratified(&mut rng, &mut index, None).unwrap();
        assert_eq!(index.map(|item| item / 32), [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]);
    }
}

/// Raj's estimator of a batch without replacement: unbiased, and of at most the variance of one with replacement.
#[test]
fn distinct_batches_are_unbiased() {
    for items in [20, 60] {
        for (number, (name, importance, fraction)) in cases(items).into_iter().enumerate() {
            let values = values(&lognormal(items, 1.0, 5), 6);
            let mean = mean(&values, &importance, fraction);
            let mut table = table(&importance, fraction);
            for batch in [1, 7, items / 2, items] {
                // Items that are never drawn are in no batch of all.
                if batch == items && fraction == 0.0 && importance.contains(&0.0) {
                    continue;
                }
                let mut rng = Rng::seed((100 * batch + number) as u64);
                let (mut index, mut weight) = (vec![0; batch], vec![0.0; batch]);
                let [mut distinct, mut plain] = [(); 2].map(|()| Moments::default());
                for _ in 0..400_000 / items {
                    table.draw_distinct(&mut rng, &mut index, Some(&mut weight)).unwrap();
                    distinct.add(estimate(&index, &weight, &values) / batch as f64);
                    let mut sorted = index.clone();
                    sorted.sort_unstable();
                    assert!(sorted.windows(2).all(|pair| pair[0] < pair[1]), "{name}: an item twice");
                    table.draw(&mut rng, &mut index, Some(&mut weight)).unwrap();
                    plain.add(estimate(&index, &weight, &values) / batch as f64);
                }
                let z = distinct.z(mean);
                assert!(z.abs() < Z_LIMIT, "{name}, {batch} of {items}: z = {z:.2}");
                let ratio = distinct.variance() / plain.variance();
                println!("{name}, {batch} of {items}: z {z:.2}, variance {ratio:.3} of that with replacement");
                // 6,700 values or more: a ratio's standard error is 1.7 % for normal values, 3.2 % for a kurtosis of 8:
                // 1.2 is six of them.
                assert!(ratio < 1.2, "{name}, {batch} of {items}: {ratio}");
                assert!(batch < items / 2 || ratio < 0.9, "{name}, {batch} of {items}: {ratio}");
            }
        }
    }
}

/// Three tables of different sizes drawn as one: the mean over both steps, allocation and draws.
#[test]
fn shards_are_unbiased() {
    const BATCH: u32 = 25;
    let importance = [lognormal(90, 1.0, 1), vec![0.0; 333], lognormal(17, 0.5, 2).iter().map(|q| q * 1e6).collect()];
    for fraction in [0.0, 0.2, 1.0] {
        let tables: Vec<Owned> = importance.iter().map(|q| table(q, fraction)).collect();
        let shards: Vec<Shard> = tables.iter().map(Owned::shard).collect();
        let all = Shard::sum(shards.iter().copied()).unwrap();
        assert_eq!(all.items, 440);
        // Values as large as the importances, but for the third shard's, which is drawn far too often.
        let values = [values(&importance[0], 3), values(&importance[1], 4), values(&[1.0; 17], 5)];
        let mean = mean(&values.concat(), &importance.concat(), fraction);
        let share = shards.iter().map(|shard| {
            let d = f64::from(fraction);
            (1.0 - d) * shard.importance / all.importance + d * shard.items as f64 / 440.0
        });
        let share: Vec<f64> = share.collect();

        let mut common = Rng::seed(77);
        let mut own = [Rng::seed(1), Rng::seed(2), Rng::seed(3)];
        let mut moments = Moments::default();
        let mut frequency = [(); 3].map(|()| Moments::default());
        for _ in 0..60_000 {
            let mut counts = [0; 3];
            allocate(shards.iter().copied(), fraction, &mut common, BATCH, &mut counts).unwrap();
            assert_eq!(counts.iter().sum::<u32>(), BATCH);
            let mut total = 0.0;
            for k in 0..3 {
                let expected = share[k] * f64::from(BATCH);
                assert!((f64::from(counts[k]) - expected).abs() < 1.0 + 1e-9, "{counts:?} {expected}");
                frequency[k].add(f64::from(counts[k]));
                let (mut index, mut weight) = (vec![0; counts[k] as usize], vec![0.0; counts[k] as usize]);
                // Also where there is nothing to draw, and nothing is asked for.
                tables[k].draw_shard(&all, &mut own[k], &mut index, Some(&mut weight)).unwrap();
                total += estimate(&index, &weight, &values[k]);
            }
            moments.add(total / f64::from(BATCH));
        }
        for (k, frequency) in frequency.iter().enumerate() {
            let expected = share[k] * f64::from(BATCH);
            let z = if frequency.variance() > 0.0 { frequency.z(expected) } else { 0.0 };
            assert!(z.abs() < Z_LIMIT, "fraction {fraction}, shard {k}: {} {expected}", frequency.mean());
        }
        // With a share of 1e-8 the first shard is hardly ever drawn: with fraction 0 only its parts' weights can be
        // checked.
        if fraction > 0.0 {
            let z = moments.z(mean);
            println!("fraction {fraction}: {} {mean}, z {z:.2}", moments.mean());
            assert!(z.abs() < Z_LIMIT, "fraction {fraction}: z = {z:.2}");
        }
    }
}

/// One shard alone is the table itself, and what two shards draw has the weights of the table of both.
#[test]
fn shards_have_the_weights_of_the_whole() {
    let whole = lognormal(500, 1.0, 8);
    for fraction in [0.0, 0.2] {
        let both = table(&whole, fraction);
        let parts = [table(&whole[..100], fraction), table(&whole[100..], fraction)];
        let all = Shard::sum(parts.iter().map(Owned::shard)).unwrap();
        for (part, first) in parts.iter().zip([0, 100]) {
            let (mut index, mut weight) = ([0; 200], [0.0; 200]);
            part.draw_shard(&all, &mut Rng::seed(4), &mut index, Some(&mut weight)).unwrap();
            for (&item, &weight) in index.iter().zip(&weight) {
                let p = f64::from(both.probability(first + item));
                assert!((f64::from(weight) * 500.0 * p - 1.0).abs() < 3e-7);
            }
        }
        let (mut index, mut weight, mut again, mut same) = ([0; 99], [0.0; 99], [0; 99], [0.0; 99]);
        both.draw(&mut Rng::seed(4), &mut index, Some(&mut weight)).unwrap();
        both.draw_shard(&both.shard(), &mut Rng::seed(4), &mut again, Some(&mut same)).unwrap();
        assert_eq!(index, again);
        assert!(weight.iter().zip(&same).all(|(a, b)| (a / b - 1.0).abs() < 3e-7));
    }
}
