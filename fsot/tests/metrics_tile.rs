//! Energies of tiles against direct convolution.

use crate::metrics_common::{assert_mean, assert_near, random};
use fsot::metrics::integrands::{Family, Integrand};
use fsot::metrics::tile::{Energies, FILTERS, FamilyEnergies, TileOptions, TileReport, TileView, integrands};
use fsot::metrics::{error_spectrum, measure_energies, measure_tile};
use fsot::points::Points;

const FAMILIES: [Family; 2] = [Family::HalfSpace, Family::Gaussian];

/// A tile for the tests: [frame][y][x][sample][dim].
struct Tile {
    size: usize,
    spp: usize,
    dims: usize,
    frames: usize,
    points: Points,
}

impl Tile {
    fn random(size: usize, spp: usize, dims: usize, frames: usize, seed: u64) -> Tile {
        Tile { size, spp, dims, frames, points: random(size * size * spp * frames, dims, seed) }
    }

    fn measure(&self, integrands: usize, alphas: &[f64]) -> TileReport {
        let view = TileView::new(self.size, self.spp, self.dims, self.frames, self.points.coordinates()).unwrap();
        measure_tile(&view, &TileOptions { integrands, alphas: alphas.to_vec() }).unwrap()
    }

    /// The error of the first `spp` samples at every pixel of a frame.
    fn errors(&self, integrand: &Integrand, frame: usize, spp: usize) -> Vec<f64> {
        let pixels = self.size * self.size;
        let all: Vec<&[f32]> = self.points.iter().skip(frame * pixels * self.spp).take(pixels * self.spp).collect();
        let estimate =
            |samples: &[&[f32]]| samples.iter().take(spp).map(|p| integrand.value(p)).sum::<f64>() / spp as f64;
        all.chunks(self.spp).map(|samples| estimate(samples) - integrand.integral).collect()
    }
}

/// A normalised kernel about pixel 0 of the torus; none: the unit.
fn kernel(size: usize, deviation: Option<f64>) -> Vec<f64> {
    let squared = |i: usize| (i.min(size - i) as f64).powi(2);
    let value = |i: usize| match deviation {
        Some(s) => (-(squared(i / size) + squared(i % size)) / (2.0 * s * s)).exp(),
        None => f64::from(u8::from(i == 0)),
    };
    let values: Vec<f64> = (0..size * size).map(value).collect();
    let total: f64 = values.iter().sum();
    values.iter().map(|v| v / total).collect()
}

/// Toroidal convolution, by its definition.
fn convolve(image: &[f64], kernel: &[f64], size: usize) -> Vec<f64> {
    let at = |x: usize, y: usize| {
        let term = |i: usize| {
            let (kx, ky) = (i % size, i / size);
            kernel[i] * image[(y + size - ky) % size * size + (x + size - kx) % size]
        };
        (0..size * size).map(term).sum()
    };
    (0..size * size).map(|i| at(i % size, i / size)).collect()
}

fn mean_square(image: &[f64]) -> f64 {
    image.iter().map(|e| e * e).sum::<f64>() / image.len() as f64
}

/// Energies in the order G2.1, A, G1, raw, of error images over those of white noise: `images(integrand)` gives
/// several.
fn slow(
    size: usize,
    spp: usize,
    list: &[Integrand],
    white: f64,
    images: impl Fn(&Integrand) -> Vec<Vec<f64>>,
) -> Energies {
    let deviations = FILTERS.map(Some).into_iter().chain([None]);
    let ratio: Vec<f64> = deviations
        .map(|deviation| {
            let kernel = kernel(size, deviation);
            let squares: f64 = kernel.iter().map(|k| k * k).sum();
            let (mut sum, mut expected) = (0.0, 0.0);
            for integrand in list {
                for image in images(integrand) {
                    sum += mean_square(&convolve(&image, &kernel, size));
                    expected += integrand.variance / spp as f64 * squares * white;
                }
            }
            sum / expected
        })
        .collect();
    Energies { wide: ratio[0], perceptual: ratio[1], narrow: ratio[2], raw: ratio[3] }
}

fn assert_energies(a: &FamilyEnergies, b: [Energies; 2], what: &str) {
    for (a, b) in [(a.half_spaces, b[0]), (a.gaussians, b[1])] {
        for (a, b) in [(a.wide, b.wide), (a.perceptual, b.perceptual), (a.narrow, b.narrow), (a.raw, b.raw)] {
            assert_near(a, b, 1e-9 * b, what);
        }
    }
}

#[test]
fn energies_are_those_of_direct_convolution() {
    for (size, spp, dims) in [(1, 1, 2), (2, 3, 1), (8, 4, 2), (9, 2, 3), (8, 1, 8)] {
        let tile = Tile::random(size, spp, dims, 1, 1);
        let report = tile.measure(6, &[]);
        assert!(report.per_frame.is_empty() && report.temporal.is_empty());
        assert_eq!(report.prefixes.last().unwrap().spp, spp);
        for prefix in &report.prefixes {
            let expected = FAMILIES.map(|family| {
                let list = integrands(family, dims, 0, 6);
                slow(size, prefix.spp, &list, 1.0, |i| vec![tile.errors(i, 0, prefix.spp)])
            });
            assert_energies(&prefix.energies, expected, &format!("{size} pixels, {} of {spp} samples", prefix.spp));
        }
    }
}

