//! Scenes that shared fits cannot help, and their error over that of the plain mean of the same samples.

use crate::planar::Planar;
use crate::random::SplitMix64;
use crate::shared::{block, image};
use crate::statistics::{Ratio, rmse_ratio};
use noisefloor::control_variate::{Config, Image, Samples};

/// Samples of a pixel.
pub const COUNTS: [usize; 5] = [1, 2, 4, 8, 16];
/// Pixels on a side of an image.
pub const SIDE: usize = 12;
/// Pixels of an image.
pub const PIXELS: usize = SIDE * SIDE;

/// Samples of an image and what they estimate.
pub struct Scene {
    /// Positions.
    pub u: Vec<f32>,
    /// Values.
    pub f: Vec<f32>,
    /// Each pixel's integral.
    pub truth: Vec<f64>,
}

impl Scene {
    /// Independent points, and a pixel's value at each.
    pub fn new(
        n: usize,
        pixels: usize,
        rng: &mut SplitMix64,
        mut pixel: impl FnMut(usize, [f64; 2], &mut SplitMix64) -> f64,
    ) -> Self {
        let u: Vec<f32> = (0..pixels * n * 2).map(|_| rng.uniform_f32()).collect();
        let f = (0..pixels * n).map(|i| pixel(i / n, [f64::from(u[2 * i]), f64::from(u[2 * i + 1])], rng) as f32);
        let f = f.collect();
        Self { u, f, truth: vec![0.0; pixels] }
    }

    /// The same with integrals that are not 0.
    #[must_use]
    pub fn with_truth(mut self, truth: impl Fn(usize) -> f64) -> Self {
        self.truth = (0..self.truth.len()).map(truth).collect();
        self
    }
}

fn checker(pixel: usize) -> f64 {
    f64::from(u8::from((pixel % SIDE + pixel / SIDE).is_multiple_of(2)))
}

fn bright(pixel: usize) -> bool {
    // A slanted border through most windows.
    3 * (pixel % SIDE) + 2 * (pixel / SIDE) > 27
}

/// A scene of so many samples in each pixel.
pub type Make = fn(usize, &mut SplitMix64) -> Scene;

/// Scenes that fits should leave alone, by name.
pub const SCENES: [(&str, Make); 12] = [
    ("noise", |n, rng| Scene::new(n, PIXELS, rng, |_, _, rng| rng.normal())),
    ("skewed noise", |n, rng| {
        Scene::new(n, PIXELS, rng, |_, _, rng| (1.5 * rng.normal()).exp()).with_truth(|_| (1.5_f64 * 1.5 / 2.0).exp())
    }),
    ("rare noise", |n, rng| {
        Scene::new(n, PIXELS, rng, |_, _, rng| f64::from(u8::from(rng.uniform() < 0.02))).with_truth(|_| 0.02)
    }),
    ("noise under a border", |n, rng| {
        Scene::new(n, PIXELS, rng, |pixel, _, rng| rng.normal() + if bright(pixel) { 10.0 } else { 0.0 })
            .with_truth(|pixel| if bright(pixel) { 10.0 } else { 0.0 })
    }),
    ("two surfaces", |n, rng| {
        // Opposite slopes, of which a common fit can explain nothing.
        Scene::new(n, PIXELS, rng, |pixel, u, _| if bright(pixel) { 4.0 * u[0] } else { 5.0 - u[0] })
            .with_truth(|pixel| if bright(pixel) { 2.0 } else { 4.5 })
    }),
    ("checkerboard", |n, rng| {
        Scene::new(n, PIXELS, rng, |pixel, _, rng| 5.0 * checker(pixel) + rng.normal())
            .with_truth(|pixel| 5.0 * checker(pixel))
    }),
    ("checkerboard of slopes", |n, rng| {
        Scene::new(n, PIXELS, rng, |pixel, u, _| if checker(pixel) > 0.0 { u[0] } else { 1.0 - u[0] })
            .with_truth(|_| 0.5)
    }),
    ("an integrand for each pixel", |n, rng| {
        let each: Vec<Planar> = (0..PIXELS).map(|_| Planar::half_plane(rng)).collect();
        let truth: Vec<f64> = each.iter().map(|planar| planar.integral()[0]).collect();
        Scene::new(n, PIXELS, rng, |pixel, u, _| each[pixel].at(u)).with_truth(|pixel| truth[pixel])
    }),
    ("thin strips", |n, rng| {
        let at = 0.05 + 0.9 * rng.uniform();
        Scene::new(n, PIXELS, rng, |_, u, _| f64::from(u8::from((u[1] - at).abs() < 0.005))).with_truth(|_| 0.01)
    }),
    ("high frequency", |n, rng| {
        Scene::new(n, PIXELS, rng, |_, u, _| (core::f64::consts::TAU * (9.0 * u[0] + 4.0 * u[1])).sin())
    }),
    ("one point", |n, rng| {
        let mut scene = Scene::new(n, PIXELS, rng, |_, _, rng| rng.normal());
        scene.u.fill(0.3);
        scene
    }),
    ("one point in each pixel", |n, rng| {
        let mut scene = Scene::new(n, PIXELS, rng, |_, _, rng| rng.normal());
        for own in scene.u.chunks_mut(2 * n) {
            let first = [own[0], own[1]];
            own.chunks_mut(2).for_each(|u| u.copy_from_slice(&first));
        }
        scene
    }),
];

/// An image's root mean square errors: of the estimates, of the means.
pub fn errors(scene: &Scene, estimates: &[f32]) -> [f64; 2] {
    let n = scene.f.len() / scene.truth.len();
    let mut squares = [0.0; 2];
    for ((own, estimate), truth) in scene.f.chunks(n).zip(estimates).zip(&scene.truth) {
        let mean = own.iter().copied().map(f64::from).sum::<f64>() / n as f64;
        squares[0] += (f64::from(*estimate) - truth).powi(2);
        squares[1] += (mean - truth).powi(2);
    }
    squares.map(|square| (square / scene.truth.len() as f64).sqrt())
}

/// Over images that are independent of each other; pixels of one image are not.
pub fn ratio(errors: &[[f64; 2]]) -> Ratio {
    let at = |index: usize| errors.iter().map(|pair| pair[index]).collect::<Vec<f64>>();
    rmse_ratio(&at(0), &at(1))
}

/// A scene's RMSE ratio to the mean, by `call`: over as many images as have `samples` of each pixel together, half as
/// many at 1 sample.
pub fn measure(
    make: Make,
    n: usize,
    samples: usize,
    seed: u64,
    call: impl Fn(&Config, Samples<'_>) -> Vec<f32>,
) -> (usize, Ratio) {
    let mut rng = SplitMix64::new(seed + n as u64);
    let images = samples / n.max(2);
    let config = Config::new(2, 3, 1);
    let all: Vec<[f64; 2]> = (0..images)
        .map(|_| {
            let scene = make(n, &mut rng);
            errors(&scene, &call(&config, Samples::new(&scene.u, &scene.f)))
        })
        .collect();
    (images, ratio(&all))
}

/// The pixels as an image.
pub fn as_image(config: &Config, samples: Samples<'_>) -> Vec<f32> {
    image(config, &Image::new(SIDE, SIDE), samples).unwrap().iter().map(|estimate| estimate.mean[0]).collect()
}

/// The pixels in no order.
pub fn as_block(config: &Config, samples: Samples<'_>) -> Vec<f32> {
    block(config, PIXELS, samples).unwrap().iter().map(|estimate| estimate.mean[0]).collect()
}
