//! Times of single estimates, interleaved: every contestant once per round, medians over the rounds.

use crate::peer::{self, Peer, Solver};
use nalgebra::{DMatrix, DVector};
use noisefloor::basis::Family;
use noisefloor::control_variate::Regressor;
use noisefloor_bench::Extent;
use noisefloor_bench::method::METHODS;
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::statistics::median;
use std::hint::black_box;
use std::time::Instant;

/// (dims, order): 6, 10, 4 and 136 terms.
pub(crate) const SIZES: [(usize, usize); 4] = [(2, 2), (3, 2), (1, 3), (15, 2)];
pub(crate) const COUNTS: [usize; 3] = [16, 64, 256];

/// What the two peers are called.
pub(crate) const PEERS: [(&str, Solver); 2] =
    [("Algorithm 1, monomials, QR", Solver::Qr), ("Algorithm 1, monomials, Cholesky", Solver::Cholesky)];

/// A contestant's time.
pub(crate) struct Speed {
    pub(crate) name: &'static str,
    pub(crate) dims: usize,
    pub(crate) order: usize,
    pub(crate) n: usize,
    /// Nanoseconds per sample: the median over the rounds.
    pub(crate) ns: f64,
}

type Estimate = Box<dyn FnMut(&[f32], &[f32]) -> f32>;
type Contestant<'a> = (&'static str, Box<dyn FnMut() + 'a>);

/// Nanoseconds of each contestant's calls, divided by `units`: the median over the rounds, of which the first warms up
/// and does not count.
fn race(mut contestants: Vec<Contestant<'_>>, rounds: usize, units: usize) -> Vec<(&'static str, f64)> {
    let mut times = vec![Vec::with_capacity(rounds); contestants.len()];
    for round in 0..=rounds {
        for ((_, call), times) in contestants.iter_mut().zip(&mut times) {
            let start = Instant::now();
            call();
            if round > 0 {
                times.push(start.elapsed().as_secs_f64() * 1e9 / units as f64);
            }
        }
    }
    contestants.into_iter().zip(times).map(|((name, _), times)| (name, median(&times))).collect()
}

/// All methods, and the peers.
pub(crate) fn estimates(dims: usize, order: usize, n: usize, extent: Extent) -> Vec<Speed> {
    let large = dims > 3;
    let sets = if large { 512 / n } else { 4096 / n };
    let rounds = if large { extent.choose(3, 7, 28) } else { extent.choose(3, 41, 164) };
    let mut rng = SplitMix64::new(n as u64);
    let pool: Vec<(Vec<f32>, Vec<f32>)> = (0..sets)
        .map(|_| {
            let u: Vec<f32> = (0..n * dims).map(|_| rng.uniform_f32()).collect();
            let f = u.chunks(dims).map(|u| (-u.iter().sum::<f32>()).exp()).collect();
            (u, f)
        })
        .collect();
    let pool = &pool;
    let mut contestants: Vec<Contestant<'_>> = Vec::new();
    let mut enter = |name: &'static str, mut estimate: Estimate| {
        let call = move || {
            for (u, f) in pool {
                black_box(estimate(black_box(u), black_box(f)));
            }
        };
        contestants.push((name, Box::new(call)));
    };
    for method in METHODS {
        let mut prepared = method.prepare(dims, order, n);
        enter(method.name, Box::new(move |u, f| prepared.estimate(u, f)));
    }
    for (name, solver) in PEERS.into_iter().filter(|_| !large) {
        let peer = Peer::new(dims, order, solver);
        enter(name, Box::new(move |u, f| peer.estimate(u, f)));
    }
    race(contestants, rounds, sets * n).into_iter().map(|(name, ns)| Speed { name, dims, order, n, ns }).collect()
}

/// What a solution of 6 unknowns is called in the library.
pub(crate) const SOLVE: &str = "Regressor::estimate";

/// Nanoseconds of a solution of a system of 6 unknowns (2 dims, order 2), its sums being there.
///
/// The library's is the whole of `Regressor::estimate`: ridge, L D L', solution, standard error, and an `Estimate` made
/// of it. The peers' is their decomposition and solution alone, matrices copied and allocated.
pub(crate) fn solves(extent: Extent) -> Vec<(&'static str, f64)> {
    const CALLS: usize = 500;
    let mut regressor = Regressor::<2, 6, 1>::new(Family::Legendre, 2).expect("6 terms");
    let mut rng = SplitMix64::new(6);
    let mut matrix = DMatrix::<f64>::identity(6, 6);
    let rhs = DVector::<f64>::from_fn(6, |row, _| row as f64);
    for _ in 0..64 {
        let u = [rng.uniform_f32(), rng.uniform_f32()];
        regressor.add(&u, &[(-u[0] - u[1]).exp()]).expect("a valid sample");
        let p = DVector::<f64>::from_fn(6, |_, _| rng.uniform());
        matrix += &p * p.transpose();
    }
    let repeat = |mut call: Box<dyn FnMut()>| -> Box<dyn FnMut()> { Box::new(move || (0..CALLS).for_each(|_| call())) };
    let library = move || {
        let _ = black_box(black_box(&regressor).estimate(black_box(1e-9)));
    };
    let mut contestants: Vec<Contestant<'_>> = vec![(SOLVE, repeat(Box::new(library)))];
    for (name, solver) in PEERS {
        let (matrix, rhs) = (matrix.clone(), rhs.clone());
        let call = move || drop(black_box(peer::solve(black_box(&matrix).clone(), black_box(&rhs), solver)));
        contestants.push((name, repeat(Box::new(call))));
    }
    let rounds = extent.choose(101, 101, 401);
    race(contestants, rounds, CALLS)
}
