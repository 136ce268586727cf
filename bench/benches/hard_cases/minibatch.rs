//! Tables of importances over forty orders of magnitude, and importances of logits that overflow.

use crate::table::Tables;
use noisefloor::minibatch::table::{importance_len, sums_len};
use noisefloor::minibatch::{Table, importance};
use noisefloor::rng::Rng;
use noisefloor_tests::random::SplitMix64;

const GROUP: &str = "tables";
const DRAWS: usize = 10_000;

type Owned = Table<Vec<f32>, Vec<i64>>;

fn table(importances: &[f32], fraction: f32) -> Result<Owned, noisefloor::Error> {
    let items = importances.len() as u32;
    let (importance, sums) = (vec![0.0; importance_len(items)], vec![0; sums_len(items)]);
    let mut table = Table::new(importance, sums, items, Some(importances))?;
    table.set_uniform_fraction(fraction)?;
    Ok(table)
}

pub(crate) fn measure(tables: &mut Tables, items: usize) {
    one_of_many(tables, items);
    magnitudes(tables);
    updates(tables, items);
    for (case, values) in [
        ("an importance is NaN", [1.0, f32::NAN]),
        ("an importance is infinite", [1.0, f32::INFINITY]),
        ("an importance is negative", [1.0, -1.0]),
        ("all importances 0", [0.0, 0.0]),
    ] {
        tables.refused(GROUP, case, table(&values, 0.2));
    }
    logits(tables);
}

fn row(tables: &mut Tables, case: String, outcome: String, error: f64, plain: Option<(&'static str, f64)>) {
    tables.outcome(GROUP, case, outcome, Some(error), plain);
}

/// One item of importance 1, all others 0.
fn one_of_many(tables: &mut Tables, items: usize) {
    let mut importances = vec![0.0; items];
    importances[items / 3] = 1.0;
    let table = table(&importances, 0.0).expect("one importance is positive");
    let (mut index, mut weight) = (vec![0; DRAWS], vec![0.0; DRAWS]);
    table.draw(&mut Rng::seed(1), &mut index, Some(&mut weight)).expect("there is something to draw");
    let others = index.iter().filter(|&&item| item as usize != items / 3).count();
    let expected = 1.0 / items as f64;
    let error = weight.iter().map(|&w| (f64::from(w) / expected - 1.0).abs()).fold(0.0, f64::max);
    let outcome = format!("items of importance 0 drawn {others} times of {DRAWS}");
    row(tables, format!("one of {items} items has importance 1, others 0: its weight"), outcome, error, None);
}

/// 1e-20 to 1e20: the largest relative error of a probability, among items that a draw has any chance of.
fn magnitudes(tables: &mut Tables) {
    const ITEMS: usize = 1000;
    let mut rng = SplitMix64::new(3);
    let values: Vec<f32> = (0..ITEMS).map(|_| 10.0_f64.powf(40.0 * rng.uniform() - 20.0) as f32).collect();
    let total: f64 = values.iter().map(|&q| f64::from(q)).sum();
    let table = table(&values, 0.0).expect("valid importances");
    let exact = |item: usize| f64::from(values[item]) / total;
    let likely = (0..ITEMS).filter(|&item| exact(item) > 1e-9);
    let error = likely.map(|item| (f64::from(table.probability(item as u32)) / exact(item) - 1.0).abs());
    let lost = (0..ITEMS).filter(|&item| table.probability(item as u32) <= 0.0).count();
    let outcome = format!("{lost} of {ITEMS} items lost");
    let case = "importances 1e-20 to 1e20: probabilities above 1e-9".to_owned();
    row(tables, case, outcome, error.fold(0.0, f64::max), None);
}

/// As many updates as items: the relative error of the sum, beside a running `f32` sum of differences.
fn updates(tables: &mut Tables, updates: usize) {
    const ITEMS: usize = 1000;
    let mut rng = SplitMix64::new(4);
    let mut values = vec![1.0_f32; ITEMS];
    let mut table = table(&values, 0.2).expect("valid importances");
    let mut running = ITEMS as f32;
    for step in 0..updates {
        let item = rng.below(ITEMS);
        // The last ones are moderate, so that what the extreme ones left behind shows.
        let spread = if step + 20 * ITEMS < updates { 16.0 } else { 1.0 };
        let value = 10.0_f64.powf(spread * (rng.uniform() - 0.5)) as f32;
        running += value - values[item];
        values[item] = value;
        table.update(&[item as u32], &[value], 0.0).expect("a valid importance");
    }
    let total: f64 = values.iter().map(|&q| f64::from(q)).sum();
    let error = |sum: f64| (sum / total - 1.0).abs();
    let plain = Some(("running sum in f32", error(running.into())));
    row(tables, format!("{updates} updates, 1e-8 to 1e8: the sum"), "accepted".to_owned(), error(table.total()), plain);
}

/// The norm of softmax less the label, beside the formula in `f32`.
fn logits(tables: &mut Tables) {
    let cases: [(&str, &[f32], usize, f64); 4] = [
        ("logits 1e38 and -1e38, the wrong label", &[1e38, -1e38], 1, std::f64::consts::SQRT_2),
        ("logits 1e38, four times", &[1e38; 4], 3, 0.75_f64.sqrt()),
        ("logits 100 and 0, the wrong label", &[100.0, 0.0], 1, std::f64::consts::SQRT_2),
        ("logits 60 and 0, the right label", &[60.0, 0.0], 0, std::f64::consts::SQRT_2 * (-60.0_f64).exp()),
    ];
    for (case, logits, label, expected) in cases {
        let value = f64::from(importance::cross_entropy(logits, label));
        let powers: Vec<f32> = logits.iter().map(|z| z.exp()).collect();
        let sum: f32 = powers.iter().sum();
        let square = |(k, p): (usize, &f32)| (p / sum - f32::from(u8::from(k == label))).powi(2);
        let naive = f64::from(powers.iter().enumerate().map(square).sum::<f32>().sqrt());
        let error = |value: f64| (value / expected - 1.0).abs();
        let outcome = if value.is_finite() { "accepted" } else { "NOT FINITE" };
        let plain = Some(("its formula in f32", error(naive)));
        tables.outcome("importance of cross-entropy", case, outcome, Some(error(value)), plain);
    }
}
