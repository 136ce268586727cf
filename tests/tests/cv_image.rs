//! Shared fits over the pixels of an image: what the arguments mean, errors, exactness, scale, determinism.

use crate::cv_support::{is_sound, jittered, largest, points, smooth, values, wide};
use noisefloor::Error;
use noisefloor::basis::Family;
use noisefloor::control_variate::{
    Color, Config, Estimate, Estimator, Image, NonFinite, Ridge, Samples, Solver, estimate_image, image_workspace_len,
};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::shared::{block, image};
use noisefloor_tests::statistics::{Moments, root_mean_square};
use proptest::prelude::*;

const SHARED: [Estimator; 3] = [Estimator::Robust, Estimator::LeaveOneOut, Estimator::KFold];
/// Points of an image, and values that change across it.
fn scene(pixels: usize, n: usize, channels: usize, rng: &mut SplitMix64) -> (Vec<f32>, Vec<f32>) {
    let u = points(pixels * n, 2, rng);
    let value = |(i, u): (usize, &[f64])| (1.0 + 0.02 * (i / n) as f64) * smooth(u);
    let f = wide(&u).chunks(2).enumerate().map(value).collect::<Vec<f64>>();
    let f = f.iter().flat_map(|f| (0..channels).map(move |channel| ((1.0 + channel as f64) * f) as f32)).collect();
    (u, f)
}

/// Knowledge that says nothing changes no bit: one surface, factors of 1 or 0, defaults that are spelled out, fresh
/// calls.
#[test]
fn trivial_knowledge_changes_nothing() {
    let mut rng = SplitMix64::new(1);
    for (width, height, frames, n) in [(11, 9, 1, 1), (9, 10, 2, 3), (5, 1, 1, 4)] {
        let pixels = width * height * frames;
        let (u, f) = scene(pixels, n, 2, &mut rng);
        let samples = Samples::new(&u, &f);
        let (surfaces, ones) = (vec![u32::MAX; pixels], vec![1.0; 2 * pixels]);
        let zeros: Vec<f32> = (0..2 * pixels).map(|i| [0.0, 1.0, -0.0][i % 3]).collect();
        let plain = Image { frames, ..Image::new(width, height) };
        for estimator in SHARED {
            let config = Config { estimator, ..Config::new(2, 2, 2) };
            {
                let expected = image(&config, &plain, samples).unwrap();
                for same in [
                    plain,
                    Image { window: 8, ..plain },
                    Image { stride: 4, samples: n, ..plain },
                    Image { surfaces: &surfaces, ..plain },
                    Image { factors: &ones, ..plain },
                    Image { factors: &zeros, surfaces: &surfaces, ..plain },
                ] {
                    assert_eq!(image(&config, &same, samples).unwrap(), expected, "{same:?}");
                }
            }
        }
    }
}

/// A surface's pixels do not see the others: the estimates of one are those of an image where the others' samples
/// differ.
#[test]
fn surfaces_are_separate() {
    let mut rng = SplitMix64::new(2);
    for n in [1, 3] {
        let (u, mut f) = scene(12 * 12, n, 1, &mut rng);
        let surfaces: Vec<u32> = (0..144).map(|_| rng.below(3) as u32 * 1_000_000_007).collect();
        let of = Image { surfaces: &surfaces, ..Image::new(12, 12) };
        for estimator in SHARED {
            let config = Config { estimator, ..Config::new(2, 2, 1) };
            let before = image(&config, &of, Samples::new(&u, &f)).unwrap();
            for (pixel, own) in f.chunks_mut(n).enumerate() {
                if surfaces[pixel] != 0 {
                    own.iter_mut().for_each(|f| *f = 30.0 - 7.0 * *f);
                }
            }
            let after = image(&config, &of, Samples::new(&u, &f)).unwrap();
            for ((before, after), surface) in before.iter().zip(&after).zip(&surfaces) {
                assert_eq!(before == after, *surface == 0);
            }
        }
    }
}

