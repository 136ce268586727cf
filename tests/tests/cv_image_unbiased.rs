//! Which shared fits are exactly unbiased, and how little the others are biased.
//!
//! Seeds are fixed. A z-test is two-sided at |z| < 4.75, probability 2e-6. For each setting the mean over an image's
//! pixels, its difference between left and right half, and five pixels are tested: 7 deviates, 504 in all, so that the
//! chance that any failed by chance was 1e-3 when the seeds were chosen. Eight times as many samples found nothing
//! either.

use crate::cv_support::points;
use noisefloor::control_variate::{Config, Estimator, Image, Ridge, Samples};
use noisefloor::tile::Builtin;
use noisefloor_tests::planar::Planar;
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::shared::image;
use noisefloor_tests::shared_bias::{bias, independent, of_tile};
use noisefloor_tests::statistics::{Moments, maximum};

const Z_LIMIT: f64 = 4.75;
const WIDTH: usize = 6;
const HEIGHT: usize = 4;
const PIXELS: usize = WIDTH * HEIGHT;

/// The part of the square in which all pixels are bright.
const RARE: f64 = 0.06;

/// A pixel's value and, without a point, its integral.
type Scene = fn(usize, Option<[f64; 2]>) -> f64;

fn planar(planar: Planar, u: Option<[f64; 2]>) -> f64 {
    u.map_or(planar.integral()[0], |u| planar.at(u))
}

const SCENES: [(&str, Scene); 5] = [
    ("half-plane that moves", |pixel, u| {
        planar(Planar::HalfPlane { a: [0.6, 0.8], b: 0.3 }.moved(0.1 * (pixel % WIDTH) as f64), u)
    }),
    ("bump that scales", |pixel, u| {
        let bump = Planar::Bump { c: [0.2, 0.7], s: 0.15 }.moved(0.02 * (pixel / WIDTH) as f64);
        (1.0 + 0.3 * (pixel % WIDTH) as f64) * planar(bump, u)
    }),
    ("step between pixels", |pixel, u| {
        let u = u.unwrap_or([0.5, 0.5]);
        if pixel % WIDTH < 3 { u[0] } else { 3.0 + 10.0 * u[1] }
    }),
    // Pixels that are left out of fits to others: always the same one, and whichever has drawn a bright sample.
    ("bright pixel", |pixel, u| {
        let u = u.unwrap_or([0.5, 0.5]);
        (u[0] + 0.5 * u[1]) * if pixel == 9 { 100.0 } else { 1.0 }
    }),
    ("rare bright samples", |_, u| match u {
        Some(u) => 50.0 * f64::from(u8::from(u[0] < RARE)) + u[1],
        None => 50.0 * RARE + 0.5,
    }),
];

/// What is known of the image: surfaces and factors at random.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Known {
    Nothing,
    Surfaces,
    Factors,
}

/// Errors of a scene's pixels over many sets of independent samples.
struct Errors {
    /// The image's mean, its left half less its right, and some pixels.
    tested: [Moments; 7],
    /// Squares of all.
    squares: Moments,
}

impl Errors {
    fn new(
        config: &Config,
        scene: Scene,
        (n, window): (usize, usize),
        known: Known,
        repetitions: usize,
        seed: u64,
    ) -> Self {
        let mut rng = SplitMix64::new(seed);
        let truth: Vec<f64> = (0..PIXELS).map(|pixel| scene(pixel, None)).collect();
        let mut errors = Errors { tested: Default::default(), squares: Moments::default() };
        for _ in 0..repetitions {
            let u = points(PIXELS * n, 2, &mut rng);
            let at = |i: usize| Some([f64::from(u[2 * i]), f64::from(u[2 * i + 1])]);
            let f: Vec<f32> = (0..PIXELS * n).map(|i| scene(i / n, at(i)) as f32).collect();
            let surfaces: Vec<u32> = (0..PIXELS).map(|_| rng.below(2) as u32).collect();
            let factors: Vec<f32> = (0..PIXELS).map(|_| 0.1 + rng.uniform_f32()).collect();
            let mut of = Image { window, ..Image::new(WIDTH, HEIGHT) };
            match known {
                Known::Nothing => {}
                Known::Surfaces => of.surfaces = &surfaces,
                Known::Factors => of.factors = &factors,
            }
            let estimates = image(config, &of, Samples::new(&u, &f)).unwrap();
            let all: Vec<f64> = estimates.iter().zip(&truth).map(|(a, b)| f64::from(a.mean[0]) - b).collect();
            let [left, right] = [0, 1].map(|half| {
                let own = (0..PIXELS).filter(|pixel| pixel % WIDTH / 3 == half);
                own.map(|pixel| all[pixel]).sum::<f64>() / PIXELS as f64
            });
            let tested = [left + right, left - right, all[0], all[2], all[9], all[15], all[PIXELS - 1]];
            errors.tested.iter_mut().zip(tested).for_each(|(moments, error)| moments.add(error));
            all.iter().for_each(|error| errors.squares.add(error * error));
        }
        errors
    }

