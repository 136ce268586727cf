//! Pictures as input.

use super::colour::encode;
use super::resample::resample;
use crate::error::{Error, Result};
use image::{DynamicImage, GenericImageView, Rgba, Rgba32FImage};

/// Larger pictures are reduced to about this many pixels when they are read: more than any number of dots can show.
const MAX_PIXELS: f64 = 8e6;

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
        let linear = is_linear(image);
        let opaque = || !image.color().has_alpha() || image.pixels().all(|(.., Rgba([.., alpha]))| alpha == 255);
        if let Some([width, height]) = reduced(width, height).filter(|_| !linear && opaque()) {
            return Photo::new(&image.thumbnail_exact(width, height));
        }
        let rgba = over_white(image)?;
        // Not the image crate's: of floats its means are too large.
        let [columns, rows] = reduced(width, height).unwrap_or([width, height]).map(|length| length as usize);
        let (width, height) = (width as usize, height as usize);
        let cell = (width * height) as f64 / (columns * rows) as f64;
        let mut pixels = vec![[0.0; 3]; columns * rows];
        for channel in 0..3 {
            let values: Vec<f32> = rgba.pixels().map(|pixel| pixel[channel]).collect();
            for (pixel, sum) in pixels.iter_mut().zip(resample(width, height, &values, columns, rows)) {
                let value = (sum / cell) as f32;
                pixel[channel] = if linear { encode(value.clamp(0.0, 1.0)) } else { value };
            }
        }
        Ok(Photo { width: columns, height: rows, pixels })
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

/// Whether a picture's values are light, and already multiplied by alpha: those of OpenEXR are.
pub(crate) fn is_linear(image: &DynamicImage) -> bool {
    matches!(image, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_))
}

/// Of a picture with too many pixels, the sides to reduce it to.
fn reduced(width: u32, height: u32) -> Option<[u32; 2]> {
    let scale = (MAX_PIXELS / (f64::from(width) * f64::from(height))).sqrt();
    (scale < 1.0).then(|| [width, height].map(|length| ((f64::from(length) * scale) as u32).max(1)))
}

/// A picture on white paper.
fn over_white(image: &DynamicImage) -> Result<Rgba32FImage> {
    let mut rgba = image.to_rgba32f();
    for (x, y, Rgba(pixel)) in rgba.enumerate_pixels_mut() {
        if !pixel.iter().all(|value| value.is_finite()) {
            return Err(Error::Input(format!("the pixel at column {x}, row {y} is {pixel:?}, not finite")));
        }
        let alpha = pixel[3].clamp(0.0, 1.0);
        let part = if is_linear(image) { 1.0 } else { alpha };
        *pixel = pixel.map(|value| value * part + (1.0 - alpha));
    }
    Ok(rgba)
}
