//! Integrands: those of the tests, and figure 4.6's in 15 dimensions.

use noisefloor_tests::integrands::Integrand;
use std::f64::consts::TAU;

type Evaluate = Box<dyn Fn(&[f64]) -> f64>;

/// A function on the unit cube.
pub(crate) struct Function {
    pub(crate) name: String,
    pub(crate) dims: usize,
    pub(crate) integral: f64,
    evaluate: Evaluate,
}

impl From<Integrand> for Function {
    fn from(integrand: Integrand) -> Self {
        let Integrand { name, dims, integral, evaluate } = integrand;
        Self { name: name.to_owned(), dims, integral, evaluate: Box::new(evaluate) }
    }
}

impl Function {
    /// Values at points.
    pub(crate) fn values(&self, u: &[f32], f: &mut [f32]) {
        let mut point = [0.0; 16];
        for (f, u) in f.iter_mut().zip(u.chunks_exact(self.dims)) {
            point.iter_mut().zip(u).for_each(|(x, &u)| *x = u.into());
            *f = (self.evaluate)(&point[..self.dims]) as f32;
        }
    }
}

/// sum over i of sin(2 pi x_i (i + 1) / D), for figure 4.6's sum of sinusoids, whose formula the thesis does not give.
pub(crate) fn sines(dims: usize) -> Function {
    let frequency = move |i: usize| TAU * i as f64 / dims as f64;
    let integral = (1..=dims).map(|i| (1.0 - frequency(i).cos()) / frequency(i)).sum();
    let evaluate = move |u: &[f64]| u.iter().enumerate().map(|(i, x)| (frequency(i + 1) * x).sin()).sum();
    Function { name: format!("sines {dims}D"), dims, integral, evaluate: Box::new(evaluate) }
}
