//! Shared fits that are told what each sample would be with nothing in the way, and its integral.

use crate::cv_support::{jittered, points};
use noisefloor::Error;
use noisefloor::control_variate::{Config, Estimator, Image, Ridge, Samples, image_workspace_len};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::shared::image;
use noisefloor_tests::statistics::{Moments, maximum};

const WIDTH: usize = 8;
const PIXELS: usize = WIDTH * WIDTH;

/// A light that an edge hides in part, seen by pixels that it reaches by different amounts.
struct Frame {
    n: usize,
    u: Vec<f32>,
    f: Vec<f32>,
    known: Vec<f32>,
    integrals: Vec<f32>,
    surfaces: Vec<u32>,
    factors: Vec<f32>,
}

/// What arrives from a point of the light, panes of 8 x 6, if nothing is in the way: its integral over u is 1.
fn light(u: [f64; 2]) -> f64 {
    let pane = (8.0 * u[0]).floor() + (6.0 * u[1]).floor();
    if pane % 2.0 == 0.0 { 1.75 } else { 0.25 }
}

/// The part of the light that pixels see: u[0] + slope u[1] < edge.
fn edge(pixel: usize) -> [f64; 2] {
    [0.1 + 0.1 * (pixel % WIDTH) as f64, 0.3]
}

fn albedo(pixel: usize) -> f64 {
    0.2 + 0.1 * (pixel / WIDTH) as f64
}

/// The integral of what arrives at a pixel.
fn truth(pixel: usize) -> f64 {
    let [edge, slope] = edge(pixel);
    let steps = 6 * 1024;
    let row = |i: usize| {
        let v = (i as f64 + 0.5) / steps as f64;
        let end = (edge - slope * v).clamp(0.0, 1.0);
        let pane = |k: usize| {
            let left = k as f64 / 8.0;
            light([left + 0.0625, v]) * (end.min(left + 0.125) - left).max(0.0)
        };
        (0..8).map(pane).sum::<f64>()
    };
    albedo(pixel) * (0..steps).map(row).sum::<f64>() / steps as f64
}

impl Frame {
    fn new(n: usize, rng: &mut SplitMix64) -> Self {
        Self::of(PIXELS, n, rng)
    }

    fn of(pixels: usize, n: usize, rng: &mut SplitMix64) -> Self {
        let u = points(pixels * n, 2, rng);
        let (mut f, mut known) = (vec![], vec![]);
        for (sample, u) in u.chunks(2).enumerate() {
            let pixel = sample / n;
            let [x, y] = [f64::from(u[0]), f64::from(u[1])];
            let unshadowed = albedo(pixel) * light([x, y]);
            let [edge, slope] = edge(pixel);
            known.push(unshadowed as f32);
            f.push(if x + slope * y < edge { unshadowed as f32 } else { 0.0 });
        }
        let integrals = (0..pixels).map(|pixel| albedo(pixel) as f32).collect();
        Self { n, u, f, known, integrals, surfaces: vec![], factors: vec![] }
    }

