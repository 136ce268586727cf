//! The tables that are compared, each with its generator.

use noisefloor::minibatch::{Table, table};
use noisefloor::rng::Rng;
use noisefloor_bench::{c_abi, c_table};
use rand::SeedableRng;
use rand::rngs::SmallRng;
use rand_distr::Distribution;
use rand_distr::weighted::{WeightedAliasIndex, WeightedTreeIndex};

/// Draws of a step, and updates.
pub(crate) const BATCH: usize = 64;

/// One method's table, and how it makes a step's draws and updates.
pub(crate) trait Method {
    fn name(&self) -> &'static str;
    fn bytes(&self) -> usize;
    fn draw(&mut self, index: &mut [u32; BATCH], weight: &mut [f32; BATCH]);
    fn update(&mut self, index: &[u32; BATCH], importance: &[f32; BATCH]);
    /// An update takes milliseconds.
    fn updates_slowly(&self) -> bool {
        false
    }
    /// False: it cannot but be made anew.
    fn add_epsilon(&mut self) -> bool {
        false
    }
}

/// The methods that update in place, for items of these importances: those of this library first.
pub(crate) fn updated(q: &[f32]) -> Vec<Box<dyn Method>> {
    let mut methods: Vec<Box<dyn Method>> = Vec::new();
    if c_abi::LINKED {
        methods.push(Box::new(CTable(c_table::Table::new(q), Rng::seed(1))));
    }
    methods.push(Box::new(RustTable(rust_table(q), Rng::seed(1))));
    methods.push(Box::new(Tree(tree(q), SmallRng::seed_from_u64(1))));
    methods
}

/// The method that is made anew at each update.
pub(crate) fn rebuilt(q: &[f32]) -> Box<dyn Method> {
    let table = WeightedAliasIndex::new(q.to_vec()).expect("valid weights");
    Box::new(Alias(table, q.to_vec(), SmallRng::seed_from_u64(1)))
}

pub(crate) fn rust_table(q: &[f32]) -> Table<Vec<f32>, Vec<i64>> {
    let items = q.len() as u32;
    let memory = (vec![0.0; table::importance_len(items)], vec![0; table::sums_len(items)]);
    Table::new(memory.0, memory.1, items, Some(q)).expect("valid importances")
}

pub(crate) fn tree(q: &[f32]) -> WeightedTreeIndex<f32> {
    WeightedTreeIndex::new(q).expect("valid weights")
}

struct CTable(c_table::Table, Rng);

impl Method for CTable {
    fn name(&self) -> &'static str {
        "nf_table"
    }
    fn bytes(&self) -> usize {
        self.0.bytes()
    }
    fn draw(&mut self, index: &mut [u32; BATCH], weight: &mut [f32; BATCH]) {
        self.0.draw(&mut self.1, index, weight);
    }
    fn update(&mut self, index: &[u32; BATCH], importance: &[f32; BATCH]) {
        self.0.update(index, importance, 0.3);
    }
    fn add_epsilon(&mut self) -> bool {
        self.0.add_epsilon(1e-3);
        true
    }
}

struct RustTable(Table<Vec<f32>, Vec<i64>>, Rng);

impl Method for RustTable {
    fn name(&self) -> &'static str {
        "Table in Rust"
    }
    fn bytes(&self) -> usize {
        let items = self.0.items();
        4 * table::importance_len(items) + 8 * table::sums_len(items)
    }
    fn draw(&mut self, index: &mut [u32; BATCH], weight: &mut [f32; BATCH]) {
        self.0.draw(&mut self.1, index, Some(weight)).expect("a batch");
    }
    fn update(&mut self, index: &[u32; BATCH], importance: &[f32; BATCH]) {
        self.0.update(index, importance, 0.3).expect("valid importances");
    }
    fn add_epsilon(&mut self) -> bool {
        self.0.add_epsilon(1e-3).expect("a valid epsilon");
        true
    }
}

struct Tree(WeightedTreeIndex<f32>, SmallRng);

impl Method for Tree {
    fn name(&self) -> &'static str {
        "WeightedTreeIndex"
    }
    fn bytes(&self) -> usize {
        // One sum for each item.
        4 * self.0.len()
    }
    fn draw(&mut self, index: &mut [u32; BATCH], _: &mut [f32; BATCH]) {
        index.iter_mut().for_each(|index| *index = self.0.try_sample(&mut self.1).expect("a positive sum") as u32);
    }
    fn update(&mut self, index: &[u32; BATCH], importance: &[f32; BATCH]) {
        for (&index, &importance) in index.iter().zip(importance) {
            self.0.update(index as usize, importance).expect("a valid weight");
        }
    }
}

/// The draws of a step are cheap; its update is a new table.
struct Alias(WeightedAliasIndex<f32>, Vec<f32>, SmallRng);

impl Method for Alias {
    fn name(&self) -> &'static str {
        "alias table rebuilt"
    }
    fn bytes(&self) -> usize {
        // An index and a probability for each item, and the weight that the next table needs.
        12 * self.1.len()
    }
    fn draw(&mut self, index: &mut [u32; BATCH], _: &mut [f32; BATCH]) {
        index.iter_mut().for_each(|index| *index = self.0.sample(&mut self.2) as u32);
    }
    fn updates_slowly(&self) -> bool {
        self.1.len() > 1000
    }
    fn update(&mut self, index: &[u32; BATCH], importance: &[f32; BATCH]) {
        for (&index, &importance) in index.iter().zip(importance) {
            self.1[index as usize] = importance;
        }
        self.0 = WeightedAliasIndex::new(self.1.clone()).expect("valid weights");
    }
}
