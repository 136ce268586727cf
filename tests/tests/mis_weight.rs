//! What samples add with the optimal weights (2.15).

use noisefloor::Error;
use noisefloor::mis::{balance, optimal_contribution};
use proptest::prelude::*;

/// The optimal weight w_j = term n_j p_j / f.
fn optimal(pdf: &[f32], counts: &[u32], j: usize, alpha: &[f32], value: f32) -> f64 {
    let term = optimal_contribution(pdf, counts, j, alpha, value).unwrap();
    f64::from(term) * f64::from(counts[j]) * f64::from(pdf[j]) / f64::from(value)
}

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
            if pdf[j] == 0.0 {
                prop_assert_eq!(optimal_contribution(&pdf, &counts, j, &alpha, value), Err(Error::Range));
                continue;
            }
            let weight = optimal(&pdf, &counts, j, &alpha, value);
            sum += weight;
            largest = largest.max(weight.abs());
        }
        let expected = if pdf.iter().any(|&p| p > 0.0) { 1.0 } else { 0.0 };
        prop_assert!((sum - expected).abs() < 16.0 * 6e-8 * largest, "sum {}", sum);
    }
}

#[test]
fn alpha_zero_is_the_balance_heuristic() {
    let (pdf, counts) = ([0.3, 2.0, 0.7], [2, 1, 5]);
    for j in 0..3 {
        let expected = f64::from(balance(&pdf, &counts, j).unwrap());
        assert!((optimal(&pdf, &counts, j, &[0.0; 3], 1.7) - expected).abs() < 1e-7);
    }
    assert_eq!(optimal(&[1.0, 3.0], &[1, 1], 1, &[0.0; 2], 2.0), 0.75);
}

#[test]
fn a_value_by_hand() {
    // S = 2 * 1 + 1 * 3 = 5, sum alpha p = 0.5 * 1 - 1 * 3 = -2.5, f = 2:
    // w_0 = 0.5 * 1 / 2 + 2 / 5 (1 + 1.25) = 1.15, w_1 = -1 * 3 / 2 + 3 / 5 * 2.25 = -0.15.
    let (pdf, counts, alpha) = ([1.0, 3.0], [2, 1], [0.5, -1.0]);
    assert!((optimal(&pdf, &counts, 0, &alpha, 2.0) - 1.15).abs() < 1e-7);
    assert!((optimal(&pdf, &counts, 1, &alpha, 2.0) + 0.15).abs() < 1e-7);
    // alpha_0 / n_0 + (0 + 2.5) / 5.
    assert_eq!(optimal_contribution(&pdf, &counts, 0, &alpha, 0.0), Ok(0.75));
}

#[test]
fn errors() {
    let w = optimal_contribution;
    let range = Err(Error::Range);
    assert_eq!(w(&[], &[], 0, &[], 1.0), range);
    assert_eq!(w(&[1.0; 17], &[1; 17], 0, &[0.0; 17], 1.0), range);
    assert_eq!(w(&[1.0; 2], &[1; 1], 0, &[0.0; 2], 1.0), Err(Error::Length));
    assert_eq!(w(&[1.0; 2], &[1; 2], 0, &[0.0; 3], 1.0), Err(Error::Length));
    assert_eq!(w(&[1.0; 2], &[1; 2], 2, &[0.0; 2], 1.0), range);
    assert_eq!(w(&[1.0, -1.0], &[1; 2], 0, &[0.0; 2], 1.0), range);
    assert_eq!(w(&[1.0; 2], &[1, 0], 0, &[0.0; 2], 1.0), range);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(w(&[1.0, bad], &[1; 2], 0, &[0.0; 2], 1.0), Err(Error::NotFinite));
        assert_eq!(w(&[1.0; 2], &[1; 2], 0, &[0.0, bad], 1.0), Err(Error::NotFinite));
        assert_eq!(w(&[1.0; 2], &[1; 2], 0, &[0.0; 2], bad), Err(Error::NotFinite));
    }
    // A term that is no f32: a large value over a tiny density.
    assert_eq!(w(&[1e-30], &[1], 0, &[0.0], 1e30), range);
}