    fn image(&self) -> Image<'_> {
        Image {
            stride: WIDTH,
            surfaces: &self.surfaces,
            factors: &self.factors,
            known: &self.known,
            known_integrals: &self.integrals,
            ..Image::new(WIDTH, WIDTH)
        }
    }

    fn samples(&self) -> Samples<'_> {
        Samples::new(&self.u, &self.f)
    }

    fn means(&self, config: &Config, of: &Image<'_>) -> Vec<f64> {
        image(config, of, self.samples()).unwrap().iter().map(|estimate| f64::from(estimate.mean[0])).collect()
    }

    /// A pixel's mean of some values.
    fn mean(&self, values: &[f32], pixel: usize) -> f64 {
        values[pixel * self.n..(pixel + 1) * self.n].iter().map(|&value| f64::from(value)).sum::<f64>() / self.n as f64
    }

    /// The coefficient of a pixel by the others that share its fit, as the documentation defines it.
    fn coefficient(&self, pixel: usize) -> f64 {
        let surface = |pixel: usize| self.surfaces.get(pixel);
        let factor = |pixel: usize| self.factors.get(pixel).map_or(1.0, |&factor| f64::from(factor));
        let integral = |pixel: usize| f64::from(self.integrals[pixel]) / factor(pixel);
        let group = || (0..self.integrals.len()).filter(|&other| surface(other) == surface(pixel));
        let largest = group().map(integral).fold(0.0, f64::max);
        let others: Vec<[f64; 3]> = group()
            .filter(|&other| other != pixel && integral(other) > 0.0)
            .map(|other| {
                let unit = factor(other) * integral(other).max(0.01 * largest);
                [self.mean(&self.f, other), self.mean(&self.known, other), f64::from(self.integrals[other])]
                    .map(|value| value / unit)
            })
            .filter(|values| values.iter().all(|value| value.abs() < f64::from(1 << 20)))
            .collect();
        let sum = |f: &dyn Fn(&[f64; 3]) -> f64| others.iter().map(f).sum::<f64>();
        let share = sum(&|[mean, ..]| *mean) / sum(&|[_, known, _]| *known);
        let slope = sum(&|[mean, known, integral]| (mean - share * integral) * (known - integral))
            / sum(&|[_, known, integral]| (known - integral).powi(2));
        let arrives = self.integrals[pixel] > 0.0 && sum(&|[_, known, _]| *known) > 1e-6;
        if arrives { slope.min(share).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// The samples less what is known of them.
    fn rest(&self) -> Vec<f32> {
        let coefficients: Vec<f64> = (0..self.integrals.len()).map(|pixel| self.coefficient(pixel)).collect();
        let rest = |(i, &f): (usize, &f32)| {
            let apart = f64::from(self.known[i]) - f64::from(self.integrals[i / self.n]);
            (f64::from(f) - coefficients[i / self.n] * apart) as f32
        };
        self.f.iter().enumerate().map(rest).collect()
    }
}

fn alone(order: usize) -> Config {
    Config { estimator: Estimator::LeaveOneOut, ..Config::new(2, order, 1) }
}

/// What is known alone: each pixel by the coefficient of all others; and a fit to what that leaves.
#[test]
fn the_definition() {
    let mut rng = SplitMix64::new(1);
    for n in [1, 2, 5] {
        let mut frame = Frame::new(n, &mut rng);
        // Pixels that no light can reach say nothing, and stay as they are.
        for pixel in [3, 40] {
            frame.integrals[pixel] = 0.0;
            frame.known[pixel * n..(pixel + 1) * n].fill(0.0);
        }
        let rest = frame.rest();
        for (pixel, mean) in frame.means(&alone(3), &frame.image()).iter().enumerate() {
            let expected = frame.mean(&rest, pixel);
            assert!((mean - expected).abs() < 3e-6, "{n} {pixel}: {mean} for {expected}");
        }
        // What tells pixels apart is weighed by the one that it says least of, f or the rest: here both are channels.
        let config = Config { ridge: Ridge::Fixed(0.05), ..Config::new(2, 3, 1) };
        let blind = Image { known: &[], known_integrals: &[], ..frame.image() };
        let both: Vec<f32> = rest.iter().zip(&frame.f).flat_map(|(&rest, &f)| [rest, f]).collect();
        let both = Samples::new(&frame.u, &both);
        let expected = image(&Config { channels: 2, ..config }, &blind, both).unwrap();
        for (mean, expected) in frame.means(&config, &frame.image()).iter().zip(expected) {
            assert!((mean - f64::from(expected.mean[0])).abs() < 1e-5, "{n}: {mean} for {}", expected.mean[0]);
        }
    }
}

/// The coefficient's bounds: more arrives than is known, integrals of very different size, other signs; of groups of
/// all kinds.
#[test]
fn the_definition_in_hard_cases() {
    let mut rng = SplitMix64::new(6);
    for case in 0..48 {
        let (kind, n) = (case % 4, [1, 3][case / 4 % 2]);
        let is_ordered = kind < 2;
        let pixels = [PIXELS, PIXELS, PIXELS, 100][kind];
        let mut frame = Frame::of(pixels, n, &mut rng);
        match case / 8 {
            // The share of the light that arrives is above 1.
            0 => frame.f.iter_mut().for_each(|f| *f *= 5.0),
            // Integrals from 1 to 1/1000, below the floor too.
            1 => {
                for pixel in 0..pixels {
                    let scale = 0.1_f32.powi(rng.below(4) as i32);
                    frame.integrals[pixel] *= scale;
                    let samples = pixel * n..(pixel + 1) * n;
                    frame.f[samples.clone()].iter_mut().for_each(|f| *f *= scale);
                    frame.known[samples].iter_mut().for_each(|known| *known *= scale);
                }
            }
            // A value that says nothing about others.
            2 => frame.known[3 * n] = 1e8,
            // Both signs, all of one and none.
            3 => frame.known.iter_mut().for_each(|known| *known -= 0.75),
            4 => frame.f.iter_mut().for_each(|f| *f = -*f),
            _ => frame.known.fill(0.0),
        }
        if kind == 1 {
            frame.surfaces = (0..pixels).map(|pixel| (pixel % 3) as u32).collect();
            frame.factors = (0..pixels).map(|_| 0.25 + rng.uniform_f32()).collect();
        }
        let of = if is_ordered {
            frame.image()
        } else {
            Image { unordered: true, width: pixels, height: 1, stride: 0, ..frame.image() }
        };
        let rest = frame.rest();
        for (pixel, mean) in frame.means(&alone(1), &of).iter().enumerate() {
            let expected = frame.mean(&rest, pixel);
            let size = frame.mean(&frame.known, pixel).abs().max(expected.abs()).max(1.0);
            assert!((mean - expected).abs() < 1e-5 * size, "case {case}, pixel {pixel}: {mean} for {expected}");
        }
    }
}

/// Where a constant share of the light arrives, every pixel is exact.
#[test]
fn a_constant_share_is_exact() {
    let mut rng = SplitMix64::new(2);
    for n in [1, 4] {
        let mut frame = Frame::new(n, &mut rng);
        frame.f = frame.known.iter().map(|&known| 0.375 * known).collect();
        for (pixel, mean) in frame.means(&alone(1), &frame.image()).iter().enumerate() {
            let expected = 0.375 * albedo(pixel);
            assert!((mean - expected).abs() < 1e-6 * expected, "{n} {pixel}: {mean} for {expected}");
        }
    }
}

/// Samples that are all alike, but for what is known of them, are corrected as those are of which one differs a little:
/// whether a pixel is corrected must not depend on its own value.
#[test]
fn equal_values_are_corrected_as_others() {
    let mut rng = SplitMix64::new(9);
    for n in [1, 4] {
        let mut frame = Frame::new(n, &mut rng);
        frame.f.fill(1.0);
        let plain = |frame: &Frame| frame.means(&alone(1), &Image { factors: &[], ..frame.image() });
        let equal = plain(&frame);
        let moved = equal.iter().map(|mean| (mean - 1.0).abs()).fold(0.0, f64::max);
        assert!(moved > 1e-3, "{n}: {moved}");
        *frame.f.last_mut().unwrap() += 1e-5;
        for (pixel, (equal, other)) in equal.iter().zip(plain(&frame)).enumerate() {
            assert!((equal - other).abs() < 1e-4, "{n} {pixel}: {equal} {other}");
        }
    }
}

/// The mean over many frames is the integral, of all pixels together and of some. |z| < 4.75 by chance with probability
/// 2e-6, of 14 deviates; with integrals that are 5 % too large it is not.
#[test]
fn unbiased_alone() {
    let [mut largest, mut wrong] = [0.0_f64; 2];
    for n in [1, 4] {
        let mut rng = SplitMix64::new(3);
        let truth: Vec<f64> = (0..PIXELS).map(truth).collect();
        let mut errors: [Moments; 7] = Default::default();
        let mut biased = Moments::default();
        for _ in 0..6000 / n {
            let frame = Frame::new(n, &mut rng);
            let means = frame.means(&alone(1), &frame.image());
            let all = means.iter().zip(&truth).map(|(mean, truth)| mean - truth).sum::<f64>() / PIXELS as f64;
            let some = [0, 7, 20, 43, 56, 63].map(|pixel| means[pixel] - truth[pixel]);
            errors[0].add(all);
            errors[1..].iter_mut().zip(some).for_each(|(moments, error)| moments.add(error));
            let integrals: Vec<f32> = frame.integrals.iter().map(|integral| 1.05 * integral).collect();
            let means = frame.means(&alone(1), &Image { known_integrals: &integrals, ..frame.image() });
            biased.add(means.iter().zip(&truth).map(|(mean, truth)| mean - truth).sum::<f64>() / PIXELS as f64);
        }
        largest = maximum(errors.iter().map(|moments| moments.z(0.0).abs()).chain([largest]));
        wrong = wrong.max(biased.z(0.0).abs());
    }
    println!("z {largest:.1}, with wrong integrals {wrong:.1}");
    assert!(largest < 4.75 && wrong > 4.75, "{largest} {wrong}");
}

/// Squared errors over the plain mean's: what is known helps beside polynomials, and what says nothing hardly hurts.
#[test]
fn squared_errors() {
    for (n, most, most_useless) in [(1, 0.85, 1.02), (4, 0.85, 1.02), (16, 0.85, 1.02)] {
        let mut rng = SplitMix64::new(4);
        let truth: Vec<f64> = (0..PIXELS).map(truth).collect();
        let config = Config::new(2, 3, 1);
        let [mut plain, mut blind, mut known, mut useless] = [0.0; 4];
        for _ in 0..200 {
            let frame = Frame::new(n, &mut rng);
            let error = |means: &[f64]| means.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            plain += error(&(0..PIXELS).map(|pixel| frame.mean(&frame.f, pixel)).collect::<Vec<_>>());
            blind += error(&frame.means(&config, &Image { known: &[], known_integrals: &[], ..frame.image() }));
            known += error(&frame.means(&config, &frame.image()));
            let noise: Vec<f32> = frame.known.iter().map(|_| 2.0 * rng.uniform_f32()).collect();
            let ones = vec![1.0; PIXELS];
            useless += error(&frame.means(&config, &Image { known: &noise, known_integrals: &ones, ..frame.image() }));
        }
        let [blind_ratio, ratio, useless_ratio] = [blind / plain, known / blind, useless / blind];
        println!("{n} spp: fits {blind_ratio:.3}, known {ratio:.3} of that, noise {useless_ratio:.3} of that");
        assert!(ratio < most && useless_ratio < most_useless, "{n}: {ratio} {useless_ratio}");
    }
}

/// Where all light arrives, stratified samples follow it, however uneven it is across a window: the spread of their
/// means is then nearly all the picture's own.
#[test]
fn stratified_samples_follow_uneven_light() {
    let (n, mut rng) = (16, SplitMix64::new(6));
    let level = |pixel: usize| {
        let [x, y] = [pixel % WIDTH, pixel / WIDTH].map(|place| place as f64 / WIDTH as f64 - 0.4);
        1.0 / (0.05 + x * x + y * y)
    };
    let u = jittered(PIXELS, n, &mut rng);
    let unshadowed = |(sample, u): (usize, &[f32])| level(sample / n) * (0.5 + 2.0 * f64::from(u[0] * u[1]));
    let known: Vec<f32> = u.chunks(2).enumerate().map(|sample| unshadowed(sample) as f32).collect();
    let frame = Frame {
        n,
        u,
        f: known.clone(),
        known,
        integrals: (0..PIXELS).map(|pixel| level(pixel) as f32).collect(),
        surfaces: vec![],
        factors: vec![],
    };
    let means = frame.means(&Config { stratified: true, ..Config::new(2, 1, 1) }, &frame.image());
    let error = |of: &dyn Fn(usize) -> f64| (0..PIXELS).map(|pixel| (of(pixel) - level(pixel)).powi(2)).sum::<f64>();
    let [known, plain] = [error(&|pixel| means[pixel]), error(&|pixel| frame.mean(&frame.f, pixel))];
    println!("{known} of {plain}");
    assert!(known < 0.01 * plain, "{known} of {plain}");
}

/// Powers of two change exponents alone, and colours follow the same rule each by itself.
#[test]
fn scales_and_channels() {
    let mut rng = SplitMix64::new(5);
    for config in [alone(2), Config::new(2, 2, 1)] {
        let frame = Frame::new(2, &mut rng);
        let means = frame.means(&config, &frame.image());
        let scaled = |values: &[f32]| values.iter().map(|value| value * 1024.0).collect::<Vec<f32>>();
        let other = Frame {
            n: 2,
            u: frame.u.clone(),
            f: scaled(&frame.f),
            known: scaled(&frame.known),
            integrals: scaled(&frame.integrals),
            surfaces: vec![],
            factors: vec![],
        };
        let others = other.means(&config, &other.image());
        assert!(means.iter().zip(&others).all(|(mean, other)| mean * 1024.0 == *other));
        let [f, known] = [&frame.f, &frame.known].map(|all| all.iter().flat_map(|&x| [x, 2.0 * x]).collect::<Vec<_>>());
        let integrals: Vec<f32> = frame.integrals.iter().flat_map(|&x| [x, 2.0 * x]).collect();
        let of = Image { known: &known, known_integrals: &integrals, ..frame.image() };
        let colours = image(&Config { channels: 2, ..config }, &of, Samples::new(&frame.u, &f)).unwrap();
        for (mean, colour) in means.iter().zip(colours) {
            let [first, second, ..] = colour.mean.map(f64::from);
            assert!((mean - first).abs() < 1e-6 && first * 2.0 == second, "{mean} {first} {second}");
        }
    }
}

#[test]
fn bad_input() {
    let mut rng = SplitMix64::new(6);
    let frame = Frame::new(2, &mut rng);
    let config = Config::new(2, 2, 1);
    let check = |known: &[f32], integrals: &[f32], expected: Error| {
        let of = Image { known, known_integrals: integrals, ..frame.image() };
        assert_eq!(image(&config, &of, frame.samples()).unwrap_err(), expected, "{} {}", known.len(), integrals.len());
    };
    check(&frame.known, &[], Error::Range);
    check(&[], &frame.integrals, Error::Range);
    check(&frame.known[1..], &frame.integrals, Error::Length);
    check(&frame.known, &frame.integrals[1..], Error::Length);
    let with = |values: &[f32], value: f32| [&values[1..], &[value]].concat();
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        check(&with(&frame.known, value), &frame.integrals, Error::NotFinite);
        check(&frame.known, &with(&frame.integrals, value), Error::NotFinite);
    }
    check(&frame.known, &with(&frame.integrals, -1.0), Error::Range);
    let halves = Config { estimator: Estimator::KFold, ..config };
    assert_eq!(image(&halves, &frame.image(), frame.samples()).unwrap_err(), Error::Unsupported);
    assert_eq!(image_workspace_len(&halves, &frame.image(), 2).unwrap_err(), Error::Unsupported);
}

/// Values at the ends of their type, and integrals far from what is known.
#[test]
fn extreme_values() {
    let values = [0.0, -0.0, 1.0, f32::MIN_POSITIVE, 1e-45, 1e30, f32::MAX, -f32::MAX];
    let mut rng = SplitMix64::new(7);
    for n in [1, 3] {
        for config in [alone(2), Config::new(2, 2, 1), Config { stratified: true, ..Config::new(2, 0, 1) }] {
            for _ in 0..300 {
                let mut frame = Frame::new(n, &mut rng);
                let mut any = |values: &[f32]| values[rng.below(values.len())];
                frame.f.iter_mut().for_each(|out| *out = any(&values));
                frame.known.iter_mut().for_each(|out| *out = any(&values));
                frame.integrals.iter_mut().for_each(|out| *out = any(&values[..7]));
                for estimate in image(&config, &frame.image(), frame.samples()).unwrap() {
                    assert!(estimate.mean[0].is_finite() && estimate.std_error[0] >= 0.0, "{estimate:?}");
                }
            }
        }
    }
}
