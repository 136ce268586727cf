//! A mixture of isotropic Gaussians with centres that cover the cube evenly.

use super::shape::{MAX_DIMS, MAX_TERMS};
use crate::lanes::Lanes;
use crate::matrix::set;
use crate::real::Real;
use heapless::Vec;

/// The centring and scaling of exp(-|x - c|^2 / (2 sigma^2)).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Moments {
    /// The integral over the cube.
    mean: f64,
    /// One over the standard deviation over the cube.
    scale: f64,
}

/// The mixture's components; the regression finds their weights.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gaussians {
    /// -1 / (2 sigma^2)
    exponent: f64,
    /// The step of the centres' Kronecker sequence along each coordinate.
    steps: [f64; MAX_DIMS],
    components: Vec<Moments, MAX_TERMS>,
}

impl Gaussians {
    /// `count` components over `dims` coordinates. Neighbouring centres are about count^(-1/dims) apart; sigma is half
    /// of that times sqrt(dims), so that neighbours overlap in any number of dimensions.
    pub(crate) fn new(dims: usize, count: usize) -> Self {
        let spacing = libm::pow(count.max(1) as f64, -1.0 / dims.max(1) as f64);
        let sigma = 0.5 * libm::sqrt(dims.max(1) as f64) * spacing;
        let root = kronecker_root(dims);
        let mut steps = [0.0; MAX_DIMS];
        let mut step = 1.0;
        for out in steps.iter_mut().take(dims) {
            step /= root;
            *out = step;
        }
        let mut components = Vec::new();
        for index in 0..count.min(MAX_TERMS) {
            let (mut mean, mut square) = (1.0, 1.0);
            for &step in steps.iter().take(dims) {
                let c = centre(index, step);
                mean *= integral(c, sigma);
                // The square of a Gaussian is a Gaussian with sigma / sqrt(2).
                square *= integral(c, sigma * core::f64::consts::FRAC_1_SQRT_2);
            }
            let variance = square - mean * mean;
            let scale = if variance > 0.0 { 1.0 / libm::sqrt(variance) } else { 0.0 };
            if components.push(Moments { mean, scale }).is_err() {
                break;
            }
        }
        Self { exponent: -0.5 / (sigma * sigma), steps, components }
    }

    /// Columns 0 to `continuous`, then those after a gap, at `L` points.
    #[inline(never)]
    pub(crate) fn evaluate<R: Real, const L: usize>(
        &self,
        x: &[Lanes<R, L>],
        continuous: usize,
        gap: usize,
        out: &mut [Lanes<R, L>],
    ) {
        let exponent = R::from_f64(self.exponent);
        for (index, component) in self.components.iter().enumerate() {
            let mut squares = [R::ZERO; L];
            for (x, &step) in x.iter().zip(&self.steps).take(continuous) {
                let c = R::from_f64(centre(index, step));
                for (square, &x) in squares.iter_mut().zip(x) {
                    let offset = x - c;
                    *square += offset * offset;
                }
            }
            let mean = R::from_f64(component.mean);
            let scale = R::from_f64(component.scale);
            let values = squares.map(|square| scale * ((exponent * square).exp() - mean));
            set(out, if index < continuous { index } else { index + gap }, values);
        }
    }
}

/// Coordinate of the `index`-th centre.
fn centre(index: usize, step: f64) -> f64 {
    let x = 0.5 + (index + 1) as f64 * step;
    x - libm::floor(x)
}

/// The integral over [0, 1] of exp(-(x - c)^2 / (2 sigma^2)).
fn integral(c: f64, sigma: f64) -> f64 {
    let scale = core::f64::consts::FRAC_1_SQRT_2 / sigma;
    // sqrt(pi / 2) sigma (erf(b) - erf(a)), and 1 / scale = sqrt(2) sigma.
    0.5 * libm::sqrt(core::f64::consts::PI) / scale * (libm::erf((1.0 - c) * scale) + libm::erf(c * scale))
}

/// The root above 1 of x^(dims + 1) = x + 1, whose negative powers generate an evenly spread Kronecker sequence.
fn kronecker_root(dims: usize) -> f64 {
    let mut root = 1.5;
    for _ in 0..64 {
        root = libm::pow(1.0 + root, 1.0 / (dims as f64 + 1.0));
    }
    root
}
