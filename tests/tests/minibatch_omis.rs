//! Optimal MIS gradients: their algebra, their limits and their errors. Statistics are in minibatch_statistics.rs.

use noisefloor::Error;
use noisefloor::minibatch::{Batch, Gradient, System, gradient_len, weights};
use noisefloor::mis::{DEFAULT_RIDGE, Solver};
use noisefloor::rng::Rng;
use noisefloor_tests::minibatch::{Drawn, Problem};
use noisefloor_tests::oracle::least_squares;
use proptest::prelude::*;

const RIDGE: Solver = Solver::Ridge(DEFAULT_RIDGE);
const SOLVERS: [Solver; 3] = [RIDGE, Solver::Plain, Solver::Balance];

fn gradient(techniques: usize, parameters: usize) -> Gradient<Vec<f32>> {
    Gradient::new(vec![f32::NAN; gradient_len(techniques, parameters)], techniques, parameters).unwrap()
}

/// A problem of random importances, and gradients without structure.
fn random_problem(seed: u64, techniques: usize, items: usize, parameters: usize) -> Problem {
    let mut rng = Rng::seed(seed);
    let importance: Vec<Vec<f64>> =
        (0..techniques).map(|_| (0..items).map(|_| rng.uniform_f64().powi(3)).collect()).collect();
    let values = (0..items * parameters).map(|_| 2.0 * rng.uniform_f32() - 1.0).collect();
    Problem::new(&importance, 0.1, values, parameters)
}

fn counts(drawn: &Drawn) -> Vec<f64> {
    let mut counts = vec![0.0; drawn.techniques];
    drawn.technique.iter().for_each(|&j| counts[j as usize] += 1.0);
    counts
}

/// S and p / S of each sample.
fn ratios(drawn: &Drawn) -> Vec<(f64, Vec<f64>)> {
    let counts = counts(drawn);
    let of = |pdf: &[f32]| {
        let sum: f64 = pdf.iter().zip(&counts).map(|(&p, n)| f64::from(p) * n).sum();
        (sum, pdf.iter().map(|&p| f64::from(p) / sum).collect())
    };
    drawn.pdf.chunks(drawn.techniques).map(of).collect()
}

/// sum_s x_s y_s', and q = sum_s p / S.
fn matrix_and_sum(ratios: &[(f64, Vec<f64>)]) -> (Vec<Vec<f64>>, Vec<f64>) {
    let n = ratios[0].1.len();
    let (mut a, mut q) = (vec![vec![0.0; n]; n], vec![0.0; n]);
    for (_, r) in ratios {
        for i in 0..n {
            q[i] += r[i];
            (0..n).for_each(|k| a[i][k] += r[i] * r[k]);
        }
    }
    (a, q)
}

/// The weights straight from their formulas.
fn oracle(drawn: &Drawn, ridge: Option<f64>) -> Vec<f64> {
    let ratios = ratios(drawn);
    let (mut a, q) = matrix_and_sum(&ratios);
    let n = q.len();
    let counts = counts(drawn);
    let scale = ratios.len() as f64 / f64::from(drawn.items);
    if let Some(ridge) = ridge {
        let trace: f64 = (0..n).map(|j| counts[j] * a[j][j]).sum();
        let diagonal = (ridge * (trace - 1.0) / ratios.len() as f64).max(1e-8 * trace);
        (0..n).for_each(|j| a[j][j] += diagonal / counts[j]);
        let c = least_squares(&a, &q.iter().map(|q| q - 1.0).collect::<Vec<_>>());
        let v = |(sum, r): &(f64, Vec<f64>)| (1.0 - c.iter().zip(r).map(|(c, r)| c * r).sum::<f64>()) / sum;
        ratios.iter().map(|sample| scale * v(sample)).collect()
    } else {
        let ones = least_squares(&a, &vec![1.0; n]);
        let v = |(sum, r): &(f64, Vec<f64>)| ones.iter().zip(r).map(|(x, r)| x * r).sum::<f64>() / sum;
        ratios.iter().map(|sample| scale * v(sample)).collect()
    }
}

fn assert_close(actual: &[f64], expected: &[f64], tolerance: f64) {
    let size = expected.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    assert_eq!(actual.len(), expected.len());
    for (a, e) in actual.iter().zip(expected) {
        assert!((a - e).abs() <= tolerance * size, "{a} is not {e}, of up to {size}");
    }
}

fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().map(|&v| v.into()).collect()
}

#[test]
fn weights_are_their_formulas() {
    let mut rng = Rng::seed(1);
    for (seed, (techniques, batch)) in [(1, [5, 0, 0]), (2, [8, 8, 0]), (3, [4, 1, 20])].into_iter().enumerate() {
        let problem = random_problem(seed as u64, techniques, 50, 1);
        for _ in 0..20 {
            let drawn = problem.draw(&batch[..techniques], &mut rng);
            for ridge in [1e-3, 3.0, 100.0] {
                let expected = oracle(&drawn, Some(f64::from(ridge)));
                assert_close(&wide(&drawn.weights(Solver::Ridge(ridge))), &expected, 1e-6);
            }
            assert_close(&wide(&drawn.weights(Solver::Plain)), &oracle(&drawn, None), 1e-5);
            let scale = drawn.technique.len() as f64 / f64::from(drawn.items);
            let balance: Vec<f64> = ratios(&drawn).iter().map(|(sum, _)| scale / sum).collect();
            assert_close(&wide(&drawn.weights(Solver::Balance)), &balance, 1e-6);
            // What a large ridge shrinks to.
            assert_close(&wide(&drawn.weights(Solver::Ridge(1e8))), &balance, 1e-6);
        }
    }
}

/// Uniform techniques, also of one sample or none each: the plain mean.
#[test]
fn uniform_sampling_has_weight_one() {
    for (solver, techniques) in SOLVERS.into_iter().flat_map(|solver| [(solver, 1), (solver, 16)]) {
        let drawn = Drawn {
            items: 64,
            techniques,
            pdf: vec![1.0 / 64.0; 10 * techniques],
            technique: (0..10).map(|s| s % techniques as u32).collect(),
            gradient: vec![0.0; 10],
        };
        let tolerance = if techniques == 1 { 1e-6 } else { 1e-5 };
        assert!(drawn.weights(solver).iter().all(|w| (w - 1.0).abs() < tolerance), "{:?}", drawn.weights(solver));
    }
}

/// Plain weights recover any linear combination of the probabilities without error, from any batch that tells them
/// apart.
#[test]
fn linear_combinations_are_exact() {
    let mut rng = Rng::seed(2);
    let base = random_problem(7, 4, 60, 1);
    let mixes = [[1.0, 0.0, 0.0, 0.0], [0.5, -1.0, 2.0, 0.1], [3.0, 3.0, -3.0, -2.9]];
    let gradient = |p: &[f32]| mixes.map(|mix| mix.iter().zip(p).map(|(m, &p)| m * p).sum::<f32>());
    let problem = Problem { gradient: base.pdf.chunks(4).flat_map(gradient).collect(), parameters: 3, ..base };
    // Each technique's probabilities sum to 1, so the mean gradient is the sum of the coefficients over N.
    let exact = mixes.map(|mix| f64::from(mix.iter().sum::<f32>()) / 60.0);
    let mut state = self::gradient(4, 3);
    for _ in 0..50 {
        let mut counts = [(); 4].map(|()| 2 + rng.below(5) as usize);
        let drawn = problem.draw(&counts, &mut rng);
        for (estimate, exact) in drawn.estimate(Solver::Plain).iter().zip(exact) {
            assert!((estimate - exact).abs() < 2e-4, "{estimate} is not {exact}");
        }
        // With momentum as well, though the counts change from batch to batch.
        counts[1] = 1;
        let drawn = problem.draw(&counts, &mut rng);
        let mut estimate = [0.0; 3];
        state.estimate(&drawn.batch(), Solver::Plain, 0.7, &drawn.gradient, &mut estimate).unwrap();
        for (&estimate, exact) in estimate.iter().zip(exact) {
            assert!((f64::from(estimate) - exact).abs() < 2e-4, "{estimate} is not {exact}");
        }
    }
}