/// Values divided by the factors, estimated, multiplied: the same as factors, within the rounding of outputs and
/// inputs.
#[test]
fn factors_are_demodulation() {
    let mut rng = SplitMix64::new(3);
    let (width, height, n) = (9, 6, 2);
    let (u, f) = scene(width * height, n, 2, &mut rng);
    // Powers of two, so that nothing is rounded.
    let factors: Vec<f32> = (0..2 * width * height).map(|_| 2.0_f32.powi(rng.below(12) as i32 - 6)).collect();
    let modulated: Vec<f32> = f.iter().enumerate().map(|(i, f)| f * factors[i / (2 * n) * 2 + i % 2]).collect();
    for estimator in SHARED {
        let config = Config { estimator, ..Config::new(2, 2, 2) };
        let plain = image(&config, &Image::new(width, height), Samples::new(&u, &f)).unwrap();
        let of = Image { factors: &factors, ..Image::new(width, height) };
        let estimates = image(&config, &of, Samples::new(&u, &modulated)).unwrap();
        for (pixel, (a, b)) in estimates.iter().zip(&plain).enumerate() {
            for channel in 0..2 {
                let factor = factors[2 * pixel + channel];
                let error = (a.mean[channel] / factor - b.mean[channel]).abs();
                assert!(error <= 1e-6 * largest(&f) as f32, "{estimator:?} {pixel}: {error}");
            }
        }
    }
}

/// Constant values are exact, and so are constant pixels of different values with several samples in each. Of one
/// sample what is left of the fits in the mixture adds noise, here at most .018 where the values are uniform in 0 to 1.
#[test]
fn constants() {
    let mut rng = SplitMix64::new(4);
    for (width, height, frames) in [(1, 1, 1), (1, 7, 1), (2, 1, 1), (12, 12, 1), (4, 4, 5)] {
        let pixels = width * height * frames;
        let of = Image { frames, ..Image::new(width, height) };
        for n in [1, 2, 5] {
            let u = points(pixels * n, 2, &mut rng);
            for (order, estimator) in [(0, SHARED[0]), (1, SHARED[1]), (3, SHARED[2]), (7, SHARED[0])] {
                let config = Config { estimator, ..Config::new(2, order, 1) };
                for constant in [0.0, 1.0, -1e30, 1e-30, 16_777_215.0] {
                    let f = vec![constant; pixels * n];
                    for estimate in image(&config, &of, Samples::new(&u, &f)).unwrap() {
                        assert_eq!((estimate.mean[0], estimate.gain), (constant, 1.0), "{pixels} {n} {order}");
                        assert!(n == 1 || estimate.std_error[0] == 0.0, "{estimate:?}");
                    }
                }
            }
            let levels: Vec<f32> = (0..pixels).map(|_| rng.uniform_f32()).collect();
            let f: Vec<f32> = (0..pixels * n).map(|i| levels[i / n]).collect();
            let estimates = image(&Config::new(2, 2, 1), &of, Samples::new(&u, &f)).unwrap();
            let error: f64 = estimates.iter().zip(&levels).map(|(a, b)| f64::from(a.mean[0] - b).powi(2)).sum();
            let error = (error / pixels as f64).sqrt();
            println!("constant pixels, {width} x {height} x {frames}, {n} samples: {error:.4}");
            let limit = if n > 1 { 1e-7 } else { 0.03 };
            assert!(error < limit, "{width} {height} {frames} {n}: {error}");
        }
    }
}

/// Windows of black pixels alone count in their pixels' averages as those do in which one is all but black, where fits
/// are made.
#[test]
fn black_windows_are_windows() {
    let mut rng = SplitMix64::new(7);
    let (width, height) = (24, 16);
    for (n, factor) in [1, 4, 5].into_iter().flat_map(|n| [(n, 0.0), (n, 0.5)]) {
        let (u, mut f) = scene(width * height, n, 2, &mut rng);
        let is_black = |sample: usize| sample / n % width < 13;
        f.chunks_mut(2).enumerate().filter(|&(sample, _)| is_black(sample)).for_each(|(_, value)| value.fill(0.0));
        let mut faint = f.clone();
        for pixel in [0, 8, 8 * width, 8 * width + 8].map(|corner| corner + width + 1) {
            faint[2 * n * pixel] = 1e-30;
        }
        let factors = vec![factor; 2 * width * height];
        let of = Image { factors: &factors, ..Image::new(width, height) };
        for (estimator, stratified) in SHARED.into_iter().flat_map(|estimator| [(estimator, false), (estimator, true)])
        {
            let config = Config { estimator, stratified, ..Config::new(2, 2, 2) };
            let [black, almost] = [&f, &faint].map(|f| image(&config, &of, Samples::new(&u, f)).unwrap());
            for (pixel, (black, almost)) in black.iter().zip(&almost).enumerate() {
                let (x, y) = (pixel % width, pixel / width);
                assert_eq!(black.mean[1], almost.mean[1], "{n} {estimator:?} {x}, {y}: {black:?} {almost:?}");
                if x < 8 {
                    assert_eq!((black.mean[0], black.std_error[0], black.gain), (0.0, 0.0, 1.0));
                }
            }
        }
    }
}

