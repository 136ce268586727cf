//! Tables under random operations, against the obvious: a list of importances; and what docs/minibatch.md says of any
//! table and shards.

use crate::table_support::{Borrowed, Owned, ideal, memory, reloaded, saved, table};
use noisefloor::Error;
use noisefloor::minibatch::Table;
use noisefloor::minibatch::table::{Shard, allocate};
use noisefloor::rng::Rng;
use noisefloor_tests::random::SplitMix64;
use proptest::prelude::*;

#[derive(Clone, Debug)]
enum Operation {
    Draw { draws: usize, stratified: bool },
    Distinct { draws: usize },
    Update { items: Vec<(u16, f32)>, momentum: f32 },
    Append(Vec<f32>),
    Epsilon(f32),
    Fraction(f32),
    Reload,
}

fn importance() -> impl Strategy<Value = f32> {
    prop_oneof![
        6 => 0.0_f32..10.0,
        2 => (-44.0_f32..38.0).prop_map(|e| 10f32.powf(e)),
        3 => Just(0.0),
        1 => prop::sample::select(vec![-0.0, 1e-38, 1e38, 1e-45, f32::MIN_POSITIVE, f32::MAX]),
    ]
}

/// Now and then not an importance.
fn any_importance() -> impl Strategy<Value = f32> {
    let bad = prop::sample::select(vec![-1.0, -f32::MIN_POSITIVE, f32::NAN, f32::INFINITY]);
    prop_oneof![400 => importance(), 1 => bad]
}

fn fraction() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => Just(0.2_f32),
        3 => Just(0.0),
        1 => Just(1.0),
        2 => 0.0_f32..1.0,
        1 => Just(1e-12),
        1 => Just(1.5),
        1 => Just(-0.1),
    ]
}

fn operation() -> impl Strategy<Value = Operation> {
    let draws = || prop_oneof![1_usize..5, 60_usize..70, Just(0), 1_usize..300];
    let items = prop::collection::vec((any::<u16>(), any_importance()), 0..150);
    let momentum = prop_oneof![
        3 => Just(0.0_f32),
        1 => Just(-0.0_f32),
        4 => Just(0.3),
        1 => Just(1.0),
        1 => 0.0_f32..1.0,
        1 => Just(1.1),
    ];
    prop_oneof![
        4 => (draws(), any::<bool>()).prop_map(|(draws, stratified)| Operation::Draw { draws, stratified }),
        2 => draws().prop_map(|draws| Operation::Distinct { draws }),
        6 => (items, momentum).prop_map(|(items, momentum)| Operation::Update { items, momentum }),
        2 => prop::collection::vec(any_importance(), 0..80).prop_map(Operation::Append),
        1 => any_importance().prop_map(Operation::Epsilon),
        2 => fraction().prop_map(Operation::Fraction),
        1 => Just(Operation::Reload),
    ]
}

fn start() -> impl Strategy<Value = Vec<f32>> {
    prop_oneof![prop::collection::vec(importance(), 1..20), prop::collection::vec(importance(), 200..700)]
}

struct Model {
    q: Vec<f32>,
    fraction: f32,
}

/// Which error a list of importances is, if any.
fn refused(values: &[f32]) -> Option<Error> {
    if values.iter().any(|q| !q.is_finite()) {
        return Some(Error::NotFinite);
    }
    values.iter().any(|&q| q < 0.0).then_some(Error::Range)
}

impl Model {
    /// What an operation must return; it changes the list unless that is an error.
    fn apply(&mut self, operation: &Operation, capacity: usize) -> Result<(), Error> {
        let positive = self.q.iter().filter(|&&q| q > 0.0).count();
        match operation {
            Operation::Draw { .. } if positive == 0 && self.fraction == 0.0 => return Err(Error::NoSamples),
            Operation::Distinct { draws } if *draws > self.q.len() => return Err(Error::Range),
            Operation::Distinct { draws } if *draws > positive && self.fraction == 0.0 => {
                return Err(Error::NoSamples);
            }
            Operation::Update { items, momentum } => {
                let values: Vec<f32> = items.iter().map(|item| item.1).collect();
                refused(&values).map_or(Ok(()), Err)?;
                if *momentum > 1.0 {
                    return Err(Error::Range);
                }
                for (item, new) in self.items(items) {
                    let old = &mut self.q[item as usize];
                    *old = ((momentum + 0.0) * *old + (1.0 - momentum) * new + 0.0).min(f32::MAX);
                }
            }
            Operation::Append(values) => {
                refused(values).map_or(Ok(()), Err)?;
                if self.q.len() + values.len() > capacity {
                    return Err(Error::Memory);
                }
                self.q.extend(values);
            }
            Operation::Epsilon(epsilon) => {
                refused(&[*epsilon]).map_or(Ok(()), Err)?;
                self.q.iter_mut().for_each(|q| *q = (*q + epsilon).min(f32::MAX));
            }
            Operation::Fraction(fraction) => {
                if !(0.0..=1.0).contains(fraction) {
                    return Err(Error::Range);
                }
                self.fraction = *fraction;
            }
            _ => {}
        }
        Ok(())
    }

