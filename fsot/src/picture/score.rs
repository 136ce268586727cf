//! How much a picture made of dots looks like its source.

use super::colour::{decode, luminance};
use super::{Photo, resample};
use image::RgbImage;
use rayon::prelude::*;

/// The peak signal-to-noise ratio, in dB, of a drawn picture against its source, both blurred by the same Gaussian of
/// standard deviation `sigma` (pixels of the drawn picture): what an eye sees from where single dots merge.
///
/// The source is resampled to the drawn picture's size. `linear`: compare linear light instead of encoded values.
/// `grey`: compare with the source's grey. The mean squared error is that of all pixels and channels, the peak is 1.
/// Equal pictures have no noise: infinity.
pub fn blurred_psnr(drawn: &RgbImage, source: &Photo, sigma: f32, linear: bool, grey: bool) -> f64 {
    let (width, height) = (drawn.width() as usize, drawn.height() as usize);
    let value = |value: f32| if linear { decode(value) } else { value };
    let mut squares = 0.0;
    for channel in 0..3 {
        let expected: Vec<f32> = source
            .pixels
            .iter()
            .map(|rgb| {
                let rgb = rgb.map(value);
                if grey { luminance(rgb) } else { rgb[channel] }
            })
            .collect();
        let expected = means([source.width, source.height], &expected, [width, height]);
        let difference: Vec<f32> = drawn
            .pixels()
            .zip(expected)
            .map(|(pixel, expected)| value(f32::from(pixel.0[channel]) / 255.0) - expected)
            .collect();
        // The difference of blurred pictures is the blurred difference.
        squares += blurred_squares(&difference, width, height, sigma);
    }
    -10.0 * libm::log10(squares / 3.0)
}

/// The mean of the squares of blurred values. A wide blur leaves nothing that a coarser grid would lose: means of
/// blocks of an eighth of the standard deviation are blurred instead.
fn blurred_squares(values: &[f32], width: usize, height: usize, sigma: f32) -> f64 {
    let block = (sigma / 8.0) as usize;
    if block >= 2 && width >= 2 * block && height >= 2 * block {
        let (columns, rows) = (width / block, height / block);
        let means = means([width, height], values, [columns, rows]);
        // Block means are blurred already, by a box.
        let scale = columns as f32 / width as f32;
        let rest = (sigma * sigma * scale * scale - 1.0 / 12.0).sqrt();
        return mean_square(&blur(&means, columns, rows, rest));
    }
    mean_square(&blur(values, width, height, sigma))
}

/// A picture at another size.
fn means([width, height]: [usize; 2], values: &[f32], [columns, rows]: [usize; 2]) -> Vec<f32> {
    // Pixels of the other per pixel of this: sums become means.
    let area = (columns * rows) as f64 / (width * height) as f64;
    resample(width, height, values, columns, rows).into_iter().map(|sum| (sum * area) as f32).collect()
}

fn mean_square(values: &[f32]) -> f64 {
    values.iter().map(|value| f64::from(*value) * f64::from(*value)).sum::<f64>() / values.len() as f64
}

/// The same of a picture as large as `values`, approximately: what is wide is blurred on a coarser grid, whose cells
/// are at most half of the standard deviation.
pub(crate) fn blurred(values: &[f32], width: usize, height: usize, sigma: f32) -> Vec<f32> {
    let block = (sigma / 2.0) as usize;
    if block < 2 {
        return blur(values, width, height, sigma);
    }
    let (columns, rows) = (width.div_ceil(block), height.div_ceil(block));
    let means = means([width, height], values, [columns, rows]);
    let means = blur(&means, columns, rows, sigma * columns as f32 / width as f32);
    (0..width * height).map(|i| means[i / width * rows / height * columns + i % width * columns / width]).collect()
}

/// A Gaussian blur, cut at three standard deviations; at the borders, of what lies inside.
fn blur(values: &[f32], width: usize, height: usize, sigma: f32) -> Vec<f32> {
    let once = transposed_blur(values, width, sigma);
    transposed_blur(&once, height, sigma)
}

