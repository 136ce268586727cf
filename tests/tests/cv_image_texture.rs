//! Shared fits where pixels differ by a texture, and hardly by their samples: they must not make noise of it.
//!
//! f = texture (1 + sigma h(u)), sigma from 0 to 1. From two samples on a pixel knows its own noise; of one sample each
//! only `surfaces` or `factors` tell texture from noise.

use crate::cv_support::points;
use noisefloor::control_variate::{Config, Estimator, Image, Samples, image_workspace_len};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::shared::image;
use noisefloor_tests::statistics::maximum;

const SIDE: usize = 32;
const PIXELS: usize = SIDE * SIDE;
const REPETITIONS: usize = 2;
const SIGMAS: [f64; 7] = [0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0];

type Texture = fn(usize, usize, f64) -> f64;

const TEXTURES: [(&str, Texture); 6] = [
    ("noise", |_, _, random| 0.1 + 0.9 * random),
    ("stripes", |x, _, _| if x / 3 % 2 == 1 { 1.0 } else { 0.1 }),
    ("checkers", |x, y, _| if (x + y) % 2 == 1 { 1.0 } else { 0.1 }),
    ("waves", |x, y, _| 0.5 + 0.45 * (1.3 * x as f64).sin() * (0.9 * y as f64).cos()),
    ("a bright pixel of 64", |x, y, _| if x % 8 == 3 && y % 8 == 4 { 1.0 } else { 0.05 }),
    ("black beside noise", |x, _, random| if x < 17 { 0.0 } else { 0.2 + 0.8 * random }),
];

/// Deviates of mean 0: one that fits explain, one that they do not.
const DEVIATES: [fn(&[f32]) -> f64; 2] = [
    |u| (f64::from(u[0]) - 0.5) * 12.0_f64.sqrt(),
    |u| if ((56.0 * u[0]) as u32 + (42.0 * u[1]) as u32) % 2 == 1 { 1.0 } else { -1.0 },
];

fn values(texture: Texture) -> Vec<f64> {
    let mut rng = SplitMix64::new(5);
    (0..PIXELS).map(|pixel| texture(pixel % SIDE, pixel / SIDE, f64::from(rng.uniform_f32()))).collect()
}

/// Of the estimates and of the plain means: sums of squared errors, and how often the truth is within two standard
/// errors.
#[derive(Default)]
struct Score {
    squares: [f64; 2],
    covered: [usize; 2],
    largest: f64,
}

/// Fits of two numbers, and those of two and a third that picks one of many slices.
fn configs() -> [Config; 2] {
    [Config::new(2, 3, 1), Config { slices: 16, ..Config::new(3, 2, 1) }]
}

fn score(
    config: &Config,
    texture: &[f64],
    of: &Image<'_>,
    n: usize,
    (sigma, deviate): (f64, fn(&[f32]) -> f64),
) -> Score {
    let dims = config.dims;
    let mut score = Score::default();
    let mut rng = SplitMix64::new(11);
    for _ in 0..REPETITIONS {
        let u = points(PIXELS * n, dims, &mut rng);
        let f: Vec<f32> =
            u.chunks(dims).enumerate().map(|(i, u)| (texture[i / n] * (1.0 + sigma * deviate(u))) as f32).collect();
        let estimates = image(config, of, Samples::new(&u, &f)).unwrap();
        for ((estimate, own), truth) in estimates.iter().zip(f.chunks(n)).zip(texture) {
            let mean = own.iter().map(|&f| f64::from(f)).sum::<f64>() / n as f64;
            let variance =
                own.iter().map(|&f| (f64::from(f) - mean).powi(2)).sum::<f64>() / ((n - 1).max(1) * n) as f64;
            let errors = [f64::from(estimate.mean[0]) - truth, mean - truth];
            let told = [f64::from(estimate.std_error[0]), variance.sqrt()];
            for k in 0..2 {
                score.squares[k] += errors[k] * errors[k];
                score.covered[k] += usize::from(errors[k].abs() <= 2.0 * told[k] + 1e-7);
            }
            score.largest = maximum([score.largest, (f64::from(estimate.mean[0]) - f64::from(own[0])).abs()]);
        }
    }
    score
}

fn ratio(score: &Score) -> f64 {
    (score.squares[0] / score.squares[1].max(1e-300)).sqrt()
}

