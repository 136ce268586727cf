//! Shared fits to the samples of the built-in tiles: what they gain, raw and as the eye sees it.
//!
//! The integrands are half-planes and Gaussian bumps, the same in every pixel or moving and scaling across the image.
//! Scores are mean squared errors relative to white noise, that is independent samples without a fit, of the image
//! itself and of the image blurred by a Gaussian of 2.1 pixels. Seeds are fixed.

use crate::planar::{Blur, Planar};
use crate::random::SplitMix64;
use crate::shared::{block, image};
use noisefloor::control_variate::{Config, Image, Samples};
use noisefloor::tile::{Builtin, Sampler};

const SIZE: usize = 128;

/// How integrands change across the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// Not at all.
    None,
    /// By half of the square along 128 pixels.
    Slow,
    /// Back and forth by half of the square every 32 pixels.
    Steep,
}

impl Motion {
    /// How far the integrand has moved, and what it is multiplied by.
    fn at(self, x: usize, y: usize) -> [f64; 2] {
        let along = |at: usize| match self {
            Self::None => 0.0,
            Self::Slow => 0.5 * (at as f64 / SIZE as f64 - 0.5),
            Self::Steep => 0.5 * (((at as f64 / 32.0) % 2.0 - 1.0).abs() - 0.5),
        };
        [along(x), 1.0 + 2.0 * along(y)]
    }
}

fn tile(spp: usize) -> Builtin {
    match spp {
        1 => Builtin::Size128Spp1Dims2,
        4 => Builtin::Size128Spp4Dims2,
        _ => Builtin::Size128Spp16Dims2,
    }
}

/// The samples of a built-in tile, pixel after pixel.
fn tile_points(spp: usize) -> Vec<f32> {
    let tile = tile(spp).tile().unwrap();
    let pixels = (0..SIZE * SIZE).map(|pixel| ((pixel % SIZE) as u32, (pixel / SIZE) as u32));
    pixels
        .flat_map(|(x, y)| (0..spp as u32).map(move |index| (x, y, index)))
        .flat_map(|(x, y, index)| Sampler::pixel(&tile, x, y, 0, index).draw::<2>())
        .collect()
}

/// Values of four integrands at a tile's samples, their integrals pixel after pixel, and the variance of a pixel's mean
/// of independent samples.
struct Scene {
    f: Vec<f32>,
    truth: Vec<f64>,
    noise: [f64; 4],
}

impl Scene {
    fn new(integrands: &[Planar], motion: Motion, u: &[f32]) -> Self {
        let spp = u.len() / 2 / (SIZE * SIZE);
        let columns: Vec<Vec<(Planar, [f64; 2])>> = (0..SIZE)
            .map(|x| integrands.iter().map(move |planar| planar.moved(motion.at(x, 0)[0])))
            .map(|column| column.map(|planar| (planar, planar.integral())).collect())
            .collect();
        let mut scene = Scene { f: vec![], truth: vec![], noise: [0.0; 4] };
        for (pixel, own) in u.chunks(2 * spp).enumerate() {
            let (x, scale) = (pixel % SIZE, motion.at(0, pixel / SIZE)[1]);
            for ((_, [mean, variance]), noise) in columns[x].iter().zip(&mut scene.noise) {
                scene.truth.push(scale * mean);
                *noise += scale * scale * variance / (spp * SIZE * SIZE) as f64;
            }
            for u in own.chunks(2) {
                let u = [f64::from(u[0]), f64::from(u[1])];
                scene.f.extend(columns[x].iter().map(|(planar, _)| (scale * planar.at(u)) as f32));
            }
        }
        scene
    }

    /// The plain means.
    fn means(&self) -> Vec<f64> {
        let spp = self.f.len() / self.truth.len();
        let mean = |own: &[f32]| {
            (0..4)
                .map(|c| own.iter().skip(c).step_by(4).map(|&f| f64::from(f)).sum::<f64>() / spp as f64)
                .collect::<Vec<_>>()
        };
        self.f.chunks(4 * spp).flat_map(mean).collect()
    }