/// Linear pixels that brighten across the image, of 4 samples: a hundredth of the mean's squared error. Of one sample,
/// where all are alike, within .1 of 2.
#[test]
fn linear_pixels() {
    let mut rng = SplitMix64::new(12);
    let of = Image::new(11, 7);
    let u = points(4 * 77, 2, &mut rng);
    let linear = |i: usize| 1.0 + u[2 * i] + u[2 * i + 1];
    for (channels, estimator) in SHARED.into_iter().flat_map(|estimator| (1..4).map(move |c| (c, estimator))) {
        let truth = |pixel: usize| 2.0 + 2.0 * (pixel % 11) as f32 / 16.0;
        let value = |i: usize| 0.5 * truth(i / 4) * linear(i);
        let f: Vec<f32> = (0..4 * 77).flat_map(|i| (1..=channels).map(move |c| c as f32 * value(i))).collect();
        let estimates = image(&Config { estimator, ..Config::new(2, 2, channels) }, &of, Samples::new(&u, &f)).unwrap();
        let [mut plain, mut error] = [0.0; 2];
        for (pixel, estimate) in estimates.iter().enumerate() {
            let mean = (4 * pixel..4 * pixel + 4).map(value).sum::<f32>() / 4.0;
            plain += (mean - truth(pixel)).powi(2);
            error += (estimate.mean[0] - truth(pixel)).powi(2);
            assert!(channels == 1 || (estimate.mean[1] - 2.0 * estimate.mean[0]).abs() < 1e-3, "{estimate:?}");
            assert!(estimate.gain.is_finite() && estimate.samples == 4);
            for (channel, (&mean, &error)) in estimate.mean.iter().zip(&estimate.std_error).enumerate() {
                assert!(if channel < channels { error >= 0.0 } else { (mean, error) == (0.0, 0.0) }, "{estimate:?}");
            }
        }
        assert!(error < 0.01 * plain, "{estimator:?} {channels}: {error} {plain}");
    }
    let f: Vec<f32> = (0..77).map(linear).collect();
    for estimate in image(&Config::new(2, 1, 1), &of, Samples::new(&u[..2 * 77], &f)).unwrap() {
        assert!((estimate.mean[0] - 2.0).abs() < 0.1 && estimate.std_error[0].is_finite(), "{estimate:?}");
        assert_eq!(estimate.samples, 1);
    }
}

/// Of few samples a pixel's own variance says little: where fits are right, no more corrections are taken for errors
/// than one in 22, as of samples of a normal distribution. Here up to one in 16 makes an error of 20 times the RMSE.
#[test]
fn right_corrections_are_likely() {
    let mut rng = SplitMix64::new(13);
    for n in [2, 3, 4, 8] {
        let u = points(256 * n, 2, &mut rng);
        let f = values(&u, 2, |u| 1.0 + u[0] + u[1] * u[1]);
        let estimates = image(&Config::new(2, 2, 1), &Image::new(16, 16), Samples::new(&u, &f)).unwrap();
        let errors: Vec<f64> = estimates.iter().map(|estimate| f64::from(estimate.mean[0]) - 11.0 / 6.0).collect();
        let rmse = root_mean_square(&errors);
        let far = estimates.iter().filter(|estimate| f64::from(estimate.std_error[0]) > 20.0 * rmse).count();
        println!("{n} samples: RMSE {rmse:.1e}, {far} of 256 errors above 20 times that");
        assert!(far <= 16, "{n}: {far}");
    }
}

