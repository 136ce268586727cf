//! Genz's families of integrands (1984).

use crate::random::SplitMix64;
use core::f64::consts::{PI, TAU};

/// A family. One of its members has a steepness `a` along each axis, above 0, and a place `w`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Family {
    /// A wave.
    Oscillatory,
    /// A product of Lorentzian peaks.
    ProductPeak,
    /// A peak in the corner at 0, wherever `w` is.
    CornerPeak,
    /// A Gaussian.
    Gaussian,
    /// Continuous, with a kink along each axis.
    Continuous,
    /// 0 behind `w` along the first two axes.
    Discontinuous,
}

impl Family {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Oscillatory, Self::ProductPeak, Self::CornerPeak, Self::Gaussian, Self::Continuous, Self::Discontinuous];

    /// For tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Oscillatory => "oscillatory",
            Self::ProductPeak => "product peak",
            Self::CornerPeak => "corner peak",
            Self::Gaussian => "Gaussian",
            Self::Continuous => "continuous",
            Self::Discontinuous => "discontinuous",
        }
    }

    /// The sum of `a` that makes members equally hard (Novak and Ritter 1996).
    fn difficulty(self) -> f64 {
        match self {
            Self::Oscillatory => 9.0,
            Self::ProductPeak => 7.25,
            Self::CornerPeak => 1.85,
            Self::Gaussian => 7.03,
            Self::Continuous => 20.4,
            Self::Discontinuous => 4.3,
        }
    }

    /// `a` and `w` of a random member of that difficulty.
    pub fn draw(self, dims: usize, rng: &mut SplitMix64) -> [Vec<f64>; 2] {
        let mut drawn = || (0..dims).map(|_| rng.uniform()).collect::<Vec<_>>();
        let (a, w) = (drawn(), drawn());
        let scale = self.difficulty() / a.iter().sum::<f64>();
        [a.iter().map(|a| (scale * a).max(1e-3)).collect(), w]
    }

    /// A member's value at a point of the unit cube.
    pub fn evaluate(self, u: &[f64], a: &[f64], w: &[f64]) -> f64 {
        let axes = || u.iter().zip(a).zip(w).map(|((x, a), w)| (*x, *a, *w));
        let sum: f64 = u.iter().zip(a).map(|(x, a)| a * x).sum();
        match self {
            Self::Oscillatory => (TAU * w[0] + sum).cos(),
            Self::ProductPeak => axes().map(|(x, a, w)| 1.0 / (1.0 / (a * a) + (x - w).powi(2))).product(),
            Self::CornerPeak => (1.0 + sum).powi(-(u.len() as i32 + 1)),
            Self::Gaussian => axes().map(|(x, a, w)| (-(a * (x - w)).powi(2)).exp()).product(),
            Self::Continuous => axes().map(|(x, a, w)| (-a * (x - w).abs()).exp()).product(),
            Self::Discontinuous if axes().take(2).any(|(x, _, w)| x > w) => 0.0,
            Self::Discontinuous => sum.exp(),
        }
    }

    /// A member's integral over the unit cube.
    pub fn integral(self, a: &[f64], w: &[f64]) -> f64 {
        let axes = || a.iter().zip(w);
        match self {
            // Re(e^(i 2 pi w) prod (e^(i a) - 1) / (i a)).
            Self::Oscillatory => {
                let amplitude: f64 = a.iter().map(|a| (a / 2.0).sin() / (a / 2.0)).product();
                (TAU * w[0] + a.iter().sum::<f64>() / 2.0).cos() * amplitude
            }
            Self::ProductPeak => axes().map(|(a, w)| a * ((a * (1.0 - w)).atan() + (a * w).atan())).product(),
            // Inclusion and exclusion over the cube's corners, divided by dims! prod a.
            Self::CornerPeak => {
                let corner = |bits: usize| {
                    let sum: f64 = (0..a.len()).filter(|j| bits >> j & 1 == 1).map(|j| a[j]).sum();
                    (if bits.count_ones().is_multiple_of(2) { 1.0 } else { -1.0 }) / (1.0 + sum)
                };
                let divisor = a.iter().zip(1..).map(|(a, j)| a * f64::from(j)).product::<f64>();
                (0..1 << a.len()).map(corner).sum::<f64>() / divisor
            }
            Self::Gaussian => {
                axes().map(|(a, w)| PI.sqrt() / 2.0 / a * (libm::erf(a * (1.0 - w)) + libm::erf(a * w))).product()
            }
            Self::Continuous => axes().map(|(a, w)| (2.0 - (-a * w).exp() - (-a * (1.0 - w)).exp()) / a).product(),
            Self::Discontinuous => {
                let end = |axis: usize| if axis < 2 { w[axis] } else { 1.0 };
                a.iter().enumerate().map(|(axis, a)| (a * end(axis)).exp_m1() / a).product()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the midpoint rule.
    #[test]
    fn integrals_are_those_of_the_values() {
        const SIDE: usize = 1000;
        let mut rng = SplitMix64::new(1);
        for family in Family::ALL {
            let [a, w] = family.draw(2, &mut rng);
            let at = |i: usize| (i as f64 + 0.5) / SIDE as f64;
            let sum: f64 = (0..SIDE * SIDE).map(|i| family.evaluate(&[at(i / SIDE), at(i % SIDE)], &a, &w)).sum();
            let (found, exact) = (sum / (SIDE * SIDE) as f64, family.integral(&a, &w));
            assert!((found - exact).abs() < 3e-3 * exact.abs().max(1e-3), "{family:?}: {found} for {exact}");
        }
    }
}
