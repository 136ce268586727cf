//! The balance, power, cutoff and maximum heuristics (2.12-2.14).

use crate::mis_support::{Z_LIMIT, problems, z};
use noisefloor::Error;
use noisefloor::mis::{DEFAULT_BETA, balance, cutoff, maximum, power};
use noisefloor::rng::Rng;
use noisefloor_tests::statistics::Moments;
use proptest::prelude::*;

type Heuristic = fn(&[f32], &[u32], usize) -> Result<f32, Error>;

const ALL: [(&str, Heuristic); 7] = [
    ("balance", balance),
    ("power 2", |pdf, counts, j| power(pdf, counts, j, DEFAULT_BETA)),
    ("power 0.5", |pdf, counts, j| power(pdf, counts, j, 0.5)),
    ("power 7.3", |pdf, counts, j| power(pdf, counts, j, 7.3)),
    ("cutoff 0.1", |pdf, counts, j| cutoff(pdf, counts, j, 0.1)),
    ("cutoff 1", |pdf, counts, j| cutoff(pdf, counts, j, 1.0)),
    ("maximum", maximum),
];

fn weights(heuristic: Heuristic, pdf: &[f32], counts: &[u32]) -> Vec<f32> {
    (0..pdf.len()).map(|j| heuristic(pdf, counts, j).unwrap()).collect()
}

/// 1e-38..1e38, 0, the smallest and largest f32, infinity.
fn density() -> impl Strategy<Value = f32> {
    prop_oneof![
        6 => (-38.0..38.0_f32).prop_map(|exponent| 10.0_f32.powf(exponent)),
        3 => 0.1..10.0_f32,
        2 => Just(0.0_f32),
        1 => Just(f32::from_bits(1)),
        1 => Just(f32::MAX),
        1 => Just(f32::INFINITY),
    ]
}

fn techniques() -> impl Strategy<Value = (Vec<f32>, Vec<u32>)> {
    let count = prop_oneof![4 => 1..100_u32, 1 => Just(0), 1 => Just(u32::MAX)];
    prop::collection::vec((density(), count), 1..=16).prop_map(|both| both.into_iter().unzip())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn weights_sum_to_one_and_vanish_with_the_density((pdf, counts) in techniques()) {
        let possible = pdf.iter().zip(&counts).any(|(&p, &n)| p > 0.0 && n > 0);
        for (name, heuristic) in ALL {
            let weights = weights(heuristic, &pdf, &counts);
            let sum: f64 = weights.iter().map(|&w| f64::from(w)).sum();
            // Each weight is rounded to f32, by at most 2^-25.
            let expected = if possible { 1.0 } else { 0.0 };
            prop_assert!((sum - expected).abs() < 16.0 * 3e-8, "{name}: sum {sum} of {weights:?}");
            for ((w, p), n) in weights.iter().zip(&pdf).zip(&counts) {
                prop_assert!((0.0..=1.0).contains(w));
                prop_assert!(*w == 0.0 || (*p > 0.0 && *n > 0), "{name}: {w} for density {p}, count {n}");
            }
        }
    }

    #[test]
    fn the_unit_of_the_densities_does_not_matter(
        // Proptest 1.12 asserts too much of ends that are no multiples of the largest value's last bit.
        both in prop::collection::vec((0.0078125..10.0_f32, 1..9_u32), 1..=16),
        exponent in -100..100_i32,
    ) {
        let (pdf, counts): (Vec<f32>, Vec<u32>) = both.into_iter().unzip();
        let scaled: Vec<f32> = pdf.iter().map(|p| p * 2.0_f32.powi(exponent)).collect();
        for (name, heuristic) in ALL {
            prop_assert_eq!(weights(heuristic, &pdf, &counts), weights(heuristic, &scaled, &counts), "{}", name);
        }
    }
}

#[test]
fn values_by_hand() {
    // n p = 2, 6, 0.5.
    let (pdf, counts) = ([2.0, 3.0, 0.25], [1, 2, 2]);
    let close = |heuristic: Heuristic, expected: [f64; 3]| {
        for (w, e) in weights(heuristic, &pdf, &counts).iter().zip(expected) {
            assert!((f64::from(*w) - e).abs() < 1e-7, "{w} is not {e}");
        }
    };
    close(balance, [2.0 / 8.5, 6.0 / 8.5, 0.5 / 8.5]);
    close(|p, n, j| power(p, n, j, 1.0), [2.0 / 8.5, 6.0 / 8.5, 0.5 / 8.5]);
    close(|p, n, j| power(p, n, j, 2.0), [4.0 / 40.25, 36.0 / 40.25, 0.25 / 40.25]);
    close(|p, n, j| power(p, n, j, 3.0), [8.0 / 224.125, 216.0 / 224.125, 0.125 / 224.125]);
    // 0.5 is below a tenth of 6; 2 is exactly a third of it and stays.
    close(|p, n, j| cutoff(p, n, j, 0.1), [0.25, 0.75, 0.0]);
    close(|p, n, j| cutoff(p, n, j, 0.33), [0.25, 0.75, 0.0]);
    close(|p, n, j| cutoff(p, n, j, 0.34), [0.0, 1.0, 0.0]);
    close(maximum, [0.0, 1.0, 0.0]);
    // To the bit.
    let (pdf, counts) = ([1.0, 3.0], [1, 1]);
    assert_eq!([balance(&pdf, &counts, 1), power(&pdf, &counts, 1, 2.0)], [Ok(0.75), Ok(0.9)]);
    assert_eq!([cutoff(&pdf, &counts, 0, 0.5), maximum(&pdf, &counts, 1)], [Ok(0.0), Ok(1.0)]);
}

