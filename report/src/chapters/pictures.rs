//! Contact sheets, small enough to be committed.

use crate::measure::output::Output;
use anyhow::{Context, Result, bail};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, RgbImage};

/// Bytes of a picture at most.
const LIMIT: usize = 600_000;

/// Writes a PNG of at most [`LIMIT`] bytes: shades are merged, two by two, until it is as small.
pub(crate) fn write_small(output: &Output, name: &str, picture: &RgbImage) -> Result<()> {
    for bits in 0..4 {
        let bytes = encode(&merged(picture, bits)).with_context(|| format!("cannot encode {name}"))?;
        if bytes.len() <= LIMIT {
            return output.write_bytes(name, &bytes);
        }
    }
    bail!("{name} is larger than {LIMIT} bytes, even with 16 shades of a colour")
}

/// Without the lowest `bits` bits, each merged group of shades shown as its middle.
fn merged(picture: &RgbImage, bits: u32) -> RgbImage {
    let mut picture = picture.clone();
    if bits > 0 {
        for value in picture.iter_mut() {
            *value = (*value >> bits << bits) | (1 << (bits - 1));
        }
    }
    picture
}

fn encode(picture: &RgbImage) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::Adaptive);
    encoder.write_image(picture, picture.width(), picture.height(), ExtendedColorType::Rgb8)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn merged_shades_are_close_and_few() {
        let picture = RgbImage::from_fn(256, 1, |x, _| Rgb([x as u8; 3]));
        let merged = merged(&picture, 3);
        let shades: std::collections::BTreeSet<u8> = merged.iter().copied().collect();
        assert_eq!(shades.len(), 32);
        assert!(picture.iter().zip(merged.iter()).all(|(a, b)| a.abs_diff(*b) <= 4));
    }
}
