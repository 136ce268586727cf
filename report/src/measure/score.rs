//! How an image errs: how much, how much of it the eye sees, and at which frequencies.

use super::filter::gaussian;
use super::spectrum::Spectra;
use crate::measure::metric::Reference;
use image::Rgb32FImage;

/// An image's errors; or, by [`Score::mean`], those of several.
#[derive(Clone, Copy)]
pub(crate) struct Score {
    /// relMSE, errors beyond [`LIMIT`] limited.
    pub(crate) raw: f64,
    /// relMSE of the image as it is seen: the errors are filtered, then squared.
    pub(crate) filtered: f64,
    /// Power of the errors at low frequencies, relative to white noise.
    pub(crate) low: f64,
}

impl Score {
    pub(crate) fn new(image: &Rgb32FImage, reference: &Reference) -> Self {
        let [raw, filtered] = errors(image, reference);
        let low = Spectra::new(&signed_errors(image, reference), image.width() as usize).low();
        Self { raw, filtered, low }
    }

    pub(crate) fn mean(scores: &[Self]) -> Self {
        let mean = |of: fn(&Self) -> f64| scores.iter().map(of).sum::<f64>() / scores.len().max(1) as f64;
        Self { raw: mean(|score| score.raw), filtered: mean(|score| score.filtered), low: mean(|score| score.low) }
    }
}

/// [`Score::raw`] and [`Score::filtered`] alone: spectra take longer.
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

/// The share of the pixels whose error is limited.
pub(crate) fn limited(image: &Rgb32FImage, reference: &Reference) -> f64 {
    let [a, b] = reference.relative_errors(image);
    let beyond = average(&a, &b).into_iter().filter(|error| error.abs() > LIMIT).count();
    beyond as f64 / a.len().max(1) as f64
}

/// [`Reference::relative_errors`], limited.
fn limited_errors(image: &Rgb32FImage, reference: &Reference) -> [Vec<f64>; 2] {
    reference.relative_errors(image).map(|errors| errors.into_iter().map(|error| error.clamp(-LIMIT, LIMIT)).collect())
}

/// (I - R) / sqrt(R^2 + epsilon), limited, row after row.
pub(crate) fn signed_errors(image: &Rgb32FImage, reference: &Reference) -> Vec<f64> {
    let [a, b] = limited_errors(image, reference);
    average(&a, &b)
}

fn average(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect()
}
