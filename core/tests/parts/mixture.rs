//! Numbers to draw by: what only the crate itself can see.

use super::{Scale, quotient};
use crate::rng::Rng;

/// A span of n numbers maps to those below n one to one; of a longer span the first and the last map to 0 and n - 1.
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

/// The same as division in 128 bits.
#[test]
fn quotients_are_exact() {
    let mut rng = Rng::new(7, 0);
    let mut bits = || u64::from(rng.next_u32()) << 32 | u64::from(rng.next_u32());
    let ends = [1 << 63, (1 << 63) + 1, (1 << 63) | 0xffff_ffff, u64::MAX << 32, u64::MAX - 1, u64::MAX];
    for k in 0..100_000 {
        let divisor = ends.get(k % 8).copied().unwrap_or_else(|| bits() | 1 << 63);
        // Anywhere, just below the divisor, one that needs the largest digit, and small.
        let n = [bits(), divisor - 1 - (bits() >> 40), divisor & !0xffff_ffff, bits() >> 40][k / 8 % 4] % divisor;
        assert_eq!(u128::from(quotient(n, divisor)), (u128::from(n) << 64) / u128::from(divisor), "{n} {divisor}");
    }
    assert_eq!(quotient(12345, 0), 12345);
}