/// Blurs the rows, and gives the columns of the result.
fn transposed_blur(values: &[f32], width: usize, sigma: f32) -> Vec<f32> {
    let radius = libm::ceilf(3.0 * sigma.max(0.0)) as usize;
    let kernel: Vec<f32> = (0..=radius)
        .map(|at| if at == 0 { 1.0 } else { libm::expf(-0.5 * (at as f32 / sigma) * (at as f32 / sigma)) })
        .collect();
    let weights: Vec<f32> = (0..width)
        .map(|x| (x.saturating_sub(radius)..(x + radius + 1).min(width)).map(|at| kernel[at.abs_diff(x)]).sum())
        .collect();
    let height = values.len() / width;
    let blurred: Vec<Vec<f32>> = values
        .par_chunks_exact(width)
        .map(|row| {
            (0..width)
                .map(|x| {
                    let from = x.saturating_sub(radius);
                    let inside = &row[from..(x + radius + 1).min(width)];
                    let sum: f32 = inside.iter().enumerate().map(|(at, v)| v * kernel[(from + at).abs_diff(x)]).sum();
                    sum / weights[x]
                })
                .collect()
        })
        .collect();
    (0..width * height).map(|i| blurred[i % height][i / height]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn a_constant_difference_has_the_same_ratio_at_any_blur() {
        let photo = Photo::from_fn(3, 2, |_, _| [0.5, 0.5, 0.5]);
        let drawn = RgbImage::from_pixel(60, 40, Rgb([153; 3]));
        for sigma in [0.0, 1.0, 7.5] {
            let ratio = blurred_psnr(&drawn, &photo, sigma, false, true);
            assert!((ratio - 20.0).abs() < 1e-3, "{ratio}");
        }
        let light = decode(0.6) - decode(0.5);
        let ratio = blurred_psnr(&drawn, &photo, 2.0, true, false);
        assert!((ratio + 20.0 * f64::from(light).log10()).abs() < 1e-3);
    }

    #[test]
    fn blurring_blocks_is_blurring_pixels() {
        let (width, height) = (150, 101);
        let values: Vec<f32> =
            (0..width * height).map(|i| ((i * 7919 % 104_729) as f32 / 104_729.0 - 0.5) * (i % 150) as f32).collect();
        let exact = mean_square(&blur(&values, width, height, 17.0));
        let blocks = blurred_squares(&values, width, height, 17.0);
        assert!((blocks / exact - 1.0).abs() < 0.03, "{blocks} {exact}");
    }

    #[test]
    fn a_wide_blur_is_nearly_the_same_on_a_coarse_grid() {
        let (width, height) = (150, 101);
        let values: Vec<f32> = (0..width * height).map(|i| if i % 150 < 60 { 1.0 } else { 0.0 }).collect();
        let (exact, fast) = (blur(&values, width, height, 9.0), blurred(&values, width, height, 9.0));
        assert!(exact.iter().zip(&fast).all(|(a, b)| (a - b).abs() < 0.12));
        let difference: f32 = exact.iter().zip(&fast).map(|(a, b)| a - b).sum();
        assert!((difference / values.len() as f32).abs() < 1e-2, "{difference}");
    }

    #[test]
    fn blurring_keeps_sums_and_spreads_as_far_as_it_says() {
        let (width, height) = (41, 31);
        let mut values = vec![0.0; width * height];
        values[15 * width + 20] = 1.0;
        let blurred = blur(&values, width, height, 2.5);
        let sum: f32 = blurred.iter().sum();
        let variance: f32 = blurred.iter().enumerate().map(|(i, v)| v * ((i % width) as f32 - 20.0).powi(2)).sum();
        assert!((sum - 1.0).abs() < 1e-5 && (variance - 6.25).abs() < 0.25, "{sum} {variance}");
    }
}
