//! Beyond the tile's samples: the error of a pixel's estimate, against random samples and Owen-scrambled Sobol points.
//!
//! `cargo test -p noisefloor-tests --test tile_continued -- --nocapture` prints the table of docs/tiles.md. Errors are root mean
//! squares over 256 pixels and 48 integrands, relative to the integrand's standard deviation; seeds are fixed.

use noisefloor::tile::{Builtin, Sampler, Shape, Tile};
use noisefloor_tests::random::SplitMix64;
use noisefloor_tests::tile::{noise, ordered};

const PIXELS: u32 = 256;
/// Samples over the tile's.
const TIMES: [u32; 6] = [1, 2, 4, 16, 64, 256];

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

#[test]
fn continued_samples_converge_as_sobol_points_do() {
    let mut rng = SplitMix64::new(41);
    let kinds: [(&str, Vec<Integrand>); 2] = [
        ("smooth", (0..48).map(|_| exponential(&mut rng)).collect()),
        ("half-planes", (0..48).map(|_| half_plane(&mut rng)).collect()),
    ];
    let single = noise(Shape { size: 64, spp: 1, dims: 2, frames: 1, bits: 16, progressive: false }, 42);
    let sobol = Tile::from_bytes(&single).unwrap();
    let mut tiles = vec![("1 spp, noise".to_owned(), single.clone())];
    tiles.extend([4, 16].map(|spp| (format!("{spp} spp, jittered"), ordered(64, spp, false, 43))));
    for builtin in [Builtin::Size128Spp4Dims2, Builtin::Size128Spp16Dims2, Builtin::Size128Spp16Dims2Progressive] {
        tiles.extend(builtin.bytes().map(|bytes| (builtin.name().to_owned(), bytes.to_vec())));
    }
    for (name, bytes) in &tiles {
        let tile = Tile::from_bytes(bytes).unwrap();
        let spp = tile.shape().spp;
        let counts: Vec<u32> = TIMES.iter().map(|times| spp * times).filter(|&n| n <= 4096).collect();
        println!("{name}: n = {counts:?}");
        for (kind, integrands) in &kinds {
            // A domain of each pixel's own scrambles the sequence for each on its own.
            let owen = errors(integrands, &counts, |pixel, index| {
                Sampler::pixel(&sobol, pixel, pixel / 64, 0, index).domain(pixel).draw()
            });
            let random = errors(integrands, &counts, |_, _| [rng.uniform_f32(), rng.uniform_f32()]);
            let own = errors(integrands, &counts, |pixel, index| {
                Sampler::pixel(&tile, pixel % 16, pixel / 16, 0, index).draw()
            });
            let child = errors(integrands, &counts, |pixel, index| {
                Sampler::pixel(&tile, pixel % 16, pixel / 16, 0, index).domain(5).draw()
            });
            for (of, row) in [("random", &random), ("Owen-Sobol", &owen), ("tile", &own), ("child", &child)] {
                let row: Vec<String> = row.iter().map(|error| format!("{error:.5}")).collect();
                println!("  {kind:12} {of:10} {}", row.join(" "));
            }
            for (place, &times) in TIMES.iter().enumerate().take(counts.len()) {
                for row in [&own, &child] {
                    // Measured, with a quarter to spare.
                    let allowed = match times {
                        1 => 1.1,
                        2..16 => 0.95,
                        _ => 0.7,
                    };
                    assert!(row[place] < allowed * random[place], "{name} {kind} {times}");
                    if spp == 1 {
                        assert!(row[place] < 1.25 * owen[place], "{name} {kind} {times}");
                    }
                }
            }
        }
    }
}
