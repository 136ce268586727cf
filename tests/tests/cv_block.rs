//! One fit shared by the pixels of a block (section 4.3.6).

use crate::cv_support::*;
use noisefloor::Error;
use noisefloor::control_variate::{
    Config, Estimate, Estimator, Image, NonFinite, Samples, estimate_image, image_workspace_len,
};
use noisefloor_tests::random::{SplitMix64, mix};
use noisefloor_tests::shared;
use noisefloor_tests::shared_hard::{self, Scene, ratio};

fn block(config: &Config, u: &[f32], f: &[f32], pixels: usize) -> Result<Vec<Estimate>, Error> {
    shared::block(config, pixels, Samples::new(u, f))
}

/// Root mean square errors of a block's estimates and of its pixels' means.
fn pair(scene: &Scene) -> [f64; 2] {
    let estimates = block(&Config::new(2, 3, 1), &scene.u, &scene.f, 64).unwrap();
    shared_hard::errors(scene, &estimates.iter().map(|estimate| estimate.mean[0]).collect::<Vec<_>>())
}

/// A pixel's integrand: a half-plane or a bump, which moves and scales across the block.
fn integrand(bump: bool, block: u64, pixel: usize) -> impl Fn([f64; 2]) -> f64 {
    // The same in all pixels of the block, and other numbers than its samples.
    let mut rng = SplitMix64::new(mix(block));
    let (x, y) = ((pixel % 8) as f64, (pixel / 8) as f64);
    let angle = core::f64::consts::TAU * rng.uniform();
    let (a, b, offset) = (angle.cos(), angle.sin(), 0.6 * (rng.uniform() - 0.5) + 0.02 * (x - y));
    let (cx, cy, scale) = (rng.uniform() + 0.01 * x, rng.uniform() + 0.01 * y, 1.0 + 0.03 * x);
    move |u| {
        if bump {
            scale * (-((u[0] - cx).powi(2) + (u[1] - cy).powi(2)) / 0.18).exp()
        } else {
            f64::from(u8::from(a * (u[0] - 0.5) + b * (u[1] - 0.5) > offset))
        }
    }
}

/// 8 x 8 blocks of independent samples, upper ends of the 95 % intervals: .25 of the mean's RMSE for bumps, .55 for
/// half-planes. Each block has its own integrand, which moves and scales across it.
#[test]
fn shared_fits_beat_the_mean() {
    for (bump, limit) in [(true, 0.25), (false, 0.55)] {
        for n in [1, 4] {
            let mut rng = SplitMix64::new(2);
            let blocks = (0..400).map(|index| {
                let truth = |pixel| {
                    let (integrand, centre) = (integrand(bump, index, pixel), |i: usize| (i as f64 + 0.5) / 64.0);
                    (0..4096).map(|i| integrand([centre(i % 64), centre(i / 64)])).sum::<f64>() / 4096.0
                };
                pair(&Scene::new(n, 64, &mut rng, |pixel, u, _| integrand(bump, index, pixel)(u)).with_truth(truth))
            });
            let ratio = ratio(&blocks.collect::<Vec<_>>());
            println!("bump {bump}, {n} spp: {ratio:?}");
            assert!(ratio.upper() < limit, "bump {bump}, {n} spp: {ratio:?}");
        }
    }
}

/// Noise that no function of the position explains: within 1.03 of the mean.
#[test]
fn shared_fits_of_noise_do_no_harm() {
    let mut rng = SplitMix64::new(3);
    for n in [1, 4] {
        let blocks: Vec<_> = (0..300).map(|_| pair(&Scene::new(n, 64, &mut rng, |_, _, rng| rng.normal()))).collect();
        let ratio = ratio(&blocks);
        println!("noise, {n} spp: {ratio:?}");
        assert!(ratio.upper() < 1.03, "{n}: {ratio:?}");
    }
}