/// Algorithm 5 prints W = n_j p_j / S where p_j / S belongs, which makes the estimate too small by the count. Of a
/// constant gradient of 1 it is 1 by three techniques, whose first is uniform, so that they span constants.
#[test]
fn counts_do_not_scale_the_estimate() {
    let mut rng = Rng::seed(3);
    let tables: Vec<Vec<f64>> =
        (0..3).map(|j| (0..100).map(|_| if j == 0 { 1.0 } else { rng.uniform_f64() }).collect()).collect();
    let problem = Problem::new(&tables, 0.0, vec![1.0; 100], 1);
    for counts in [[8, 8, 8], [1, 4, 9]] {
        let drawn = problem.draw(&counts, &mut rng);
        let estimate = drawn.estimate(Solver::Plain)[0];
        assert!((estimate - 1.0).abs() < 1e-5, "{estimate}");
    }
}

/// Without momentum, and at the first step with it, the explicit estimate is the weights'.
#[test]
fn gradients_are_the_weights() {
    let mut rng = Rng::seed(4);
    // Every remainder of blocks and rows, and of several groups.
    let shapes = [(1, 1, 1), (2, 7, 3), (3, 255, 4), (4, 256, 5), (5, 257, 6), (10, 1000, 64), (3, 520, 130)];
    for (techniques, parameters, batch) in shapes {
        let problem = random_problem(parameters as u64, techniques, 80, parameters);
        let counts: Vec<usize> = (0..techniques).map(|j| (batch + j) / techniques).collect();
        let mut state = gradient(techniques, parameters);
        for step in 0..6 {
            let drawn = problem.draw(&counts, &mut rng);
            let solver = SOLVERS[step % 3];
            let expected = drawn.weights(solver);
            // What rounding in f32 is relative to: the sum of sizes.
            let size: f64 = expected.iter().map(|w| f64::from(w.abs())).sum::<f64>() / expected.len() as f64;
            let mut estimate = vec![f32::NAN; parameters];
            if step == 0 {
                let mut first = gradient(techniques, parameters);
                first.estimate(&drawn.batch(), solver, 0.9, &drawn.gradient, &mut estimate).unwrap();
                let expected = drawn.apply(&expected);
                estimate.iter().zip(&expected).for_each(|(&a, e)| assert!((f64::from(a) - e).abs() < 1e-5 * size));
            }
            state.estimate(&drawn.batch(), solver, 0.0, &drawn.gradient, &mut estimate).unwrap();
            for (&a, e) in estimate.iter().zip(drawn.apply(&expected)) {
                assert!((f64::from(a) - e).abs() < 1e-5 * size, "{a} is not {e} ({solver:?}, size {size})");
            }
        }
    }
}

/// The copy for wider registers gives the same bits.
#[cfg(target_arch = "x86_64")]
#[test]
fn wider_registers_change_no_bit() {
    #[target_feature(enable = "avx2")]
    fn wide(state: &mut Gradient<Vec<f32>>, drawn: &Drawn, estimate: &mut [f32]) {
        state.estimate(&drawn.batch(), RIDGE, 0.6, &drawn.gradient, estimate).unwrap();
    }
    if !std::arch::is_x86_feature_detected!("avx2") {
        return;
    }
    let mut rng = Rng::seed(12);
    let problem = random_problem(12, 5, 60, 1300);
    let (mut a, mut b) = (gradient(5, 1300), gradient(5, 1300));
    for _ in 0..4 {
        let drawn = problem.draw(&[14; 5], &mut rng);
        let (mut x, mut y) = (vec![0.0; 1300], vec![1.0; 1300]);
        a.estimate(&drawn.batch(), RIDGE, 0.6, &drawn.gradient, &mut x).unwrap();
        // SAFETY: the processor has AVX2, as just found out.
        unsafe { wide(&mut b, &drawn, &mut y) };
        assert!(x.iter().zip(&y).all(|(x, y)| x.to_bits() == y.to_bits()));
        assert_eq!(a, b);
    }
}

/// With beta = 1 an average of any number of batches stays within a part in 2^9 of theirs.
#[test]
fn averages_do_not_drift() {
    let (mut rng, mut state, mut estimate) = (Rng::seed(6), gradient(1, 1), [0.0]);
    let batch = Batch::new(4, 1, &[0.25], &[0]).unwrap();
    for step in 1..7_000_001 {
        let value = 0.7 + 0.02 * rng.uniform_f32();
        state.estimate(&batch, Solver::Balance, 1.0, &[value], &mut estimate).unwrap();
        if step % 500_000 == 0 {
            assert!((estimate[0] / 0.71 - 1.0).abs() < 0.0022, "{step}: {estimate:?}");
        }
    }
}

