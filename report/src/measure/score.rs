//! How an image errs: how much, and how much of it the eye sees.

use super::filter::gaussian;
use crate::measure::metric::Reference;
use image::Rgb32FImage;

/// The relMSE, errors beyond [`LIMIT`] limited; and that of the image as it is seen: the errors are filtered, then
/// squared.
pub(crate) fn errors(image: &Rgb32FImage, reference: &Reference) -> [f64; 2] {
    let [a, b] = limited_errors(image, reference);
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / a.len().max(1) as f64;
    let width = image.width() as usize;
    // As for the relMSE, two halves of the reference keep its own noise out.
    [product(&a, &b), product(&gaussian(&a, width), &gaussian(&b, width))]
}

/// Relative errors beyond it count as this. One rare highlight in a dark pixel, a hundred times too bright, would
/// otherwise outweigh all other pixels, and whether a frame has one is chance.
pub(crate) const LIMIT: f64 = 5.0;

/// [`Reference::relative_errors`], limited.
fn limited_errors(image: &Rgb32FImage, reference: &Reference) -> [Vec<f64>; 2] {
    reference.relative_errors(image).map(|errors| errors.into_iter().map(|error| error.clamp(-LIMIT, LIMIT)).collect())
}

/// (I - R) / sqrt(R^2 + epsilon), limited, row after row.
pub(crate) fn signed_errors(image: &Rgb32FImage, reference: &Reference) -> Vec<f64> {
    let [a, b] = limited_errors(image, reference);
    a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect()
}
