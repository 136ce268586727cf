//! The accumulator of optimal MIS (2.15): its algebra, its limits and its errors. Statistics are in mis_statistics.rs.

use crate::mis_support::{Problem, Sample, Technique, problems};
use noisefloor::Error;
use noisefloor::mis::{self, DEFAULT_RIDGE, OptimalMis, RIDGE_RANGE, Solver, optimal_contribution};
use noisefloor::rng::Rng;
use noisefloor_tests::oracle::least_squares;
use proptest::prelude::*;

const SOLVERS: [Solver; 4] = [Solver::Ridge(DEFAULT_RIDGE), Solver::Plain, Solver::Progressive, Solver::Balance];

fn empty(counts: &[u32], integrals: usize) -> OptimalMis<Vec<f64>> {
    OptimalMis::new(vec![0.0; mis::len(counts.len(), integrals)], counts, integrals).unwrap()
}

fn add_all(omis: &mut OptimalMis<Vec<f64>>, samples: &[Sample]) {
    for s in samples {
        omis.add(s.technique, &s.pdf, &[s.value]).unwrap();
    }
}

fn of(counts: &[u32], samples: &[Sample]) -> OptimalMis<Vec<f64>> {
    let mut omis = empty(counts, 1);
    add_all(&mut omis, samples);
    omis
}

fn estimate(omis: &OptimalMis<Vec<f64>>, solver: Solver) -> f32 {
    let mut out = [f32::NAN];
    omis.solve(solver, &mut out).unwrap();
    out[0]
}

fn rounds(problem: &Problem, seed: u64, rounds: usize) -> Vec<Sample> {
    let mut rng = Rng::seed(seed);
    (0..rounds).flat_map(|_| problem.round(&mut rng)).collect()
}

/// A, b, sum p/S, sum f/S and the number of rounds, the slow way.
fn oracle_sums(counts: &[u32], samples: &[Sample]) -> (Vec<Vec<f64>>, Vec<f64>, Vec<f64>, f64, f64) {
    let j = counts.len();
    let (mut a, mut b, mut q, mut g) = (vec![vec![0.0; j]; j], vec![0.0; j], vec![0.0; j], 0.0);
    for s in samples {
        let sum: f64 = s.pdf.iter().zip(counts).map(|(&p, &n)| f64::from(p) * f64::from(n)).sum();
        for i in 0..j {
            for (cell, &p) in a[i].iter_mut().zip(&s.pdf) {
                *cell += f64::from(s.pdf[i]) * f64::from(p) / (sum * sum);
            }
            b[i] += f64::from(s.value) * f64::from(s.pdf[i]) / (sum * sum);
            q[i] += f64::from(s.pdf[i]) / sum;
        }
        g += f64::from(s.value) / sum;
    }
    let rounds = samples.len() as f64 / counts.iter().map(|&n| f64::from(n)).sum::<f64>();
    (a, b, q, g, rounds)
}

fn assert_close(actual: f32, expected: f64, tolerance: f64, what: &str) {
    let error = (f64::from(actual) - expected).abs();
    assert!(error <= tolerance * expected.abs().max(1e-3), "{what}: {actual} is not {expected}");
}