/// The root of the squared error over the plain mean's, and how often +- 2 `std_error` hold the truth.
#[test]
fn no_noise_from_texture() {
    let bounds = [(2, 1.10), (4, 1.05), (16, 1.05)];
    for ((n, most), config) in bounds.into_iter().flat_map(|bound| configs().map(|config| (bound, config))) {
        let (mut worst, mut least) = (0.0_f64, 1.0_f64);
        for (name, texture) in TEXTURES {
            let texture = values(texture);
            for deviate in DEVIATES {
                for sigma in SIGMAS {
                    let score = score(&config, &texture, &Image::new(SIDE, SIDE), n, (sigma, deviate));
                    let [own, plain] = score.covered.map(|count| count as f64 / (REPETITIONS * PIXELS) as f64);
                    let ratio = ratio(&score);
                    assert!(ratio < most, "{name} {sigma}: {ratio}");
                    assert!(own > plain - 0.05, "{name} {sigma}: {own} for {plain}");
                    worst = worst.max(ratio);
                    least = least.min(own - plain);
                }
            }
        }
        println!(
            "{n} samples, {} slices: worst {worst:.3}, coverage {least:+.3} of the mean's at the least",
            config.slices
        );
    }
}

/// What slices explain is kept beside a texture ten times as large as it.
#[test]
fn slices_beside_a_texture() {
    let texture = values(TEXTURES[0].1);
    let of_slices: fn(&[f32]) -> f64 = |u| if ((16.0 * u[2]) as u32).is_multiple_of(3) { 1.4 } else { -0.6363 };
    for estimator in [Estimator::Robust, Estimator::LeaveOneOut] {
        let config = Config { estimator, ..configs()[1] };
        let ratio = ratio(&score(&config, &texture, &Image::new(SIDE, SIDE), 4, (0.1, of_slices)));
        println!("{ratio:.3}");
        assert!(ratio < 0.7, "{ratio}");
    }
}

/// Pixels whose samples are equal stay as they are, to the last bit.
#[test]
fn equal_samples_stay() {
    for (name, texture) in TEXTURES {
        let texture = values(texture);
        let estimators = [Estimator::Robust, Estimator::LeaveOneOut];
        for (config, estimator) in configs().into_iter().flat_map(|c| estimators.map(|estimator| (c, estimator))) {
            let config = Config { estimator, ..config };
            for n in [2, 4, 7] {
                let score = score(&config, &texture, &Image::new(SIDE, SIDE), n, (0.0, DEVIATES[0]));
                assert_eq!(score.largest, 0.0, "{name}");
            }
        }
    }
}

/// One sample in each: as good as the mean if the renderer says what differs; the harm if not is measured.
#[test]
fn one_sample_needs_to_be_told() {
    let [mut by_factors, mut by_surfaces, mut blind] = [0.0_f64; 3];
    for (name, texture) in TEXTURES {
        let texture = values(texture);
        // A factor per texel, black ones apart; a surface for each of few levels, whose pixels are alike.
        let black: Vec<u32> = texture.iter().map(|&value| u32::from(value == 0.0)).collect();
        let factors: Vec<f32> = texture.iter().map(|&value| value as f32).collect();
        let surfaces: Vec<u32> = texture.iter().map(|&value| (value as f32).to_bits()).collect();
        let has_levels = ["stripes", "checkers", "a bright pixel of 64"].contains(&name);
        for deviate in DEVIATES {
            for sigma in SIGMAS {
                let base = Image::new(SIDE, SIDE);
                let of = |image: &Image<'_>| ratio(&score(&configs()[0], &texture, image, 1, (sigma, deviate)));
                by_factors = maximum([by_factors, of(&Image { factors: &factors, surfaces: &black, ..base })]);
                if has_levels {
                    by_surfaces = maximum([by_surfaces, of(&Image { surfaces: &surfaces, ..base })]);
                }
                blind = blind.max(of(&base));
            }
        }
    }
    println!("factors {by_factors:.3}, surfaces {by_surfaces:.3}, blind {blind:.1}");
    assert!(by_factors < 1.03 && by_surfaces < 1.03, "{by_factors} {by_surfaces}");
    assert!(blind > 2.0, "the guide warns of what does not happen: {blind}");
}

/// Numbers of workspace: what a window needs, and a few rows of sums.
#[test]
fn memory() {
    let bytes = |config: &Config, side: [usize; 2], n: usize| {
        4 * image_workspace_len(config, &Image::new(side[0], side[1]), n).unwrap()
    };
    for channels in [1, 3] {
        for n in [1, 4, 16] {
            let config = Config::new(2, 3, channels);
            let [small, large] = [[256, 256], [3840, 2160]].map(|side| bytes(&config, side, n));
            println!("{channels} channels, {n} samples: {small} and {large} bytes");
            assert!(small < 2 << 20 && large < 64 << 20, "{channels} {n}: {small} {large}");
        }
    }
}
