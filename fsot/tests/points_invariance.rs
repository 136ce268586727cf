//! The same bits for any number of threads, and after any interruption.

use fsot::class;
use fsot::optimize::{Domain, Optimizer, Problem, Quality};
use fsot::run::Optimization;
use fsot::target::Function;
use std::sync::Arc;

fn problem(points: usize, dims: usize, iterations: u64) -> Problem {
    Problem { quality: Quality::Iterations(iterations), seed: 42, ..Problem::new(points, dims) }
}

fn problems() -> Vec<Problem> {
    let mut colors = problem(1500, 2, 10);
    colors.classes = class::two_colors(2);
    let mut prefixes = problem(700, 3, 8);
    prefixes.classes = class::progressive(3, 5, 700);
    prefixes.axis_priority = 0.3;
    let mut torus = problem(600, 2, 10);
    torus.domain = Domain::Toroidal;
    let mut hill = problem(900, 2, 6);
    let target = Function::new(2, 900, |x| x[0] + 0.1).unwrap();
    hill.classes[0].target = Arc::new(target);
    // In windows.
    let large = problem(20_000, 2, 24);
    let mut large_colors = problem(20_000, 2, 24);
    large_colors.classes = class::three_colors(2);
    large_colors.domain = Domain::Toroidal;
    let mut large_space = problem(20_001, 3, 16);
    large_space.classes = class::ramp(3);
    vec![colors, prefixes, torus, hill, problem(300, 1, 4), problem(500, 8, 4), large, large_colors, large_space]
}

/// All energies, and the points.
fn run(problem: Problem, threads: usize) -> (Vec<u64>, Vec<u32>) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let mut optimizer = Optimizer::new(problem).unwrap();
        let mut energies = Vec::new();
        while optimizer.iteration() < optimizer.iterations() {
            energies.push(optimizer.step().to_bits());
        }
        (energies, optimizer.coordinates().iter().map(|x| x.to_bits()).collect())
    })
}

#[test]
fn any_number_of_threads() {
    for (number, problem) in problems().into_iter().enumerate() {
        let one = run(problem.clone(), 1);
        for threads in [2, 3] {
            assert!(run(problem.clone(), threads) == one, "problem {number}, {threads} threads");
        }
    }
}

#[test]
fn resumed_anywhere() {
    for (number, problem) in problems().into_iter().enumerate() {
        let mut whole = Optimizer::new(problem.clone()).unwrap();
        let iterations = whole.iterations();
        for stop in [1, iterations / 2, iterations - 1] {
            while whole.iteration() < stop {
                whole.step();
            }
            let mut resumed = Optimizer::new(problem.clone()).unwrap();
            assert!(resumed.restore(stop, whole.coordinates()));
            assert_eq!(resumed.iteration(), stop);
            assert_eq!(resumed.step().to_bits(), whole.step().to_bits());
            assert!(resumed.coordinates() == whole.coordinates(), "problem {number} after {stop}");
        }
    }
}

#[test]
fn states_of_another_problem_are_refused() {
    let mut optimizer = Optimizer::new(problem(10, 2, 5)).unwrap();
    let before = optimizer.points();
    let good = vec![0.5; 20];
    for (iteration, coordinates) in [
        (6, good.clone()),
        (1, vec![0.5; 19]),
        (1, vec![0.5; 21]),
        (1, vec![f32::NAN; 20]),
        (1, vec![1.0; 20]),
        (1, vec![-0.1; 20]),
    ] {
        assert!(!optimizer.restore(iteration, &coordinates));
        assert_eq!(optimizer.points(), before);
        assert_eq!(optimizer.iteration(), 0);
    }
    assert!(optimizer.restore(5, &good));
}

#[test]
fn seeds_differ() {
    let of = |seed| run(Problem { seed, ..problem(50, 2, 3) }, 1);
    assert!(of(1) == of(1));
    assert!(of(1) != of(2));
}