/// Against Gaussian elimination in f64; f32 outputs, so 1e-6.
#[test]
fn solvers_match_the_oracle() {
    for problem in problems() {
        let samples = rounds(&problem, 7, 20);
        let mut omis = empty(&problem.counts, 1);
        add_all(&mut omis, &samples);
        let (a, b, q, g, r) = oracle_sums(&problem.counts, &samples);
        let j = problem.counts.len();

        assert_close(estimate(&omis, Solver::Balance), g / r, 1e-6, problem.name);
        assert_close(estimate(&omis, Solver::Progressive), g / r, 1e-6, problem.name);

        // The direct estimator is the sum of alpha.
        let mut found = vec![0.0; j];
        omis.alpha(Solver::Plain, &mut found).unwrap();
        assert_close(estimate(&omis, Solver::Plain), found.iter().map(|&a| f64::from(a)).sum(), 1e-6, problem.name);
        if problem.independent {
            for (&found, &expected) in found.iter().zip(&least_squares(&a, &b)) {
                assert_close(found, expected, 1e-5, problem.name);
            }
        }

        for ridge in [1e-3, 0.1, DEFAULT_RIDGE, 100.0] {
            let n = |k: usize| f64::from(problem.counts[k]);
            let trace: f64 = (0..j).map(|k| n(k) * a[k][k]).sum();
            let mut ridged = a.clone();
            let differences = f64::from(ridge) * (trace - r) / samples.len() as f64;
            for (k, row) in ridged.iter_mut().enumerate() {
                row[k] += differences.max(1e-8 * trace) / n(k);
            }
            let alpha = least_squares(&ridged, &b);
            let expected = g / r - (0..j).map(|k| (q[k] / r - 1.0) * alpha[k]).sum::<f64>();
            assert_close(estimate(&omis, Solver::Ridge(ridge)), expected, 1e-6, problem.name);
            omis.alpha(Solver::Ridge(ridge), &mut found).unwrap();
            for (&found, &expected) in found.iter().zip(&alpha) {
                assert_close(found, expected, 1e-5, problem.name);
            }
        }
    }
}

#[test]
fn the_ridge_goes_from_the_plain_solve_to_the_balance_heuristic() {
    for problem in problems() {
        let mut omis = empty(&problem.counts, 1);
        add_all(&mut omis, &rounds(&problem, 3, 12));
        let [small, large] = [*RIDGE_RANGE.start(), *RIDGE_RANGE.end()].map(|r| estimate(&omis, Solver::Ridge(r)));
        assert_close(small, estimate(&omis, Solver::Plain).into(), 1e-5, problem.name);
        assert_close(large, estimate(&omis, Solver::Balance).into(), 1e-6, problem.name);
    }
}

/// f = sum_k c_k p_k is integrated without error by any J samples that tell the densities apart.
#[test]
fn a_mixture_of_the_densities_is_exact() {
    let problem = Problem {
        name: "a mixture",
        independent: true,
        techniques: vec![Technique::Uniform, Technique::Rising, Technique::Box(0.25, 0.5)],
        counts: vec![2, 1, 1],
        f: |x| 1.5 + 6.0 * x - if (0.25..0.5).contains(&x) { 2.0 } else { 0.0 },
        integral: 1.5 + 3.0 - 0.5,
    };
    for seed in 0..20 {
        let mut omis = empty(&problem.counts, 1);
        add_all(&mut omis, &rounds(&problem, seed, 2));
        assert_close(estimate(&omis, Solver::Plain), problem.integral, 1e-5, "plain");
        // Known alpha makes every later batch exact as well.
        omis.next_batch(Solver::Plain).unwrap();
        let mut alpha = [0.0; 3];
        omis.alpha(Solver::Progressive, &mut alpha).unwrap();
        let total: f64 = rounds(&problem, 1000 + seed, 3)
            .iter()
            .map(|s| optimal_contribution(&s.pdf, &problem.counts, s.technique, &alpha, s.value).unwrap())
            .map(f64::from)
            .sum();
        assert_close((total / 3.0) as f32, problem.integral, 1e-5, "contributions");
    }
}

/// A public implementation overwrites its matrix in place: a second solve then answers something else.
#[test]
fn solving_changes_nothing() {
    for problem in problems() {
        let samples = rounds(&problem, 5, 10);
        let (first, second) = samples.split_at(samples.len() / 2);
        let (mut solved, mut unsolved) = (empty(&problem.counts, 1), empty(&problem.counts, 1));
        add_all(&mut solved, first);
        add_all(&mut unsolved, first);
        for solver in SOLVERS {
            let answer = estimate(&solved, solver);
            assert_eq!(answer.to_bits(), estimate(&solved, solver).to_bits());
        }
        assert_eq!(solved, unsolved);
        add_all(&mut solved, second);
        add_all(&mut unsolved, second);
        for solver in SOLVERS {
            assert_eq!(estimate(&solved, solver).to_bits(), estimate(&unsolved, solver).to_bits());
        }
    }
}

