//! How an image errs, on luminance: relMSE, equation (2.32) of the thesis, and how much of it the eye sees.

use super::filter::gaussian;
use super::image::luminance;
use image::{Rgb, Rgb32FImage};

/// Relative errors beyond it count as this. One rare highlight in a dark pixel, a hundred times too bright, would
/// otherwise outweigh all other pixels, and whether a frame has one is chance.
pub(crate) const LIMIT: f64 = 5.0;

/// What images are compared with.
///
/// Two independent renderings A and B rather than one: R = (A + B) / 2 is shown and divides, and the squared error
/// (I - R)^2 becomes (I - A)(I - B), whose expectation is the squared error to the true image. With one noisy reference
/// the reference's own error would be added to every estimator's, and would flatter the worse ones.
pub(crate) struct Reference {
    pub(crate) image: Rgb32FImage,
    /// The two halves.
    pub(crate) images: [Rgb32FImage; 2],
    /// Their luminance.
    halves: [Vec<f64>; 2],
    /// R^2 + epsilon of each pixel; epsilon = 0.01 times the squared mean luminance of the image.
    denominators: Vec<f64>,
}

impl Reference {
    pub(crate) fn new(a: &Rgb32FImage, b: &Rgb32FImage) -> Self {
        let image = Rgb32FImage::from_fn(a.width(), a.height(), |x, y| {
            let (a, b) = (a.get_pixel(x, y).0, b.get_pixel(x, y).0);
            Rgb(std::array::from_fn(|channel| 0.5 * (a[channel] + b[channel])))
        });
        let values: Vec<f64> = image.pixels().map(luminance).collect();
        let epsilon = 0.01 * mean(&values).powi(2);
        let denominators = values.iter().map(|value| value * value + epsilon).collect();
        let halves = [a, b].map(|half| half.pixels().map(luminance).collect());
        Self { image, images: [a.clone(), b.clone()], halves, denominators }
    }

    /// The mean over all pixels of (I - A)(I - B) / (R^2 + epsilon).
    pub(crate) fn rel_mse(&self, image: &Rgb32FImage) -> f64 {
        mean(&self.terms(image))
    }

    /// (I - A)(I - B) / (R^2 + epsilon) of each pixel, row after row.
    pub(crate) fn terms(&self, image: &Rgb32FImage) -> Vec<f64> {
        products(&self.relative_errors(image))
    }

    /// (I - A) / sqrt(R^2 + epsilon) and the same with B, row after row: the mean of their product is the relMSE.
    fn relative_errors(&self, image: &Rgb32FImage) -> [Vec<f64>; 2] {
        self.halves.each_ref().map(|half| {
            let values = image.pixels().map(luminance).zip(half).zip(&self.denominators);
            values.map(|((i, half), d)| (i - half) / d.sqrt()).collect()
        })
    }

    /// The same, none larger than [`LIMIT`].
    fn limited_errors(&self, image: &Rgb32FImage) -> [Vec<f64>; 2] {
        let limited = |errors: Vec<f64>| errors.into_iter().map(|error| error.clamp(-LIMIT, LIMIT)).collect();
        self.relative_errors(image).map(limited)
    }

    /// The relMSE, errors limited; and that of the image as it is seen: the errors are filtered, then squared.
    pub(crate) fn errors(&self, image: &Rgb32FImage) -> [f64; 2] {
        let limited = self.limited_errors(image);
        let seen = limited.each_ref().map(|errors| gaussian(errors, image.width() as usize));
        [limited, seen].map(|errors| mean(&products(&errors)))
    }

    /// (I - R) / sqrt(R^2 + epsilon), limited, row after row.
    pub(crate) fn signed_errors(&self, image: &Rgb32FImage) -> Vec<f64> {
        let [a, b] = self.limited_errors(image);
        a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect()
    }
}

/// Of the errors from either half: so the reference's own noise stays out.
fn products([a, b]: &[Vec<f64>; 2]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(value: f32) -> Rgb32FImage {
        Rgb32FImage::from_pixel(4, 4, Rgb([value; 3]))
    }

    #[test]
    fn rel_mse_of_known_images() {
        let reference = Reference::new(&flat(2.0), &flat(2.0));
        assert!((reference.rel_mse(&flat(3.0)) - 1.0 / (4.0 + 0.04)).abs() < 1e-6);
        assert!(reference.rel_mse(&flat(2.0)).abs() < 1e-12);
    }

    #[test]
    fn noise_of_the_reference_cancels() {
        // (3 - 1)(3 - 3) + (3 - 3)(3 - 1) = 0, while (3 - 2)^2 is not.
        assert!(Reference::new(&flat(1.0), &flat(3.0)).rel_mse(&flat(3.0)).abs() < 1e-12);
    }
}