    fn items(&self, items: &[(u16, f32)]) -> Vec<(u32, f32)> {
        items.iter().map(|&(item, q)| (u32::from(item) % self.q.len() as u32, q)).collect()
    }
}

/// By how much a probability may differ: the weights of blocks are integers, rounded and not 0.
fn tolerance(table: &Borrowed<'_>, p: f64) -> f64 {
    // The sum must stay above 2^16 for each block: what is below is no excuse.
    let least = f64::from(table.items() / 16 + 1) * 65_536.0;
    let sum = (table.total() * table.state().scale).max(least);
    if table.total() > 0.0 { 2e-7 * p + 2.0 / sum + p * f64::from(table.items()) / 16.0 / sum } else { 1e-7 * p }
}

fn check_draws(table: &Borrowed<'_>, model: &Model, index: &[u32], weight: &[f32]) -> Result<(), TestCaseError> {
    let probability = ideal(&model.q, model.fraction);
    for (&item, &weight) in index.iter().zip(weight) {
        prop_assert!((item as usize) < model.q.len());
        prop_assert!(model.fraction > 0.0 || model.q[item as usize] > 0.0, "item {item} has importance 0");
        let p = 1.0 / (f64::from(weight) * model.q.len() as f64);
        let expected = probability[item as usize];
        prop_assert!((p - expected).abs() <= tolerance(table, expected), "item {item}: {p:e}, not {expected:e}");
    }
    Ok(())
}