#[test]
fn several_integrals_are_several_accumulators() {
    let (counts, scale) = ([2, 1, 1], [1.0, -2.0, 0.0, 1e-3, 4.0]);
    let mut rng = Rng::seed(11);
    let mut together = empty(&counts, 5);
    let mut apart: Vec<_> = scale.iter().map(|_| empty(&counts, 1)).collect();
    for i in 0..40 {
        let pdf = [1.0, 0.1 + rng.uniform_f32(), 0.1 + rng.uniform_f32()];
        let values = scale.map(|s: f32| s * rng.uniform_f32());
        together.add(i % 3, &pdf, &values).unwrap();
        for (one, value) in apart.iter_mut().zip(values) {
            one.add(i % 3, &pdf, &[value]).unwrap();
        }
        if i == 20 {
            together.next_batch(Solver::default()).unwrap();
            apart.iter_mut().for_each(|one| one.next_batch(Solver::default()).unwrap());
        }
    }
    for solver in SOLVERS {
        let mut out = [0.0; 5];
        together.solve(solver, &mut out).unwrap();
        let mut alpha = [0.0; 15];
        together.alpha(solver, &mut alpha).unwrap();
        for (p, one) in apart.iter().enumerate() {
            assert_eq!(out[p].to_bits(), estimate(one, solver).to_bits());
            let mut own = [0.0; 3];
            one.alpha(solver, &mut own).unwrap();
            assert_eq!(own, alpha[3 * p..3 * p + 3]);
        }
    }
}

