//! What the eye does to an image: a Gaussian.

/// Standard deviation of the Gaussian, in pixels.
pub(crate) const SIGMA: f64 = 2.1;

/// Filters an image of rows of `width` values. Near the border the kernel's part that is inside is normalised.
pub(crate) fn gaussian(values: &[f64], width: usize) -> Vec<f64> {
    let height = values.len() / width.max(1);
    let rows = along(values, width, height, 1, width);
    along(&rows, height, width, width, 1)
}

/// Filters `lines` lines of `length` values; neighbours in a line are `step` apart, lines `stride`.
fn along(values: &[f64], length: usize, lines: usize, step: usize, stride: usize) -> Vec<f64> {
    let radius = (4.0 * SIGMA).ceil() as usize;
    let kernel: Vec<f64> = (0..=radius).map(|r| (-0.5 * (r as f64 / SIGMA).powi(2)).exp()).collect();
    let mut filtered = vec![0.0; values.len()];
    for i in 0..length {
        let window = i.saturating_sub(radius)..(i + radius + 1).min(length);
        let total: f64 = window.clone().map(|j| kernel[i.abs_diff(j)]).sum();
        for line in 0..lines {
            let sum: f64 = window.clone().map(|j| kernel[i.abs_diff(j)] * values[line * stride + j * step]).sum();
            filtered[line * stride + i * step] = sum / total;
        }
    }
    filtered
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_stays_and_a_point_becomes_the_kernel() {
        let (width, height) = (50, 40);
        assert!(gaussian(&vec![2.0; width * height], width).iter().all(|value| (value - 2.0).abs() < 1e-12));
        let mut point = vec![0.0; width * height];
        point[20 * width + 25] = 1.0;
        let filtered = gaussian(&point, width);
        let ratio = (-0.5 * (13.0 / SIGMA.powi(2))).exp();
        assert!((filtered[22 * width + 28] / filtered[20 * width + 25] - ratio).abs() < 1e-12);
        assert!((filtered.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        // Of white noise, 1 / (4 pi sigma^2) of the energy passes.
        let energy: f64 = filtered.iter().map(|value| value * value).sum();
        assert!((energy * 4.0 * std::f64::consts::PI * SIGMA * SIGMA - 1.0).abs() < 1e-3);
    }
}
