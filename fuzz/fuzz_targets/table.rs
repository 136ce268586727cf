//! Any operations on a table of importances: errors or batches that make sense, never a panic; sums without drift.
#![no_main]

use arbitrary::Arbitrary;
use libfuzzer_sys::fuzz_target;
use noisefloor::minibatch::table::{Shard, State, allocate, importance_len, saved_items, saved_len, sums_len};
use noisefloor::minibatch::{Table, shuffle};
use noisefloor::rng::Rng;

#[derive(Arbitrary, Debug)]
enum Operation {
    Draw { draws: u16, stratified: bool },
    Distinct { draws: u16 },
    Update { items: Vec<(u16, f32)>, momentum: f32 },
    Append(Vec<f32>),
    Epsilon(f32),
    Fraction(f32),
    Shards { others: Vec<(f64, u64)>, draws: u16 },
    Save,
    Load(Vec<u8>),
}

#[derive(Arbitrary, Debug)]
struct Input {
    start: Vec<f32>,
    room: u8,
    seed: u64,
    operations: Vec<Operation>,
}

type Owned = Table<Vec<f32>, Vec<i64>>;

fn memory(items: u32) -> (Vec<f32>, Vec<i64>) {
    (vec![f32::NAN; importance_len(items)], vec![-1; sums_len(items)])
}

fn load(bytes: &[u8], capacity: u32) -> (Table<Vec<f32>, Vec<i64>>, Vec<i64>) {
    let (mut q, mut sums) = memory(capacity);
    Table::load(&mut q[..], &mut sums[..], bytes).unwrap();
    let (owned, owned_sums) = memory(capacity);
    (Owned::load(owned, owned_sums, bytes).unwrap(), sums)
}

/// Whatever bits have changed on their own, draws return, and what they draw exists.
fn damage(q: &mut [f32], sums: &mut [i64], state: State, seed: u64) {
    let mut rng = Rng::seed(seed);
    for _ in 0..1 + seed % 16 {
        let (word, bit) = (rng.next_u32() as usize % (q.len() + sums.len()), rng.next_u32());
        match q.get_mut(word) {
            Some(q) => *q = f32::from_bits(q.to_bits() ^ 1 << (bit % 32)),
            None => sums[word - q.len()] ^= 1 << (bit % 64),
        }
    }
    let mut table = Table::resume(q, sums, state).unwrap();
    let all = Shard { importance: 2.0 * table.total(), items: 2 * u64::from(table.items()) };
    for batch in [1, 65] {
        let (mut index, mut weight) = (vec![u32::MAX; batch], vec![0.0; batch]);
        for way in 0..4 {
            let result = match way {
                0 => table.draw(&mut rng, &mut index, Some(&mut weight)),
                1 => table.draw_stratified(&mut rng, &mut index, Some(&mut weight)),
                2 => table.draw_shard(&all, &mut rng, &mut index, Some(&mut weight)),
                _ => table.draw_distinct(&mut rng, &mut index, Some(&mut weight)),
            };
            assert!(result.is_err() || index.iter().all(|&item| item < table.items()), "{way}: {index:?}");
            index.fill(u32::MAX);
        }
    }
}

