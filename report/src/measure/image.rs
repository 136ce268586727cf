//! Linear images: read from PFM, compared, shown as sRGB.

use crate::chapters::statistics::percentile;
use anyhow::{Context, Result, bail};
use image::{Rgb, Rgb32FImage, RgbImage};
use std::fs;
use std::path::Path;

/// Reads the path tracer's images: little-endian PFM with rows from the bottom up.
pub(crate) fn read_pfm(path: &Path) -> Result<Rgb32FImage> {
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    parse_pfm(&bytes).with_context(|| format!("{} is not the image that was expected", path.display()))
}

fn parse_pfm(bytes: &[u8]) -> Result<Rgb32FImage> {
    let parts: Vec<&[u8]> = bytes.splitn(4, |&byte| byte == b'\n').collect();
    let [b"PF", size, scale, data] = parts[..] else { bail!("not a colour PFM file") };
    let (width, height) = str::from_utf8(size)?.split_once(' ').context("no size")?;
    let (width, height): (u32, u32) = (width.parse()?, height.parse()?);
    if data.len() as u64 != u64::from(width) * u64::from(height) * 12 {
        bail!("{} bytes of data for {width}x{height} pixels", data.len());
    }
    // The sign of the scale tells the order of the bytes.
    let read = if str::from_utf8(scale)?.parse::<f32>()? < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    let values: Vec<f32> = data.as_chunks().0.iter().map(|&bytes| read(bytes)).collect();
    if let Some(value) = values.iter().find(|value| !value.is_finite()) {
        bail!("it contains {value}");
    }
    let image = Rgb32FImage::from_raw(width, height, values).context("wrong size")?;
    Ok(image::imageops::flip_vertical(&image))
}

/// Rec. 709 luminance.
pub(crate) fn luminance(pixel: &Rgb<f32>) -> f64 {
    let [r, g, b] = pixel.0.map(f64::from);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Brightness at which a scene is shown: the 90th percentile of the reference's luminance becomes 0.7.
pub(crate) fn exposure(reference: &Rgb32FImage) -> f32 {
    let bright = percentile(reference.pixels().map(luminance), 90);
    if bright > 0.0 { (0.7 / bright) as f32 } else { 1.0 }
}

/// Exposed, clamped and sRGB-encoded (IEC 61966-2-1).
pub(crate) fn tone_map(image: &Rgb32FImage, exposure: f32) -> RgbImage {
    RgbImage::from_fn(image.width(), image.height(), |x, y| {
        Rgb(image.get_pixel(x, y).0.map(|value| {
            let linear = (value * exposure).clamp(0.0, 1.0);
            let encoded = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
            (encoded * 255.0).round() as u8
        }))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pfm_rows_run_from_the_bottom_up() {
        let mut bytes = b"PF\n1 2\n-1.0\n".to_vec();
        for value in [1.0_f32, 2.0, 3.0, 4.0, 5.0, 6.0] {
            bytes.extend(value.to_le_bytes());
        }
        let image = parse_pfm(&bytes).expect("a valid file");
        assert_eq!(image.get_pixel(0, 1).0, [1.0, 2.0, 3.0]);
        assert_eq!(image.get_pixel(0, 0).0, [4.0, 5.0, 6.0]);
        bytes.pop();
        assert!(parse_pfm(&bytes).is_err());
        assert!(parse_pfm(b"").is_err());
    }

    #[test]
    fn a_nan_is_refused() {
        let mut bytes = b"PF\n1 1\n-1.0\n".to_vec();
        for value in [1.0_f32, f32::NAN, 3.0] {
            bytes.extend(value.to_le_bytes());
        }
        assert!(parse_pfm(&bytes).is_err());
    }
}
