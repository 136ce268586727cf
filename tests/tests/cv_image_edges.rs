//! Shared fits that follow the edge of a shadow in two coordinates: `Config::edges`.
//!
//! Seeds are fixed. A z-test is at |z| < 4.75, two-sided probability 2e-6; there are 160 of them.

use crate::cv_support::{jittered, points};
use noisefloor::Error;
use noisefloor::control_variate::{
    Config, Estimate, Estimator, Image, Ridge, Samples, estimate_image, image_workspace_len,
};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::shared::image;
use noisefloor_tests::statistics::{Moments, maximum};
use std::f64::consts::PI;

const Z_LIMIT: f64 = 4.75;
const SIDE: usize = 8;
const PIXELS: usize = SIDE * SIDE;

/// What hides the light: it is seen within a disc, or before a line, that move from pixel to pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shadow {
    Disc,
    Line,
    /// Light that few samples see: whether a group has any is chance.
    Glint,
}

impl Shadow {
    fn along(pixel: usize) -> [f64; 2] {
        [(pixel % SIDE) as f64 / SIDE as f64, (pixel / SIDE) as f64 / SIDE as f64]
    }

    fn at(self, pixel: usize, [u, v]: [f64; 2]) -> f64 {
        let [x, y] = Self::along(pixel);
        match self {
            Self::Disc if (u - 0.4 - 0.2 * x).hypot(v - 0.4 - 0.2 * y) < 0.35 => 1.0 + u,
            Self::Line if u + 0.4 * v < 0.5 + 0.3 * x => 2.0 + x,
            Self::Glint if u < 0.01 => 1.0 + v,
            _ => 0.0,
        }
    }

    fn integral(self, pixel: usize) -> f64 {
        let [x, _] = Self::along(pixel);
        match self {
            Self::Disc => PI * 0.35 * 0.35 * (1.4 + 0.2 * x),
            Self::Line => (0.3 + 0.3 * x) * (2.0 + x),
            Self::Glint => 0.015,
        }
    }

    fn values(self, n: usize, u: &[f32]) -> Vec<f32> {
        let at = |(i, u): (usize, &[f32])| self.at(i / n, [u[0], u[1]].map(f64::from)) as f32;
        u.chunks(2).enumerate().map(at).collect()
    }
}

fn estimates(config: &Config, u: &[f32], f: &[f32]) -> Vec<Estimate> {
    image(config, &Image::new(SIDE, SIDE), Samples::new(u, f)).unwrap()
}

fn bits(estimates: &[Estimate]) -> Vec<u32> {
    estimates.iter().flat_map(|e| [e.mean[0], e.std_error[0], e.gain].map(f32::to_bits)).collect()
}

/// Squared errors with edges against those without, frame by frame: how sure it is that they differ, and their ratio.
fn compare(config: &Config, shadow: Shadow, n: usize, rng: &mut SplitMix64) -> (f64, f64) {
    let (mut gained, mut all) = (Moments::default(), [Moments::default(); 2]);
    for _ in 0..60 {
        let u = if config.stratified { jittered(PIXELS, n, rng) } else { points(PIXELS * n, 2, rng) };
        let f = shadow.values(n, &u);
        let [plain, edges] = [0, 1].map(|edges| {
            let of = |(pixel, e): (usize, &Estimate)| (f64::from(e.mean[0]) - shadow.integral(pixel)).powi(2);
            estimates(&Config { edges, ..*config }, &u, &f).iter().enumerate().map(of).sum::<f64>()
        });
        gained.add(edges - plain);
        all.iter_mut().zip([plain, edges]).for_each(|(moments, error)| moments.add(error));
    }
    (gained.z(0.0), all[1].mean() / all[0].mean())
}

#[test]
fn they_lower_the_error() {
    for (index, shadow) in [Shadow::Disc, Shadow::Line].into_iter().enumerate() {
        for n in [4, 16] {
            for stratified in [false, true] {
                let config = Config { stratified, ..Config::new(2, 3, 1) };
                let mut rng = SplitMix64::new(300 + index as u64);
                let (z, ratio) = compare(&config, shadow, n, &mut rng);
                println!("{shadow:?}, {n} samples, stratified {stratified}: {ratio:.3} of the error, z {z:.1}");
                assert!(z < -Z_LIMIT && ratio < 0.95, "{shadow:?} {n} {stratified}: {ratio} {z}");
            }
        }
    }
}