#[test]
fn singular_systems() {
    // Identical techniques: every solver is the balance heuristic.
    for j in [2, 3, 16] {
        let counts: Vec<u32> = (1..=j as u32).collect();
        let mut omis = empty(&counts, 1);
        let mut rng = Rng::seed(j as u64);
        for i in 0..50 {
            omis.add(i % j, &vec![0.5 + rng.uniform_f32(); j], &[rng.uniform_f32()]).unwrap();
        }
        for solver in SOLVERS {
            assert_close(estimate(&omis, solver), estimate(&omis, Solver::Balance).into(), 1e-5, "identical");
        }
    }
    // Fewer samples than techniques, one sample, and a technique that is 0 wherever anything was drawn.
    for samples in [1, 2, 5] {
        let mut omis = empty(&[1; 16], 1);
        let mut rng = Rng::seed(samples);
        for i in 0..samples as usize {
            let mut pdf = [0.0; 16];
            pdf.iter_mut().take(12).for_each(|p| *p = 0.1 + rng.uniform_f32());
            omis.add(i, &pdf, &[1.0 + rng.uniform_f32()]).unwrap();
        }
        for solver in SOLVERS {
            let value = estimate(&omis, solver);
            assert!(value.is_finite() && value.abs() < 100.0, "{solver:?}: {value}");
        }
    }
    // f = 0 everywhere, where the plain solve must not divide 0 by 0.
    let mut omis = empty(&[1, 1], 1);
    omis.add(0, &[1.0, 1.0], &[0.0]).unwrap();
    for solver in SOLVERS {
        assert_eq!(estimate(&omis, solver), 0.0);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever finite input: no panic, finite outputs.
    #[test]
    fn extreme_input_gives_finite_output(
        counts in prop::collection::vec(prop_oneof![1..5_u32, Just(u32::MAX)], 1..=16),
        seed in any::<u64>(),
        samples in 1..40_usize,
    ) {
        let mut rng = Rng::seed(seed);
        let mut omis = empty(&counts, 2);
        for i in 0..samples {
            let technique = i % counts.len();
            let mut density = || match rng.below(4) {
                0 => 0.0,
                _ => 10.0_f32.powf(76.0 * rng.uniform_f32() - 38.0),
            };
            let mut pdf: Vec<f32> = counts.iter().map(|_| density()).collect();
            pdf[technique] = pdf[technique].max(1e-38);
            let value = [f32::MAX * (2.0 * rng.uniform_f32() - 1.0), 1e-38];
            omis.add(technique, &pdf, &value).unwrap();
            if i % 7 == 6 {
                omis.next_batch(if i % 2 == 0 { Solver::Plain } else { Solver::default() }).unwrap();
            }
        }
        for solver in SOLVERS {
            let mut out = [f32::NAN; 2];
            omis.solve(solver, &mut out).unwrap();
            prop_assert!(out.iter().all(|x| x.is_finite()), "{:?} {:?}", solver, out);
            let mut alpha = vec![f32::NAN; 2 * counts.len()];
            omis.alpha(solver, &mut alpha).unwrap();
            prop_assert!(alpha.iter().all(|x| x.is_finite()));
        }
    }
}

proptest! {
    #![proptest_config(crate::cases(500, 3))]

    /// Merging is associative, the order of samples does not matter, and estimates scale with f, within 1e-5.
    #[test]
    fn merging_order_and_scale(
        techniques in 1..6_usize,
        sizes in prop::collection::vec(1..12_usize, 3),
        factor in -50.0..50.0_f32,
        seed in any::<u64>(),
    ) {
        let mut rng = Rng::seed(seed);
        let counts: Vec<u32> = (0..techniques).map(|_| 1 + rng.below(3)).collect();
        let mut samples: Vec<Sample> = (0..sizes.iter().sum()).map(|i: usize| {
            let pdf = (0..techniques).map(|_| 0.1 + rng.uniform_f32()).collect();
            Sample { technique: i % techniques, pdf, value: 2.0 * rng.uniform_f32() - 1.0 }
        }).collect();
        let solve =
            |omis: &OptimalMis<Vec<f64>>| [Solver::default(), Solver::Balance].map(|solver| estimate(omis, solver));
        let same = |a: [f32; 2], b: [f32; 2], size: f32| {
            a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-5 * size * (1.0 + a.abs()))
        };
        let whole = solve(&of(&counts, &samples));
        let (first, rest) = samples.split_at(sizes[0]);
        let (second, third) = rest.split_at(sizes[1]);
        let [a, b, c] = [first, second, third].map(|part| of(&counts, part));
        let (mut left, mut right, mut end) = (a.clone(), a, b.clone());
        left.merge(&b).unwrap();
        left.merge(&c).unwrap();
        end.merge(&c).unwrap();
        right.merge(&end).unwrap();
        prop_assert!(same(solve(&left), whole, 1.0) && same(solve(&right), whole, 1.0));
        samples.sort_by_cached_key(|_| rng.next_u64());
        prop_assert!(same(solve(&of(&counts, &samples)), whole, 1.0));
        samples.iter_mut().for_each(|sample| sample.value *= factor);
        prop_assert!(same(solve(&of(&counts, &samples)), whole.map(|x| factor * x), 1.0 + factor.abs()));
    }

    /// Powers of two scale exactly: densities do not matter at all, values come out as they went in.
    #[test]
    fn scales_are_exact(seed in any::<u64>(), density in -60..60_i32, value in -60..60_i32) {
        let mut rng = Rng::seed(seed);
        let (mut omis, mut scaled) = (empty(&[2, 1, 1], 1), empty(&[2, 1, 1], 1));
        for i in 0..12 {
            let pdf = [(); 3].map(|()| 0.1 + rng.uniform_f32());
            let f = rng.uniform_f32();
            omis.add(i % 3, &pdf, &[f]).unwrap();
            scaled.add(i % 3, &pdf.map(|p| p * 2.0_f32.powi(density)), &[f * 2.0_f32.powi(value)]).unwrap();
        }
        for solver in SOLVERS {
            let expected = estimate(&omis, solver) * 2.0_f32.powi(value - density);
            prop_assert_eq!(estimate(&scaled, solver), expected);
        }
    }
}

#[test]
fn merging_is_adding() {
    for problem in problems() {
        let samples = rounds(&problem, 21, 16);
        let (first, second) = samples.split_at(samples.len() / 2);
        let (mut whole, mut left, mut right) =
            (empty(&problem.counts, 1), empty(&problem.counts, 1), empty(&problem.counts, 1));
        add_all(&mut whole, &samples);
        add_all(&mut left, first);
        add_all(&mut right, second);
        left.merge(&right).unwrap();
        for solver in SOLVERS {
            assert_close(estimate(&left, solver), estimate(&whole, solver).into(), 1e-6, problem.name);
        }
    }
}

