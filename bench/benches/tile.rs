//! Nanoseconds of a draw: constructing the pixel's sampler and drawing two numbers, through the Rust API and through
//! the C ABI of the archive that ships. Pixels run over the image row by row; each figure is of one draw.

use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime};
use noisefloor::rng::Rng;
use noisefloor::tile::{Header, Sampler, Shape, Tile, fill};
use noisefloor_bench::{c_abi, c_tile};
use std::hint::black_box;
use std::time::Duration;

const SIDE: u32 = 128;

/// A file's bytes, full of noise: time does not depend on the values.
fn bytes(spp: u32, dims: u32, bits: u32) -> &'static [u8] {
    let shape = Shape { size: SIDE, spp, dims, frames: 1, bits, progressive: false };
    let mut rng = Rng::seed(1);
    let payload: Vec<u8> = (0..shape.payload_bytes()).map(|_| rng.next_u32() as u8).collect();
    let header = Header::new(shape, 1, "noise").unwrap().encode(&payload).unwrap();
    Vec::leak([&header[..], &payload].concat())
}

/// Adds what `draw`, a sum of two numbers, gives for each pixel: one iteration is one image of `SIDE` x `SIDE`.
fn image(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, mut draw: impl FnMut(u32, u32) -> f32) {
    group.throughput(Throughput::Elements(u64::from(SIDE * SIDE)));
    group.bench_function(name, |bencher| {
        bencher.iter(|| {
            let mut sum = 0.0;
            for y in 0..SIDE {
                for x in 0..SIDE {
                    // The coordinates are opaque, as a renderer's are.
                    sum += draw(black_box(x), y);
                }
            }
            sum
        });
    });
}

#[inline]
fn add(sampler: Sampler<'_>) -> f32 {
    let [a, b] = sampler.draw();
    a + b
}

fn draws(criterion: &mut Criterion) {
    for (spp, dims, bits) in [(1, 2, 16), (1, 2, 8), (4, 2, 16), (16, 2, 16), (1, 4, 16)] {
        let bytes = bytes(spp, dims, bits);
        let mut group = criterion.benchmark_group(format!("{spp}SPP {dims}D {bits} bits"));
        group.sample_size(30).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_millis(600));
        let tile = Tile::from_bytes(bytes).unwrap();
        let tile = &tile;
        let (last, next) = (spp - 1, spp * 5);
        image(&mut group, "Rust/pixel + 2", |x, y| add(Sampler::pixel(tile, x, y, 0, last)));
        image(&mut group, "Rust/pixel + domain + 2", |x, y| add(Sampler::pixel(tile, x, y, 0, last).domain(3)));
        image(&mut group, "Rust/pixel + 2, beyond spp", |x, y| add(Sampler::pixel(tile, x, y, 0, next)));
        let mut u = vec![0.0; (SIDE * SIDE * 2) as usize];
        group.bench_function("Rust/fill, 2", |bencher| {
            let domains = [(Sampler::pixel(tile, 0, 0, 0, last), 2)];
            bencher.iter(|| fill(&domains, SIDE as usize, SIDE as usize, 1, black_box(&mut u)).unwrap());
        });
        if c_abi::LINKED {
            let tile = c_tile::Tile::new(bytes);
            image(&mut group, "C ABI/pixel + 2", |x, y| tile.root(x, y, last));
            image(&mut group, "C ABI/pixel + domain + 2", |x, y| tile.child(x, y, last, 3));
            image(&mut group, "C ABI/pixel + 2, beyond spp", |x, y| tile.root(x, y, next));
            group.bench_function("C ABI/fill, 2", |bencher| {
                bencher.iter(|| tile.fill(SIDE, SIDE, 1, black_box(&mut u)));
            });
        }
        group.finish();
    }
    if !c_abi::LINKED {
        println!("libnoisefloor.a is missing, so its C functions are skipped: run `cargo xtask library`");
    }
}

criterion_group!(benches, draws);
criterion_main!(benches);
