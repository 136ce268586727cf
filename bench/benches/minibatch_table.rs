//! A training step's sampling, 64 draws and 64 updates, by tables of importances and by their public peers:
//! `cargo bench --package noisefloor-bench --bench minibatch_table`.
//!
//! All methods take turns, a chunk of steps at a time, so that a busy machine slows all alike; figures are medians over the
//! chunks. "Warm" steps follow each other at once; before each "cold" step 64 MB are read, as a training step does.

// Without the archive the C table is a type of no values.
#![cfg_attr(not(archive), allow(unreachable_code, unused_variables))]

use noisefloor::minibatch::{Table, table};
use noisefloor::rng::Rng;
use noisefloor_bench::{c_abi, c_table};
use rand::SeedableRng;
use rand::rngs::SmallRng;
use rand_distr::Distribution;
use rand_distr::weighted::{WeightedAliasIndex, WeightedTreeIndex};
use std::hint::black_box;
use std::time::Instant;

const BATCH: usize = 64;

/// One method's table, and how it makes a step's draws and updates.
trait Method {
    fn name(&self) -> &'static str;
    fn bytes(&self) -> Option<usize>;
    fn draw(&mut self, index: &mut [u32; BATCH], weight: &mut [f32; BATCH]);
    fn update(&mut self, index: &[u32; BATCH], importance: &[f32; BATCH]);
    fn add_epsilon(&mut self) -> bool {
        false
    }
}

struct CTable(c_table::Table, Rng);

impl Method for CTable {
    fn name(&self) -> &'static str {
        "noisefloor, C ABI"
    }
    fn bytes(&self) -> Option<usize> {
        Some(self.0.bytes())
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

impl RustTable {
    fn new(q: &[f32]) -> Self {
        let items = q.len() as u32;
        let memory = (vec![0.0; table::importance_len(items)], vec![0; table::sums_len(items)]);
        RustTable(Table::new(memory.0, memory.1, items, Some(q)).unwrap(), Rng::seed(1))
    }
}

impl Method for RustTable {
    fn name(&self) -> &'static str {
        "noisefloor, Rust, portable"
    }
    fn bytes(&self) -> Option<usize> {
        let items = self.0.items();
        Some(4 * table::importance_len(items) + 8 * table::sums_len(items))
    }
    fn draw(&mut self, index: &mut [u32; BATCH], weight: &mut [f32; BATCH]) {
        self.0.draw(&mut self.1, index, Some(weight)).unwrap();
    }
    fn update(&mut self, index: &[u32; BATCH], importance: &[f32; BATCH]) {
        self.0.update(index, importance, 0.3).unwrap();
    }
    fn add_epsilon(&mut self) -> bool {
        self.0.add_epsilon(1e-3).unwrap();
        true
    }
}

struct Tree(WeightedTreeIndex<f32>, SmallRng);

impl Method for Tree {
    fn name(&self) -> &'static str {
        "rand_distr WeightedTreeIndex"
    }
    fn bytes(&self) -> Option<usize> {
        Some(4 * self.0.len())
    }
    fn draw(&mut self, index: &mut [u32; BATCH], _: &mut [f32; BATCH]) {
        index.iter_mut().for_each(|index| *index = self.0.try_sample(&mut self.1).unwrap() as u32);
    }
    fn update(&mut self, index: &[u32; BATCH], importance: &[f32; BATCH]) {
        for (&index, &importance) in index.iter().zip(importance) {
            self.0.update(index as usize, importance).unwrap();
        }
    }
}

/// The draws of a step are cheap; its update is a new table.
struct Alias(WeightedAliasIndex<f32>, Vec<f32>, SmallRng);

impl Method for Alias {
    fn name(&self) -> &'static str {
        "rand_distr WeightedAliasIndex, rebuilt"
    }
    fn bytes(&self) -> Option<usize> {
        None
    }
    fn draw(&mut self, index: &mut [u32; BATCH], _: &mut [f32; BATCH]) {
        index.iter_mut().for_each(|index| *index = self.0.sample(&mut self.2) as u32);
    }
    fn update(&mut self, index: &[u32; BATCH], importance: &[f32; BATCH]) {
        for (&index, &importance) in index.iter().zip(importance) {
            self.1[index as usize] = importance;
        }
        self.0 = WeightedAliasIndex::new(self.1.clone()).unwrap();
    }
}

