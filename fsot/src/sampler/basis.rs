//! Cosines over the unit square, and the energy kernel in them.

use super::power::{LANES, total};

/// Frequencies along each axis.
pub(crate) const MODES: usize = 32;
/// Numbers of a spectrum: `[frequency along x][along y]`.
pub(crate) const SPECTRUM: usize = MODES * MODES;
/// Places at which cosines are known.
const PLACES: usize = 1024;
/// Cells along each axis of the table of the mean energy.
const CELLS: usize = 32;
/// Steps of a numerical integral.
const STEPS: usize = 256;

/// A spectrum: what the terms of an energy cost between pixels, where it need not be exact.
pub(crate) type Spectrum = [f32; SPECTRUM];

/// Tables that depend on the kernel's exponent alone.
#[derive(Debug)]
pub(crate) struct Basis {
    /// Half of the exponent.
    pub(crate) half: f32,
    cosines: Vec<[f32; MODES]>,
    /// The energy of each product of two cosines; 0 for the constant.
    pub(crate) energies: Spectrum,
    /// The mean of the distance's power from a point to all others.
    mean: Vec<f32>,
    /// The mean of that.
    pub(crate) total: f32,
}

impl Basis {
    pub(crate) fn new(exponent: f32) -> Basis {
        let half = f64::from(exponent) / 2.0;
        let cosine = |place: usize, k: usize| {
            let x = (place as f64 + 0.5) / PLACES as f64;
            let scale = if k == 0 { 1.0 } else { std::f64::consts::SQRT_2 };
            (scale * libm::cos(std::f64::consts::PI * k as f64 * x)) as f32
        };
        let mean = mean(half);
        let inner = |place: usize| if place == 0 || place == CELLS { 0.5 } else { 1.0 };
        let weigh = |(i, m): (usize, &f32)| f64::from(*m) * inner(i % (CELLS + 1)) * inner(i / (CELLS + 1));
        let total = mean.iter().enumerate().map(weigh).sum::<f64>() / (CELLS * CELLS) as f64;
        Basis {
            half: half as f32,
            cosines: (0..PLACES).map(|place| std::array::from_fn(|k| cosine(place, k))).collect(),
            energies: energies(half),
            mean,
            total: total as f32,
        }
    }

    fn cosines(&self, coordinate: u16) -> &[f32; MODES] {
        &self.cosines[(usize::from(coordinate) * PLACES) >> 16]
    }

    /// Adds a point's cosines to a spectrum.
    pub(crate) fn add(&self, x: u16, y: u16, sum: &mut Spectrum) {
        let (cx, cy) = (self.cosines(x), self.cosines(y));
        for (row, cx) in sum.as_chunks_mut::<MODES>().0.iter_mut().zip(cx) {
            for (sum, cy) in row.iter_mut().zip(cy) {
                *sum += cx * cy;
            }
        }
    }

    /// The function that a spectrum stands for, at a point.
    pub(crate) fn at(&self, x: u16, y: u16, spectrum: &Spectrum) -> f32 {
        let (cx, cy) = (self.cosines(x), self.cosines(y));
        let mut sums = [0.0f32; MODES];
        for (row, cx) in spectrum.as_chunks::<MODES>().0.iter().zip(cx) {
            for (sum, value) in sums.iter_mut().zip(row) {
                *sum += cx * value;
            }
        }
        let lanes = std::array::from_fn(|lane| (lane..MODES).step_by(LANES).map(|i| sums[i] * cy[i]).sum::<f32>());
        total(&lanes)
    }

    /// The mean of the distance's power from this point to all others.
    pub(crate) fn mean_at(&self, x: f32, y: f32) -> f32 {
        let (x, y) = (x * CELLS as f32, y * CELLS as f32);
        let (column, row) = ((x as usize).min(CELLS - 1), (y as usize).min(CELLS - 1));
        let (a, b) = (x - column as f32, y - row as f32);
        let (low, high) = (row * (CELLS + 1) + column, (row + 1) * (CELLS + 1) + column);
        let along = |from: usize| self.mean[from] + a * (self.mean[from + 1] - self.mean[from]);
        along(low) + b * (along(high) - along(low))
    }
}

/// The mean of the distance's power, on the corners of the cells.
fn mean(half: f64) -> Vec<f32> {
    const FINE: usize = 64;
    let at = |x: f64, y: f64| {
        let place = |i: usize| (i as f64 + 0.5) / FINE as f64;
        let squares = |c: f64| -> Vec<f64> { (0..FINE).map(|i| (place(i) - c) * (place(i) - c)).collect() };
        let (xs, ys) = (squares(x), squares(y));
        let sum: f64 = ys.iter().map(|y| xs.iter().map(|x| libm::pow(x + y, half)).sum::<f64>()).sum();
        sum / (FINE * FINE) as f64
    };
    let middle = CELLS / 2;
    let corner = |row: usize, column: usize| at(column as f64 / CELLS as f64, row as f64 / CELLS as f64);
    // Symmetric: an eighth is enough.
    let mut eighth = vec![0.0; (middle + 1) * (middle + 1)];
    for row in 0..=middle {
        for column in 0..=row {
            eighth[row * (middle + 1) + column] = corner(row, column);
        }
    }
    let folded = |c: usize| c.min(CELLS - c);
    let places = 0..(CELLS + 1) * (CELLS + 1);
    let value = |i: usize| {
        let (row, column) = (folded(i / (CELLS + 1)), folded(i % (CELLS + 1)));
        eighth[row.max(column) * (middle + 1) + row.min(column)] as f32
    };
    places.map(value).collect()
}

/// The energy of each product of cosines with itself: minus the integral of the distance's power times the product's
/// autocorrelation. Products of different frequencies are taken for orthogonal.
fn energies(half: f64) -> Spectrum {
    let lag = |i: usize| (i as f64 + 0.5) / STEPS as f64;
    let correlation = |k: usize, s: f64| {
        let phase = std::f64::consts::PI * k as f64;
        if k == 0 { 1.0 - s } else { (1.0 - s) * libm::cos(phase * s) - libm::sin(phase * s) / phase }
    };
    let waves: Vec<Vec<f64>> = (0..MODES).map(|k| (0..STEPS).map(|i| correlation(k, lag(i))).collect()).collect();
    let mut rows = vec![0.0; STEPS * MODES];
    for y in 0..STEPS {
        let powers: Vec<f64> = (0..STEPS).map(|x| libm::pow(lag(x) * lag(x) + lag(y) * lag(y), half)).collect();
        for (k, wave) in waves.iter().enumerate() {
            rows[k * STEPS + y] = wave.iter().zip(&powers).map(|(a, b)| a * b).sum();
        }
    }
    let mut spectrum = [0.0; SPECTRUM];
    for (i, energy) in spectrum.iter_mut().enumerate().skip(1) {
        let row = &rows[i / MODES * STEPS..][..STEPS];
        let sum: f64 = row.iter().zip(&waves[i % MODES]).map(|(a, b)| a * b).sum();
        *energy = (-4.0 * sum / (STEPS * STEPS) as f64).max(0.0) as f32;
    }
    spectrum
}
