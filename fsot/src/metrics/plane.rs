//! Square images and their Fourier transforms.

use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};
use std::sync::Arc;

/// An image, row after row, or its transform.
pub(crate) type Plane = Vec<Complex<f64>>;

/// The two-dimensional transform of images of one size.
pub(crate) struct Transform {
    size: usize,
    rows: Arc<dyn Fft<f64>>,
}

impl Transform {
    pub(crate) fn new(size: usize) -> Transform {
        Transform { size, rows: FftPlanner::new().plan_fft_forward(size) }
    }

    /// Transforms an image in place; the result is transposed.
    pub(crate) fn forward(&self, image: &mut Plane) {
        self.rows.process(image);
        transpose(image, self.size);
        self.rows.process(image);
    }

    /// The transform of a normalised Gaussian about pixel 0 of the torus, evaluated at pixel centres.
    pub(crate) fn gaussian(&self, deviation: f64) -> Plane {
        let size = self.size;
        let along = |i: usize| {
            let r = i.min(size - i) as f64;
            libm::exp(-r * r / (2.0 * deviation * deviation))
        };
        let line: Vec<f64> = (0..size).map(along).collect();
        let total = line.iter().sum::<f64>();
        let value = |i: usize| line[i / size] * line[i % size] / (total * total);
        let mut plane: Plane = (0..size * size).map(|i| Complex::new(value(i), 0.0)).collect();
        self.forward(&mut plane);
        plane
    }
}

fn transpose(image: &mut Plane, size: usize) {
    for y in 0..size {
        for x in 0..y {
            image.swap(y * size + x, x * size + y);
        }
    }
}

/// Transforms every pixel of a sequence of images over time, in place, scaled so that the sum of squares is kept.
pub(crate) fn over_time(images: &mut [Plane]) {
    let frames = images.len();
    let fft = FftPlanner::new().plan_fft_forward(frames);
    let scale = 1.0 / (frames as f64).sqrt();
    let mut line = vec![Complex::new(0.0, 0.0); frames];
    let mut scratch = vec![Complex::new(0.0, 0.0); fft.get_inplace_scratch_len()];
    for pixel in 0..images.first().map_or(0, Vec::len) {
        line.iter_mut().zip(images.iter()).for_each(|(z, image)| *z = image[pixel]);
        fft.process_with_scratch(&mut line, &mut scratch);
        images.iter_mut().zip(&line).for_each(|(image, z)| image[pixel] = z * scale);
    }
}

/// The squared frequency response of y_t = alpha x_t + (1 - alpha) y_(t-1) for signals of period `frames`.
pub(crate) fn moving_average_response(alpha: f64, frames: usize) -> Vec<f64> {
    let response = |k: usize| {
        // |1 - keep exp(i angle)|^2 with keep = 1 - alpha, of which nothing cancels where alpha is small.
        let half = libm::sin(std::f64::consts::PI * k as f64 / frames as f64);
        alpha * alpha / (alpha * alpha + 4.0 * (1.0 - alpha) * half * half)
    };
    (0..frames).map(response).collect()
}