#[test]
fn merging_and_decay_keep_the_progressive_alpha() {
    let problem = &problems()[0];
    let (mut left, mut right) = (empty(&problem.counts, 1), empty(&problem.counts, 1));
    add_all(&mut left, &rounds(problem, 1, 5));
    left.next_batch(Solver::Plain).unwrap();
    add_all(&mut right, &rounds(problem, 2, 5));
    right.next_batch(Solver::Plain).unwrap();
    let (mut before, mut after) = ([0.0; 2], [0.0; 2]);
    left.alpha(Solver::Progressive, &mut before).unwrap();
    left.merge(&right).unwrap();
    left.decay(0.5).unwrap();
    left.alpha(Solver::Progressive, &mut after).unwrap();
    assert!(before != [0.0; 2]);
    assert_eq!(before, after);
}

#[test]
fn decay_weighs_old_samples_less() {
    let problem = &problems()[1];
    let (old, new) = (rounds(problem, 1, 8), rounds(problem, 2, 4));
    let mut omis = empty(&problem.counts, 1);
    add_all(&mut omis, &old);
    let solvers = [Solver::Plain, Solver::Progressive, Solver::Balance];
    let before = solvers.map(|solver| estimate(&omis, solver));
    // A quarter of the samples is a ridge four times as large.
    let ridge = estimate(&omis, Solver::Ridge(4.0));
    omis.decay(0.25).unwrap();
    // All sums shrink alike: by itself decay changes no other estimate.
    assert_eq!(before, solvers.map(|solver| estimate(&omis, solver)));
    assert_close(estimate(&omis, Solver::Ridge(1.0)), ridge.into(), 1e-6, "ridge");
    add_all(&mut omis, &new);
    let (mut a, mut b, q, mut g, r) = oracle_sums(&problem.counts, &old);
    let (a2, b2, _, g2, r2) = oracle_sums(&problem.counts, &new);
    g = (0.25 * g + g2) / (0.25 * r + r2);
    assert_close(estimate(&omis, Solver::Balance), g, 1e-6, "balance");
    assert_close(estimate(&omis, Solver::Progressive), g, 1e-6, "progressive");
    for i in 0..q.len() {
        b[i] = 0.25 * b[i] + b2[i];
        for k in 0..q.len() {
            a[i][k] = 0.25 * a[i][k] + a2[i][k];
        }
    }
    assert_close(estimate(&omis, Solver::Plain), least_squares(&a, &b).iter().sum(), 1e-6, "plain");

    omis.decay(0.0).unwrap();
    assert_eq!(omis.solve(Solver::Plain, &mut [0.0]), Err(Error::NoSamples));
    add_all(&mut omis, &new);
    let mut fresh = empty(&problem.counts, 1);
    add_all(&mut fresh, &new);
    assert_eq!(omis, fresh);
    // Long decay ends in no samples, never in NaN.
    for _ in 0..3000 {
        omis.decay(0.5).unwrap();
        for solver in SOLVERS {
            let mut out = [0.0];
            assert!(omis.solve(solver, &mut out) == Err(Error::NoSamples) || out[0].is_finite());
        }
    }
    assert_eq!(omis.solve(Solver::Balance, &mut [0.0]), Err(Error::NoSamples));
}

/// Densities that differ by rounding alone say nothing: coefficients stay of the size of values, however small the
/// ridge. So a table whose probabilities sum to one only nearly does no harm.
#[test]
fn rounding_is_no_technique() {
    let mut rng = Rng::seed(12);
    let mut omis = empty(&[1, 1], 1);
    for sample in 0..1000 {
        let (p, ulps) = (0.5 + rng.uniform_f32(), rng.below(50));
        omis.add(sample % 2, &[p, f32::from_bits(p.to_bits() + ulps)], &[rng.uniform_f32()]).unwrap();
    }
    let mut alpha = [0.0; 2];
    omis.alpha(Solver::Ridge(1e-8), &mut alpha).unwrap();
    assert!(alpha.iter().all(|alpha| alpha.abs() < 2.0), "{alpha:?}");
}

