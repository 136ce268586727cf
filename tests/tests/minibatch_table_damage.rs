//! Tables whose memory has changed under them: whatever its bits, calls return, and what is drawn exists.

use crate::table_support::{Borrowed, memory};
use noisefloor::minibatch::Table;
use noisefloor::minibatch::table::{Shard, State};
use noisefloor::rng::Rng;
use noisefloor_tests::random::SplitMix64;

/// Draws in every way, and then changes the table in every way.
fn use_it(q: &mut [f32], sums: &mut [i64], state: State, seed: u64) {
    let mut table = Borrowed::resume(q, sums, state).unwrap();
    let mut rng = Rng::seed(seed);
    let whole = |table: &Borrowed<'_>| {
        let own = table.shard();
        Shard { importance: 3.0 * own.importance + 1.0, items: 2 * own.items }
    };
    for batch in [1, 70] {
        let check = |way: &str, index: &[u32]| {
            let most = index.iter().max().unwrap();
            assert!(*most < state.items, "{way} drew item {most} of {}, seed {seed}", state.items);
        };
        let (mut index, mut weight) = (vec![u32::MAX; batch], vec![0.0; batch]);
        if table.draw(&mut rng, &mut index, Some(&mut weight)).is_ok() {
            check("draw", &index);
        }
        index.fill(u32::MAX);
        if table.draw_stratified(&mut rng, &mut index, Some(&mut weight)).is_ok() {
            check("draw_stratified", &index);
        }
        index.fill(u32::MAX);
        if table.draw_shard(&whole(&table), &mut rng, &mut index, Some(&mut weight)).is_ok() {
            check("draw_shard", &index);
        }
        index.fill(u32::MAX);
        if table.draw_distinct(&mut rng, &mut index, Some(&mut weight)).is_ok() {
            check("draw_distinct", &index);
        }
    }
    let item = seed as u32 % state.items;
    table.probability(item);
    table.probabilities(&[item, 0], &mut [0.0; 2]).ok();
    table.update(&[item, 0], &[1.0, 2.0], 0.3).ok();
    table.append(&[1.0]).ok();
    table.add_epsilon(0.1).ok();
}

fn fresh(items: u32, fraction: f32, zeros: bool) -> (Vec<f32>, Vec<i64>, State) {
    // Room behind the last item, whose memory no item is in.
    let (mut q, mut sums) = memory(items + 40);
    let importance: Vec<f32> =
        (0..items).map(|i| if zeros && i % 7 == 3 { 0.0 } else { (1 + i % 13) as f32 }).collect();
    let mut table = Table::new(&mut q[..], &mut sums[..], items, Some(&importance)).unwrap();
    table.set_uniform_fraction(fraction).unwrap();
    let state = table.state();
    (q, sums, state)
}

/// Each bit of each word, alone.
#[test]
fn one_bit_of_any_word() {
    for (items, fraction) in [(1, 0.0), (17, 0.2), (300, 0.0)] {
        let (q, sums, state) = fresh(items, fraction, true);
        for word in 0..q.len() {
            for bit in 0..32 {
                let (mut q, mut sums) = (q.clone(), sums.clone());
                q[word] = f32::from_bits(q[word].to_bits() ^ 1 << bit);
                use_it(&mut q, &mut sums, state, (32 * word + bit) as u64);
            }
        }
        for word in 0..sums.len() {
            for bit in 0..64 {
                let (mut q, mut sums) = (q.clone(), sums.clone());
                sums[word] ^= 1 << bit;
                use_it(&mut q, &mut sums, state, (64 * word + bit) as u64);
            }
        }
    }
}

/// A few words, or all of them.
#[test]
fn bits_of_many_words() {
    let mut random = SplitMix64::new(71);
    for case in 0..20_000 {
        let items = [1, 2, 16, 71, 300, 4200][case % 6];
        // The largest is slow.
        if items == 4200 && case % 60 != 5 {
            continue;
        }
        let fraction = [0.0, 0.2, 1.0][case / 6 % 3];
        let (mut q, mut sums, state) = fresh(items, fraction, case % 2 == 0);
        let flips = [1, 2, 5, 40, 3 * (q.len() + sums.len())][case / 18 % 5];
        for _ in 0..flips {
            let bits = random.next_u64();
            let word = (bits >> 32) as usize % (q.len() + sums.len());
            match q.get_mut(word) {
                Some(q) => *q = f32::from_bits(q.to_bits() ^ 1 << (bits % 32)),
                None => sums[word - q.len()] ^= 1 << (bits % 64),
            }
        }
        use_it(&mut q, &mut sums, state, case as u64);
    }
}

/// Words that bits alone seldom make.
#[test]
fn words_of_one_kind() {
    for items in [1, 16, 100, 300] {
        for fraction in [0.0, 0.2, 1.0] {
            for value in [0.0, -0.0, -1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX] {
                for sum in [None, Some(0), Some(-1), Some(1), Some(i64::MIN), Some(i64::MAX)] {
                    let (mut q, mut sums, state) = fresh(items, fraction, false);
                    q.fill(value);
                    sum.inspect(|&sum| sums.fill(sum));
                    use_it(&mut q, &mut sums, state, 5);
                    // The importances as they were, so that all can be drawn that the sums hide.
                    let (mut q, mut sums, state) = fresh(items, fraction, false);
                    sum.inspect(|&sum| sums.fill(sum));
                    use_it(&mut q, &mut sums, state, 6);
                }
            }
        }
    }
}