    /// Mean squared errors of estimates, [raw, blurred], with what white noise would have.
    fn score(&self, blur: &Blur, estimates: &[f64]) -> [[f64; 2]; 2] {
        let mut sums = [[0.0; 2]; 2];
        for channel in 0..4 {
            let at = |values: &[f64]| values.iter().skip(channel).step_by(4).copied().collect::<Vec<f64>>();
            let error: Vec<f64> = at(estimates).iter().zip(at(&self.truth)).map(|(a, b)| a - b).collect();
            let square = |image: &[f64]| image.iter().map(|e| e * e).sum::<f64>() / (SIZE * SIZE) as f64;
            sums[0][0] += square(&error);
            sums[0][1] += self.noise[channel];
            sums[1][0] += square(&blur.apply(&error));
            sums[1][1] += self.noise[channel] * blur.of_noise();
        }
        sums
    }
}

/// Errors relative to white noise.
#[derive(Clone, Copy, Debug)]
pub struct Score {
    /// Of the image.
    pub raw: f64,
    /// Of the blurred image.
    pub blurred: f64,
}

/// Half-planes, bumps.
pub type Scores = [Score; 2];

/// How pixels are estimated.
#[derive(Clone, Copy, Debug)]
pub enum Method {
    /// The mean of a pixel's own samples.
    Plain,
    /// Order, window, stride.
    Image(usize, usize, usize),
    /// 8 x 8 blocks, each for itself: order.
    Blocks(usize),
}

impl Method {
    fn run(self, u: &[f32], scene: &Scene) -> Vec<f64> {
        let means = |estimate: &noisefloor::control_variate::Estimate| estimate.mean.map(f64::from);
        let spp = u.len() / 2 / (SIZE * SIZE);
        match self {
            Self::Plain => scene.means(),
            Self::Image(order, window, stride) => {
                let config = Config { stratified: true, ..Config::new(2, order, 4) };
                let of = Image { window, stride, ..Image::new(SIZE, SIZE) };
                let all = image(&config, &of, Samples::new(u, &scene.f)).unwrap();
                all.iter().flat_map(means).collect()
            }
            Self::Blocks(order) => {
                let config = Config { stratified: true, ..Config::new(2, order, 4) };
                let mut out = vec![0.0; SIZE * SIZE * 4];
                for first in (0..SIZE * SIZE).filter(|pixel| pixel % 8 == 0 && (pixel / SIZE).is_multiple_of(8)) {
                    let pixels: Vec<usize> = (0..64).map(|i| first + i / 8 * SIZE + i % 8).collect();
                    let gather = |values: &[f32], width: usize| {
                        pixels.iter().flat_map(|&p| values[p * width..(p + 1) * width].to_vec()).collect::<Vec<f32>>()
                    };
                    let (u, f) = (gather(u, 2 * spp), gather(&scene.f, 4 * spp));
                    for (estimate, pixel) in block(&config, 64, Samples::new(&u, &f)).unwrap().iter().zip(&pixels) {
                        out[pixel * 4..pixel * 4 + 4].copy_from_slice(&means(estimate));
                    }
                }
                out
            }
        }
    }
}

/// Four times as many half-planes, and as many bumps, as [`scores`] needs for three digits.
pub fn quadruples(spp: usize) -> usize {
    if spp < 16 { 6 } else { 3 }
}

/// The scores of some methods on the tile of `spp` samples in each pixel, over 4 `quadruples` integrands of each kind.
pub fn scores<const N: usize>(spp: usize, motion: Motion, methods: [Method; N], quadruples: usize) -> [Scores; N] {
    let mut rng = SplitMix64::new(5);
    let (u, blur) = (tile_points(spp), Blur::new(SIZE));
    let mut sums = [[[[0.0; 2]; 2]; 2]; N];
    for kind in 0..2 {
        for _ in 0..quadruples {
            let integrands: [Planar; 4] =
                core::array::from_fn(|_| if kind == 0 { Planar::half_plane(&mut rng) } else { Planar::bump(&mut rng) });
            let scene = Scene::new(&integrands, motion, &u);
            for (method, sums) in methods.iter().zip(&mut sums) {
                let more = scene.score(&blur, &method.run(&u, &scene));
                sums[kind].as_flattened_mut().iter_mut().zip(more.as_flattened()).for_each(|(a, b)| *a += b);
            }
        }
    }
    sums.map(|sums| sums.map(|[raw, blurred]| Score { raw: raw[0] / raw[1], blurred: blurred[0] / blurred[1] }))
}