/// Against weighted averages in f64 of every sum, with batches of different counts, one group of samples or more.
#[test]
fn momentum_is_the_oracle() {
    let mut rng = Rng::seed(5);
    let (techniques, parameters, items) = (3, 300, 70);
    let problem = random_problem(5, techniques, items, parameters);
    for beta in [0.3, 0.7, 1.0] {
        let mut state = gradient(techniques, parameters);
        let (mut a, mut q) = (vec![vec![0.0; 3]; 3], vec![0.0; 3]);
        let (mut n, mut weight) = (vec![0.0; 3], 0.0);
        let (mut balance, mut b) = (vec![0.0; parameters], vec![vec![0.0; parameters]; 3]);
        for step in 0..12 {
            let drawn = problem.draw(&[3 + step % 2, 4, if step % 5 == 3 { 130 } else { 2 + step % 3 }], &mut rng);
            let ratios = ratios(&drawn);
            let (new_a, new_q) = matrix_and_sum(&ratios);
            let beta64 = f64::from(beta);
            weight = beta64 * weight + 1.0;
            for j in 0..3 {
                q[j] = beta64 * q[j] + new_q[j];
                n[j] = beta64 * n[j] + counts(&drawn)[j];
                (0..3).for_each(|k| a[j][k] = beta64 * a[j][k] + new_a[j][k]);
            }
            balance.iter_mut().chain(b.iter_mut().flatten()).for_each(|sum| *sum *= beta64);
            for ((sum, r), g) in ratios.iter().zip(drawn.gradient.chunks(parameters)) {
                for (p, &g) in g.iter().enumerate() {
                    let term = f64::from(g) / sum / items as f64;
                    balance[p] += term;
                    (0..3).for_each(|j| b[j][p] += term * r[j]);
                }
            }
            let mut estimate = vec![f32::NAN; parameters];
            state.estimate(&drawn.batch(), RIDGE, beta, &drawn.gradient, &mut estimate).unwrap();

            let mut matrix = a.clone();
            let trace: f64 = (0..3).map(|j| n[j] / weight * a[j][j]).sum();
            let samples: f64 = n.iter().sum();
            let common: f64 = (0..9).map(|i| n[i / 3] * a[i / 3][i % 3] * n[i % 3]).sum::<f64>() / samples / weight;
            let ridge = f64::from(DEFAULT_RIDGE) * (trace - common) / samples;
            (0..3).for_each(|j| matrix[j][j] += ridge / (n[j] / weight));
            let c = least_squares(&matrix, &q.iter().map(|q| q - weight).collect::<Vec<_>>());
            let value = |p: usize| (balance[p] - (0..3).map(|j| c[j] * b[j][p]).sum::<f64>()) / weight;
            let expected: Vec<f64> = (0..parameters).map(value).collect();
            assert_close(&wide(&estimate), &expected, 2e-6);
        }
    }
}

#[test]
fn momentum_forgets() {
    let mut rng = Rng::seed(6);
    let problem = random_problem(6, 2, 40, 3);
    let mut state = gradient(2, 3);
    let drawn = problem.draw(&[4, 4], &mut rng);
    let mut first = [0.0; 3];
    state.estimate(&drawn.batch(), RIDGE, 0.7, &drawn.gradient, &mut first).unwrap();
    let fresh = state.clone();
    for _ in 0..5 {
        let other = problem.draw(&[4, 4], &mut rng);
        state.estimate(&other.batch(), Solver::Plain, 0.9, &other.gradient, &mut [0.0; 3]).unwrap();
    }
    assert_ne!(state, fresh);
    let mut again = [0.0; 3];
    let mut forgetful = state.clone();
    forgetful.estimate(&drawn.batch(), RIDGE, 0.0, &drawn.gradient, &mut again).unwrap();
    assert_eq!((again, &forgetful), (first, &fresh));
    state.reset();
    state.estimate(&drawn.batch(), RIDGE, 0.7, &drawn.gradient, &mut again).unwrap();
    assert_eq!((again, &state), (first, &fresh));
    state.reset();
    assert_eq!(state, Gradient::resume(vec![0.0; 9], System::new(2), 3).unwrap());
    state.estimate(&drawn.batch(), RIDGE, 0.7, &drawn.gradient, &mut again).unwrap();
    // What is taken up goes on as if it had never been put down.
    let mut resumed = Gradient::resume(fresh_memory(&fresh, &drawn), *state.system(), 3).unwrap();
    let (mut a, mut b) = ([0.0; 3], [0.0; 3]);
    state.estimate(&drawn.batch(), RIDGE, 0.5, &drawn.gradient, &mut a).unwrap();
    resumed.estimate(&drawn.batch(), RIDGE, 0.5, &drawn.gradient, &mut b).unwrap();
    assert_eq!(a, b);
}

