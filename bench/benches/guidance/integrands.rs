//! Integrands with exact mean and variance, whose first coordinate can be shifted.

use noisefloor_tests::random::SplitMix64;
use std::f64::consts::{PI, SQRT_2, TAU};

/// The kinds of integrands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    /// 1 on one side of a hyperplane, a function of all coordinates.
    HalfSpace,
    /// A Gaussian of all coordinates; it covers as much of the cube in any dimension.
    Bump,
    /// A product of a factor 1 + a cos(pi u + b) for each coordinate.
    Product,
    /// A sum of such functions of two coordinates each (of one, if there are only two), each of less weight: a path's
    /// vertices.
    Parts,
}

impl Family {
    pub(crate) const ALL: [Self; 4] = [Self::HalfSpace, Self::Bump, Self::Product, Self::Parts];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::HalfSpace => "half-space",
            Self::Bump => "bump",
            Self::Product => "product",
            Self::Parts => "parts",
        }
    }
}

enum Kind {
    HalfSpace { normal: Vec<f64>, offset: f64, series: Series },
    Bump { centre: Vec<f64>, width: f64 },
    Product { amplitudes: Vec<f64>, phases: Vec<f64> },
}

/// A function of neighbouring coordinates.
struct Part {
    weight: f64,
    first: usize,
    kind: Kind,
}

/// A sum of functions of disjoint coordinates.
pub(crate) struct Integrand {
    parts: Vec<Part>,
}

/// Mean and variance over the cube.
#[derive(Clone, Copy, Default)]
pub(crate) struct Moments {
    pub(crate) mean: f64,
    pub(crate) variance: f64,
}

impl Integrand {
    pub(crate) fn new(family: Family, dims: usize, rng: &mut SplitMix64) -> Self {
        if family != Family::Parts {
            return Self { parts: vec![Part::new(family, 0, dims, 1.0, rng)] };
        }
        let width = if dims > 2 { 2 } else { 1 };
        let firsts = (0..dims).step_by(width).enumerate();
        let parts = firsts.map(|(number, first)| {
            let family = Family::ALL[rng.below(3)];
            let weight = 0.7_f64.powi(number as i32) * (0.5 + rng.uniform());
            Part::new(family, first, width.min(dims - first), weight, rng)
        });
        Self { parts: parts.collect() }
    }

    pub(crate) fn value(&self, u: &[f32], shift: f64) -> f64 {
        self.parts.iter().map(|part| part.weight * part.value(&u[part.first..], shift)).sum()
    }

    pub(crate) fn moments(&self, shift: f64) -> Moments {
        let mut sum = Moments::default();
        for part in &self.parts {
            let of = part.moments(shift);
            sum.mean += part.weight * of.mean;
            sum.variance += part.weight * part.weight * of.variance;
        }
        sum
    }
}

impl Part {
    fn new(family: Family, first: usize, dims: usize, weight: f64, rng: &mut SplitMix64) -> Self {
        let kind = match family {
            Family::HalfSpace => loop {
                let normal: Vec<f64> = (0..dims).map(|_| rng.normal()).collect();
                let length = normal.iter().map(|a| a * a).sum::<f64>().sqrt();
                let normal: Vec<f64> = normal.iter().map(|a| a / length).collect();
                if dims <= 4 && normal.iter().any(|a| a.abs() < 0.05) {
                    continue;
                }
                let offset = normal.iter().map(|a| a * rng.uniform()).sum();
                let series = Series::new(&normal);
                break Kind::HalfSpace { normal, offset, series };
            },
            Family::Bump => {
                let centre = (0..dims).map(|_| rng.uniform()).collect();
                let width = 0.05 + 0.25 * rng.uniform();
                let width = if dims > 2 { (2.5 * width).powf(2.0 / dims as f64) / 2.5 } else { width };
                Kind::Bump { centre, width }
            }
            Family::Product | Family::Parts => {
                let largest = (2.0 / dims as f64).sqrt().min(1.0);
                let amplitudes = (0..dims).map(|_| largest * (0.3 + 0.6 * rng.uniform())).collect();
                Kind::Product { amplitudes, phases: (0..dims).map(|_| TAU * rng.uniform()).collect() }
            }
        };
        Self { weight, first, kind }
    }

    fn value(&self, u: &[f32], shift: f64) -> f64 {
        // The first coordinate is shifted, the others are not.
        let shifts = std::iter::once(shift).chain(std::iter::repeat(0.0));
        match &self.kind {
            Kind::HalfSpace { normal, offset, .. } => {
                let side: f64 = normal.iter().zip(u).map(|(a, &u)| a * f64::from(u)).sum();
                f64::from(u8::from(side < offset + shift))
            }
            Kind::Bump { centre, width } => {
                let square: f64 =
                    centre.iter().zip(u).zip(shifts).map(|((c, &u), s)| (f64::from(u) - c - s).powi(2)).sum();
                (-square / (2.0 * width * width)).exp()
            }
            Kind::Product { amplitudes, phases } => {
                let factors = amplitudes.iter().zip(phases).zip(u).zip(shifts);
                factors.map(|(((a, phase), &u), s)| 1.0 + a * (PI * (f64::from(u) + s) + phase).cos()).product()
            }
        }
    }