/// Times of one method: nanoseconds of a draw and of an update.
#[derive(Default)]
struct Times {
    draw: Vec<f64>,
    update: Vec<f64>,
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// `chunks` chunks of `steps` steps by each method in turn.
fn measure(methods: &mut [(Box<dyn Method>, usize)], chunks: usize, cold: Option<&[u64]>) -> Vec<Times> {
    let mut rng = Rng::seed(2);
    let mut times: Vec<Times> = methods.iter().map(|_| Times::default()).collect();
    for chunk in 0..chunks {
        for ((method, steps), times) in methods.iter_mut().zip(&mut times) {
            let steps = if cold.is_some() { 1 } else { *steps };
            let (mut draw, mut update) = (0.0, 0.0);
            for _ in 0..steps {
                let importance = std::array::from_fn(|_| rng.uniform_f32());
                let (mut index, mut weight) = ([0; BATCH], [0.0; BATCH]);
                if let Some(memory) = cold {
                    black_box(memory.iter().step_by(8).sum::<u64>());
                }
                let start = Instant::now();
                method.draw(black_box(&mut index), &mut weight);
                let drawn = Instant::now();
                // What a step learns is known later: its items have left the caches again.
                if let Some(memory) = cold {
                    black_box(memory.iter().step_by(8).sum::<u64>());
                }
                let updating = Instant::now();
                method.update(black_box(&index), &importance);
                update += updating.elapsed().as_secs_f64();
                draw += (drawn - start).as_secs_f64();
                black_box(&weight);
            }
            // The first chunk finds caches and predictors of other work.
            if chunk > 0 {
                let scale = 1e9 / (steps * BATCH) as f64;
                times.draw.push(draw * scale);
                times.update.push(update * scale);
            }
        }
    }
    times
}

fn main() {
    println!("libnoisefloor.a is {}", c_abi::STATE);
    if !c_abi::LINKED {
        println!("the C functions are skipped: run `cargo xtask library` first");
    }
    let memory = vec![1u64; 8 << 20];
    for items in [60_000u32, 1_000_000, 10_000_000] {
        let mut rng = Rng::seed(3);
        let q: Vec<f32> = (0..items).map(|_| libm::expf(4.0 * rng.uniform_f32() - 2.0)).collect();
        // An alias table is built in milliseconds to seconds: few steps of it.
        let rebuilds = (2_000_000 / items as usize).clamp(1, 20);
        let mut methods: Vec<(Box<dyn Method>, usize)> = Vec::new();
        if c_abi::LINKED {
            methods.push((Box::new(CTable(c_table::Table::new(&q), Rng::seed(1))), 200));
        }
        methods.push((Box::new(RustTable::new(&q)), 200));
        methods.push((Box::new(Tree(WeightedTreeIndex::new(q.clone()).unwrap(), SmallRng::seed_from_u64(1))), 200));
        let alias = WeightedAliasIndex::new(q.clone()).unwrap();
        methods.push((Box::new(Alias(alias, q.clone(), SmallRng::seed_from_u64(1))), rebuilds));
        println!("\n{items} items; ns of a draw / of an update, us of a step of {BATCH} of both; warm, then cold");
        let warm = measure(&mut methods, if items > 1_000_000 { 12 } else { 41 }, None);
        let _ = methods.pop();
        let cold = measure(&mut methods, 101, Some(&memory));
        let mut first = None;
        for (i, mut times) in warm.into_iter().enumerate() {
            let (draw, update) = (median(&mut times.draw), median(&mut times.update));
            let step = (draw + update) * BATCH as f64 / 1000.0;
            let first = *first.get_or_insert(step);
            let (name, bytes) =
                methods.get(i).map_or(("rand_distr WeightedAliasIndex, rebuilt", None), |(method, _)| {
                    (method.name(), method.bytes())
                });
            let bytes = bytes.map_or(String::new(), |bytes| format!("{:.2} B/item", bytes as f64 / f64::from(items)));
            println!("{name:40} {draw:8.1} / {update:10.1}  {step:10.3} us  {:8.2} x  {bytes}", step / first);
        }
        for ((method, _), mut times) in methods.iter().zip(cold) {
            let (draw, update) = (median(&mut times.draw), median(&mut times.update));
            println!("{:40} {draw:8.1} / {update:10.1}  {:10.3} us cold", method.name(), (draw + update) * 0.064);
        }
        for (method, _) in &mut methods {
            let mut nanoseconds: Vec<f64> = (0..21)
                .map(|_| {
                    let start = Instant::now();
                    method.add_epsilon();
                    start.elapsed().as_secs_f64() * 1e9 / f64::from(items)
                })
                .collect();
            if method.add_epsilon() {
                println!("{:40} {:.3} ns per item to add epsilon", method.name(), median(&mut nanoseconds));
            }
        }
    }
}