/// The averages after one batch, made in memory of the caller's.
fn fresh_memory(like: &Gradient<Vec<f32>>, drawn: &Drawn) -> Vec<f32> {
    let mut memory = vec![0.0; gradient_len(2, 3)];
    let mut state = Gradient::new(&mut memory[..], 2, 3).unwrap();
    state.estimate(&drawn.batch(), RIDGE, 0.7, &drawn.gradient, &mut [0.0; 3]).unwrap();
    assert_eq!(state.system(), like.system());
    memory
}

/// Two identical techniques are one with the samples of both.
#[test]
fn identical_techniques() {
    let mut rng = Rng::seed(7);
    let problem = random_problem(8, 2, 50, 4);
    for _ in 0..20 {
        let single = problem.draw(&[5, 6], &mut rng);
        let mut double = single.clone();
        double.techniques = 3;
        double.pdf = single.pdf.chunks(2).flat_map(|p| [p[0], p[1], p[1]]).collect();
        double.technique.iter_mut().rev().take(2).for_each(|technique| *technique = 2);
        for (solver, tolerance) in [(Solver::Plain, 1e-4), (Solver::Balance, 1e-6)] {
            assert_close(&wide(&double.weights(solver)), &wide(&single.weights(solver)), tolerance);
        }
        assert!(double.weights(RIDGE).iter().all(|w| w.is_finite()));
    }
}

/// A technique that never drew is as good as none, whatever its probabilities are.
#[test]
fn technique_never_drawn() {
    let mut rng = Rng::seed(8);
    let problem = random_problem(9, 2, 50, 4);
    for place in 0..3 {
        let two = problem.draw(&[5, 6], &mut rng);
        for odd in [0.0, 1e-30, 0.02, 1.0, 1e30] {
            let mut three = two.clone();
            three.techniques = 3;
            three.pdf = Vec::new();
            for p in two.pdf.chunks(2) {
                let mut p = p.to_vec();
                p.insert(place, odd);
                three.pdf.extend(p);
            }
            three.technique.iter_mut().for_each(|j| *j += u32::from(*j as usize >= place));
            for solver in SOLVERS {
                assert_close(&wide(&three.weights(solver)), &wide(&two.weights(solver)), 1e-5);
                let (mut a, mut b) = ([0.0; 4], [0.0; 4]);
                gradient(2, 4).estimate(&two.batch(), solver, 0.5, &two.gradient, &mut a).unwrap();
                gradient(3, 4).estimate(&three.batch(), solver, 0.5, &three.gradient, &mut b).unwrap();
                assert_close(&wide(&b), &wide(&a), 1e-5);
            }
        }
    }
}

/// More techniques than samples, probabilities of 1e-30..1, and both at once: finite.
#[test]
fn singular_and_extreme() {
    let mut rng = Rng::seed(9);
    for step in 0..2000 {
        let techniques = 1 + step % 16;
        let batch = 1 + rng.below(6) as usize;
        let exponent = if step % 3 == 0 { 0.0 } else { 30.0 };
        let mut extreme = || 10f32.powf(-exponent * rng.uniform_f32());
        let drawn = Drawn {
            items: 1000,
            techniques,
            pdf: (0..techniques * batch).map(|_| extreme()).collect(),
            technique: (0..batch).map(|s| ((s * 7 + step) % techniques) as u32).collect(),
            gradient: vec![1.0; batch * 3],
        };
        for solver in SOLVERS {
            let weight = drawn.weights(solver);
            assert!(weight.iter().all(|w| w.is_finite()), "{weight:?}");
            let mut state = gradient(techniques, 3);
            let mut estimate = [f32::NAN; 3];
            for beta in [0.7, 0.0, 1.0] {
                state.estimate(&drawn.batch(), solver, beta, &drawn.gradient, &mut estimate).unwrap();
                assert!(estimate.iter().all(|e| e.is_finite()), "{estimate:?}");
            }
        }
    }
}