/// Halves that choose for each other: the mean of the pixels, that of the left less the right half, and five pixels.
#[test]
fn k_fold_is_unbiased() {
    for (index, shadow) in [Shadow::Disc, Shadow::Line, Shadow::Glint].into_iter().enumerate() {
        for window in [4, SIDE] {
            let config = Config { estimator: Estimator::KFold, edges: 1, ..Config::new(2, 2, 1) };
            let of = Image { window, ..Image::new(SIDE, SIDE) };
            let mut rng = SplitMix64::new(310 + index as u64);
            let mut tested = [Moments::default(); 7];
            for _ in 0..1000 {
                let u = points(PIXELS * 4, 2, &mut rng);
                let f = shadow.values(4, &u);
                let all: Vec<f64> = image(&config, &of, Samples::new(&u, &f))
                    .unwrap()
                    .iter()
                    .enumerate()
                    .map(|(pixel, e)| f64::from(e.mean[0]) - shadow.integral(pixel))
                    .collect();
                let half = |right: usize| {
                    (0..PIXELS).filter(|pixel| pixel % SIDE / 4 == right).map(|pixel| all[pixel]).sum::<f64>()
                };
                let [left, right] = [half(0), half(1)];
                let errors = [left + right, left - right, all[0], all[7], all[27], all[36], all[PIXELS - 1]];
                tested.iter_mut().zip(errors).for_each(|(moments, error)| moments.add(error));
            }
            let z = maximum(tested.iter().map(|moments| moments.z(0.0).abs()));
            println!("{shadow:?}, window {window}: |z| <= {z:.2}");
            assert!(z < Z_LIMIT, "{shadow:?} {window}: {z}");
        }
    }
}

/// No bit changes where there is nothing to follow, below 4 samples, and for estimators that do not choose.
#[test]
fn elsewhere_nothing_changes() {
    let mut rng = SplitMix64::new(320);
    let single = Config { estimator: Estimator::LeaveOneOut, ..Config::new(2, 2, 1) };
    let fixed = Config { ridge: Ridge::Fixed(0.1), ..Config::new(2, 2, 1) };
    for (config, n, light) in [
        (Config::new(2, 2, 1), 4, 0.1),
        (Config::new(2, 2, 1), 3, 0.0),
        (single, 4, 0.0),
        (fixed, 4, 0.0),
        (Config::new(2, 2, 1), 4, -9.0),
    ] {
        let u = points(PIXELS * n, 2, &mut rng);
        let f: Vec<f32> = Shadow::Disc.values(n, &u).iter().map(|f| f + light).collect();
        let with = Config { edges: 1, ..config };
        assert!(bits(&estimates(&with, &u, &f)) == bits(&estimates(&config, &u, &f)), "{n} {light}");
        let of = Image::new(SIDE, SIDE);
        let [len, more] = [config, with].map(|config| image_workspace_len(&config, &of, n).unwrap());
        assert_eq!(more > len, n > 3 && config == Config::new(2, 2, 1));
    }
    // Nor in groups of fewer than 8 pixels.
    for (pixels, follows) in [(7, false), (8, true)] {
        let u = points(pixels * 4, 2, &mut rng);
        let f = Shadow::Line.values(4, &u);
        let [with, without] = [1, 0].map(|edges| {
            let config = Config { edges, ..Config::new(2, 2, 1) };
            bits(&image(&config, &Image::new(pixels, 1), Samples::new(&u, &f)).unwrap())
        });
        assert_eq!(with != without, follows, "{pixels}");
    }
}

/// The edge is sought in the two coordinates that `edges` names: at order 0 the others change no bit.
#[test]
fn edges_are_where_they_are_said_to_be() {
    let mut rng = SplitMix64::new(325);
    let u = points(PIXELS * 4, 2, &mut rng);
    let f = Shadow::Disc.values(4, &u);
    let expected = bits(&estimates(&Config { edges: 1, ..Config::new(2, 0, 1) }, &u, &f));
    for first in 0..3 {
        let place = |row: &[f32]| {
            let mut longer: [f32; 4] = std::array::from_fn(|_| rng.uniform() as f32);
            longer[first..first + 2].copy_from_slice(row);
            longer
        };
        let longer: Vec<f32> = u.chunks(2).flat_map(place).collect();
        let config = Config { edges: first + 1, ..Config::new(4, 0, 1) };
        assert!(bits(&estimates(&config, &longer, &f)) == expected, "{first}");
    }
}

