//! Optimal MIS gradients from explicit per-item gradients: time per parameter, and bytes of gradient per second,
//! against adding up the same matrix and against the two passes that the library makes over it: a check that all is
//! finite, and sums over samples. Throughput is in bytes of the matrix, so that criterion's "GiB/s" compare. 64 samples
//! x 100,000 parameters of f32 are 25.6 MB.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use noisefloor::minibatch::{Batch, Gradient, gradient_len, weights};
use noisefloor::mis::Solver;
use noisefloor::rng::Rng;
use noisefloor_bench::c_abi;
use noisefloor_bench::c_gradient::{self, Inputs};
use std::hint::black_box;
use std::time::Duration;

const BATCH: usize = 64;
const PARAMETERS: usize = 100_000;
const ITEMS: u32 = 60_000;

fn inputs(techniques: usize) -> Inputs {
    let mut rng = Rng::seed(1);
    let mut draw = |len: usize| (0..len).map(|_| rng.uniform_f32() + 0.01).collect::<Vec<f32>>();
    Inputs {
        techniques,
        parameters: PARAMETERS,
        pdf: draw(BATCH * techniques).iter().map(|p| p / ITEMS as f32).collect(),
        technique: (0..BATCH).map(|s| (s % techniques) as u32).collect(),
        gradient: draw(BATCH * PARAMETERS),
    }
}

/// Eight sums, so that additions do not wait for each other: limited by the memory.
fn memory_sum(values: &[f32]) -> f32 {
    let mut sums = [0.0_f32; 64];
    for chunk in values.as_chunks::<64>().0 {
        sums.iter_mut().zip(chunk).for_each(|(sum, value)| *sum += value);
    }
    sums.iter().sum()
}

fn gradients(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("gradient, 64 x 100,000");
    group.sample_size(20).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(2));
    group.throughput(Throughput::Bytes((BATCH * PARAMETERS * size_of::<f32>()) as u64));
    for techniques in [4, 10] {
        let inputs = inputs(techniques);
        if techniques == 4 {
            group.bench_function("memory sum", |bencher| bencher.iter(|| memory_sum(black_box(&inputs.gradient))));
        }
        if c_abi::LINKED {
            for beta in [0.0, 0.7] {
                let mut state = c_gradient::Gradient::new(techniques, PARAMETERS);
                group.bench_function(format!("C, J = {techniques}, beta = {beta}"), |bencher| {
                    bencher.iter(|| state.estimate(black_box(&inputs), ITEMS, beta)[0]);
                });
            }
        } else {
            println!("libnoisefloor.a is missing, so its C functions are skipped: run `cargo xtask library`");
        }
        let memory = vec![0.0; gradient_len(techniques, PARAMETERS)];
        let mut state = Gradient::new(memory, techniques, PARAMETERS).expect("a valid size");
        let mut estimate = vec![0.0; PARAMETERS];
        group.bench_function(format!("Rust, J = {techniques}, beta = 0.7"), |bencher| {
            bencher.iter(|| {
                let batch = Batch::new(ITEMS, techniques, &inputs.pdf, &inputs.technique).expect("a valid batch");
                state.estimate(&batch, Solver::default(), 0.7, black_box(&inputs.gradient), &mut estimate)
            });
        });
    }
    group.finish();

    let mut group = criterion.benchmark_group("weights, batch 64");
    group.sample_size(20).warm_up_time(Duration::from_millis(100)).measurement_time(Duration::from_millis(500));
    for techniques in [4, 10] {
        let inputs = inputs(techniques);
        let mut weight = [0.0; BATCH];
        for (name, solver) in [("ridge", Solver::default()), ("plain", Solver::Plain), ("balance", Solver::Balance)] {
            group.bench_function(format!("J = {techniques}, {name}"), |bencher| {
                bencher.iter(|| {
                    let batch = Batch::new(ITEMS, techniques, black_box(&inputs.pdf), &inputs.technique);
                    weights(&batch.expect("a valid batch"), solver, &mut weight)
                });
            });
        }
    }
}

criterion_group!(benches, gradients);
criterion_main!(benches);