/// The errors of stratified samples are smaller than their spread says: they are taken from the pixels' differences.
/// 1,024 pixels know the ratio within 5 % (95 %) if their errors are independent; they share fits, and the limits are
/// 10 %. Two pixels alone have no differences to tell, and the error is that of their samples.
#[test]
fn errors_of_stratified_samples() {
    let mut rng = SplitMix64::new(14);
    let u = jittered(1024, 4, &mut rng);
    let f = values(&u, 2, |u| 1.0 + (1.5 * u[0] + u[1]).exp());
    let truth = 1.0 + (1.5_f64.exp_m1() / 1.5) * 1.0_f64.exp_m1();
    for order in [1, 2, 3] {
        let config = Config { stratified: true, ..Config::new(2, order, 1) };
        let estimates = image(&config, &Image::new(32, 32), Samples::new(&u, &f)).unwrap();
        let errors: Vec<f64> = estimates.iter().map(|estimate| f64::from(estimate.mean[0]) - truth).collect();
        let told: Vec<f64> = estimates.iter().map(|estimate| f64::from(estimate.std_error[0])).collect();
        let ratio = root_mean_square(&told) / root_mean_square(&errors);
        println!("order {order}: {ratio:.3}");
        assert!((ratio - 1.0).abs() < 0.1, "order {order}: {ratio}");
    }
    let (u, ridge) = (jittered(2, 4, &mut rng), Ridge::Fixed(0.01));
    let f = values(&u, 2, |u| u[0] + u[1] * u[1]);
    let config = Config { stratified: true, ridge, ..Config::new(2, 1, 1) };
    let estimates = image(&config, &Image::new(2, 1), Samples::new(&u, &f)).unwrap();
    for (estimate, f) in estimates.iter().zip(f.chunks(4)) {
        let own: Moments = wide(f).into_iter().collect();
        assert!(f64::from(estimate.std_error[0]) > 0.999 * own.standard_error(), "{estimate:?}");
    }
}

/// Where corrections leave the type's range pixels are their means, to the sign of zero.
#[test]
fn no_correction_keeps_every_bit() {
    let u = points(64, 2, &mut SplitMix64::new(3));
    let mut f: Vec<f32> = u.chunks(2).map(|u| 3e38 * (2.0 * u[0] - 1.0)).collect();
    f[20] = -0.0;
    for estimator in SHARED {
        let config = Config { estimator, ..Config::new(2, 2, 1) };
        let estimates = image(&config, &Image::new(8, 8), Samples::new(&u, &f)).unwrap();
        assert_eq!(estimates[20].mean[0].to_bits(), f[20].to_bits(), "{estimator:?}");
    }
}

/// Where no correction can be added up, the standard error is the plain mean's, and nothing is gained.
#[test]
fn no_correction_has_no_gain() {
    let (u, n) = (points(64 * 4, 2, &mut SplitMix64::new(4)), 4);
    let f: Vec<f32> = u.chunks(2).map(|u| 2e37 * (1.0 + u[0])).collect();
    let estimates = image(&Config::new(2, 1, 1), &Image::new(8, 8), Samples::new(&u, &f)).unwrap();
    let mut uncorrected = 0;
    for (estimate, own) in estimates.iter().zip(wide(&f).chunks(n)) {
        let own: Moments = own.iter().copied().collect();
        if (f64::from(estimate.mean[0]) / own.mean() - 1.0).abs() < 1e-6 {
            assert!((f64::from(estimate.std_error[0]) / own.standard_error() - 1.0).abs() < 1e-6);
            assert_eq!(estimate.gain, 1.0);
            uncorrected += 1;
        }
    }
    assert!(uncorrected > 48, "{uncorrected}");
}

