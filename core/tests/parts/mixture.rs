//! Numbers to draw by: what only the crate itself can see.

use super::*;

/// As many numbers as there are of those that are asked for: each is itself, none is left out. Of many more, the first
/// and the last become the first and the last.
#[test]
fn all_numbers_are_reached() {
    for first in [0, 1 << 63] {
        for n in 1..100 {
            let scale = Scale::new(first, n.into(), n);
            assert!((0..n).all(|x| scale.map(first + x).0 == x), "{n}");
        }
        for n in [1, 2, 3, 60_000, u64::from(u32::MAX), (1 << 62) - 1] {
            let span = (1 << 64) - u128::from(first);
            let scale = Scale::new(first, span, n);
            assert_eq!([first, u64::MAX].map(|x| scale.map(x).0), [0, n - 1], "{n}");
        }
    }
}