#[test]
fn reset_starts_again() {
    let problem = &problems()[0];
    let mut omis = empty(&problem.counts, 1);
    add_all(&mut omis, &rounds(problem, 1, 5));
    omis.next_batch(Solver::default()).unwrap();
    omis.reset();
    assert_eq!(omis, empty(&problem.counts, 1));
}

#[test]
fn memory_may_be_owned_borrowed_and_taken_up_again() {
    let counts = [1, 2];
    const LEN: usize = mis::len(2, 1);
    let mut owned = OptimalMis::new([f64::NAN; LEN], &counts, 1).unwrap();
    let mut memory = [f64::NAN; LEN + 3];
    let mut borrowed = OptimalMis::new(&mut memory[..], &counts, 1).unwrap();
    owned.add(0, &[1.0, 0.5], &[3.0]).unwrap();
    borrowed.add(0, &[1.0, 0.5], &[3.0]).unwrap();
    let mut again = OptimalMis::resume(&mut memory[..], &counts, 1).unwrap();
    again.add(1, &[1.0, 1.5], &[1.0]).unwrap();
    owned.add(1, &[1.0, 1.5], &[1.0]).unwrap();
    let (mut a, mut b) = ([0.0], [0.0]);
    owned.solve(Solver::Plain, &mut a).unwrap();
    OptimalMis::resume(&memory[..], &counts, 1).unwrap().solve(Solver::Plain, &mut b).unwrap();
    assert_eq!(a, b);
    assert_eq!((owned.techniques(), owned.integrals()), (2, 1));
}

#[test]
fn lengths() {
    assert_eq!(mis::len(1, 1), 1 + 1 + 1 + 4);
    assert_eq!(mis::len(16, 10), 1 + 16 + 136 + 10 * 34);
    assert_eq!((mis::len(2, 1), Solver::default()), (12, Solver::Ridge(2.0)));
    for (techniques, integrals) in [(0, 1), (17, 1), (2, 0), (2, usize::MAX), (16, usize::MAX / 300), (usize::MAX, 1)] {
        assert_eq!(mis::len(techniques, integrals), 0);
    }
}

#[test]
fn errors_of_construction() {
    let new = |len: usize, counts: &[u32], integrals| OptimalMis::new(vec![0.0; len], counts, integrals).err();
    assert_eq!(new(100, &[], 1), Some(Error::Range));
    assert_eq!(new(1000, &[1; 17], 1), Some(Error::Range));
    assert_eq!(new(100, &[1, 0], 1), Some(Error::Range));
    assert_eq!(new(100, &[1, 1], 0), Some(Error::Range));
    assert_eq!(new(mis::len(2, 3) - 1, &[1, 1], 3), Some(Error::Memory));
    assert_eq!(new(mis::len(2, 3), &[1, 1], 3), None);
    assert_eq!(OptimalMis::resume([0.0; 3], &[1, 1], 1).err(), Some(Error::Memory));
}

#[test]
fn errors_of_samples_leave_the_sums() {
    let mut omis = empty(&[1, 1], 2);
    omis.add(0, &[1.0, 2.0], &[1.0, 0.0]).unwrap();
    let before = omis.clone();
    let mut add = |technique, pdf: &[f32], value: &[f32]| {
        let result = omis.add(technique, pdf, value);
        assert_eq!(omis, before);
        result
    };
    let (range, length) = (Err(Error::Range), Err(Error::Length));
    assert_eq!(add(0, &[1.0], &[1.0, 1.0]), length);
    assert_eq!(add(0, &[1.0; 3], &[1.0, 1.0]), length);
    assert_eq!(add(0, &[1.0; 2], &[1.0]), length);
    assert_eq!(add(2, &[1.0; 2], &[1.0; 2]), range);
    assert_eq!(add(0, &[0.0, 1.0], &[1.0; 2]), range);
    assert_eq!(add(0, &[1.0, -1.0], &[1.0; 2]), range);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(add(0, &[1.0, bad], &[1.0; 2]), Err(Error::NotFinite));
        assert_eq!(add(0, &[1.0; 2], &[1.0, bad]), Err(Error::NotFinite));
    }
}

