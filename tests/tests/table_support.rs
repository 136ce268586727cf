//! What the tests of minibatch tables share.

use noisefloor::Error;
use noisefloor::minibatch::Table;
use noisefloor::minibatch::table::{importance_len, saved_items, saved_len, sums_len};
use noisefloor_tests::random::SplitMix64;

/// Where a two-sided z-test is at significance 1e-5.
pub const Z_LIMIT: f64 = 4.42;

/// A table that owns its memory.
pub type Owned = Table<Vec<f32>, Vec<i64>>;
/// A table in slices, whose memory can be looked at afterwards.
pub type Borrowed<'a> = Table<&'a mut [f32], &'a mut [i64]>;

/// Memory for so many items, full of what a table must not read.
pub fn memory(items: u32) -> (Vec<f32>, Vec<i64>) {
    (vec![f32::NAN; importance_len(items)], vec![-1; sums_len(items)])
}

/// A table of these importances, which may all be 0, and this uniform fraction.
pub fn table(importance: &[f32], fraction: f32) -> Owned {
    let items = importance.len() as u32;
    let (q, sums) = memory(items);
    let mut table = match Table::new(q, sums, items, Some(importance)) {
        Err(Error::NoSamples) => {
            let (q, sums) = memory(items);
            let mut table = Table::new(q, sums, items, None).unwrap();
            table.update(&(0..items).collect::<Vec<_>>(), importance, 0.0).unwrap();
            table
        }
        table => table.unwrap(),
    };
    table.set_uniform_fraction(fraction).unwrap();
    table
}

/// The table's bytes.
pub fn saved<I: AsRef<[f32]>, S: AsRef<[i64]>>(table: &Table<I, S>) -> Vec<u8> {
    let mut bytes = vec![0xc3; saved_len(table.items())];
    table.save(&mut bytes).unwrap();
    bytes
}

/// A table loaded from its bytes into memory as large as it has itself: what it draws, and its memory.
pub fn reloaded<I: AsRef<[f32]>, S: AsRef<[i64]>>(table: &Table<I, S>) -> (Owned, Vec<f32>, Vec<i64>) {
    let bytes = saved(table);
    assert_eq!(saved_items(&bytes), Ok(table.items()));
    let capacity = table.capacity();
    let (mut q, mut sums) = memory(capacity);
    Borrowed::load(&mut q, &mut sums, &bytes).unwrap();
    let (owned_q, owned_sums) = memory(capacity);
    (Table::load(owned_q, owned_sums, &bytes).unwrap(), q, sums)
}

/// (1 - d) q / sum q + d / N in f64; uniform where every importance is 0.
pub fn ideal(importance: &[f32], fraction: f32) -> Vec<f64> {
    let (sum, items) = (importance.iter().map(|&q| f64::from(q)).sum::<f64>(), importance.len() as f64);
    let d = if sum > 0.0 { f64::from(fraction) } else { 1.0 };
    importance.iter().map(|&q| (1.0 - d) * f64::from(q) / if sum > 0.0 { sum } else { 1.0 } + d / items).collect()
}

/// exp of a normal number.
pub fn lognormal(items: usize, spread: f64, seed: u64) -> Vec<f32> {
    let mut rng = SplitMix64::new(seed);
    (0..items).map(|_| (spread * rng.normal()).exp() as f32).collect()
}

/// The sets of importances that draws are tested with.
pub fn families(items: usize, seed: u64) -> [(&'static str, Vec<f32>); 5] {
    let mut rng = SplitMix64::new(seed);
    let mut one_hot = vec![0.0; items];
    one_hot[items / 3] = 2.5;
    let wide = (0..items).map(|_| 10f64.powf(40.0 * rng.uniform() - 20.0) as f32).collect();
    // Whole blocks of 16 without importance, and items here and there.
    let mut holes = lognormal(items, 1.0, seed + 1);
    for (i, q) in holes.iter_mut().enumerate() {
        if i / 16 % 3 == 1 || i % 7 == 3 {
            *q = 0.0;
        }
    }
    [
        ("lognormal", lognormal(items, 1.5, seed)),
        ("one-hot", one_hot),
        ("equal", vec![0.3; items]),
        ("1e-20..1e20", wide),
        ("with zeros", holes),
    ]
}