/// Other coordinates, channels, frames, orders and pixels without places; values of any size.
#[test]
fn every_form_is_finite() {
    let mut rng = SplitMix64::new(330);
    for round in 0..200 {
        let [dims, channels, frames] = [2 + rng.below(4), 1 + rng.below(4), 1 + rng.below(2)];
        let estimator = [Estimator::Robust, Estimator::KFold][round % 2];
        let edges = 1 + rng.below(dims - 1);
        let config = Config { edges, estimator, ..Config::new(dims, rng.below(4), channels) };
        let unordered = rng.below(4) == 0;
        let of = Image { unordered, frames, stride: 1 + rng.below(8), ..Image::new(9 + rng.below(8), 9) };
        let pixels = of.width * of.height * frames;
        let mut u = points(pixels * 4, dims, &mut rng);
        u.iter_mut().step_by(7).for_each(|u| *u = u.round());
        let scale = [1.0, 1e-38, 1e30, f32::MAX / 8.0][rng.below(4)];
        let bright = rng.below(pixels);
        let f: Vec<f32> = (0..pixels * 4 * channels)
            .map(|i| {
                let (sample, lit) = (i / channels, rng.below(3) > 0);
                let factor = if sample / 4 == bright { 8.0 } else { 1.0 };
                if lit && u[sample * dims] < 0.6 { scale * factor * (rng.uniform_f32() - 0.1) } else { 0.0 }
            })
            .collect();
        for estimate in image(&config, &of, Samples::new(&u, &f)).unwrap() {
            let numbers = [estimate.mean, estimate.std_error].concat();
            assert!(numbers.iter().all(|value| value.is_finite()), "{config:?} {of:?} {scale}: {estimate:?}");
        }
    }
}

/// Pixels in no order are worked on in eight parts, with a surface in one: they choose alike.
#[test]
fn parts_choose_as_one() {
    let mut rng = SplitMix64::new(335);
    let (n, pixels) = (4, 64);
    let config = Config { edges: 1, ..Config::new(2, 0, 1) };
    let surfaces = vec![0; pixels];
    let mut errors = [[0.0; 2]; 2];
    for _ in 0..100 {
        let u = points(pixels * n, 2, &mut rng);
        // Light that has an edge, and light that comes by chance.
        for (errors, has_edge) in errors.iter_mut().zip([true, false]) {
            let is_lit = |u: &[f32], chance: f64| if has_edge { u[0] < 0.5 } else { chance < 0.5 };
            let f: Vec<f32> = u.chunks(2).map(|u| if is_lit(u, rng.uniform()) { 1.0 } else { 0.0 }).collect();
            for (error, surfaces) in errors.iter_mut().zip([&[][..], &surfaces]) {
                let of = Image { surfaces, ..Image::unordered(pixels) };
                let all = image(&config, &of, Samples::new(&u, &f)).unwrap();
                *error += all.iter().map(|pixel| f64::from(pixel.mean[0] - 0.5).powi(2)).sum::<f64>();
            }
        }
    }
    let [edge, chance] = errors.map(|[parts, one]| parts / one);
    assert!((0.9..1.1).contains(&edge) && (0.995..1.005).contains(&chance), "{edge} {chance}");
}

/// Powers of two scale estimates, exactly.
#[test]
fn units_do_not_matter() {
    let mut rng = SplitMix64::new(340);
    let config = Config { edges: 1, ..Config::new(2, 2, 1) };
    let u = points(PIXELS * 4, 2, &mut rng);
    let f = Shadow::Line.values(4, &u);
    let larger: Vec<f32> = f.iter().map(|f| f * 1024.0).collect();
    let all = estimates(&config, &u, &f);
    for (a, b) in all.iter().zip(estimates(&config, &u, &larger)) {
        assert_eq!((a.mean[0] * 1024.0).to_bits(), b.mean[0].to_bits());
    }
}

