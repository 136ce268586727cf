//! Is the mean of many renderings the exact mean?

use crate::chapters::statistics::normal_quantile;
use crate::measure::metric::Reference;
use image::Rgb32FImage;

/// Blocks on a side of the image that are tested one by one.
const BLOCKS: usize = 4;
/// Tests that [`largest`] makes: the blocks, and the whole image.
pub(crate) const TESTS: usize = BLOCKS * BLOCKS + 1;

/// The largest deviation of the mean of several renderings from the exact mean.
pub(crate) struct Bias {
    /// In standard errors of the mean, as a normal variable's.
    pub(crate) deviations: f64,
    pub(crate) place: String,
}

/// Relative errors, averaged over blocks and over the image: one number per rendering, of which Student's t is taken.
pub(crate) fn largest(images: &[Rgb32FImage], reference: &Reference) -> Bias {
    let mut values = vec![Vec::new(); TESTS];
    for image in images {
        let [errors, _] = reference.relative_errors(image);
        let (width, height) = (image.width() as usize, image.height() as usize);
        let mut sums = [0.0; TESTS];
        for (pixel, error) in errors.iter().enumerate() {
            let (x, y) = (pixel % width, pixel / width);
            sums[y * BLOCKS / height * BLOCKS + x * BLOCKS / width] += error;
            sums[TESTS - 1] += error;
        }
        for (values, sum) in values.iter_mut().zip(sums) {
            values.push(sum);
        }
    }
    let scores = values.iter().map(|values| student(values).abs()).enumerate();
    let (test, deviations) = scores.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, f64::NAN));
    let place = match test == TESTS - 1 {
        true => "over the image".to_owned(),
        false => format!("in block ({}, {})", test % BLOCKS, test / BLOCKS),
    };
    Bias { deviations, place }
}

/// Student's t of "the mean is nought", as the normal deviate of the same probability (D. Wallace 1959).
fn student(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
    if variance == 0.0 {
        return if mean.abs() < 1e-9 { 0.0 } else { f64::INFINITY };
    }
    let (t, freedom) = (mean / (variance / n).sqrt(), n - 1.0);
    t.signum() * (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0) * (freedom * (t * t / freedom).ln_1p()).sqrt()
}

/// The deviation that the largest of so many independent tests exceeds with that chance, at most.
pub(crate) fn limit(significance: f64, tests: usize) -> f64 {
    normal_quantile(0.5 * significance / tests as f64)
}

/// The mean relative error over all pixels of all images.
pub(crate) fn brightness(images: &[Rgb32FImage], reference: &Reference) -> f64 {
    let errors: Vec<f64> = images.iter().flat_map(|image| reference.relative_errors(image)[0].clone()).collect();
    errors.iter().sum::<f64>() / errors.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    /// Images of noise around `mean`, uniform in +-`noise`.
    fn images(mean: impl Fn(u32) -> f32, noise: f32) -> Vec<Rgb32FImage> {
        let mut state = 1_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1 << 23) as f32 - 1.0
        };
        (0..64).map(|_| Rgb32FImage::from_fn(16, 16, |x, _| Rgb([mean(x) + noise * uniform(); 3]))).collect()
    }

    #[test]
    fn a_planted_bias_is_found_and_noise_is_not() {
        let flat = Rgb32FImage::from_pixel(16, 16, Rgb([1.0; 3]));
        let reference = Reference::new(&flat, &flat);
        let limit = limit(1e-3, TESTS);
        assert!((4.0..4.2).contains(&limit), "{limit}");
        assert!(largest(&images(|_| 1.0, 0.5), &reference).deviations < limit);
        // A standard error is .5 / sqrt(3) / sqrt(64 images * 16 pixels) = .009 in a block, and a quarter of it over
        // the image.
        let everywhere = largest(&images(|_| 1.015, 0.5), &reference);
        assert!(everywhere.deviations > limit && everywhere.place == "over the image");
        let one_column = largest(&images(|x| if x < 4 { 1.06 } else { 1.0 }, 0.5), &reference);
        assert!(one_column.deviations > limit && one_column.place.starts_with("in block (0, "), "{}", one_column.place);
        // Without any noise nothing may be off.
        assert_eq!(largest(&images(|_| 1.0, 0.0), &reference).deviations, 0.0);
        assert!(largest(&images(|_| 1.01, 0.0), &reference).deviations > limit);
    }
    #[test]
    fn student_as_normal() {
        // t = 2.262157 with 9 degrees of freedom has the probability of 1.959964.
        let spread: Vec<f64> = (0..10).map(|i| f64::from(i) - 4.5).collect();
        let error = (spread.iter().map(|value| value * value).sum::<f64>() / 9.0 / 10.0).sqrt();
        let shifted: Vec<f64> = spread.iter().map(|value| value + 2.262_157 * error).collect();
        assert!((student(&shifted) - 1.959_964).abs() < 0.01, "{}", student(&shifted));
    }
}