/// Noise far below the group's largest value, of which fits explain nothing: their pixels' errors are told as theirs.
#[test]
fn noise_far_below_one_bright_pixel() {
    let mut rng = SplitMix64::new(6);
    let (u, n) = (points(64 * 4, 2, &mut rng), 4);
    let f: Vec<f32> = (0..64 * n).map(|i| if i / n == 9 { 1.0 } else { 1e-14 * rng.uniform() as f32 }).collect();
    let estimates = image(&Config::new(2, 2, 1), &Image::new(8, 8), Samples::new(&u, &f)).unwrap();
    for (pixel, estimate) in estimates.iter().enumerate().filter(|&(pixel, _)| pixel != 9) {
        let own: Moments = wide(&f[pixel * n..(pixel + 1) * n]).into_iter().collect();
        let ratio = f64::from(estimate.std_error[0]) / own.standard_error();
        assert!(ratio > 0.8, "{pixel}: {ratio}, gain {}", estimate.gain);
    }
}

/// Values times 1e-30 to 1e30: the estimates scale.
#[test]
fn any_scale() {
    let mut rng = SplitMix64::new(5);
    for n in [1, 4] {
        let (u, f) = scene(10 * 10, n, 1, &mut rng);
        for estimator in SHARED {
            let config = Config { estimator, ..Config::new(2, 3, 1) };
            {
                let tolerance = [1e-4, 1e-2];
                let plain = image(&config, &Image::new(10, 10), Samples::new(&u, &f)).unwrap();
                for scale in [1e-30, 1e-20, 1e-5, 1e10, 1e20, 1e30] {
                    let scaled: Vec<f32> = f.iter().map(|f| f * scale).collect();
                    let estimates = image(&config, &Image::new(10, 10), Samples::new(&u, &scaled)).unwrap();
                    for (a, b) in estimates.iter().zip(&plain) {
                        let error = f64::from((a.mean[0] / scale - b.mean[0]).abs()) / largest(&f);
                        assert!(error < tolerance[0], "{estimator:?} {scale:e} {n}: {error:e}");
                        let errors = [a.std_error[0] / scale, b.std_error[0]];
                        let error = f64::from((errors[0] - errors[1]).abs() / errors[1]);
                        assert!(error <= tolerance[1], "{scale:e} {errors:?}");
                    }
                }
            }
        }
    }
}

/// Channels are fitted together but each for itself, if textures set their pixels apart alike: means weigh by the
/// channel that is textured most.
#[test]
fn channels_are_separate() {
    let mut rng = SplitMix64::new(7);
    let (u, f) = scene(8 * 8, 2, 3, &mut rng);
    let of = Image::new(8, 8);
    let together = image(&Config::new(2, 2, 3), &of, Samples::new(&u, &f)).unwrap();
    for channel in 0..3 {
        let own: Vec<f32> = f.iter().skip(channel).step_by(3).copied().collect();
        let alone = image(&Config::new(2, 2, 1), &of, Samples::new(&u, &own)).unwrap();
        for (all, alone) in together.iter().zip(alone) {
            assert!((all.mean[channel] - alone.mean[0]).abs() <= 1e-5 * largest(&own) as f32);
        }
    }
}

/// Pixels in no order are a block, whatever their width, height and frames, bit by bit.
#[test]
fn unordered_is_a_block() {
    let mut rng = SplitMix64::new(9);
    for n in [1, 2, 8] {
        let (u, f) = scene(12, n, 2, &mut rng);
        let samples = Samples::new(&u, &f);
        for estimator in SHARED {
            let config = Config { estimator, ..Config::new(2, 2, 2) };
            {
                let expected = block(&config, 12, samples).unwrap();
                let of = Image::unordered(12);
                for same in [
                    of,
                    Image { width: 4, height: 3, ..of },
                    Image { width: 2, height: 2, frames: 3, ..of },
                    Image { width: 1, frames: 12, window: 1, ..of },
                    Image { window: 2, stride: 99, ..of },
                ] {
                    assert_eq!(image(&config, &same, samples).unwrap(), expected, "{same:?}");
                }
                // And places matter to pixels that have them.
                assert!(image(&config, &Image::new(12, 1), samples).unwrap() != expected, "{estimator:?} {n}");
            }
        }
    }
}