    /// The largest |z|.
    fn z(&self) -> f64 {
        maximum(self.tested.iter().map(|moments| moments.z(0.0).abs()))
    }
}

fn exactly_unbiased(estimator: Estimator, ridge: Ridge) {
    let config = Config { estimator, ridge, ..Config::new(2, 2, 1) };
    for (index, (name, scene)) in SCENES.into_iter().enumerate() {
        for n in [1, 4] {
            for (known, window) in
                [(Known::Nothing, 4), (Known::Surfaces, 4), (Known::Factors, 4), (Known::Nothing, WIDTH)]
            {
                if known != Known::Nothing && index != 2 {
                    continue;
                }
                // In one window halves that choose for themselves show, by z = 11. What all pixels together, instead of
                // the other half, say is to be left out shows in the last scene, by z = 5.
                let repetitions = match (n, window) {
                    (1, 4) if index == SCENES.len() - 1 && estimator == Estimator::KFold => 20_000,
                    (1, WIDTH) => 10_000,
                    (1, _) => 4000,
                    _ => 1500,
                };
                let errors = Errors::new(&config, scene, (n, window), known, repetitions, 110 + index as u64);
                let (z, bias) = (errors.z(), errors.tested[0].mean() / errors.squares.mean().sqrt());
                let line = format!("{estimator:?}, {name}, {known:?}, window {window}, {n} samples");
                println!("{line}: |z| <= {z:.2}, bias {bias:.4} of the RMSE");
                assert!(z < Z_LIMIT, "{line}: {z}");
            }
        }
    }
}

#[test]
fn leave_one_out() {
    exactly_unbiased(Estimator::LeaveOneOut, Ridge::Default);
}

#[test]
fn a_fixed_ridge() {
    exactly_unbiased(Estimator::Robust, Ridge::Fixed(0.05));
}

#[test]
fn k_fold() {
    exactly_unbiased(Estimator::KFold, Ridge::Default);
}

/// The tests above can fail: the robust mixture does, at one sample in such small windows.
#[test]
fn the_tests_are_sharp() {
    let config = Config::new(2, 2, 1);
    let z = [0, 1, 2]
        .map(|index: usize| SCENES[index].1)
        .map(|scene| Errors::new(&config, scene, (1, 4), Known::Nothing, 6000, 20).z());
    println!("robust: {z:?}");
    assert!(z.into_iter().fold(0.0, f64::max) > 6.0);
}

/// The robust mixture, one independent sample: a bias of .025 of the RMSE in windows of 4 x 4 pixels (largest of 24
/// integrands .080), .009 (.028) in windows of 8, .002 (.008) in windows of 16, where chance alone would show .004.
#[test]
fn robust_on_independent_samples() {
    let mut typical = vec![];
    for (side, repetitions) in [(4, 3000), (8, 800), (16, 200)] {
        let bias = bias(&Config::new(2, 3, 1), side, 1, repetitions, independent(side * side));
        println!("robust, independent, window {side}: {bias:?}");
        typical.push(bias.typical);
        assert!(bias.largest < 0.1 && bias.chance < 0.01, "{side}: {bias:?}");
    }
    assert!(typical[1] < typical[0] && typical[2] < typical[1], "{typical:?}");
}

/// Samples of the built-in tiles, a random part of it with all values shifted at random, which leaves each uniform but
/// not independent: not exactly unbiased for any estimator. Measured at one sample: robust .004 (largest of 24
/// integrands .012), leave-one-out .008 (.016), two halves .005 (.016); at four .003 (.011) or less.
#[test]
fn on_the_built_in_tiles() {
    for (builtin, n) in [(Builtin::Size128Spp1Dims2, 1), (Builtin::Size128Spp4Dims2, 4)] {
        for estimator in [Estimator::Robust, Estimator::LeaveOneOut, Estimator::KFold] {
            let config = Config { estimator, ..Config::new(2, 3, 1) };
            let bias = bias(&config, 8, n, 600 / n, of_tile(builtin));
            println!("{estimator:?}, tile of {n} samples: {bias:?}");
            assert!(bias.typical < 0.02 && bias.largest < 0.05, "{estimator:?} {n}: {bias:?}");
        }
    }
}