fn run(start: &[f32], room: u32, operations: &[Operation]) -> Result<(), TestCaseError> {
    let (mut q, mut sums) = memory(start.len() as u32 + room);
    let first = Table::new(&mut q[..], &mut sums[..], start.len() as u32, Some(start)).map(|table| table.state());
    if start.iter().all(|&q| q == 0.0) {
        prop_assert_eq!(first, Err(Error::NoSamples));
        return Ok(());
    }
    let mut state = first.unwrap();
    let mut model = Model { q: start.to_vec(), fraction: 0.2 };
    let mut rng = Rng::seed(9);
    for operation in operations {
        let (q_before, sums_before, state_before, rng_before) = (q.clone(), sums.clone(), state, rng.clone());
        let mut table = Borrowed::resume(&mut q, &mut sums, state).unwrap();
        let expected = model.apply(operation, table.capacity() as usize);
        let result = match operation {
            Operation::Draw { draws, stratified } => {
                let (mut index, mut weight) = (vec![0; *draws], vec![0.0; *draws]);
                let result = match stratified {
                    true => table.draw_stratified(&mut rng, &mut index, Some(&mut weight)),
                    false => table.draw(&mut rng, &mut index, Some(&mut weight)),
                };
                if result.is_ok() {
                    check_draws(&table, &model, &index, &weight)?;
                }
                result
            }
            Operation::Distinct { draws } => {
                let (mut index, mut weight) = (vec![0; *draws], vec![0.0; *draws]);
                let result = table.draw_distinct(&mut rng, &mut index, Some(&mut weight));
                if result.is_ok() {
                    prop_assert!(index.iter().all(|&item| model.fraction > 0.0 || model.q[item as usize] > 0.0));
                    // By chance 1e-12 the first of two uniform draws gets a weight beyond f32.
                    prop_assert!(weight.iter().all(|weight| *weight > 0.0), "{weight:?}");
                    index.sort_unstable();
                    prop_assert!(index.windows(2).all(|pair| pair[0] < pair[1]), "{index:?}");
                    prop_assert!(index.iter().all(|&item| (item as usize) < model.q.len()));
                }
                result
            }
            Operation::Update { items, momentum } => {
                let (index, values): (Vec<u32>, Vec<f32>) = model.items(items).into_iter().unzip();
                table.update(&index, &values, *momentum)
            }
            Operation::Append(values) => table.append(values),
            Operation::Epsilon(epsilon) => table.add_epsilon(*epsilon),
            Operation::Fraction(fraction) => table.set_uniform_fraction(*fraction),
            Operation::Reload => {
                let (loaded, ..) = reloaded(&table);
                let (mut index, mut again) = ([0; 70], [0; 70]);
                let result = table.draw(&mut Rng::seed(1), &mut index, None);
                prop_assert_eq!(loaded.draw(&mut Rng::seed(1), &mut again, None), result);
                prop_assert_eq!(index, again);
                Ok(())
            }
        };
        prop_assert_eq!(result, expected, "{:?}", operation);

        // The importances are the model's, to the bit; the sums those of a table built afresh.
        let (_, fresh_q, fresh_sums) = reloaded(&table);
        prop_assert_eq!(table.items() as usize, model.q.len());
        for (item, &q) in model.q.iter().enumerate() {
            prop_assert_eq!(table.importance(item as u32).to_bits(), (q + 0.0).to_bits(), "item {}", item);
        }
        let probability = ideal(&model.q, model.fraction);
        let sum: f64 = model.q.iter().map(|&q| f64::from(q)).sum();
        prop_assert!(
            (table.total() - sum).abs() <= sum * tolerance(&table, 1.0),
            "total {:e} {:e}",
            table.total(),
            sum
        );
        if sum > 0.0 || model.fraction > 0.0 {
            for (item, &p) in probability.iter().enumerate().step_by(7) {
                let actual = f64::from(table.probability(item as u32));
                prop_assert!((actual - p).abs() <= tolerance(&table, p) + 1e-44, "item {item}: {actual:e}, not {p:e}");
            }
        }
        prop_assert_eq!(saved(&table).len(), 32 + 4 * model.q.len());
        state = table.state();
        prop_assert_eq!(state.uniform_fraction, model.fraction);
        prop_assert!(q.iter().zip(&fresh_q).all(|(a, b)| a.to_bits() == b.to_bits()));
        prop_assert!(sums == fresh_sums, "sums of {:?}", operation);
        let unchanged = !matches!(
            operation,
            Operation::Update { .. } | Operation::Append(_) | Operation::Epsilon(_) | Operation::Fraction(_)
        );
        if result.is_err() || unchanged {
            prop_assert!(q.iter().zip(&q_before).all(|(a, b)| a.to_bits() == b.to_bits()));
            prop_assert!(sums == sums_before && state == state_before, "{:?} has changed the table", operation);
        }
        if result.is_err() {
            prop_assert_eq!(&rng, &rng_before);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(crate::cases(3000, 61))]

    #[test]
    fn operations_are_those_of_a_list(
        start in start(),
        room in 0_u32..200,
        operations in prop::collection::vec(operation(), 1..25),
    ) {
        run(&start, room, &operations)?;
    }
}

/// From the smallest f32 to the largest, and 0.
fn any_size() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => 0.0_f32..10.0,
        2 => (-45.0_f32..38.5).prop_map(|e| 10f32.powf(e).min(f32::MAX)),
        2 => Just(0.0),
        1 => prop::sample::select(vec![f32::from_bits(1), f32::MIN_POSITIVE, f32::MAX]),
    ]
}

fn valid_fraction() -> impl Strategy<Value = f32> {
    prop_oneof![2 => Just(0.2_f32), 1 => Just(0.0), 1 => Just(1.0), 4 => 0.0_f32..1.0]
}

proptest! {
    #![proptest_config(crate::cases(1000, 3))]

    /// p_i = (1 - d) q_i / sum q + d / N are probabilities, and the weight 1 / (N p_i) is at most 1 / d,
    /// drawn independently or stratified.
    #[test]
    fn probabilities_sum_to_one(
        q in prop::collection::vec(any_size(), 1..400),
        fraction in valid_fraction(),
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

    /// Sums do not depend on the order of updates of different items, and only ratios of importances
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
        let draw = |table: &Owned| {
            let (mut index, mut weight) = ([0; 40], [0.0; 40]);
            table.draw(&mut Rng::seed(seed), &mut index, Some(&mut weight)).unwrap();
            (index, weight)
        };
        prop_assert_eq!(draw(&forward), draw(&backward));
        prop_assert_eq!(draw(&forward), draw(&scaled));
    }

    /// The counts of shards are those of the whole batch, each its share rounded up or down.
    #[test]
    fn shards_share_out_the_batch(
        shards in prop::collection::vec(
            (prop_oneof![4 => 0.0..1e3_f64, 1 => Just(0.0), 1 => 0.0..1e30_f64], 0..1000_u64),
            1..20,
        ),
        fraction in valid_fraction(),
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
}