/// A block with surfaces is a block of each, with its factors, bit by bit.
#[test]
fn unordered_surfaces_are_blocks() {
    let mut rng = SplitMix64::new(10);
    for n in [1, 2, 8] {
        let (u, f) = scene(40, n, 2, &mut rng);
        let surfaces: Vec<u32> = (0..40).map(|_| rng.below(4) as u32 * 1_000_000_007).collect();
        let factors: Vec<f32> = (0..80).map(|_| [0.0, 0.3, 1.0, 7.0][rng.below(4)]).collect();
        for factors in [&[][..], &factors] {
            for estimator in SHARED {
                let config = Config { estimator, ..Config::new(2, 2, 2) };
                let of = Image { surfaces: &surfaces, factors, width: 5, height: 2, frames: 4, ..Image::unordered(40) };
                let all = image(&config, &of, Samples::new(&u, &f)).unwrap();
                for surface in [0, 1, 2, 3].map(|surface| surface * 1_000_000_007) {
                    let own: Vec<usize> = (0..40).filter(|&pixel| surfaces[pixel] == surface).collect();
                    let take = |from: &[f32], each: usize| -> Vec<f32> {
                        own.iter().flat_map(|pixel| from[pixel * each..(pixel + 1) * each].to_vec()).collect()
                    };
                    let (u, f) = (take(&u, 2 * n), take(&f, 2 * n));
                    let factors = if factors.is_empty() { vec![] } else { take(factors, 2) };
                    let alone = Image { factors: &factors, ..Image::unordered(own.len()) };
                    let alone = image(&config, &alone, Samples::new(&u, &f)).unwrap();
                    let together: Vec<Estimate> = own.iter().map(|&pixel| all[pixel]).collect();
                    assert_eq!(together, alone, "{estimator:?} {n} {surface}");
                }
            }
        }
    }
}

/// Surfaces of a block are told apart in at most `Image::MAX_WINDOW` pixels; without, there is no limit.
#[test]
fn unordered_limit() {
    let config = Config::new(2, 1, 1);
    let mut rng = SplitMix64::new(11);
    for (pixels, fits) in [(1024, true), (1025, false)] {
        let (u, f) = scene(pixels, 1, 1, &mut rng);
        let samples = Samples::new(&u, &f);
        let surfaces: Vec<u32> = (0..pixels).map(|pixel| pixel as u32 % 3).collect();
        assert_eq!(image(&config, &Image::unordered(pixels), samples).unwrap().len(), pixels);
        let of = Image { surfaces: &surfaces, ..Image::unordered(pixels) };
        let result = image(&config, &of, samples);
        assert_eq!(result.as_ref().err(), if fits { None } else { Some(&Error::Range) });
        if !fits {
            // With any workspace, and in rows too.
            let of = Image { surfaces: &surfaces, width: 205, height: 5, ..Image::unordered(pixels) };
            let never = &mut |_, _| panic!("called on an error");
            assert_eq!(estimate_image(&config, &of, samples, &mut vec![0.0; 1 << 20], never), Err(Error::Range));
        }
    }
    let none = Image::unordered(0);
    assert_eq!(image_workspace_len(&config, &none, 1), Err(Error::Range));
}