/// Constant blocks and blocks of constant pixels, single pixels, two pixels: finite, and a constant is exact.
#[test]
fn degenerate_blocks() {
    let mut rng = SplitMix64::new(4);
    for pixels in [1, 2, 3, 64] {
        for n in [1, 2, 8] {
            for order in [0, 1, 2, 7] {
                let u = points(pixels * n, 2, &mut rng);
                let config = Config::new(2, order, 1);
                for constant in [0.0, 1.0, -1e30, 16_777_215.0] {
                    let f = vec![constant; pixels * n];
                    for estimate in block(&config, &u, &f, pixels).unwrap() {
                        assert_eq!((estimate.mean[0], estimate.gain), (constant, 1.0), "{pixels} {n} {order}");
                        assert!(is_sound(&estimate));
                    }
                }
                let per_pixel: Vec<f32> = (0..pixels * n).map(|i| (i / n) as f32).collect();
                let same_place = vec![0.3; 2 * pixels * n];
                for (u, f) in [(&u, &per_pixel), (&same_place, &per_pixel), (&same_place, &values(&u, 2, smooth))] {
                    for estimate in block(&config, u, f, pixels).unwrap() {
                        assert!(is_sound(&estimate), "{pixels} {n} {order}: {estimate:?}");
                    }
                }
                // One pixel has nothing to learn from.
                if pixels == 1 {
                    let f = values(&u, 2, smooth);
                    let plain = batch::<f64>(&Config { order: 0, ..config }, &u, &f).unwrap();
                    let estimate = block(&config, &u, &f, 1).unwrap()[0];
                    assert!((estimate.mean[0] - plain.mean[0]).abs() < 1e-6);
                }
            }
        }
    }
}

/// Means weigh by the channel that is textured most: here all are textured alike, or not at all.
#[test]
fn channels_are_separate() {
    let mut rng = SplitMix64::new(5);
    let u = points(32, 2, &mut rng);
    let first = values(&u, 2, smooth);
    let f: Vec<f32> = first.iter().flat_map(|&f| [f, -20.0 * f, 7.0]).collect();
    let together = block(&Config::new(2, 2, 3), &u, &f, 16).unwrap();
    for channel in 0..3 {
        let own: Vec<f32> = f.iter().skip(channel).step_by(3).copied().collect();
        for (all, alone) in together.iter().zip(block(&Config::new(2, 2, 1), &u, &own, 16).unwrap()) {
            assert!((all.mean[channel] - alone.mean[0]).abs() <= 1e-5 * largest(&own) as f32);
        }
    }
}

#[test]
fn errors() {
    let config = Config::new(1, 1, 1);
    let run = |config: &Config, u: &[f32], f: &[f32], pixels: usize, len: usize| {
        let never = &mut |_, _| panic!("called on an error");
        estimate_image(config, &Image::unordered(pixels), Samples::new(u, f), &mut vec![0.0; len], never)
    };
    let (u, f) = ([0.5; 6], [1.0; 6]);
    let len = image_workspace_len(&config, &Image::unordered(3), 2).unwrap();
    assert_eq!(run(&config, &u, &f, 4, 1000), Err(Error::Length));
    assert_eq!(run(&config, &u, &f, 7, 1000), Err(Error::Length));
    assert_eq!(run(&config, &u, &f, 0, 1000), Err(Error::Range));
    assert_eq!(run(&config, &[], &[], 3, 1000), Err(Error::NoSamples));
    assert_eq!(run(&config, &u[..5], &f, 3, 1000), Err(Error::Length));
    assert_eq!(run(&config, &u, &f, 3, len - 1), Err(Error::Memory));
    let skip = Config { non_finite: NonFinite::Skip, ..config };
    assert_eq!(run(&skip, &u, &f, 3, 1000), Err(Error::Unsupported));
    assert_eq!(run(&Config::new(0, 1, 1), &u, &f, 3, 1000), Err(Error::Range));
    assert_eq!(image_workspace_len(&config, &Image::unordered(usize::MAX), 2), Err(Error::Range));
    for estimator in [Estimator::LeastSquares, Estimator::GradientDescent, Estimator::Incremental] {
        let other = Config { estimator, ..config };
        assert_eq!(run(&other, &u, &f, 3, 1000), Err(Error::Unsupported));
        assert_eq!(image_workspace_len(&other, &Image::unordered(3), 2), Err(Error::Unsupported));
    }
}