#[test]
fn errors_of_solving_leave_the_output() {
    let mut omis = empty(&[1, 1], 2);
    for solver in SOLVERS {
        let mut out = [7.0; 2];
        assert_eq!(omis.solve(solver, &mut out), Err(Error::NoSamples));
        assert_eq!(out, [7.0; 2]);
        assert_eq!(omis.alpha(solver, &mut [0.0; 4]), Err(Error::NoSamples));
    }
    assert_eq!(omis.next_batch(Solver::Plain), Err(Error::NoSamples));
    omis.add(0, &[1.0, 2.0], &[1.0, 0.0]).unwrap();
    assert_eq!(omis.solve(Solver::Plain, &mut [0.0; 1]), Err(Error::Length));
    assert_eq!(omis.solve(Solver::Plain, &mut [0.0; 3]), Err(Error::Length));
    assert_eq!(omis.alpha(Solver::Plain, &mut [0.0; 2]), Err(Error::Length));
    assert_eq!(omis.next_batch(Solver::Progressive), Err(Error::Unsupported));
    for (ridge, error) in [
        (0.0, Error::Range),
        (-1.0, Error::Range),
        (1e-9, Error::Range),
        (1e9, Error::Range),
        (f32::NAN, Error::NotFinite),
        (f32::INFINITY, Error::NotFinite),
    ] {
        let mut out = [7.0; 2];
        assert_eq!(omis.solve(Solver::Ridge(ridge), &mut out), Err(error));
        assert_eq!(out, [7.0; 2]);
        assert_eq!(omis.alpha(Solver::Ridge(ridge), &mut [0.0; 4]), Err(error));
        assert_eq!(omis.next_batch(Solver::Ridge(ridge)), Err(error));
    }
}

#[test]
fn errors_of_decay_and_merge() {
    let mut omis = empty(&[1, 1], 2);
    omis.add(0, &[1.0, 2.0], &[1.0, 0.0]).unwrap();
    let before = omis.clone();
    assert_eq!(omis.decay(-0.1), Err(Error::Range));
    assert_eq!(omis.decay(1.1), Err(Error::Range));
    assert_eq!(omis.decay(f32::NAN), Err(Error::NotFinite));
    assert_eq!(omis.decay(f32::INFINITY), Err(Error::NotFinite));
    assert_eq!(omis.merge(&empty(&[1, 2], 2)), Err(Error::Mismatch));
    assert_eq!(omis.merge(&empty(&[1, 1, 1], 2)), Err(Error::Mismatch));
    assert_eq!(omis.merge(&empty(&[1, 1], 3)), Err(Error::Mismatch));
    assert_eq!(omis, before);
}

#[test]
fn an_estimate_beyond_f32_is_its_largest() {
    let mut omis = empty(&[1], 1);
    omis.add(0, &[1e-30], &[-1e30]).unwrap();
    assert_eq!(estimate(&omis, Solver::Balance), f32::MIN);
}

/// Bits that tests/c/omis.c pins too.
#[test]
fn pinned_values() {
    let mut rng = Rng::seed(31);
    let [mut omis, mut other] = [(); 2].map(|()| empty(&[2, 1], 2));
    for i in 0..30 {
        let x = rng.uniform_f32();
        let to = if i % 5 == 0 { &mut other } else { &mut omis };
        to.add(i % 2, &[1.0, 0.5 + x], &[x * x, 1.0 - x]).unwrap();
        if i == 14 {
            omis.next_batch(Solver::Plain).unwrap();
            omis.decay(0.5).unwrap();
        }
    }
    omis.merge(&other).unwrap();
    let mut hash = 0_u64;
    for solver in [Solver::default(), Solver::Ridge(0.5), Solver::Plain, Solver::Progressive, Solver::Balance] {
        let (mut both, mut alpha) = ([0.0; 6], [0.0; 4]);
        omis.solve(solver, &mut both[..2]).unwrap();
        omis.alpha(solver, &mut alpha).unwrap();
        both[2..].copy_from_slice(&alpha);
        for value in both {
            hash = (hash ^ u64::from(value.to_bits())).wrapping_mul(0x0100_0000_01b3);
        }
    }
    assert_eq!(hash, PINNED_HASH, "{hash:#x}");
}

const PINNED_HASH: u64 = 0x38ef_5b52_ff5e_f3cf;
