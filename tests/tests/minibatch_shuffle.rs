//! The permutation that is computed one element at a time. Seeds are fixed.

use noisefloor::minibatch::shuffle;
use noisefloor_tests::statistics::{chi_square, wilson_hilferty};
use std::collections::HashSet;

#[test]
fn every_element_once() {
    for items in (1..=300).chain([1023, 1024, 1025, 60_000, 65_537, 1_000_003]) {
        for seed in [0, 1, u64::MAX] {
            let mut seen = vec![false; items as usize];
            for position in 0..items {
                let element = shuffle(seed, items, position) as usize;
                assert!(!seen[element], "{items} items, seed {seed}: {element} twice");
                seen[element] = true;
            }
            let turns = u32::MAX / items;
            assert_eq!(shuffle(seed, items, (turns - 1) * items), shuffle(seed, items, 0));
            if items > 100_000 {
                break;
            }
        }
    }
}

#[test]
fn positions_wrap_around() {
    assert_eq!(shuffle(1, 0, 5), 0);
    assert_eq!(shuffle(3, 10, 13), shuffle(3, 10, 3));
    assert!(shuffle(9, u32::MAX, u32::MAX - 1) < u32::MAX);
}

/// Each bit of the seed makes another order.
#[test]
fn seeds_have_all_their_bits() {
    let order = |seed| (0..60).map(|position| shuffle(seed, 60, position)).collect::<Vec<u32>>();
    let orders: HashSet<Vec<u32>> = (0..64).map(|bit| order(1 << bit)).chain([order(0)]).collect();
    assert_eq!(orders.len(), 65);
}

/// Each element at each position equally often, over 100,000 seeds; the rows and columns of counts have fixed sums, so
/// the statistic has (n - 1)^2 degrees of freedom. At significance 1e-4.
#[test]
fn positions_are_uniform() {
    const SEEDS: u64 = 100_000;
    for n in [2_u32, 3, 4, 5, 6, 7, 8, 9, 12, 16, 17] {
        let mut counts = vec![0.0; (n * n) as usize];
        for seed in 0..SEEDS {
            (0..n).for_each(|position| counts[(position * n + shuffle(seed, n, position)) as usize] += 1.0);
        }
        let expected = SEEDS as f64 / f64::from(n);
        let statistic: f64 = counts.iter().map(|count: &f64| (count - expected).powi(2) / expected).sum();
        let freedom = f64::from((n - 1) * (n - 1));
        let z = wilson_hilferty(statistic, freedom);
        println!("{n}: chi-square {statistic:.1}, z {z:.2}");
        assert!(z < 3.72, "{n} items: z = {z:.2}");
    }
}

/// All orders of few items equally often. At significance 1e-4.
#[test]
fn orders_are_uniform() {
    for n in [3_u32, 4, 5] {
        let orders: u32 = (1..=n).product();
        let mut counts = vec![0.0; (n as usize).pow(n)];
        for seed in 0..600_000 {
            let code = (0..n).fold(0, |code, position| code * n + shuffle(seed, n, position));
            counts[code as usize] += 1.0;
        }
        counts.retain(|&count| count > 0.0);
        assert_eq!(counts.len(), orders as usize);
        let (_, z) = chi_square(&counts, &vec![600_000.0 / f64::from(orders); counts.len()]);
        assert!(z.abs() < 3.89, "{n} items: z = {z:.2}");
    }
}

/// Even and odd permutations equally often: of 2,000 seeds within 5 standard deviations, 22 each.
#[test]
fn half_of_the_orders_are_odd() {
    for items in [2_u32, 11, 15, 16, 31, 32, 63, 64] {
        let is_odd = |seed| {
            let order: Vec<_> = (0..items).map(|position| shuffle(seed, items, position)).collect();
            let before = |k: usize| order[..k].iter().filter(|&&element| element > order[k]).count();
            (0..order.len()).map(before).sum::<usize>() % 2 == 1
        };
        let odd = (0..2000).filter(|&seed| is_odd(seed)).count();
        assert!((890..=1110).contains(&odd), "{items} items: {odd} of 2000");
    }
}
