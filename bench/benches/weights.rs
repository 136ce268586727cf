//! Weights that are needed once for each sample: of multiple importance sampling's heuristics, and what the optimal
//! weights add up; and draws and updates of a table of importances, through criterion. Ids are numbers of techniques,
//! or of items.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use noisefloor::minibatch::{Table, table};
use noisefloor::mis::{self, OptimalMis, Solver};
use noisefloor::rng::Rng;
use std::hint::black_box;
use std::time::Duration;

const BATCH: usize = 64;

fn group<'a>(
    criterion: &'a mut Criterion,
    name: &str,
    elements: usize,
) -> criterion::BenchmarkGroup<'a, criterion::measurement::WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.sample_size(30).warm_up_time(Duration::from_millis(100)).measurement_time(Duration::from_millis(500));
    group.throughput(Throughput::Elements(elements as u64));
    group
}

fn heuristics(criterion: &mut Criterion) {
    let mut rng = Rng::seed(1);
    for techniques in [2, 8] {
        let pdf: Vec<f32> = (0..techniques).map(|_| rng.uniform_f32() + 0.1).collect();
        let counts = vec![4_u32; techniques];
        let mut group = group(criterion, &format!("mis, {techniques} techniques"), 1);
        group.bench_function("balance", |bencher| bencher.iter(|| mis::balance(black_box(&pdf), &counts, 0)));
        group.bench_function("power", |bencher| bencher.iter(|| mis::power(black_box(&pdf), &counts, 0, 2.0)));
        group.bench_function("cutoff", |bencher| bencher.iter(|| mis::cutoff(black_box(&pdf), &counts, 0, 0.1)));
        group.bench_function("maximum", |bencher| bencher.iter(|| mis::maximum(black_box(&pdf), &counts, 0)));
        let memory = vec![0.0_f64; mis::len(techniques, 1)];
        let mut sums = OptimalMis::new(memory, &counts, 1).expect("valid counts");
        group.bench_function("optimal, add", |bencher| bencher.iter(|| sums.add(0, black_box(&pdf), &[0.5])));
        let mut estimate = [0.0];
        group.bench_function("optimal, solve", |bencher| bencher.iter(|| sums.solve(Solver::default(), &mut estimate)));
    }
}

fn tables(criterion: &mut Criterion) {
    for items in [60_000_u32, 1_000_000] {
        let mut rng = Rng::seed(2);
        let q: Vec<f32> = (0..items).map(|_| rng.uniform_f32() + 0.1).collect();
        let memory = (vec![0.0; table::importance_len(items)], vec![0; table::sums_len(items)]);
        let mut table = Table::new(memory.0, memory.1, items, Some(&q)).expect("valid importances");
        let (mut index, mut weight) = ([0; BATCH], [0.0; BATCH]);
        let mut group = group(criterion, &format!("table, {items} items"), BATCH);
        group.bench_function("Rust/draw", |bencher| {
            bencher.iter(|| table.draw(&mut rng, black_box(&mut index), Some(&mut weight)));
        });
        let importance: [f32; BATCH] = std::array::from_fn(|i| q[i]);
        group.bench_function("Rust/update", |bencher| {
            bencher.iter(|| table.update(black_box(&index), &importance, 0.3));
        });
    }
}

criterion_group!(benches, heuristics, tables);
criterion_main!(benches);