#[test]
fn errors() {
    let config = Config::new(2, 1, 1);
    let (u, f) = ([0.5; 24], [1.0; 12]);
    let run = |config: &Config, image: Image<'_>, u: &[f32], f: &[f32], len: usize| {
        let never = &mut |_, _| panic!("called on an error");
        estimate_image(config, &image, Samples::new(u, f), &mut vec![f32::NAN; len], never)
    };
    let of = Image::new(3, 2);
    assert_eq!((of.width, of.height, of.window), (3, 2, 0));
    let len = image_workspace_len(&config, &of, 2).unwrap();
    assert_eq!(run(&config, of, &u, &f, len - 1), Err(Error::Memory));
    assert_eq!(run(&config, Image::new(0, 2), &u, &f, 9999), Err(Error::Range));
    assert_eq!(run(&config, Image::new(3, 0), &u, &f, 9999), Err(Error::Range));
    assert_eq!(run(&config, Image::new(5, 2), &u, &f, 9999), Err(Error::Length));
    assert_eq!(run(&config, Image { window: 2, stride: 3, ..of }, &u, &f, 9999), Err(Error::Range));
    assert_eq!(run(&config, of, &[], &[], 9999), Err(Error::NoSamples));
    assert_eq!(run(&config, of, &u[..23], &f, 9999), Err(Error::Length));
    for len in [1, 5, 7] {
        assert_eq!(run(&config, Image { surfaces: &vec![0; len], ..of }, &u, &f, 9999), Err(Error::Length));
        assert_eq!(run(&config, Image { factors: &vec![1.0; len], ..of }, &u, &f, 9999), Err(Error::Length));
    }
    for (bad, error) in [
        (-1.0, Error::Range),
        (-f32::MIN_POSITIVE, Error::Range),
        (f32::NAN, Error::NotFinite),
        (f32::INFINITY, Error::NotFinite),
        (f32::NEG_INFINITY, Error::NotFinite),
    ] {
        assert_eq!(run(&config, Image { factors: &[1.0, 1.0, 1.0, 1.0, 1.0, bad], ..of }, &u, &f, 9999), Err(error));
    }
    let mut bad = f;
    bad[11] = f32::NAN;
    assert_eq!(run(&config, of, &u, &bad, 9999), Err(Error::NotFinite));
    let mut bad = u;
    bad[23] = 1.5;
    assert_eq!(run(&config, of, &bad, &f, 9999), Err(Error::Range));
    for estimator in [Estimator::LeastSquares, Estimator::GradientDescent, Estimator::Incremental] {
        let other = Config { estimator, ..config };
        assert_eq!(run(&other, of, &u, &f, 9999), Err(Error::Unsupported));
        assert_eq!(image_workspace_len(&other, &of, 2), Err(Error::Unsupported));
    }
    for solver in [Solver::SquareRoot, Solver::Dual] {
        assert_eq!(image_workspace_len(&Config { solver, ..config }, &of, 2), Err(Error::Unsupported));
    }
    assert_eq!(run(&Config { non_finite: NonFinite::Skip, ..config }, of, &u, &f, 9999), Err(Error::Unsupported));
    assert_eq!(image_workspace_len(&Config { controls: 1, ..config }, &of, 2), Err(Error::Unsupported));
    let luminance = Config { color: Color::LuminanceRatio, channels: 3, ..config };
    assert_eq!(image_workspace_len(&luminance, &of, 2), Err(Error::Unsupported));
    for (window, frames, fits) in [(32, 1, true), (33, 1, false), (8, 16, true), (8, 17, false), (usize::MAX, 1, false)]
    {
        let large = Image { window, frames, ..Image::new(100, 100) };
        assert_eq!(image_workspace_len(&config, &large, 1).is_ok(), fits, "{window} {frames}");
    }
    let all = Image { window: usize::MAX, stride: usize::MAX, ..Image::new(30, 30) };
    assert!(image_workspace_len(&config, &all, 1).is_ok());
    for huge in [usize::MAX, usize::MAX / 2 + 1] {
        assert!(image_workspace_len(&config, &Image::new(huge, 8), 1).is_err());
        assert!(image_workspace_len(&config, &Image::new(8, huge), 1).is_err());
        assert!(image_workspace_len(&config, &Image { frames: huge, ..Image::new(8, 8) }, 1).is_err());
        assert!(image_workspace_len(&config, &Image::new(8, 8), huge).is_err());
    }
}

/// A configuration, an image and samples that belong together.
fn any_call() -> impl Strategy<Value = (Config, [usize; 5], usize, u64)> {
    let config =
        (1..5_usize, 0..5_usize, 1..5_usize, 0..3_usize, 0..Family::ALL.len(), 0..3_usize, 0..5_usize, any::<bool>());
    let config = config.prop_map(|(dims, order, channels, estimator, family, ridge, slices, stratified)| Config {
        estimator: SHARED[estimator],
        basis: Family::ALL[family],
        ridge: [Ridge::Default, Ridge::Auto, Ridge::Fixed(0.01)][ridge],
        slices: if dims > 1 { slices } else { 0 },
        edges: slices.min((dims - 1).saturating_sub(usize::from(slices > 1))),
        stratified,
        ..Config::new(dims, order, channels)
    });
    let shape = (1..14_usize, 1..14_usize, 1..4_usize, 0..12_usize, 0..12_usize);
    let shape =
        shape.prop_map(|(w, h, t, window, stride)| [w, h, t, window, stride.min(if window == 0 { 8 } else { window })]);
    (config, shape, 1..5_usize, any::<u64>())
}

