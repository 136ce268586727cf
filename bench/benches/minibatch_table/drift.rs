//! What many updates do to a table: against one made of the final importances, and against these importances in f64.

use crate::methods::{BATCH, tree};
use noisefloor::minibatch::{Table, table};
use noisefloor::rng::Rng;

pub(crate) const ITEMS: u32 = 100_000;

/// One method's state after the updates.
pub(crate) struct Drift {
    pub(crate) method: &'static str,
    /// Numbers that the table keeps, or gives back, and that are other than those of a table newly made of the same
    /// importances; and how many were compared.
    pub(crate) changed: usize,
    pub(crate) compared: usize,
    /// Items of importance 0 that can be drawn.
    pub(crate) risen: usize,
    /// Items with an importance that cannot be drawn.
    pub(crate) lost: usize,
    /// The largest relative error of an item's probability.
    pub(crate) error: f64,
}

/// Both tables after the same `updates` of random items, an eighth of them to 0.
pub(crate) fn measure(updates: u64) -> [Drift; 2] {
    let mut rng = Rng::seed(4);
    let mut q: Vec<f32> = (0..ITEMS).map(|_| importance(&mut rng)).collect();
    let (mut values, mut sums) = (vec![0.0; table::importance_len(ITEMS)], vec![0; table::sums_len(ITEMS)]);
    let mut ours = Table::new(&mut values[..], &mut sums[..], ITEMS, Some(&q)).expect("valid importances");
    // Without the uniform mixture: what the importances alone make of the probabilities.
    ours.set_uniform_fraction(0.0).expect("a fraction");
    let mut theirs = tree(&q);
    for _ in 0..updates.div_ceil(BATCH as u64) {
        let index: [u32; BATCH] =
            std::array::from_fn(|_| ((u64::from(rng.next_u32()) * u64::from(ITEMS)) >> 32) as u32);
        let value: [f32; BATCH] = std::array::from_fn(|_| importance(&mut rng));
        for (&item, &value) in index.iter().zip(&value) {
            q[item as usize] = value;
            theirs.update(item as usize, value).expect("a valid weight");
        }
        ours.update(&index, &value, 0.0).expect("valid importances");
    }

    let probability: Vec<f64> = (0..ITEMS).map(|item| f64::from(ours.probability(item))).collect();
    // To save leaves the sums out; to load makes them anew.
    let mut saved = vec![0; table::saved_len(ITEMS)];
    ours.save(&mut saved).expect("the length that was asked for");
    let (mut new_values, mut new_sums) = (vec![0.0; values.len()], vec![0; sums.len()]);
    Table::load(&mut new_values[..], &mut new_sums[..], &saved).expect("an undamaged table");
    let changed = sums.iter().zip(&new_sums).filter(|(old, new)| old != new).count();
    let ours = compare("nf_table", (changed, sums.len()), &q, &probability);

    let new = tree(&q);
    let weight = |item: u32| theirs.get(item as usize);
    let changed = (0..ITEMS).filter(|&item| weight(item) != new.get(item as usize)).count();
    let total: f64 = (0..ITEMS).map(|item| f64::from(weight(item))).sum();
    let probability: Vec<f64> = (0..ITEMS).map(|item| f64::from(weight(item)) / total).collect();
    [ours, compare("WeightedTreeIndex", (changed, ITEMS as usize), &q, &probability)]
}

/// 0 with probability 1/8, else of a size between exp(-2) and exp(2).
fn importance(rng: &mut Rng) -> f32 {
    if rng.uniform_f32() < 0.125 { 0.0 } else { libm::expf(4.0 * rng.uniform_f32() - 2.0) }
}

fn compare(method: &'static str, (changed, compared): (usize, usize), q: &[f32], probability: &[f64]) -> Drift {
    let total: f64 = q.iter().map(|&q| f64::from(q)).sum();
    let pairs = || q.iter().map(|&q| f64::from(q) / total).zip(probability.iter().copied());
    Drift {
        method,
        changed,
        compared,
        risen: pairs().filter(|&(exact, p)| exact == 0.0 && p > 0.0).count(),
        lost: pairs().filter(|&(exact, p)| exact > 0.0 && p <= 0.0).count(),
        error: pairs().filter(|&(exact, _)| exact > 0.0).map(|(exact, p)| (p / exact - 1.0).abs()).fold(0.0, f64::max),
    }
}
