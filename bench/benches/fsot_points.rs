//! Nanoseconds per slice of the point optimiser: one iteration is 16 slices and moving the points.
//!
//! Ids are numbers of points; throughput is in points times slices, so that "elem/s" is what one slice does to points
//! per second. One thread, so that a slice's cost shows and not the machine's cores.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fsot::class::{ramp, three_colors};
use fsot::optimize::{Domain, Optimizer, Problem, Quality};
use fsot::run::Optimization;
use fsot::target::Function;
use std::sync::Arc;
use std::time::Duration;

const SLICES: u64 = 16;

fn iterations(criterion: &mut Criterion, group: &str, problems: Vec<(String, Problem)>) {
    let mut group = criterion.benchmark_group(group);
    group.sample_size(20).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_secs(1));
    for (name, problem) in problems {
        group.throughput(Throughput::Elements(SLICES * problem.points as u64));
        let problem = Problem { quality: Quality::Iterations(u64::MAX / 2), ..problem };
        let mut optimizer = Optimizer::new(problem).expect("a problem without mistakes");
        // The windows of large sets are benched on their own.
        group.bench_function(name, |bencher| bencher.iter(|| optimizer.step()));
    }
    group.finish();
}

fn points(criterion: &mut Criterion) {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("no pool before this one");
    let sizes = [64, 256, 1024, 4096, 16_384];
    let of = |points: usize| (points.to_string(), Problem::new(points, 2));
    iterations(criterion, "fsot/uniform", sizes.into_iter().map(of).collect());
    let torus = |points: usize| (points.to_string(), Problem { domain: Domain::Toroidal, ..Problem::new(points, 2) });
    iterations(criterion, "fsot/toroidal", [1024, 4096].into_iter().map(torus).collect());
    let dims = |dims: usize| (format!("{dims}D"), Problem::new(4096, dims));
    iterations(criterion, "fsot/dims/4096", (1..=8).map(dims).collect());
    let classes = vec![
        ("3color".to_owned(), Problem { classes: three_colors(2), ..Problem::new(4096, 2) }),
        ("ramp".to_owned(), Problem { classes: ramp(2), ..Problem::new(4096, 2) }),
    ];
    iterations(criterion, "fsot/classes/4096", classes);
    let mut hill = Problem::new(4096, 2);
    let density = Function::new(2, 4096, |x| x[0] * x[1] + 0.1).expect("a density");
    hill.classes[0].target = Arc::new(density);
    iterations(criterion, "fsot/density", vec![("4096".to_owned(), hill)]);
}

criterion_group!(benches, points);
criterion_main!(benches);