proptest! {
    #![proptest_config(crate::cases(150, 8))]

    /// Any shape and configuration, values of any size, surfaces and factors: finite numbers, each pixel once and in
    /// order (which the calls check), the same again.
    #[test]
    fn any_shape_gives_finite_numbers((config, [width, height, frames, window, stride], n, seed) in any_call()) {
        let mut rng = SplitMix64::new(seed);
        let pixels = width * height * frames;
        let u = points(pixels * n, config.dims, &mut rng);
        let exponent = rng.below(77) as i32 - 38;
        let wild = rng.below(2) == 0;
        let value = |rng: &mut SplitMix64| {
            let own = if wild { rng.below(77) as i32 - 38 } else { exponent };
            [0.0, 1.0, rng.normal() as f32, -1.0][rng.below(4)] * 10.0_f32.powi(own)
        };
        let f: Vec<f32> = (0..pixels * n * config.channels).map(|_| value(&mut rng)).collect();
        let f: Vec<f32> = f.iter().map(|f| f.clamp(-f32::MAX, f32::MAX)).collect();
        let surfaces: Vec<u32> = (0..pixels).map(|_| rng.below(3) as u32).collect();
        let factors: Vec<f32> = (0..pixels * config.channels).map(|_| [0.0, 1e-30, 0.5, 1e20][rng.below(4)]).collect();
        let mut of = Image { frames, window, stride, ..Image::new(width, height) };
        if seed % 2 == 0 {
            of.surfaces = &surfaces;
        }
        if seed % 3 == 0 {
            of.factors = &factors;
        }
        of.unordered = seed % 5 == 0;
        let estimates = image(&config, &of, Samples::new(&u, &f)).unwrap();
        for estimate in &estimates {
            prop_assert!(is_sound(estimate), "{estimate:?}");
        }
        prop_assert_eq!(&estimates, &image(&config, &of, Samples::new(&u, &f)).unwrap());
    }
}

proptest! {
    #![proptest_config(crate::cases(500, 3))]

    /// But for the robust choice a pixel's own samples never shape its correction, and their order
    /// never matters, within the rounding of a fit in `f32`.
    #[test]
    fn a_pixel_does_not_see_itself(
        estimator in 0..3_usize,
        width in 1..10_usize,
        height in 1..10_usize,
        n in 1..5_usize,
        order in 1..3_usize,
        in_order in any::<bool>(),
        seed in any::<u64>(),
    ) {
        let estimator = [Estimator::LeaveOneOut, Estimator::KFold, Estimator::Robust][estimator];
        let config = Config { estimator, ..Config::new(2, order, 1) };
        let ridge = if estimator == Estimator::Robust { Ridge::Fixed(0.02) } else { config.ridge };
        let config = Config { ridge, ..config };
        let (mut rng, pixels) = (SplitMix64::new(seed), width * height);
        let u = points(pixels * n, 2, &mut rng);
        let f = wide(&u).chunks(2).map(|u| smooth(u) as f32).collect::<Vec<f32>>();
        let call = |u: &[f32], f: &[f32]| match in_order {
            true => image(&config, &Image::new(width, height), Samples::new(u, f)).unwrap(),
            false => block(&config, pixels, Samples::new(u, f)).unwrap(),
        };
        let pixel = rng.below(pixels);
        let own = pixel * n..(pixel + 1) * n;
        let correction = |f: &[f32]| call(&u, f)[pixel].mean[0] - f[own.clone()].iter().sum::<f32>() / n as f32;
        let mut other = f.clone();
        other[own.clone()].iter_mut().for_each(|f| *f = 3.0 * rng.uniform_f32() - 1.0);
        let (a, b) = (correction(&f), correction(&other));
        prop_assert!((a - b).abs() < 3e-4, "{a} {b}");

        let (mut turned_u, mut turned_f) = (u.clone(), f.clone());
        turned_f[own.clone()].reverse();
        turned_u[2 * own.start..2 * own.end].as_chunks_mut::<2>().0.reverse();
        for (a, b) in call(&u, &f).iter().zip(call(&turned_u, &turned_f)) {
            prop_assert!((a.mean[0] - b.mean[0]).abs() < 1e-4, "{:?} {:?}", a, b);
        }
    }
}
