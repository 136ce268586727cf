//! How often a table draws each item, and with which weight, against the ideal probabilities in f64.
//!
//! Seeds are fixed. Each chi-square test has 1e7 draws, with few items 1e6, and is at significance 1e-4; stratified
//! draws, which vary less, are tested for too much only.

use crate::table_support::{families, ideal, table};
use noisefloor::rng::Rng;
use noisefloor_tests::statistics::chi_square;

const DRAWS: usize = 10_000_000;
const BATCH: usize = 1000;
/// Bins are joined until this many draws are expected in each.
const EXPECTED: f64 = 50.0;

/// Neighbouring bins, joined.
fn pooled(observed: &[u32], probability: &[f64], draws: usize) -> (Vec<f64>, Vec<f64>) {
    let (mut counts, mut expected) = (vec![0.0], vec![0.0]);
    for (&count, p) in observed.iter().zip(probability) {
        if *expected.last().unwrap() >= EXPECTED {
            counts.push(0.0);
            expected.push(0.0);
        }
        *counts.last_mut().unwrap() += f64::from(count);
        *expected.last_mut().unwrap() += p * draws as f64;
    }
    if counts.len() > 1 && *expected.last().unwrap() < EXPECTED {
        let (count, more) = (counts.pop().unwrap(), expected.pop().unwrap());
        *counts.last_mut().unwrap() += count;
        *expected.last_mut().unwrap() += more;
    }
    (counts, expected)
}

fn check(draws: usize, items: usize, fraction: f32, stratified: bool) {
    for (number, (name, importance)) in families(items, 11).into_iter().enumerate() {
        let name = format!("{name}, {items} items, fraction {fraction}, stratified {stratified}");
        let table = table(&importance, fraction);
        let probability = ideal(&importance, fraction);
        let sum: f64 = importance.iter().map(|&q| f64::from(q)).sum();
        assert!((table.total() / sum - 1.0).abs() < 1e-9, "{name}: total {} {sum}", table.total());
        for (item, p) in probability.iter().enumerate() {
            let actual = f64::from(table.probability(item as u32));
            assert!((actual - p).abs() <= 1e-7 * p + 4e-15, "{name}: item {item}, {actual:e} {p:e}");
        }
        let mut rng = Rng::seed(100 * items as u64 + number as u64);
        let mut counts = vec![0u32; items];
        let (mut index, mut weight) = ([0; BATCH], [0.0; BATCH]);
        for _ in 0..draws / BATCH {
            match stratified {
                false => table.draw(&mut rng, &mut index, Some(&mut weight)).unwrap(),
                true => table.draw_stratified(&mut rng, &mut index, Some(&mut weight)).unwrap(),
            }
            for (&item, &weight) in index.iter().zip(&weight) {
                counts[item as usize] += 1;
                let p = probability[item as usize];
                let error = f64::from(weight) * items as f64 * p - 1.0;
                // A rounding of f32, and of the block's weight.
                assert!(error.abs() < 1e-7 + 4e-15 / p, "{name}: item {item} has weight {weight}, off by {error:e}");
            }
        }
        if fraction == 0.0 {
            assert!(counts.iter().zip(&importance).all(|(&count, &q)| q > 0.0 || count == 0), "{name}: drew a zero");
        }
        let (observed, expected) = pooled(&counts, &probability, draws);
        if observed.len() == 1 {
            assert_eq!(observed[0], draws as f64, "{name}");
            continue;
        }
        let (statistic, z) = chi_square(&observed, &expected);
        println!("{name}: {} bins, chi-square {statistic:.0}, z {z:.2}", observed.len());
        assert!(if stratified { z < 3.72 } else { z.abs() < 3.89 }, "{name}: z = {z:.2}");
        let bins = observed.len() as f64;
        for (number, (o, e)) in observed.iter().zip(&expected).enumerate() {
            // Each bin alone: binomial, far from 0, at significance 1e-6 / bins or so.
            let z = (o - e) / (e * (1.0 - e / draws as f64)).sqrt();
            assert!(z.abs() < 5.0 + bins.log10() / 2.0, "{name}: bin {number}, {o} draws, {e:.1} expected, z = {z:.2}");
        }
    }
}

#[test]
fn thousand_items() {
    check(DRAWS, 1000, 0.0, false);
    check(DRAWS, 1003, 0.2, false);
}

#[test]
fn thousand_items_stratified() {
    check(DRAWS, 1000, 0.0, true);
    check(DRAWS, 1003, 0.2, true);
}

#[test]
fn sixty_thousand_items() {
    check(DRAWS, 60_000, 0.0, false);
    check(DRAWS, 59_999, 0.2, false);
}

#[test]
fn sixty_thousand_items_stratified() {
    check(DRAWS, 60_000, 0.0, true);
    check(DRAWS, 59_999, 0.2, true);
}

/// Few items, each of them tested: the last is as likely as the others.
#[test]
fn few_items() {
    for items in [1, 2, 3, 20, 100] {
        for (fraction, stratified) in [(0.0, false), (0.2, false), (1.0, false), (1.0, true)] {
            check(DRAWS / 10, items, fraction, stratified);
        }
    }
}

/// In a stratified batch an item comes B p times, give or take less than two for each of the two ways to it.
#[test]
fn stratified_batches_hold_what_they_should() {
    for (name, importance) in families(1000, 13) {
        let table = table(&importance, 0.2);
        let probability = ideal(&importance, 0.2);
        let mut rng = Rng::seed(3);
        for batch in [1, 10, 640, 5000] {
            let mut index = vec![0; batch];
            table.draw_stratified(&mut rng, &mut index, None).unwrap();
            let mut counts = vec![0.0; importance.len()];
            index.iter().for_each(|&item| counts[item as usize] += 1.0);
            for (item, (count, p)) in counts.iter().zip(&probability).enumerate() {
                let expected = p * batch as f64;
                // An interval of length x meets at most x + 2 parts and holds at least x - 2 of them.
                assert!((count - expected).abs() < 4.0, "{name}: {batch} draws, item {item}: {count} {expected}");
            }
        }
    }
}