#[test]
fn coordinates_must_be_there() {
    const EDGES: &str = "edges must be 0, or at least 1 and below dims, with slices below dims - 1";
    let u = [0.5; 12];
    // With slices the last coordinate is no place.
    for (dims, edges, slices) in [(1, 1, 0), (2, 2, 0), (2, usize::MAX, 0), (2, 1, 2), (3, 2, 4), (3, usize::MAX, 4)] {
        let config = Config { edges, slices, ..Config::new(dims, 1, 1) };
        assert_eq!(image_workspace_len(&config, &Image::new(SIDE, SIDE), 4), Err(Error::Range));
        let invalid = config.check().unwrap_err();
        assert_eq!((Error::from(invalid), invalid.to_string().as_str()), (Error::Range, EDGES));
        assert!(image(&config, &Image::new(1, 1), Samples::new(&u[..4 * dims], &u[..4])).is_err());
    }
    for (edges, slices) in [(2, 1), (1, 4)] {
        assert_eq!(Config { edges, slices, ..Config::new(3, 1, 1) }.check(), Ok(()));
    }
}

/// Outputs to the bit, on every target: means of some pixels.
#[test]
fn outputs_are_the_pinned_ones() {
    let mut found = vec![];
    for (n, estimator, channels) in [(4, Estimator::Robust, 1), (4, Estimator::KFold, 1), (16, Estimator::Robust, 2)] {
        let mut rng = SplitMix64::new(350);
        let u = points(PIXELS * n, 2, &mut rng);
        let f: Vec<f32> = Shadow::Disc.values(n, &u).iter().flat_map(|&f| vec![f; channels]).collect();
        let config = Config { estimator, edges: 1, ..Config::new(2, 2, channels) };
        let all = estimates(&config, &u, &f);
        found.push([0, 9, 30, 63].map(|pixel: usize| all[pixel].mean[0].to_bits()));
    }
    assert_eq!(found, PINNED, "{found:#010x?}");
}

const PINNED: [[u32; 4]; 3] = [
    [0x3f2c_38d2, 0x3f10_a21c, 0x3f0b_2504, 0x3f66_71b8],
    [0x3f2c_432e, 0x3f10_a95d, 0x3f05_1893, 0x3f66_8ad1],
    [0x3f1e_bd45, 0x3efb_afeb, 0x3f37_c343, 0x3efb_f075],
];

/// They do so without polynomials, too.
#[test]
fn edges_alone_lower_the_error() {
    let (z, ratio) = compare(&Config::new(2, 0, 1), Shadow::Disc, 4, &mut SplitMix64::new(302));
    assert!(z < -Z_LIMIT && ratio < 0.5, "{ratio} {z}");
}

/// Without polynomials, groups that no edge cuts keep their means, whatever the workspace held.
#[test]
fn edges_alone_leave_lit_pixels_alone() {
    let n = 4;
    for estimator in [Estimator::Robust, Estimator::KFold] {
        let config = Config { estimator, edges: 1, ..Config::new(2, 0, 1) };
        let of = Image { stride: SIDE, ..Image::new(2 * SIDE, SIDE) };
        let u = points(2 * PIXELS * n, 2, &mut SplitMix64::new(11));
        let is_lit = |pixel: usize| pixel % (2 * SIDE) >= SIDE;
        let at = |(i, u): (usize, &[f32])| if is_lit(i / n) || u[0] < 0.5 { 1.0 + u[1] } else { 0.0 };
        let f: Vec<f32> = u.chunks(2).enumerate().map(at).collect();
        for held in [f32::NAN, 7.0] {
            let mut workspace = vec![held; image_workspace_len(&config, &of, n).unwrap()];
            let mut out = |pixel: usize, estimate: Estimate| {
                let mean = f[pixel * n..][..n].iter().map(|f| f64::from(*f)).sum::<f64>() / n as f64;
                let is_mean = (f64::from(estimate.mean[0]) - mean).abs() < 1e-6 && estimate.gain == 1.0;
                assert!(is_mean || !is_lit(pixel), "{pixel}: {estimate:?}, {mean}");
            };
            estimate_image(&config, &of, Samples::new(&u, &f), &mut workspace, &mut out).unwrap();
        }
    }
}
