//! Beyond a tile's samples: the error of a pixel's estimate, as root mean square over 256 pixels and the integrands,
//! relative to the integrand's standard deviation; of the tile's samples, and beside them of random ones and of
//! Owen-scrambled Sobol points. Seeds are fixed.

use crate::random::SplitMix64;
use crate::tile::{noise, ordered};
use noisefloor::tile::{Builtin, Sampler, Shape, Tile};

/// Each with samples of its own.
const PIXELS: u32 = 256;
/// Numbers of samples at which errors are measured, over the tile's.
pub const TIMES: [u32; 6] = [1, 2, 4, 16, 64, 256];

/// An integrand over the square, its integral and that of its square.
struct Integrand {
    value: Box<dyn Fn([f32; 2]) -> f64>,
    integral: f64,
    square: f64,
}

/// Smooth: exp(a x + b y).
fn exponential(rng: &mut SplitMix64) -> Integrand {
    let (a, b) = (3.0 * rng.normal(), 3.0 * rng.normal());
    let integral = |a: f64, b: f64| (a.exp_m1() / a) * (b.exp_m1() / b);
    let value = move |[x, y]: [f32; 2]| (a * f64::from(x) + b * f64::from(y)).exp();
    Integrand { value: Box::new(value), integral: integral(a, b), square: integral(2.0 * a, 2.0 * b) }
}

/// Discontinuous: 1 on one side of a line through a random point.
fn half_plane(rng: &mut SplitMix64) -> Integrand {
    let (a, b) = (rng.uniform() + 0.01, rng.uniform() + 0.01);
    let c = a * rng.uniform() + b * rng.uniform();
    let triangle = |c: f64| c.max(0.0).powi(2) / (2.0 * a * b);
    let area = triangle(c) - triangle(c - a) - triangle(c - b) + triangle(c - a - b);
    let (flip_x, flip_y) = (rng.below(2) == 1, rng.below(2) == 1);
    let value = move |[x, y]: [f32; 2]| {
        let side = |u: f32, flip: bool| if flip { 1.0 - f64::from(u) } else { f64::from(u) };
        f64::from(u8::from(a * side(x, flip_x) + b * side(y, flip_y) < c))
    };
    Integrand { value: Box::new(value), integral: area, square: area }
}

/// The relative error after each of `counts` samples of `point(pixel, index)`.
fn errors(integrands: &[Integrand], counts: &[u32], mut point: impl FnMut(u32, u32) -> [f32; 2]) -> Vec<f64> {
    let mut squares = vec![0.0; counts.len()];
    for pixel in 0..PIXELS {
        let mut sums = vec![0.0; integrands.len()];
        for index in 0..counts[counts.len() - 1] {
            let u = point(pixel, index);
            sums.iter_mut().zip(integrands).for_each(|(sum, f)| *sum += (f.value)(u));
            if let Some(place) = counts.iter().position(|&count| count == index + 1) {
                for (sum, f) in sums.iter().zip(integrands) {
                    let error = sum / f64::from(index + 1) - f.integral;
                    squares[place] += error * error / (f.square - f.integral * f.integral);
                }
            }
        }
    }
    squares.iter().map(|square| (square / f64::from(PIXELS) / integrands.len() as f64).sqrt()).collect()
}

/// Integrands of a kind.
pub struct Kind {
    /// What they are.
    pub name: &'static str,
    integrands: Vec<Integrand>,
}

/// `count` smooth and `count` discontinuous integrands.
pub fn kinds(count: usize, rng: &mut SplitMix64) -> [Kind; 2] {
    [
        Kind { name: "smooth", integrands: (0..count).map(|_| exponential(rng)).collect() },
        Kind { name: "half-planes", integrands: (0..count).map(|_| half_plane(rng)).collect() },
    ]
}

/// The bytes of tiles by name: independent and jittered samples, which are the hardest for the sequence to join, and
/// some that are built in.
pub fn tiles() -> Vec<(String, Vec<u8>)> {
    let mut tiles = vec![("noise".to_owned(), single())];
    tiles.extend([4, 16].map(|spp| ("jittered".to_owned(), ordered(64, spp, false, 43))));
    for builtin in [Builtin::Size128Spp4Dims2, Builtin::Size128Spp16Dims2, Builtin::Size128Spp16Dims2Progressive] {
        tiles.extend(builtin.bytes().map(|bytes| (builtin.name().to_owned(), bytes.to_vec())));
    }
    tiles
}

fn single() -> Vec<u8> {
    noise(Shape { size: 64, spp: 1, dims: 2, frames: 1, bits: 16, progressive: false }, 42)
}

/// Errors at each number of samples that was asked for.
pub struct Errors {
    /// Of independent samples.
    pub random: Vec<f64>,
    /// Of Owen-scrambled Sobol points.
    pub owen: Vec<f64>,
    /// Of the tile itself, continued.
    pub tile: Vec<f64>,
    /// Of domains of it, continued: one for each row of pixels.
    pub domain: Vec<f64>,
}

/// After `counts` samples.
pub fn measure(tile: &Tile<'_>, Kind { integrands, .. }: &Kind, counts: &[u32], rng: &mut SplitMix64) -> Errors {
    let single = single();
    let sobol = Tile::from_bytes(&single).unwrap();
    Errors {
        // A domain of each pixel's own scrambles the sequence for each on its own.
        owen: errors(integrands, counts, |pixel, index| {
            Sampler::pixel(&sobol, pixel, pixel / 64, 0, index).domain(pixel).draw()
        }),
        random: errors(integrands, counts, |_, _| [rng.uniform_f32(), rng.uniform_f32()]),
        tile: errors(integrands, counts, |pixel, index| Sampler::pixel(tile, pixel % 16, pixel / 16, 0, index).draw()),
        domain: errors(integrands, counts, |pixel, index| {
            Sampler::pixel(tile, pixel % 16, pixel / 16, 0, index).domain(pixel / 16).draw()
        }),
    }
}

/// The numbers of samples of [`TIMES`] for a tile of `spp`, as far as they are not too many to draw.
pub fn counts(spp: u32) -> Vec<u32> {
    TIMES.iter().map(|times| spp * times).filter(|&n| n <= 4096).collect()
}
