//! Text in pictures.

use image::{Rgb, RgbImage};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Height of a line, in pixels.
pub(crate) const LINE: u32 = 20;

const SIZE: RasterHeight = RasterHeight::Size16;

/// Draws white text on whatever is there; (x, y) is its top left corner. What would lie outside the picture is cut off.
pub(crate) fn draw(picture: &mut RgbImage, x: u32, y: u32, text: &str) {
    let advance = get_raster_width(FontWeight::Regular, SIZE) as u32;
    for (left, character) in (x..).step_by(advance.max(1) as usize).zip(text.chars()) {
        let Some(glyph) = get_raster(character, FontWeight::Regular, SIZE) else { continue };
        for (row, top) in glyph.rows().zip(y..) {
            for (&coverage, left) in row.iter().zip(left..) {
                if let Some(pixel) = picture.get_pixel_mut_checked(left, top) {
                    *pixel = Rgb(pixel.0.map(|old| old.saturating_add(coverage)));
                }
            }
        }
    }
}
