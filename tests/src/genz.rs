//! Genz's six families of integrands (1984), whose parameters are drawn.

use crate::random::SplitMix64;
use core::f64::consts::{PI, TAU};

/// Names of the families.
pub const FAMILIES: [&str; 6] =
    ["oscillatory", "product peak", "corner peak", "Gaussian", "continuous", "discontinuous"];
/// The sum of a family's `a`: how hard it is (Novak and Ritter 1996).
const DIFFICULTY: [f64; 6] = [9.0, 7.25, 1.85, 7.03, 20.4, 4.3];

/// One of them: how steep it is along each axis, and where it lies.
pub struct Genz {
    family: usize,
    a: Vec<f64>,
    w: Vec<f64>,
}

impl Genz {
    /// Draws the parameters.
    pub fn new(family: usize, dims: usize, rng: &mut SplitMix64) -> Genz {
        let mut drawn = || (0..dims).map(|_| rng.uniform()).collect::<Vec<_>>();
        let (a, w) = (drawn(), drawn());
        let scale = DIFFICULTY[family] / a.iter().sum::<f64>();
        Genz { family, a: a.iter().map(|a| (scale * a).max(1e-3)).collect(), w }
    }

    /// Its value at a point of the unit cube.
    pub fn evaluate(&self, u: &[f64]) -> f64 {
        let axes = || u.iter().zip(&self.a).zip(&self.w).map(|((x, a), w)| (*x, *a, *w));
        let sum: f64 = axes().map(|(x, a, _)| a * x).sum();
        match self.family {
            0 => (TAU * self.w[0] + sum).cos(),
            1 => axes().map(|(x, a, w)| 1.0 / (1.0 / (a * a) + (x - w) * (x - w))).product(),
            2 => (1.0 + sum).powi(-(u.len() as i32 + 1)),
            3 => axes().map(|(x, a, w)| (-(a * (x - w)).powi(2)).exp()).product(),
            4 => axes().map(|(x, a, w)| (-a * (x - w).abs()).exp()).product(),
            _ if axes().take(2).any(|(x, _, w)| x > w) => 0.0,
            _ => sum.exp(),
        }
    }

    /// Its integral over the unit cube.
    pub fn integral(&self) -> f64 {
        let axes = || self.a.iter().zip(&self.w);
        match self.family {
            0 => {
                let amplitude: f64 = self.a.iter().map(|a| (a / 2.0).sin() / (a / 2.0)).product();
                (TAU * self.w[0] + self.a.iter().sum::<f64>() / 2.0).cos() * amplitude
            }
            1 => axes().map(|(a, w)| a * ((a * (1.0 - w)).atan() + (a * w).atan())).product(),
            2 => {
                // Inclusion and exclusion over the cube's corners.
                let dims = self.a.len();
                let corner = |bits: usize| {
                    let sum: f64 = self.a.iter().enumerate().map(|(j, a)| (bits >> j & 1) as f64 * a).sum();
                    (if bits.count_ones().is_multiple_of(2) { 1.0 } else { -1.0 }) / (1.0 + sum)
                };
                let factors = self.a.iter().zip(1..).map(|(a, j)| a * f64::from(j)).product::<f64>();
                (0..1 << dims).map(corner).sum::<f64>() / factors
            }
            3 => axes().map(|(a, w)| PI.sqrt() / 2.0 / a * (libm::erf(a * (1.0 - w)) + libm::erf(a * w))).product(),
            4 => axes().map(|(a, w)| (2.0 - (-a * w).exp() - (-a * (1.0 - w)).exp()) / a).product(),
            _ => {
                let end = |axis: usize| if axis < 2 { self.w[axis] } else { 1.0 };
                self.a.iter().enumerate().map(|(axis, a)| (a * end(axis)).exp_m1() / a).product()
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
        for (family, name) in FAMILIES.iter().enumerate() {
            let genz = Genz::new(family, 2, &mut rng);
            let at = |i: usize| (i as f64 + 0.5) / SIDE as f64;
            let sum: f64 = (0..SIDE * SIDE).map(|i| genz.evaluate(&[at(i / SIDE), at(i % SIDE)])).sum();
            let (found, exact) = (sum / (SIDE * SIDE) as f64, genz.integral());
            assert!((found - exact).abs() < 3e-3 * exact.abs().max(1e-3), "{name}: {found} for {exact}");
        }
    }
}
