//! Integrands beside those of the tests: the thesis's figures' own dimensions and counts of lights.

use noisefloor_tests::integrands::Integrand;
use noisefloor_tests::random::SplitMix64;
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
    fn new(name: &str, dims: usize, integral: f64, evaluate: impl Fn(&[f64]) -> f64 + 'static) -> Self {
        Self { name: name.to_owned(), dims, integral, evaluate: Box::new(evaluate) }
    }

    pub(crate) fn at(&self, u: &[f64]) -> f64 {
        (self.evaluate)(u)
    }

    /// Values at points.
    pub(crate) fn values(&self, u: &[f32], f: &mut [f32]) {
        let mut point = [0.0; 16];
        for (f, u) in f.iter_mut().zip(u.chunks_exact(self.dims)) {
            point.iter_mut().zip(u).for_each(|(x, &u)| *x = u.into());
            *f = self.at(&point[..self.dims]) as f32;
        }
    }

    /// The standard deviation, from 65,536 samples of a fixed seed: the scale of errors in plots.
    pub(crate) fn deviation(&self) -> f64 {
        let mut rng = SplitMix64::new(1);
        let mut point = vec![0.0; self.dims];
        let square = |_: usize| {
            point.iter_mut().for_each(|x| *x = rng.uniform());
            (self.at(&point) - self.integral).powi(2)
        };
        ((0..1 << 16).map(square).sum::<f64>() / f64::from(1 << 16)).sqrt()
    }
}

/// exp(-sum x), figure 4.6.
pub(crate) fn exponential(dims: usize) -> Function {
    let integral = (1.0 - (-1.0_f64).exp()).powi(dims as i32);
    Function::new(&format!("exp {dims}D"), dims, integral, |u| (-u.iter().sum::<f64>()).exp())
}

/// sum over i of sin(2 pi x_i (i + 1) / D), figure 4.6.
pub(crate) fn sines(dims: usize) -> Function {
    let frequency = move |i: usize| TAU * i as f64 / dims as f64;
    let integral = (1..=dims).map(|i| (1.0 - frequency(i).cos()) / frequency(i)).sum();
    Function::new(&format!("sines {dims}D"), dims, integral, move |u| {
        u.iter().enumerate().map(|(i, x)| (frequency(i + 1) * x).sin()).sum()
    })
}

/// Of one coordinate, as figure 4.3's: smooth, oscillating, peaked, discontinuous.
pub(crate) fn of_one_dimension(listing: Integrand) -> [Function; 4] {
    let peak = |x: f64| 0.1 / (0.01 + (x - 0.4).powi(2));
    [
        Function { name: "listing 4.1".to_owned(), ..listing.into() },
        Function::new("wave", 1, (1.0 - 9.0_f64.cos()) / 9.0, |u| (9.0 * u[0]).sin()),
        Function::new("peak", 1, 6.0_f64.atan() + 4.0_f64.atan(), move |u| peak(u[0])),
        Function::new("step 1D", 1, 0.65, |u| f64::from(u8::from(u[0] > 0.35))),
    ]
}

/// One light of [`lights`].
struct Light {
    intensity: f64,
    sharpness: f64,
    nearest: [f64; 2],
    is_hidden: bool,
}

impl Light {
    fn radiance(&self, u: f64, v: f64) -> f64 {
        if self.is_hidden && u + v < 1.0 {
            return 0.0;
        }
        let square = (u - self.nearest[0]).powi(2) + (v - self.nearest[1]).powi(2);
        self.intensity / (1.0 + self.sharpness * square).powi(2)
    }

    /// The midpoint rule, 400 x 400 points: the edge of a hidden light costs most, 1e-3 of it.
    fn integral(&self) -> f64 {
        let centre = |i: usize| (i as f64 + 0.5) / 400.0;
        let row = |i: usize| (0..400).map(|j| self.radiance(centre(i), centre(j))).sum::<f64>();
        (0..400).map(row).sum::<f64>() / 160_000.0
    }
}

/// `count` lights, the third coordinate picks one (figure 4.15): random intensities, each falling off with the distance
/// to its own nearest point, every fourth half hidden.
pub(crate) fn lights(count: usize) -> Function {
    let mut rng = SplitMix64::new(77);
    let lights: Vec<Light> = (0..count)
        .map(|index| Light {
            intensity: 0.2 + 3.0 * rng.uniform().powi(2),
            sharpness: 0.5 + 2.0 * rng.uniform(),
            nearest: [rng.uniform(), rng.uniform()],
            is_hidden: index % 4 == 3,
        })
        .collect();
    let integral = lights.iter().map(Light::integral).sum::<f64>() / count as f64;
    Function::new(&format!("{count} lights"), 3, integral, move |u| {
        lights[((u[2] * count as f64) as usize).min(count - 1)].radiance(u[0], u[1])
    })
}
