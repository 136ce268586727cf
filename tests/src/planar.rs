//! Half-planes and Gaussian bumps over the unit square that may move and scale across an image, with exact integrals,
//! and the error of an image with and without the eye's blur.

use crate::random::SplitMix64;
use core::f64::consts::TAU;

/// A function on [0, 1]^2.
#[derive(Clone, Copy, Debug)]
pub enum Planar {
    /// 1 where a . u < b.
    HalfPlane {
        /// A unit vector.
        a: [f64; 2],
        /// The offset.
        b: f64,
    },
    /// exp(-|u - c|^2 / (2 s^2)).
    Bump {
        /// The centre.
        c: [f64; 2],
        /// The standard deviation.
        s: f64,
    },
}

impl Planar {
    /// A half-plane whose border goes through a random point in a random direction.
    pub fn half_plane(rng: &mut SplitMix64) -> Self {
        let (sin, cos) = (TAU * rng.uniform()).sin_cos();
        let a = [cos, sin];
        Self::HalfPlane { a, b: a[0] * rng.uniform() + a[1] * rng.uniform() }
    }

    /// A bump of random centre and a standard deviation from .05 to .3.
    pub fn bump(rng: &mut SplitMix64) -> Self {
        Self::Bump { c: [rng.uniform(), rng.uniform()], s: 0.05 + 0.25 * rng.uniform() }
    }

    /// Moved: the half-plane's border along its normal, the bump along the first axis.
    #[must_use]
    pub fn moved(self, by: f64) -> Self {
        match self {
            Self::HalfPlane { a, b } => Self::HalfPlane { a, b: b + by },
            Self::Bump { c, s } => Self::Bump { c: [c[0] + by, c[1]], s },
        }
    }

    /// The value at a point.
    pub fn at(&self, u: [f64; 2]) -> f64 {
        match *self {
            Self::HalfPlane { a, b } => f64::from(u8::from(a[0] * u[0] + a[1] * u[1] < b)),
            Self::Bump { c, s } => (-((u[0] - c[0]).powi(2) + (u[1] - c[1]).powi(2)) / (2.0 * s * s)).exp(),
        }
    }

    /// Integral and variance over the unit square.
    pub fn integral(&self) -> [f64; 2] {
        match *self {
            Self::HalfPlane { a, b } => {
                // Mirrored until both components are positive.
                let t = b - a[0].min(0.0) - a[1].min(0.0);
                let (p, q) = (a[0].abs().max(1e-9), a[1].abs().max(1e-9));
                let square = |x: f64| x.max(0.0).powi(2);
                let area = (square(t) - square(t - p) - square(t - q) + square(t - p - q)) / (2.0 * p * q);
                let area = area.clamp(0.0, 1.0);
                [area, area * (1.0 - area)]
            }
            Self::Bump { c, s } => {
                let product = |s: f64| simpson(c[0], s) * simpson(c[1], s);
                let mean = product(s);
                [mean, product(s / 2.0_f64.sqrt()) - mean * mean]
            }
        }
    }
}

/// The integral of exp(-(x - c)^2 / (2 s^2)) over [0, 1], for s above .03 within 1e-8.
fn simpson(c: f64, s: f64) -> f64 {
    let bell = |i: usize| (-(i as f64 / 200.0 - c).powi(2) / (2.0 * s * s)).exp();
    let inner: f64 = (1..200).map(|i| bell(i) * if i % 2 == 1 { 4.0 } else { 2.0 }).sum();
    (bell(0) + bell(200) + inner) / 600.0
}

/// A Gaussian of 2.1 pixels, what the eye blurs an image by, on a torus.
#[derive(Clone, Debug)]
pub struct Blur {
    size: usize,
    kernel: Vec<f64>,
}

impl Blur {
    /// For images of `size` x `size`.
    pub fn new(size: usize) -> Self {
        let weights: Vec<f64> = (-13..=13).map(|x: i32| (-f64::from(x * x) / (2.0 * 2.1 * 2.1)).exp()).collect();
        let sum: f64 = weights.iter().sum();
        Self { size, kernel: weights.iter().map(|weight| weight / sum).collect() }
    }

    /// What the variance of white noise is multiplied by.
    pub fn of_noise(&self) -> f64 {
        self.kernel.iter().map(|weight| weight * weight).sum::<f64>().powi(2)
    }

    /// The blurred image.
    pub fn apply(&self, image: &[f64]) -> Vec<f64> {
        let (size, half) = (self.size, self.kernel.len() / 2);
        let along = |image: &[f64]| {
            // Filters rows and transposes.
            let mut out = vec![0.0; size * size];
            for (y, row) in image.chunks(size).enumerate() {
                let wrapped: Vec<f64> = (0..size + 2 * half).map(|x| row[(x + size - half) % size]).collect();
                for x in 0..size {
                    let taps = &wrapped[x..x + self.kernel.len()];
                    out[x * size + y] = taps.iter().zip(&self.kernel).map(|(a, b)| a * b).sum();
                }
            }
            out
        };
        along(&along(image))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::Moments;

    /// 16 functions by 100,000 random points: |z| < 4.5 each, 1e-4 for all.
    #[test]
    fn integrals() {
        let mut rng = SplitMix64::new(1);
        for index in 0..16 {
            let planar = if index % 2 == 0 { Planar::half_plane(&mut rng) } else { Planar::bump(&mut rng) };
            let planar = planar.moved(0.1);
            let values: Moments = (0..100_000).map(|_| planar.at([rng.uniform(), rng.uniform()])).collect();
            let [mean, variance] = planar.integral();
            assert!(values.z(mean).abs() < 4.5, "{planar:?}");
            assert!((values.variance() - variance).abs() < 0.005, "{planar:?}: {variance} {}", values.variance());
        }
    }

    #[test]
    fn blur_keeps_the_sum_and_is_symmetric() {
        let blur = Blur::new(32);
        let mut image = vec![0.0; 32 * 32];
        image[5 * 32 + 1] = 1.0;
        let out = blur.apply(&image);
        assert!((out.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!((out.iter().map(|x| x * x).sum::<f64>() - blur.of_noise()).abs() < 1e-12);
        assert!(
            (out[5 * 32 + 31] - out[5 * 32 + 3]).abs() < 1e-15 && (out[3 * 32 + 1] - out[5 * 32 + 31]).abs() < 1e-15
        );
    }
}
