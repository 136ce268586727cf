//! How biased shared fits are: half-planes and bumps, the same in every pixel of one window. Seeds are fixed.

use crate::planar::Planar;
use crate::random::SplitMix64;
use crate::shared::image;
use crate::statistics::Moments;
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
        largest = largest.max(square);
    }
    Bias { typical: squares.mean().max(0.0).sqrt(), largest: largest.sqrt(), chance: chance.mean().sqrt() }
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
