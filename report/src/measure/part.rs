//! A part of the images, enlarged: as it looks, and how it errs.

use crate::chapters::statistics::percentile;
use crate::measure::image::{exposure, tone_map};
use crate::measure::metric::Reference;
use image::imageops::{FilterType, crop_imm, resize};
use image::{Rgb, Rgb32FImage, RgbImage};

/// The part of the images that is shown, each pixel as a square of `zoom` pixels.
pub(crate) struct Part<'a> {
    reference: &'a Reference,
    x: u32,
    y: u32,
    width: u32,
    height: u32,
    zoom: u32,
    exposure: f32,
}

impl<'a> Part<'a> {
    /// `width` x `height` pixels; `x` and `y` say where they begin, in images.
    pub(crate) fn new([x, y]: [f64; 2], [width, height]: [u32; 2], zoom: u32, reference: &'a Reference) -> Self {
        let [whole_width, whole_height] = [reference.image.width(), reference.image.height()];
        let (width, height) = (width.min(whole_width), height.min(whole_height));
        let corner = |at: f64, whole: u32, size: u32| ((at * f64::from(whole)) as u32).min(whole - size);
        let (x, y) = (corner(x, whole_width, width), corner(y, whole_height, height));
        Self { reference, x, y, width, height, zoom, exposure: exposure(&reference.image) }
    }

    fn enlarge(&self, image: &RgbImage) -> RgbImage {
        resize(image, image.width() * self.zoom, image.height() * self.zoom, FilterType::Nearest)
    }

    pub(crate) fn image(&self, image: &Rgb32FImage) -> RgbImage {
        let cut = crop_imm(image, self.x, self.y, self.width, self.height).to_image();
        self.enlarge(&tone_map(&cut, self.exposure))
    }

    /// The part's own errors, row after row.
    fn values(&self, image: &Rgb32FImage) -> Vec<f64> {
        let (errors, whole) = (self.reference.signed_errors(image), image.width() as usize);
        let [x, y, width, height] = [self.x, self.y, self.width, self.height].map(|value| value as usize);
        errors.chunks(whole.max(1)).skip(y).take(height).flat_map(|row| row[x..x + width].iter().copied()).collect()
    }

    /// The 95th percentile of the errors' sizes.
    pub(crate) fn error_scale(&self, image: &Rgb32FImage) -> f64 {
        let scale = percentile(self.values(image).into_iter().map(f64::abs), 95);
        if scale > 0.0 { scale } else { 1.0 }
    }

    /// Signed errors in greys, from -`scale` to `scale`.
    pub(crate) fn errors(&self, image: &Rgb32FImage, scale: f64) -> RgbImage {
        let errors = self.values(image);
        let grey = |x: u32, y: u32| {
            let error = errors[(y * self.width + x) as usize];
            (127.5 * (1.0 + (error / scale).clamp(-1.0, 1.0))).round() as u8
        };
        self.enlarge(&RgbImage::from_fn(self.width, self.height, |x, y| Rgb([grey(x, y); 3])))
    }
}