fuzz_target!(|input: Input| {
    let Ok(items) = u32::try_from(input.start.len()) else { return };
    let (mut q, mut sums) = memory(items + u32::from(input.room));
    let made = Table::new(&mut q[..], &mut sums[..], items, Some(&input.start));
    let Ok(mut state) = made.map(|table| table.state()) else { return };
    let mut model: Vec<f32> = input.start.iter().map(|q| q + 0.0).collect();
    let mut rng = Rng::seed(input.seed);
    for operation in &input.operations {
        let before = (q.clone(), sums.clone(), state);
        let mut table = Table::resume(&mut q[..], &mut sums[..], state).unwrap();
        let fraction = state.uniform_fraction;
        let drawable = |item: u32| fraction > 0.0 || model.get(item as usize).is_some_and(|&q| q > 0.0);
        let mut changes = false;
        let result = match operation {
            Operation::Draw { draws, stratified } => {
                let draws = usize::from(draws % 2048);
                let (mut index, mut weight) = (vec![u32::MAX; draws], vec![-1.0; draws]);
                let result = match stratified {
                    true => table.draw_stratified(&mut rng, &mut index, Some(&mut weight)),
                    false => table.draw(&mut rng, &mut index, Some(&mut weight)),
                };
                if result.is_ok() {
                    assert!(index.iter().all(|&item| item < table.items() && drawable(item)), "{index:?}");
                    assert!(weight.iter().all(|&weight| weight > 0.0), "{weight:?}");
                }
                result
            }
            Operation::Distinct { draws } => {
                let draws = usize::from(draws % 300);
                let (mut index, mut weight) = (vec![u32::MAX; draws], vec![-1.0; draws]);
                let result = table.draw_distinct(&mut rng, &mut index, Some(&mut weight));
                if result.is_ok() {
                    index.sort_unstable();
                    assert!(index.windows(2).all(|pair| pair[0] < pair[1]), "{index:?}");
                    assert!(index.iter().all(|&item| item < table.items() && drawable(item)), "{index:?}");
                    assert!(weight.iter().all(|&weight| weight > 0.0), "{weight:?}");
                }
                result
            }
            Operation::Update { items, momentum } => {
                changes = true;
                // Now and then an item that does not exist.
                let (index, values): (Vec<u32>, Vec<f32>) = items
                    .iter()
                    .map(|&(item, q)| (u32::from(item) % (table.items() + u32::from(item == 0)), q))
                    .unzip();
                let result = table.update(&index, &values, *momentum);
                if result.is_ok() {
                    for (&item, &value) in index.iter().zip(&values) {
                        let old = &mut model[item as usize];
                        *old = (momentum * *old + (1.0 - momentum) * value).min(f32::MAX);
                    }
                }
                result
            }
            Operation::Append(values) => {
                changes = true;
                let result = table.append(values);
                if result.is_ok() {
                    model.extend(values.iter().map(|q| q + 0.0));
                }
                result
            }
            Operation::Epsilon(epsilon) => {
                changes = true;
                let result = table.add_epsilon(*epsilon);
                if result.is_ok() {
                    model.iter_mut().for_each(|q| *q = (*q + epsilon).min(f32::MAX));
                }
                result
            }
            Operation::Fraction(fraction) => {
                changes = true;
                table.set_uniform_fraction(*fraction)
            }
            Operation::Shards { others, draws } => {
                let others = others.iter().take(20).map(|&(importance, items)| Shard { importance, items });
                let shards: Vec<Shard> = others.chain([table.shard()]).collect();
                let mut counts = vec![0; shards.len()];
                let batch = u32::from(draws % 2048);
                let result = allocate(shards.iter().copied(), fraction, &mut rng, batch, &mut counts);
                if result.is_ok() {
                    assert_eq!(counts.iter().sum::<u32>(), batch);
                    let all = Shard::sum(shards.iter().copied()).unwrap();
                    let (mut index, mut weight) = (vec![0; batch as usize], vec![-1.0; batch as usize]);
                    let drawn = table.draw_shard(&all, &mut rng, &mut index, Some(&mut weight));
                    assert!(drawn.is_err() || index.iter().all(|&item| item < table.items() && drawable(item)));
                }
                Ok(())
            }
            Operation::Save => {
                let mut bytes = vec![0; saved_len(table.items())];
                table.save(&mut bytes).unwrap();
                assert_eq!(saved_items(&bytes), Ok(table.items()));
                let (loaded, _) = load(&bytes, table.capacity());
                let (mut index, mut again) = ([0; 70], [0; 70]);
                let result = table.draw(&mut Rng::seed(1), &mut index, None);
                assert_eq!(loaded.draw(&mut Rng::seed(1), &mut again, None), result);
                assert_eq!(index, again);
                Ok(())
            }
            Operation::Load(bytes) => {
                if let Ok(items) = saved_items(bytes) {
                    let (q, sums) = memory(items);
                    if Owned::load(q, sums, bytes).is_ok() {
                        load(bytes, items);
                    }
                }
                Ok(())
            }
        };
        let mut bytes = vec![0; saved_len(table.items())];
        table.save(&mut bytes).unwrap();
        let fresh = load(&bytes, table.capacity()).1;
        assert_eq!(table.items() as usize, model.len());
        for (item, q) in model.iter().enumerate() {
            assert_eq!(table.importance(item as u32).to_bits(), q.to_bits(), "{operation:?}: item {item}");
            assert!((0.0..=1.0).contains(&table.probability(item as u32)), "{operation:?}: item {item}");
        }
        state = table.state();
        assert!(sums == fresh, "{operation:?}: sums");
        if result.is_err() || !changes {
            let same = before.0.iter().zip(&q).all(|(a, b)| a.to_bits() == b.to_bits());
            assert!(same && before.1 == sums && before.2 == state, "{operation:?} has changed the table");
        }
    }
    assert!(shuffle(input.seed, items, input.room.into()) < items);
    damage(&mut q, &mut sums, state, input.seed);
});