#[test]
fn batches_refuse() {
    let (pdf, technique) = ([0.5, 0.25, 0.125, 0.5], [0, 1]);
    let refuse = |items, techniques, pdf: &[f32], technique: &[u32], error| {
        assert_eq!(Batch::new(items, techniques, pdf, technique).unwrap_err(), error);
    };
    let batch = Batch::new(1, 2, &pdf, &technique).unwrap();
    assert_eq!((batch.len(), batch.techniques()), (2, 2));
    refuse(0, 2, &pdf, &technique, Error::Range);
    refuse(1, 0, &[], &technique, Error::Range);
    refuse(1, 17, &[0.5; 34], &technique, Error::Range);
    refuse(1, usize::MAX, &pdf, &technique, Error::Range);
    refuse(1, 2, &pdf[..3], &technique, Error::Length);
    refuse(1, 2, &pdf, &technique[..1], Error::Length);
    refuse(1, 2, &[], &[], Error::NoSamples);
    for (bad, error) in [
        (f32::NAN, Error::NotFinite),
        (f32::INFINITY, Error::NotFinite),
        (f32::NEG_INFINITY, Error::NotFinite),
        (-0.1, Error::Range),
    ] {
        for k in 0..4 {
            let mut pdf = pdf;
            pdf[k] = bad;
            refuse(1, 2, &pdf, &technique, error);
        }
    }
    // The technique's own probability is 0, or the technique does not exist.
    refuse(1, 2, &[0.0, 0.25, 0.125, 0.5], &technique, Error::Range);
    refuse(1, 2, &[-0.0, 0.25, 0.125, 0.5], &technique, Error::Range);
    // More than rounding above 1, where a technique drew something.
    refuse(1, 2, &[0.5, 1.01, 0.125, 0.5], &technique, Error::Range);
    refuse(1, 2, &[0.5, 0.25, 0.125, 1.01], &technique, Error::Range);
    assert!(Batch::new(1, 2, &[0.5, 1.0005, 0.125, 1.0005], &technique).is_ok());
    assert!(Batch::new(1, 2, &[0.5, 9.0, 0.125, 9.0], &[0, 0]).is_ok());
    refuse(1, 2, &pdf, &[0, 2], Error::Range);
    refuse(1, 2, &pdf, &[0, u32::MAX], Error::Range);
}

