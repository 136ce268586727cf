//! Logarithms and powers lane by lane: what only the crate itself can see.

use super::{exp2, log2};

#[test]
fn powers_and_logarithms() {
    for i in -1_260..=1_260 {
        let x = i as f32 / 10.0 + 0.037;
        let [power, ..] = exp2(&[x; 8]);
        let exact = libm::exp2(f64::from(x.clamp(-126.0, 126.0)));
        assert!((f64::from(power) / exact - 1.0).abs() < 3e-7, "2^{x}: {power}");
        let [logarithm, ..] = log2(&[power; 8]);
        let exact = libm::log2(f64::from(power));
        assert!((f64::from(logarithm) - exact).abs() < 3e-7 * exact.abs().max(1.0), "log {power}: {logarithm}");
    }
}
