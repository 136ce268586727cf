//! Power spectra of an error image, one for each square of it (figure 5.20 of the thesis).

use image::{GrayImage, Luma};
use rustfft::FftPlanner;
use rustfft::num_complex::Complex;
use std::f64::consts::PI;

/// Width and height of a square, in pixels.
pub(crate) const WINDOW: usize = 32;

/// Frequencies below it count as low, in cycles per pixel: the Gaussian of [`super::filter::SIGMA`] halves what has
/// .09.
const LOW: f64 = 0.1;

/// The power of each frequency in each square: squares and frequencies row after row, frequency zero first.
pub(crate) struct Spectra {
    columns: usize,
    powers: Vec<Vec<f64>>,
}

impl Spectra {
    /// `errors`: rows of `width` values. Pixels beyond the last whole square are left out.
    pub(crate) fn new(errors: &[f64], width: usize) -> Self {
        let (columns, rows) = (width / WINDOW, errors.len() / width.max(1) / WINDOW);
        let fft = FftPlanner::<f64>::new().plan_fft_forward(WINDOW);
        // Hann's: a square is no period of the image, and its borders must not look like an edge.
        let hann: Vec<f64> = (0..WINDOW).map(|i| (PI * (i as f64 + 0.5) / WINDOW as f64).sin().powi(2)).collect();
        let square = |left: usize, top: usize| {
            let mut values: Vec<_> = (0..WINDOW * WINDOW)
                .map(|i| (i % WINDOW, i / WINDOW))
                .map(|(x, y)| Complex::from(errors[(top + y) * width + left + x] * hann[x] * hann[y]))
                .collect();
            fft.process(&mut values); // every row
            let mut columns: Vec<_> = (0..WINDOW * WINDOW).map(|i| values[i % WINDOW * WINDOW + i / WINDOW]).collect();
            fft.process(&mut columns);
            (0..WINDOW * WINDOW).map(|i| columns[i % WINDOW * WINDOW + i / WINDOW].norm_sqr()).collect()
        };
        let corners = (0..rows).flat_map(|row| (0..columns).map(move |column| (column * WINDOW, row * WINDOW)));
        Self { columns, powers: corners.map(|(left, top)| square(left, top)).collect() }
    }

    /// Mean power of the low frequencies over that of all: 1 for white noise, 0 for ideal blue noise.
    pub(crate) fn low(&self) -> f64 {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let all: Vec<f64> = self.powers.iter().flatten().copied().collect();
        let is_low = |i: usize| frequency(i % WINDOW).hypot(frequency(i / WINDOW)) < LOW;
        let low: Vec<f64> =
            all.iter().enumerate().filter(|(i, _)| is_low(i % (WINDOW * WINDOW))).map(|(_, &power)| power).collect();
        mean(&low) / mean(&all)
    }

    /// The squares where they are in the image, frequency zero in the centre of each; a grey of .58 is a square's mean
    /// power.
    pub(crate) fn picture(&self) -> GrayImage {
        let rows = self.powers.len() / self.columns.max(1);
        let mut picture = GrayImage::new((self.columns * WINDOW) as u32, (rows * WINDOW) as u32);
        for (x, y, pixel) in picture.enumerate_pixels_mut() {
            let (x, y) = (x as usize, y as usize);
            // The first row and column, the highest frequency, make way for a line between squares.
            if x % WINDOW == 0 || y % WINDOW == 0 {
                continue;
            }
            let powers = &self.powers[y / WINDOW * self.columns + x / WINDOW];
            let mean = powers.iter().sum::<f64>() / powers.len() as f64;
            let centered = |i: usize| (i + WINDOW / 2) % WINDOW;
            let power = powers[centered(y % WINDOW) * WINDOW + centered(x % WINDOW)];
            let grey = if mean > 0.0 { (power / mean / 3.0).sqrt().min(1.0) } else { 0.0 };
            *pixel = Luma([(255.0 * grey) as u8]);
        }
        picture
    }
}

/// Cycles per pixel of entry i of a transform, without its sign.
fn frequency(i: usize) -> f64 {
    i.min(WINDOW - i) as f64 / WINDOW as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::filter::gaussian;

    fn white(count: usize) -> Vec<f64> {
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / f64::from(1 << 24) - 0.5
        };
        (0..count).map(|_| next() + next() + next()).collect()
    }

    #[test]
    fn white_noise_is_white_and_what_a_filter_leaves_is_blue() {
        let width = 8 * WINDOW;
        let noise = white(width * width);
        // 64 squares of 37 low frequencies, correlated by the window: a standard deviation of .03 or so.
        assert!((Spectra::new(&noise, width).low() - 1.0).abs() < 0.12);
        let blue: Vec<f64> = noise.iter().zip(gaussian(&noise, width)).map(|(value, low)| value - low).collect();
        assert!(Spectra::new(&blue, width).low() < 0.3);
    }

    #[test]
    fn a_wave_is_a_pair_of_points() {
        let wave: Vec<f64> =
            (0..WINDOW * WINDOW).map(|i| (2.0 * PI * 8.0 * (i % WINDOW) as f64 / WINDOW as f64).sin()).collect();
        let spectra = Spectra::new(&wave, WINDOW);
        assert!(spectra.powers[0][8] > 1e3 * spectra.powers[0][8 * WINDOW]);
        let picture = spectra.picture();
        assert_eq!(picture.get_pixel(16 + 8, 16).0, [255]);
        assert_eq!(picture.get_pixel(16 - 8, 16).0, [255]);
        assert_eq!(picture.get_pixel(16, 16 + 8).0, [0]);
    }
}