#[test]
fn the_limits_of_the_families() {
    let (pdf, counts) = ([0.3, 4.0, 1.5, 0.0], [7, 1, 2, 3]);
    for j in 0..4 {
        let balanced = balance(&pdf, &counts, j).unwrap();
        assert_eq!(power(&pdf, &counts, j, 1.0), Ok(balanced));
        assert_eq!(cutoff(&pdf, &counts, j, 0.0), Ok(balanced));
        let best = maximum(&pdf, &counts, j).unwrap();
        assert_eq!(cutoff(&pdf, &counts, j, 1.0), Ok(best));
        assert_eq!(power(&pdf, &counts, j, f32::MAX), Ok(best));
        // The other limit: equal weights wherever there is density.
        assert_eq!(power(&pdf, &counts, j, f32::MIN_POSITIVE), Ok(if j < 3 { 1.0 / 3.0 } else { 0.0 }));
    }
}

#[test]
fn ties() {
    let (pdf, counts) = ([1.0, 2.0, 2.0, 4.0], [1, 2, 2, 1]);
    assert_eq!(weights(maximum, &pdf, &counts), [0.0, 1.0, 0.0, 0.0]);
    let third = 1.0 / 3.0;
    assert_eq!(weights(|p, n, j| cutoff(p, n, j, 1.0), &pdf, &counts), [0.0, third, third, third]);
}

#[test]
fn delta_distributions_outweigh_densities() {
    let infinity = f32::INFINITY;
    let (pdf, counts) = ([f32::MAX, infinity, infinity, 0.0], [1000, 1, 3, 1]);
    assert_eq!(weights(balance, &pdf, &counts), [0.0, 0.25, 0.75, 0.0]);
    assert_eq!(weights(|p, n, j| power(p, n, j, 2.0), &pdf, &counts), [0.0, 0.1, 0.9, 0.0]);
    assert_eq!(weights(|p, n, j| cutoff(p, n, j, 0.5), &pdf, &counts), [0.0, 0.0, 1.0, 0.0]);
    assert_eq!(weights(maximum, &pdf, &counts), [0.0, 0.0, 1.0, 0.0]);
    // A delta distribution that took no sample plays no part.
    for (_, heuristic) in ALL {
        assert_eq!(weights(heuristic, &[1.0, infinity], &[1, 0]), [1.0, 0.0]);
    }
}

#[test]
fn a_point_that_no_technique_can_draw_has_no_weight() {
    for (_, heuristic) in ALL {
        assert_eq!(weights(heuristic, &[0.0, 0.0], &[1, 1]), [0.0, 0.0]);
        assert_eq!(weights(heuristic, &[1.0, 0.0], &[0, 1]), [0.0, 0.0]);
    }
}

#[test]
fn errors() {
    for (_, heuristic) in ALL {
        assert_eq!(heuristic(&[], &[], 0), Err(Error::Range));
        assert_eq!(heuristic(&[1.0; 17], &[1; 17], 0), Err(Error::Range));
        assert!(heuristic(&[1.0; 16], &[1; 16], 15).is_ok());
        assert_eq!(heuristic(&[1.0; 2], &[1; 3], 0), Err(Error::Length));
        assert_eq!(heuristic(&[1.0; 2], &[1; 2], 2), Err(Error::Range));
        assert_eq!(heuristic(&[1.0; 2], &[1; 2], usize::MAX), Err(Error::Range));
        assert_eq!(heuristic(&[1.0, -1e-30], &[1; 2], 0), Err(Error::Range));
        assert_eq!(heuristic(&[1.0, f32::NEG_INFINITY], &[1; 2], 0), Err(Error::Range));
        assert_eq!(heuristic(&[1.0, f32::NAN], &[1; 2], 0), Err(Error::NotFinite));
        // Negative zero is zero.
        assert_eq!(heuristic(&[1.0, -0.0], &[1; 2], 0), Ok(1.0));
    }
    let power = |beta| power(&[1.0], &[1], 0, beta);
    assert_eq!(power(0.0), Err(Error::Range));
    assert_eq!(power(-1.0), Err(Error::Range));
    assert_eq!(power(f32::NAN), Err(Error::NotFinite));
    assert_eq!(power(f32::INFINITY), Err(Error::NotFinite));
    let cutoff = |epsilon| cutoff(&[1.0], &[1], 0, epsilon);
    assert_eq!(cutoff(-0.1), Err(Error::Range));
    assert_eq!(cutoff(1.1), Err(Error::Range));
    assert_eq!(cutoff(f32::NAN), Err(Error::NotFinite));
}

/// (2.10) with every heuristic on every problem: 40 000 rounds, fixed seed, each at significance 1e-5.
#[test]
fn estimates_are_unbiased() {
    for (seed, problem) in problems().iter().enumerate() {
        for (name, heuristic) in ALL {
            let mut rng = Rng::seed(100 + seed as u64);
            let mut moments = Moments::default();
            for _ in 0..40_000 {
                let term = |s: &crate::mis_support::Sample| {
                    let j = s.technique;
                    let weight = f64::from(heuristic(&s.pdf, &problem.counts, j).unwrap());
                    weight * f64::from(s.value) / (f64::from(problem.counts[j]) * f64::from(s.pdf[j]))
                };
                moments.add(problem.round(&mut rng).iter().map(term).sum());
            }
            let z = z(&moments, problem.integral);
            assert!(z.abs() < Z_LIMIT, "{}, {name}: z = {z:.2}", problem.name);
        }
    }
}
