//! The quotient of a scale is that of 128 bits.

use super::quotient;
use crate::rng::Rng;

#[test]
fn quotients_are_exact() {
    let mut rng = Rng::new(7, 0);
    let mut bits = || u64::from(rng.next_u32()) << 32 | u64::from(rng.next_u32());
    let ends = [1 << 63, (1 << 63) + 1, (1 << 63) | 0xffff_ffff, u64::MAX << 32, u64::MAX - 1, u64::MAX];
    for k in 0..100_000 {
        let divisor = if k % 2 == 0 { bits() | 1 << 63 } else { ends[k / 2 % ends.len()] };
        // Near the divisor, too, and such as need the largest digits.
        let n = [bits() % divisor, divisor - 1 - (bits() >> 40), divisor & !0xffff_ffff, bits() >> 40][k % 4] % divisor;
        assert_eq!(u128::from(quotient(n, divisor)), (u128::from(n) << 64) / u128::from(divisor), "{n} {divisor}");
    }
    assert_eq!(quotient(12345, 0), 12345);
}