#[test]
fn prefixes_are_powers_of_two_and_all() {
    let spps =
        |spp: usize| Tile::random(2, spp, 2, 1, 1).measure(2, &[]).prefixes.iter().map(|p| p.spp).collect::<Vec<_>>();
    assert_eq!(spps(1), [1]);
    assert_eq!(spps(16), [1, 2, 4, 8, 16]);
    assert_eq!(spps(6), [1, 2, 4, 6]);
}

#[test]
fn marginals_are_tiles_of_two_dimensions() {
    let tile = Tile::random(8, 2, 4, 1, 5);
    let report = tile.measure(10, &[]);
    assert_eq!(report.marginals.len(), 6);
    for marginal in &report.marginals {
        let [a, b] = marginal.axes;
        assert!(a < b);
        let chosen = tile.points.iter().flat_map(|p| [p[a], p[b]]).collect();
        let alone = Tile { size: 8, spp: 2, dims: 2, frames: 1, points: Points::new(2, chosen) }.measure(10, &[]);
        for (x, y) in marginal.prefixes.iter().zip(&alone.prefixes) {
            assert_eq!(x.energies, y.energies);
        }
    }
    assert!(Tile::random(4, 1, 2, 1, 1).measure(2, &[]).marginals.is_empty());
}

#[test]
fn frames_and_moving_averages_are_those_of_direct_filtering() {
    let (size, spp, frames, alpha) = (6, 2, 5, 0.3);
    let tile = Tile::random(size, spp, 2, frames, 8);
    let report = tile.measure(4, &[alpha, 1.0, 1e-6]);
    let list = |family| integrands(family, 2, 0, 4);
    for (frame, energies) in report.per_frame.iter().enumerate() {
        let expected = FAMILIES.map(|f| slow(size, spp, &list(f), 1.0, |i| vec![tile.errors(i, frame, spp)]));
        assert_energies(energies, expected, &format!("frame {frame}"));
    }
    let all = |i: &Integrand| (0..frames).map(|frame| tile.errors(i, frame, spp)).collect::<Vec<_>>();
    let mean = FAMILIES.map(|f| slow(size, spp, &list(f), 1.0, all));
    assert_energies(&report.prefixes.last().unwrap().energies, mean, "mean over frames");
    // An average of alpha 1 keeps the newest frame.
    assert_energies(&report.temporal[1].energies, mean, "alpha 1");
    // One of almost 0 is the mean over all of them.
    let still = |i: &Integrand| {
        let errors = all(i);
        vec![(0..size * size).map(|pixel| errors.iter().map(|e| e[pixel]).sum::<f64>() / frames as f64).collect()]
    };
    let expected = FAMILIES.map(|f| slow(size, spp, &list(f), 1.0 / frames as f64, still));
    assert_energies(&report.temporal[2].energies, expected, "alpha 1e-6");
    // The average of the repeated sequence, after so many periods that its start is forgotten.
    let filtered = |i: &Integrand| {
        let errors = all(i);
        let mut average = vec![0.0; size * size];
        let mut last = Vec::new();
        for step in 0..40 * frames {
            average = average.iter().zip(&errors[step % frames]).map(|(a, e)| (1.0 - alpha) * a + alpha * e).collect();
            if step >= 39 * frames {
                last.push(average.clone());
            }
        }
        last
    };
    // Weights of the frames of a period, that of a frame being the sum over all periods.
    let keep: f64 = 1.0 - alpha;
    let weight = |lag: usize| alpha * keep.powi(lag as i32) / (1.0 - keep.powi(frames as i32));
    let white: f64 = (0..frames).map(|lag| weight(lag) * weight(lag)).sum();
    let expected = FAMILIES.map(|f| slow(size, spp, &list(f), white, filtered));
    assert_energies(&report.temporal[0].energies, expected, "moving average");
}

#[test]
fn random_tiles_are_white() {
    let reports: Vec<TileReport> = (0..40).map(|seed| Tile::random(16, 2, 2, 2, seed).measure(16, &[0.2])).collect();
    let values = |get: &dyn Fn(&TileReport) -> f64| reports.iter().map(get).collect::<Vec<f64>>();
    assert_mean(&values(&|r| r.prefixes[0].energies.half_spaces.wide), 1.0, "G2.1, 1 sample");
    assert_mean(&values(&|r| r.prefixes[1].energies.gaussians.perceptual), 1.0, "A, 2 samples");
    assert_mean(&values(&|r| r.prefixes[1].energies.half_spaces.raw), 1.0, "raw, 2 samples");
    assert_mean(&values(&|r| r.temporal[0].energies.gaussians.narrow), 1.0, "G1, moving average");
}

