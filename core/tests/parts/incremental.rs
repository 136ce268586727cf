//! What only the crate itself can make: sums beyond the range of their type.

use super::{Progress, outcome};

/// A spread that is no number is no perfect fit.
#[test]
fn a_spread_that_is_no_number_stays_so() {
    let mut progress = Progress::<f32>::default();
    progress.total[0] = f32::INFINITY;
    progress.square[0] = f32::INFINITY;
    assert!(outcome(&progress, 8).variance.unwrap()[0].is_nan());
}
