//! Pictures as input.

use super::colour::encode;
use crate::error::{Error, Result};
use image::DynamicImage;
use std::path::Path;

/// Larger pictures are reduced to about this many pixels when they are read: more than any number of dots can show.
const MAX_PIXELS: u64 = 8_000_000;

/// A picture in colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Photo {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue, sRGB-encoded, 0 to 1, row after row from the top; `width * height` of them.
    pub pixels: Vec<[f32; 3]>,
}

impl Photo {
    /// Reads a PNG, JPEG or OpenEXR picture; its content counts, not its name.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] if it cannot be read, [`Error::Input`] if it is none of these, damaged, or holds values that are
    /// not finite.
    pub fn read(path: &Path) -> Result<Photo> {
        Photo::new(&crate::read::image(path)?).map_err(|why| Error::Input(format!("{}: {why}", path.display())))
    }

    /// Takes over a decoded picture: transparent parts show white paper, light beyond 1 (OpenEXR) is clamped.
    ///
    /// # Errors
    ///
    /// [`Error::Input`] if it has no pixels or a value is not finite.
    pub fn new(image: &DynamicImage) -> Result<Photo> {
        let (width, height) = (image.width(), image.height());
        if width == 0 || height == 0 {
            return Err(Error::input("the picture has no pixels"));
        }
        let pixels = u64::from(width) * u64::from(height);
        if pixels > MAX_PIXELS {
            let scale = (MAX_PIXELS as f64 / pixels as f64).sqrt();
            let side = |length: u32| ((f64::from(length) * scale) as u32).max(1);
            return Photo::new(&image.thumbnail_exact(side(width), side(height)));
        }
        let linear = matches!(image, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
        let rgba = image.to_rgba32f();
        let mut pixels = Vec::with_capacity(pixels as usize);
        for (x, y, pixel) in rgba.enumerate_pixels() {
            if !pixel.0.iter().all(|value| value.is_finite()) {
                return Err(Error::Input(format!("the pixel at column {x}, row {y} is {:?}, not finite", pixel.0)));
            }
            let [red, green, blue, alpha] = pixel.0.map(|value| value.clamp(0.0, 1.0));
            pixels.push([red, green, blue].map(|value| {
                let value = value * alpha + (1.0 - alpha);
                if linear { encode(value) } else { value }
            }));
        }
        Ok(Photo { width: width as usize, height: height as usize, pixels })
    }

    /// A picture from a function of column and row.
    pub fn from_fn(width: usize, height: usize, mut pixel: impl FnMut(usize, usize) -> [f32; 3]) -> Photo {
        let pixels = (0..width * height).map(|i| pixel(i % width, i / width)).collect();
        Photo { width, height, pixels }
    }

    /// Width and height in units of the longer side.
    pub fn extent(&self) -> [f32; 2] {
        let longer = self.width.max(self.height) as f32;
        [self.width as f32 / longer, self.height as f32 / longer]
    }
}
