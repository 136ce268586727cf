//! Random test integrands whose integral and variance are known exactly: half-spaces and Gaussian bumps.

use super::projection::Projection;
use crate::random;
use serde::Serialize;

/// The two families.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// 1 on one side of a hyperplane through a uniform random point with a uniform random normal, 0 on the other.
    HalfSpace,
    /// exp(-|x - c|^2 / (2 s^2)), c uniform in the unit cube, s uniform in [.05, .3].
    Gaussian,
}

/// An integrand on the unit cube.
#[derive(Clone, Debug)]
pub struct Integrand {
    shape: Shape,
    /// Its integral over the cube.
    pub integral: f64,
    /// Its variance under the uniform distribution.
    pub variance: f64,
}

#[derive(Clone, Debug)]
enum Shape {
    HalfSpace { normal: Vec<f64>, offset: f64 },
    Gaussian { centre: Vec<f64>, exponent: f64 },
}

impl Integrand {
    /// Draws number `index` of a family in `dims` dimensions.
    ///
    /// Normals with a component below `smallest` are redrawn (as the published figures of the tiles do), except in one
    /// dimension.
    pub fn random(family: Family, dims: usize, smallest: f64, seed: u64, index: u64) -> Integrand {
        let mut rng = random::stream(seed, family as u64, index);
        match family {
            Family::HalfSpace => loop {
                let normal = random::direction(dims, &mut rng);
                if dims > 1 && normal.iter().any(|a| a.abs() < smallest) {
                    continue;
                }
                let offset: f64 = normal.iter().map(|a| a * rng.uniform_f64()).sum();
                let centre: f64 = normal.iter().sum::<f64>() / 2.0;
                let integral = Projection::new(&normal).cdf(offset - centre);
                let variance = integral * (1.0 - integral);
                return Integrand { shape: Shape::HalfSpace { normal, offset }, integral, variance };
            },
            Family::Gaussian => {
                let centre: Vec<f64> = (0..dims).map(|_| rng.uniform_f64()).collect();
                let sigma = 0.05 + 0.25 * rng.uniform_f64();
                let integral = gaussian_integral(&centre, sigma);
                // The square of a Gaussian is one of sigma / sqrt(2).
                let square = gaussian_integral(&centre, sigma * std::f64::consts::FRAC_1_SQRT_2);
                let shape = Shape::Gaussian { centre, exponent: -0.5 / (sigma * sigma) };
                Integrand { shape, integral, variance: square - integral * integral }
            }
        }
    }

    /// Its value at a point.
    #[inline]
    pub fn value(&self, point: &[f32]) -> f64 {
        match &self.shape {
            Shape::HalfSpace { normal, offset } => {
                let along: f64 = normal.iter().zip(point).map(|(a, &x)| a * f64::from(x)).sum();
                f64::from(u8::from(along < *offset))
            }
            Shape::Gaussian { centre, exponent } => {
                let squared: f64 =
                    centre.iter().zip(point).map(|(c, &x)| (f64::from(x) - c) * (f64::from(x) - c)).sum();
                libm::exp(squared * exponent)
            }
        }
    }
}

/// The integral over the unit cube of exp(-|x - c|^2 / (2 s^2)).
fn gaussian_integral(centre: &[f64], sigma: f64) -> f64 {
    let scale = sigma * std::f64::consts::SQRT_2;
    let half = scale * std::f64::consts::PI.sqrt() / 2.0;
    centre.iter().map(|c| half * (libm::erf((1.0 - c) / scale) + libm::erf(c / scale))).product()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::tile;

    #[test]
    fn normals_of_tiles_integrands_keep_away_from_the_axes() {
        for (dims, smallest) in [(2, 1e-3), (3, 0.03)] {
            for integrand in tile::integrands(Family::HalfSpace, dims, 0, 1000) {
                let Shape::HalfSpace { normal, .. } = integrand.shape else { panic!("{integrand:?}") };
                assert!(normal.len() == dims && normal.iter().all(|a| a.abs() >= smallest), "{normal:?}");
            }
        }
    }
}
