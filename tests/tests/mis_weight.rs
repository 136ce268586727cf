//! The optimal weights at a point (2.15).

use noisefloor::Error;
use noisefloor::mis::{balance, optimal, optimal_contribution};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn weights_sum_to_one_for_any_alpha(
        rows in prop::collection::vec(
            (prop_oneof![4 => 0.01..10.0_f32, 1 => Just(0.0_f32)], 1..9_u32, -3.0..3.0_f32),
            1..=16,
        ),
        value in prop_oneof![0.1..5.0_f32, -5.0..-0.1_f32],
    ) {
        let pdf: Vec<f32> = rows.iter().map(|r| r.0).collect();
        let counts: Vec<u32> = rows.iter().map(|r| r.1).collect();
        let alpha: Vec<f32> = rows.iter().map(|r| r.2).collect();
        let mut sum = 0.0;
        let mut largest = 1.0_f64;
        for j in 0..pdf.len() {
            let weight = optimal(&pdf, &counts, j, &alpha, value).unwrap();
            sum += f64::from(weight);
            largest = largest.max(f64::from(weight).abs());
            if pdf[j] == 0.0 {
                prop_assert_eq!(weight, 0.0);
                prop_assert_eq!(optimal_contribution(&pdf, &counts, j, &alpha, value), Err(Error::Range));
            } else {
                let expected = f64::from(weight) * f64::from(value) / (f64::from(counts[j]) * f64::from(pdf[j]));
                let term = f64::from(optimal_contribution(&pdf, &counts, j, &alpha, value).unwrap());
                prop_assert!((term - expected).abs() <= 1e-6 * expected.abs() + 1e-6, "{} {}", term, expected);
            }
        }
        let expected = if pdf.iter().any(|&p| p > 0.0) { 1.0 } else { 0.0 };
        prop_assert!((sum - expected).abs() < 16.0 * 6e-8 * largest, "sum {}", sum);
    }
}

#[test]
fn alpha_zero_is_the_balance_heuristic() {
    let (pdf, counts) = ([0.3, 2.0, 0.7], [2, 1, 5]);
    for j in 0..3 {
        let expected = balance(&pdf, &counts, j).unwrap();
        assert!((optimal(&pdf, &counts, j, &[0.0; 3], 1.7).unwrap() - expected).abs() < 1e-7);
    }
    assert_eq!(optimal(&[1.0, 3.0], &[1, 1], 1, &[0.0; 2], 2.0), Ok(0.75));
}

#[test]
fn a_value_by_hand() {
    // S = 2 * 1 + 1 * 3 = 5, sum alpha p = 0.5 * 1 - 1 * 3 = -2.5, f = 2:
    // w_0 = 0.5 * 1 / 2 + 2 / 5 (1 + 1.25) = 1.15, w_1 = -1 * 3 / 2 + 3 / 5 * 2.25 = -0.15.
    let (pdf, counts, alpha) = ([1.0, 3.0], [2, 1], [0.5, -1.0]);
    assert_eq!(optimal(&pdf, &counts, 0, &alpha, 2.0), Ok(1.15));
    assert_eq!(optimal(&pdf, &counts, 1, &alpha, 2.0), Ok(-0.15));
    // alpha_0 / n_0 + (0 + 2.5) / 5.
    assert_eq!(optimal_contribution(&pdf, &counts, 0, &alpha, 0.0), Ok(0.75));
}

#[test]
fn errors() {
    let w = |pdf: &[f32], counts: &[u32], j, alpha: &[f32], value| {
        let (weight, term) =
            (optimal(pdf, counts, j, alpha, value), optimal_contribution(pdf, counts, j, alpha, value));
        assert_eq!(weight.err(), term.err());
        weight
    };
    let range = Err(Error::Range);
    assert_eq!(w(&[], &[], 0, &[], 1.0), range);
    assert_eq!(w(&[1.0; 17], &[1; 17], 0, &[0.0; 17], 1.0), range);
    assert_eq!(w(&[1.0; 2], &[1; 1], 0, &[0.0; 2], 1.0), range);
    assert_eq!(w(&[1.0; 2], &[1; 2], 0, &[0.0; 3], 1.0), range);
    assert_eq!(w(&[1.0; 2], &[1; 2], 2, &[0.0; 2], 1.0), range);
    assert_eq!(w(&[1.0, -1.0], &[1; 2], 0, &[0.0; 2], 1.0), range);
    assert_eq!(w(&[1.0; 2], &[1, 0], 0, &[0.0; 2], 1.0), range);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(w(&[1.0, bad], &[1; 2], 0, &[0.0; 2], 1.0), Err(Error::NotFinite));
        assert_eq!(w(&[1.0; 2], &[1; 2], 0, &[0.0, bad], 1.0), Err(Error::NotFinite));
        assert_eq!(w(&[1.0; 2], &[1; 2], 0, &[0.0; 2], bad), Err(Error::NotFinite));
    }
    // No weight exists where f is 0, or so small that the weight is no f32; the sample contributes all the same.
    for value in [0.0, -0.0, 1e-40] {
        assert_eq!(optimal(&[1.0, 2.0], &[1; 2], 0, &[3.0, 1.0], value), range);
        assert!(optimal_contribution(&[1.0, 2.0], &[1; 2], 0, &[3.0, 1.0], value).is_ok());
    }
    // A term that is no f32: a large value over a tiny density.
    assert_eq!(optimal_contribution(&[1e-30], &[1], 0, &[0.0], 1e30), range);
    assert!(optimal(&[1e-30], &[1], 0, &[0.0], 1e30).is_ok());
}