    fn moments(&self, shift: f64) -> Moments {
        let shifts = std::iter::once(shift).chain(std::iter::repeat(0.0));
        let (mean, square) = match &self.kind {
            Kind::HalfSpace { normal, offset, series } => {
                let mean = series.below(offset + shift - 0.5 * normal.iter().sum::<f64>());
                (mean, mean)
            }
            Kind::Bump { centre, width } => {
                let integral = |width: f64| -> f64 {
                    let below = |x: f64| libm::erf(x / (width * SQRT_2));
                    let one = |c: f64| width * (PI / 2.0).sqrt() * (below(1.0 - c) + below(c));
                    centre.iter().zip(shifts.clone()).map(|(c, s)| one(c + s)).product()
                };
                (integral(*width), integral(width / SQRT_2))
            }
            Kind::Product { amplitudes, phases } => {
                let factors = amplitudes.iter().zip(phases).zip(shifts).map(|((a, phase), s)| {
                    let mean = -2.0 * a * (phase + PI * s).sin() / PI;
                    [1.0 + mean, 1.0 + 2.0 * mean + 0.5 * a * a]
                });
                factors.fold((1.0, 1.0), |(mean, square), [m, s]| (mean * m, square * s))
            }
        };
        Moments { mean, variance: (square - mean * mean).max(0.0) }
    }
}

/// The distribution of sum a_i (u_i - 1/2) for independent uniform u_i, as a Fourier series of a period that has room
/// for all of it.
struct Series {
    /// Half of the sum's range.
    reach: f64,
    /// One coordinate or two: exact, and the series would converge slowly.
    normal: Vec<f64>,
    terms: Vec<f64>,
}

impl Series {
    const TERMS: usize = 1024;

    fn new(normal: &[f64]) -> Self {
        let reach = 0.5 * normal.iter().map(|a| a.abs()).sum::<f64>();
        let sinc = |x: f64| if x.abs() < 1e-9 { 1.0 } else { x.sin() / x };
        let term = |k: usize| {
            let frequency = PI * k as f64 / reach;
            let transform: f64 = normal.iter().map(|a| sinc(0.5 * a * frequency)).product();
            transform / (PI * k as f64)
        };
        let count = if normal.len() > 2 { Self::TERMS } else { 0 };
        Self { reach, normal: normal.to_vec(), terms: (1..=count).map(term).collect() }
    }

    /// The probability that the sum is below x.
    fn below(&self, x: f64) -> f64 {
        if x.abs() >= self.reach {
            return f64::from(u8::from(x > 0.0));
        }
        match self.normal[..] {
            [_] => 0.5 + x / (2.0 * self.reach),
            [a, b] => {
                let (a, b) = (a.abs(), b.abs());
                let triangle = |c: f64| c.max(0.0).powi(2) / (2.0 * a * b);
                let c = x + self.reach;
                triangle(c) - triangle(c - a) - triangle(c - b) + triangle(c - a - b)
            }
            _ => {
                let angle = PI * x / self.reach;
                let sum: f64 = self.terms.iter().zip(1..).map(|(term, k)| term * (angle * f64::from(k)).sin()).sum();
                (0.5 + x / (2.0 * self.reach) + sum).clamp(0.0, 1.0)
            }
        }
    }
}

/// How an integrand changes over the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Variant {
    /// Its first coordinate moves with x, by 1/64 a pixel, its scale with y, by 1/32; both up and down.
    Moving,
    /// Slanted stripes, 24 pixels wide, of two integrands in turn.
    Edges,
}

impl Variant {
    pub(crate) const ALL: [Self; 2] = [Self::Moving, Self::Edges];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Moving => "moving",
            Self::Edges => "edges",
        }
    }
}

/// An integrand for each pixel.
pub(crate) struct Scene {
    variant: Variant,
    integrands: [Integrand; 2],
    phases: [f64; 2],
}

/// What a pixel integrates.
#[derive(Clone, Copy)]
pub(crate) struct Pixel {
    which: usize,
    shift: f64,
    scale: f64,
}

impl Scene {
    pub(crate) fn new(family: Family, variant: Variant, dims: usize, rng: &mut SplitMix64) -> Self {
        let integrands = [0, 1].map(|_| Integrand::new(family, dims, rng));
        Self { variant, integrands, phases: [64.0 * rng.uniform(), 64.0 * rng.uniform()] }
    }

    pub(crate) fn pixel(&self, x: usize, y: usize) -> Pixel {
        let (x, y) = (x as f64, y as f64);
        let [first, second] = self.phases;
        match self.variant {
            Variant::Moving => {
                let wave = |place: f64| (place / 32.0 % 2.0 - 1.0).abs() - 0.5;
                Pixel { which: 0, shift: 0.5 * wave(x + first), scale: 1.0 + wave(y + second) }
            }
            Variant::Edges => {
                let stripe = (x + 0.35 * y + first) / 24.0;
                Pixel { which: stripe as usize % 2, shift: 0.0, scale: 1.0 }
            }
        }
    }

    pub(crate) fn value(&self, pixel: Pixel, u: &[f32]) -> f32 {
        (pixel.scale * self.integrands[pixel.which].value(u, pixel.shift)) as f32
    }

    /// The moments of all pixels of a square image.
    pub(crate) fn moments(&self, side: usize) -> Vec<Moments> {
        let still = [0, 1].map(|which| self.integrands[which].moments(0.0));
        // A shift is that of its column.
        let columns: Vec<_> = (0..side).map(|x| self.integrands[0].moments(self.pixel(x, 0).shift)).collect();
        let pixel = |index: usize| {
            let pixel = self.pixel(index % side, index / side);
            let of = if self.variant == Variant::Moving { columns[index % side] } else { still[pixel.which] };
            Moments { mean: pixel.scale * of.mean, variance: pixel.scale * pixel.scale * of.variance }
        };
        (0..side * side).map(pixel).collect()
    }
}
