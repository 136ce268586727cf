//! Nanoseconds per sample of every estimator, through the C ABI of the archive that ships.
//!
//! Group names are `dims`D`order/method`, ids are sample counts. Throughput is in samples, so that criterion's
//! "elem/s" is samples per second.

use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime};
use noisefloor::basis::Family;
use noisefloor::control_variate::Regressor;
use noisefloor_bench::c_abi;
use noisefloor_bench::method::{LEAST_SQUARES, METHODS, ROBUST};
use noisefloor_tests::random::SplitMix64;
use std::hint::black_box;
use std::time::Duration;

/// (dims, order): 6, 10, 4 and 136 terms.
const SIZES: [(usize, usize); 4] = [(2, 2), (3, 2), (1, 3), (15, 2)];
const COUNTS: [usize; 3] = [16, 64, 256];

/// `n` uniform samples of exp(-sum x).
fn samples(dims: usize, n: usize) -> (Vec<f32>, Vec<f32>) {
    let mut rng = SplitMix64::new(1);
    let u: Vec<f32> = (0..n * dims).map(|_| rng.uniform_f32()).collect();
    let f = u.chunks(dims).map(|u| (-u.iter().sum::<f32>()).exp()).collect();
    (u, f)
}

fn group<'a>(criterion: &'a mut Criterion, name: &str) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.sample_size(20).warm_up_time(Duration::from_millis(100)).measurement_time(Duration::from_millis(400));
    group
}

/// A whole estimate: all of what a pixel costs after its samples.
fn estimates(criterion: &mut Criterion) {
    for (dims, order) in SIZES {
        for method in METHODS.iter().filter(|method| !method.streaming) {
            let mut group = group(criterion, &format!("{dims}D{order}/{}", method.name));
            for n in COUNTS {
                let (u, f) = samples(dims, n);
                let mut prepared = method.prepare(dims, order, n);
                group.throughput(Throughput::Elements(n as u64));
                group.bench_function(n.to_string(), |bencher| {
                    bencher.iter(|| prepared.estimate(black_box(&u), black_box(&f)));
                });
            }
        }
    }
}

/// An accumulator's calls, each alone: adding one sample, 64 samples in one call, estimating, merging.
fn streaming(criterion: &mut Criterion) {
    for ((dims, order), method) in
        SIZES.into_iter().flat_map(|size| [ROBUST, LEAST_SQUARES].map(|method| (size, method)))
    {
        let (u, f) = samples(dims, 64);
        let new = || {
            let mut new = c_abi::Accumulator::new(method.c_config(dims, order));
            new.add(&u, &f);
            new
        };
        let (mut accumulator, other) = (new(), new());
        let mut group = group(criterion, &format!("{dims}D{order}/{} accumulator", method.name));
        group.throughput(Throughput::Elements(1));
        group.bench_function("add 1", |bencher| {
            bencher.iter(|| accumulator.add(black_box(&u[..dims]), black_box(&f[..1])));
        });
        group.throughput(Throughput::Elements(64));
        group.bench_function("add 64", |bencher| bencher.iter(|| accumulator.add(black_box(&u), black_box(&f))));
        group.throughput(Throughput::Elements(1));
        let mut accumulator = new();
        group.bench_function("estimate", |bencher| bencher.iter(|| black_box(&mut accumulator).estimate()));
        group.bench_function("merge", |bencher| bencher.iter(|| accumulator.merge(black_box(&other))));
    }
}

/// `Regressor::estimate` with its sums already made: it copies them, adds the ridge, factorises them as L D L', solves
/// and fills in an `Estimate` with its standard error. The factorisation and solution alone cost less.
fn solve(criterion: &mut Criterion) {
    fn bench<const D: usize, const T: usize>(group: &mut BenchmarkGroup<WallTime>) {
        let mut regressor = Regressor::<D, T, 1>::new(Family::Legendre, 2).expect("order 2");
        let (u, f) = samples(D, 64);
        for (u, f) in u.as_chunks().0.iter().zip(f.as_chunks().0) {
            regressor.add(u, f).expect("a valid sample");
        }
        group.bench_function(format!("{T} terms"), |bencher| {
            bencher.iter(|| black_box(&regressor).estimate(black_box(1e-9)));
        });
    }
    let mut group = group(criterion, "Rust/Regressor::estimate");
    bench::<2, 6>(&mut group);
    bench::<3, 10>(&mut group);
}

/// Fits that the pixels of 32 x 32 share: blocks of 8 x 8 in no order, windows of 8 x 8 side by
/// side, and overlapping by half.
fn shared(criterion: &mut Criterion) {
    const SIDE: usize = 32;
    for (order, channels) in [(2, 1), (2, 3), (3, 1), (3, 3)] {
        for (name, stride) in [("block", 0), ("image, stride 8", 8), ("image, stride 4", 4)] {
            let mut group = group(criterion, &format!("C/2D{order}/{channels} channels/{name}"));
            for n in [1, 4, 16] {
                let (u, f) = samples(2, SIDE * SIDE * n);
                let f: Vec<f32> = f.iter().flat_map(|&f| vec![f; channels as usize]).collect();
                let config = c_abi::Config { dims: 2, order, channels, ..c_abi::Config::default() };
                let mut prepared = c_abi::Shared::new(config, SIDE, n, stride);
                group.throughput(Throughput::Elements((SIDE * SIDE * n) as u64));
                group.bench_function(n.to_string(), |bencher| {
                    bencher.iter(|| prepared.estimate(black_box(&u), black_box(&f)));
                });
            }
        }
    }
}

criterion_group!(benches, solve, streaming, shared, estimates);
criterion_main!(benches);
