//! How biased shared fits are: half-planes and bumps, the same in every pixel of one window. Seeds are fixed.

use crate::planar::Planar;
use crate::random::SplitMix64;
use crate::shared::image;
use crate::statistics::{Moments, maximum};
use noisefloor::control_variate::{Config, Image, Samples};
use noisefloor::tile::{Builtin, Sampler};

/// Bias relative to the RMSE over integrands: its root mean square and its largest, without what chance adds to it.
#[derive(Debug)]
pub struct Bias {
    /// Root mean square over the integrands.
    pub typical: f64,
    /// Of one of them.
    pub largest: f64,
    /// What chance alone would show.
    pub chance: f64,
}

/// Half-planes and bumps, the same in every pixel of a single window, whose samples `draw` puts out.
pub fn bias(
    config: &Config,
    side: usize,
    n: usize,
    repetitions: usize,
    draw: impl Fn(&mut SplitMix64) -> Vec<f32>,
) -> Bias {
    let mut rng = SplitMix64::new(30);
    let of = Image { window: side, stride: side, ..Image::new(side, side) };
    let (mut squares, mut largest, mut chance) = (Moments::default(), 0.0_f64, Moments::default());
    for index in 0..24 {
        let planar = if index % 2 == 0 { Planar::half_plane(&mut rng) } else { Planar::bump(&mut rng) };
        let truth = planar.integral()[0];
        let (mut means, mut all) = (Moments::default(), Moments::default());
        for _ in 0..repetitions {
            let u = draw(&mut rng);
            assert_eq!(u.len(), 2 * n * side * side);
            let f: Vec<f32> = u.chunks(2).map(|u| planar.at([f64::from(u[0]), f64::from(u[1])]) as f32).collect();
            let estimates = image(config, &of, Samples::new(&u, &f)).unwrap();
            let errors: Moments = estimates.iter().map(|estimate| f64::from(estimate.mean[0]) - truth).collect();
            means.add(errors.mean());
            estimates.iter().for_each(|estimate| all.add((f64::from(estimate.mean[0]) - truth).powi(2)));
        }
        let noise = means.standard_error().powi(2) / all.mean();
        let square = means.mean().powi(2) / all.mean() - noise;
        squares.add(square);
        chance.add(noise);
        largest = maximum([largest, square]);
    }
    Bias { typical: maximum([squares.mean()]).sqrt(), largest: largest.sqrt(), chance: chance.mean().sqrt() }
}

/// Independent samples of `pixels` pixels, one in each.
pub fn independent(pixels: usize) -> impl Fn(&mut SplitMix64) -> Vec<f32> {
    move |rng| (0..2 * pixels).map(|_| rng.uniform_f32()).collect()
}

/// Samples of 8 x 8 pixels of a built-in tile, anywhere in it, all values shifted at random, which leaves each uniform
/// but not independent.
pub fn of_tile(builtin: Builtin) -> impl Fn(&mut SplitMix64) -> Vec<f32> {
    let tile = builtin.tile().unwrap();
    move |rng| {
        let (seed, at) = (rng.next_u64() as u32 | 1, rng.next_u64());
        let root = |pixel: u32| {
            Sampler::pixel(&tile, at as u32 + pixel % 8, (at >> 32) as u32 + pixel / 8, 0, 0).scramble(seed)
        };
        let samples = tile.shape().spp;
        (0..64).flat_map(|pixel| (0..samples).flat_map(move |i| root(pixel).moved(0, 0, i).draw::<2>())).collect()
    }
}

/// Pixels on a side of an image whose integrands differ from pixel to pixel.
const SIDE: usize = 24;

/// The value of a pixel, by its column and row, at u.
type Scene = fn([usize; 2], [f64; 2]) -> f64;

/// A penumbra, a lobe that moves, two surfaces, a texture, squares.
const SCENES: [Scene; 5] = [
    |pixel, [a, b]| {
        let [x, y] = along(pixel);
        if 0.8 * a + 0.6 * b > 1.8 * y - 0.4 { 0.3 + 0.7 * x } else { 0.0 }
    },
    |pixel, [a, b]| {
        let [x, y] = along(pixel);
        let square = (a - 0.2 - 0.5 * x).powi(2) + (b - 0.7 + 0.3 * y).powi(2);
        0.2 + (1.0 + y) * (-square / 0.045).exp()
    },
    |pixel, [a, b]| {
        let [x, y] = along(pixel);
        let is_left = pixel[0] < SIDE / 2;
        let edge = if is_left { 0.6 * y - 0.5 } else { -1.0 };
        let value = 1.0 + 0.8 * (a - 0.5) + 0.5 * (b - 0.5).powi(3) * (1.0 + x);
        if 0.6 * a - 0.8 * b <= edge {
            0.0
        } else if is_left {
            value
        } else {
            0.3 * value
        }
    },
    |[x, y], [a, b]| (0.5 + 0.2 * ((x * 7 + y * 13) % 5) as f64) * (1.0 + 0.9 * (a - 0.5) + 0.6 * (b - 0.5)),
    |pixel, [a, b]| if ((6.0 * a) as u32 + (5.0 * b) as u32) % 2 == 1 { 1.0 + 0.3 * along(pixel)[0] } else { 0.1 },
];

fn along(pixel: [usize; 2]) -> [f64; 2] {
    pixel.map(|at| (at as f64 + 0.5) / SIDE as f64)
}

/// The same pixel by pixel, over images of integrands that differ between pixels, which have independent samples.
pub fn bias_of_pixels(config: &Config, n: usize, frames: usize) -> Bias {
    /// Cells of the midpoint rule; squares have their borders between cells.
    const CELLS: usize = 240;
    let mut rng = SplitMix64::new(31);
    let (mut squares, mut largest) = (Moments::default(), 0.0_f64);
    for scene in SCENES {
        let at = |pixel: usize, u: [f64; 2]| scene([pixel % SIDE, pixel / SIDE], u);
        let middle = |cell: usize| (cell as f64 + 0.5) / CELLS as f64;
        let truth = |pixel: usize| {
            let cells = (0..CELLS * CELLS).map(|cell| at(pixel, [middle(cell % CELLS), middle(cell / CELLS)]));
            cells.sum::<f64>() / (CELLS * CELLS) as f64
        };
        let truth: Vec<f64> = (0..SIDE * SIDE).map(truth).collect();
        let mut errors = vec![Moments::default(); SIDE * SIDE];
        let mut all = Moments::default();
        for _ in 0..frames {
            let u: Vec<f32> = (0..2 * n * SIDE * SIDE).map(|_| rng.uniform_f32()).collect();
            let samples = u.chunks(2).enumerate();
            let f: Vec<f32> = samples.map(|(i, u)| at(i / n, [f64::from(u[0]), f64::from(u[1])]) as f32).collect();
            let estimates = image(config, &Image::new(SIDE, SIDE), Samples::new(&u, &f)).unwrap();
            for ((errors, estimate), truth) in errors.iter_mut().zip(estimates).zip(&truth) {
                let error = f64::from(estimate.mean[0]) - truth;
                errors.add(error);
                all.add(error * error);
            }
        }
        let own = |errors: &Moments| errors.mean().powi(2) - errors.standard_error().powi(2);
        let square = errors.iter().map(own).sum::<f64>() / errors.len() as f64 / all.mean();
        squares.add(square);
        largest = maximum([largest, square]);
    }
    let chance = (1.0 / frames as f64).sqrt();
    Bias { typical: maximum([squares.mean()]).sqrt(), largest: largest.sqrt(), chance }
}