#[test]
fn equal_samples_everywhere_have_an_error_that_no_filter_removes() {
    let tile = Tile { size: 8, spp: 1, dims: 2, frames: 1, points: Points::new(2, [0.3, 0.6].repeat(64)) };
    let energies = tile.measure(32, &[]).prefixes[0].energies;
    let squares: f64 = kernel(8, Some(2.1)).iter().map(|k| k * k).sum();
    assert_near(energies.half_spaces.wide, energies.half_spaces.raw / squares, 1e-9, "a constant error");
}

#[test]
fn borders_are_counted_over_a_uniform_density() {
    let mut points = [0.5; 2 * 64];
    points[..4].copy_from_slice(&[0.0, 1.0, 0.015, 0.985]);
    points[5] = 1.0;
    let report = Tile { size: 8, spp: 1, dims: 2, frames: 1, points: Points::new(2, points.to_vec()) }.measure(2, &[]);
    assert_eq!(report.border, [0.0, 3.0]);
    assert!(report.to_string().contains("border: 0 to 3.000 of a uniform density"), "{report}");
}

#[test]
fn the_error_spectrum_is_that_of_the_definition() {
    let (size, count) = (6, 4);
    let tile = Tile::random(size, 3, 2, 2, 4);
    let view = TileView::new(size, 3, 2, 2, tile.points.coordinates()).unwrap();
    let spectrum = error_spectrum(&view, count).unwrap();
    assert_eq!((spectrum.side, spectrum.unit, spectrum.realisations), (size, size as f64, 2));
    let pairs: Vec<Vec<Integrand>> = FAMILIES
        .iter()
        .flat_map(|&f| integrands(f, 2, 0, count).chunks(2).map(<[_]>::to_vec).collect::<Vec<_>>())
        .collect();
    for (i, power) in spectrum.power.iter().enumerate() {
        let (kx, ky) = ((i % size) as f64 - 3.0, (i / size) as f64 - 3.0);
        let mut expected = 0.0;
        for pair in &pairs {
            let variance: f64 = pair.iter().map(|i| i.variance).sum();
            for frame in 0..2 {
                for integrand in pair {
                    let (mut re, mut im) = (0.0, 0.0);
                    for (p, e) in tile.errors(integrand, frame, 3).iter().enumerate() {
                        let phase = kx * (p % size) as f64 + ky * (p / size) as f64;
                        re += e * (std::f64::consts::TAU * phase / size as f64).cos();
                        im += e * (std::f64::consts::TAU * phase / size as f64).sin();
                    }
                    expected += (re * re + im * im) * 3.0 / (variance * (size * size) as f64);
                }
            }
        }
        let expected = expected / (pairs.len() * 2) as f64;
        assert_near(*power, expected, 1e-9 * (1.0 + expected), &format!("({kx}, {ky})"));
    }
    assert!(error_spectrum(&view, 0).is_err());
}

#[test]
fn what_is_no_tile_is_refused() {
    let good = vec![0.5; 4 * 2 * 3];
    assert!(TileView::new(2, 2, 3, 1, &good).is_ok());
    for (size, spp, dims, frames) in [(0, 2, 3, 1), (2, 0, 3, 1), (2, 2, 0, 1), (2, 2, 3, 0), (2, 2, 9, 1)] {
        assert!(TileView::new(size, spp, dims, frames, &good).unwrap_err().to_string().contains("at least 1"));
    }
    let error = TileView::new(2, 2, 2, 1, &good).unwrap_err().to_string();
    assert!(error.contains("24 coordinates cannot make 1 frame of 2x2 pixels"), "{error}");
    assert!(TileView::new(usize::MAX, 2, 2, 2, &good).is_err());
    for (bad, shown) in [(f32::NAN, "NaN"), (1.5, "1.5"), (-0.1, "-0.1"), (f32::INFINITY, "inf")] {
        let mut coordinates = good.clone();
        coordinates[7] = bad;
        let error = TileView::new(2, 2, 3, 1, &coordinates).unwrap_err().to_string();
        assert!(error.contains(&format!("point 3 has {shown} as coordinate 2")), "{error}");
    }
    let view = TileView::new(2, 2, 3, 1, &good).unwrap();
    assert!(measure_tile(&view, &TileOptions { integrands: 0, alphas: vec![] }).is_err());
    for alpha in [0.0, -1.0, 1.1, f64::NAN] {
        assert!(measure_tile(&view, &TileOptions { integrands: 2, alphas: vec![alpha] }).is_err());
    }
}

/// All samples' energies alone are those of the report; another first number is another draw of integrands, of the same
/// expectation.
#[test]
fn energies_of_numbered_integrands() {
    let tile = Tile::random(16, 4, 2, 2, 5);
    let view = TileView::new(16, 4, 2, 2, tile.points.coordinates()).unwrap();
    let whole = tile.measure(32, &[]).prefixes.last().unwrap().energies;
    assert_eq!(measure_energies(&view, 0, 32).unwrap(), whole);
    let other = measure_energies(&view, 1 << 32, 32).unwrap();
    assert_ne!(other, whole);
    for (a, b) in [(other.half_spaces, whole.half_spaces), (other.gaussians, whole.gaussians)] {
        assert!((a.raw / b.raw - 1.0).abs() < 0.2, "{} {}", a.raw, b.raw);
    }
    assert!(measure_energies(&view, 0, 0).is_err());
}