#[test]
fn estimates_refuse() {
    let (pdf, technique) = ([0.5, 0.25, 0.125, 0.5], [0, 1]);
    let batch = Batch::new(10, 2, &pdf, &technique).unwrap();
    let bad_solvers = [
        (Solver::Progressive, Error::Unsupported),
        (Solver::Ridge(0.0), Error::Range),
        (Solver::Ridge(1e9), Error::Range),
        (Solver::Ridge(f32::NAN), Error::NotFinite),
    ];
    let mut weight = [7.0; 3];
    assert_eq!(weights(&batch, RIDGE, &mut weight), Err(Error::Length));
    for (solver, error) in bad_solvers {
        assert_eq!(weights(&batch, solver, &mut weight[..2]), Err(error));
    }
    assert_eq!(weight, [7.0; 3]);

    assert_eq!(
        (
            gradient_len(0, 1),
            gradient_len(17, 1),
            gradient_len(1, 0),
            gradient_len(1, usize::MAX),
            gradient_len(16, usize::MAX / 17)
        ),
        (0, 0, 0, 0, 0)
    );
    assert_eq!((gradient_len(3, 5), gradient_len(4, 1000)), (20, 5000));
    assert_eq!(Gradient::new([0.0; 9], 17, 1).unwrap_err(), Error::Range);
    assert_eq!(Gradient::new([0.0; 9], 2, 0).unwrap_err(), Error::Range);
    assert_eq!(Gradient::new([0.0; 8], 2, 3).unwrap_err(), Error::Memory);
    let mut state = gradient(2, 3);
    let gradients = [0.5, 1.0, 2.0, 3.0, -1.0, 0.0];
    let mut estimate = [0.0; 3];
    state.estimate(&batch, RIDGE, 0.5, &gradients, &mut estimate).unwrap();
    let before = (state.clone(), estimate);
    let mut refuse = |batch: &Batch<'_>, solver, beta, gradients: &[f32], error| {
        assert_eq!(state.estimate(batch, solver, beta, gradients, &mut estimate), Err(error));
    };
    for (solver, error) in bad_solvers {
        refuse(&batch, solver, 0.5, &gradients, error);
    }
    for (beta, error) in
        [(-0.1, Error::Range), (1.1, Error::Range), (f32::NAN, Error::NotFinite), (f32::INFINITY, Error::NotFinite)]
    {
        refuse(&batch, RIDGE, beta, &gradients, error);
    }
    refuse(&batch, RIDGE, 0.5, &gradients[..5], Error::Length);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for k in 0..6 {
            let mut gradients = gradients;
            gradients[k] = bad;
            refuse(&batch, RIDGE, 0.5, &gradients, Error::NotFinite);
        }
    }
    let one = Batch::new(10, 1, &pdf[..2], &technique[..1]);
    assert_eq!(one.unwrap_err(), Error::Length);
    let one = Batch::new(10, 1, &pdf[..2], &[0, 0]).unwrap();
    refuse(&one, RIDGE, 0.5, &gradients, Error::Range);
    // Sums beyond the range of f32.
    let tiny = Batch::new(1, 2, &[1e-30, 0.0, 0.0, 1e-30], &technique).unwrap();
    refuse(&tiny, RIDGE, 0.5, &[1e10; 6], Error::Range);
    let denormal = Batch::new(1, 2, &[1e-45, 0.0, 0.0, 1e-45], &technique).unwrap();
    refuse(&denormal, RIDGE, 0.5, &[0.0; 6], Error::Range);
    assert_eq!(state.estimate(&batch, RIDGE, 0.5, &gradients, &mut [0.0; 2]), Err(Error::Length));
    assert_eq!((state, estimate), before);
}

proptest! {
    /// Any bits: a finite answer or an error, and then nothing has changed.
    #[test]
    fn anything(
        techniques in 1_usize..=16,
        batch in 1_usize..12,
        parameters in 1_usize..20,
        items in 1_u32..,
        style in 0..4,
        seed in any::<u64>(),
        beta in -0.25_f32..1.25,
        ridge in prop_oneof![Just(DEFAULT_RIDGE), any::<f32>()],
        kind in 0_usize..4,
    ) {
        let mut rng = Rng::seed(seed);
        let mut number = |positive: bool| match style {
            0 => f32::from_bits(rng.next_u32()),
            1 => {
                let mask = if positive { 0x7fff_ffff } else { u32::MAX };
                f32::from_bits(rng.next_u32() & mask).clamp(f32::MIN, f32::MAX)
            }
            2 => 10f32.powf(-44.0 * rng.uniform_f32()),
            _ => rng.uniform_f32(),
        };
        let pdf: Vec<f32> = (0..techniques * batch).map(|_| number(true)).collect();
        let gradients: Vec<f32> = (0..batch * parameters).map(|_| number(false)).collect();
        let technique: Vec<u32> = (0..batch).map(|_| rng.below(techniques as u32)).collect();
        let solver = [Solver::Ridge(ridge), Solver::Plain, Solver::Balance, Solver::Progressive][kind];
        let Ok(batch) = Batch::new(items, techniques, &pdf, &technique) else { return Ok(()) };
        let mut weight = vec![f32::NAN; technique.len()];
        let answer = weights(&batch, solver, &mut weight);
        let right = weight.iter().all(|w| if answer.is_ok() { w.is_finite() } else { w.is_nan() });
        prop_assert!(right, "{:?} {:?}", answer, weight);
        let mut state = gradient(techniques, parameters);
        for _ in 0..3 {
            let before = state.clone();
            let mut estimate = vec![f32::NAN; parameters];
            let answer = state.estimate(&batch, solver, beta, &gradients, &mut estimate);
            let right = estimate.iter().all(|e| if answer.is_ok() { e.is_finite() } else { e.is_nan() });
            prop_assert!(right, "{:?} {:?}", answer, estimate);
            prop_assert!(answer.is_ok() || state == before);
        }
    }
}
