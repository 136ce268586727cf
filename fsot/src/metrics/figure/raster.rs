//! A sheet as pixels.

use super::sheet::{Anchor, Colour, Element, Sheet};
use crate::error::Result;
use crate::picture;
use font8x8::UnicodeFonts;
use image::{Rgb, RgbImage};

/// Letters of 8 by 8 cells: width and height of a cell in pixels.
const CELL: [u32; 2] = [1, 2];

impl Sheet {
    /// The sheet as a PNG file.
    pub fn png(&self) -> Result<Vec<u8>> {
        let mut image = RgbImage::from_pixel(self.width, self.height, Rgb([255; 3]));
        for element in &self.elements {
            match element {
                Element::Line { points, colour, width } => {
                    points.windows(2).for_each(|ends| segment(&mut image, ends[0], ends[1], *colour, *width));
                }
                Element::Text { at, anchor, text, colour } => words(&mut image, *at, *anchor, text, *colour),
                Element::Picture { at, size, side, grey } => grey_picture(&mut image, *at, *size, *side, grey),
            }
        }
        picture::png(&image)
    }
}

/// Covers a pixel by its distance to the segment.
fn segment(image: &mut RgbImage, [ax, ay]: [f64; 2], [bx, by]: [f64; 2], colour: Colour, width: f64) {
    let reach = width / 2.0 + 1.0;
    let span = |a: f64, b: f64, limit: u32| {
        let (low, high) = (a.min(b) - reach, a.max(b) + reach);
        (low.max(0.0) as u32)..(high.clamp(0.0, f64::from(limit)) as u32)
    };
    let length = (bx - ax) * (bx - ax) + (by - ay) * (by - ay);
    for py in span(ay, by, image.height()) {
        for px in span(ax, bx, image.width()) {
            let (x, y) = (f64::from(px) + 0.5 - ax, f64::from(py) + 0.5 - ay);
            let along = if length > 0.0 { ((x * (bx - ax) + y * (by - ay)) / length).clamp(0.0, 1.0) } else { 0.0 };
            let (x, y) = (x - along * (bx - ax), y - along * (by - ay));
            let coverage = (width / 2.0 + 0.5 - (x * x + y * y).sqrt()).clamp(0.0, 1.0);
            blend(image.get_pixel_mut(px, py), colour, coverage);
        }
    }
}

fn blend(pixel: &mut Rgb<u8>, colour: Colour, coverage: f64) {
    for (old, new) in pixel.0.iter_mut().zip(colour) {
        *old = (f64::from(*old) + coverage * (f64::from(new) - f64::from(*old))).round() as u8;
    }
}

fn words(image: &mut RgbImage, at: [f64; 2], anchor: Anchor, text: &str, colour: Colour) {
    let width = f64::from(8 * CELL[0]) * text.chars().count() as f64;
    let left = match anchor {
        Anchor::Start => at[0],
        Anchor::Middle => at[0] - width / 2.0,
        Anchor::End => at[0] - width,
    };
    // The last row of cells is below the base line.
    let top = at[1] - f64::from(7 * CELL[1]);
    let mut put = |x: f64, y: f64| {
        if x >= 0.0 && y >= 0.0 && x < f64::from(image.width()) && y < f64::from(image.height()) {
            image.put_pixel(x as u32, y as u32, Rgb(colour));
        }
    };
    for (index, letter) in text.chars().enumerate() {
        let glyph = font8x8::BASIC_FONTS.get(letter).unwrap_or([0, 0x7e, 0x42, 0x42, 0x42, 0x42, 0x7e, 0]);
        for (row, bits) in glyph.iter().enumerate() {
            for column in (0..8).filter(|column| bits >> column & 1 == 1) {
                for (dx, dy) in (0..CELL[1]).flat_map(|dy| (0..CELL[0]).map(move |dx| (dx, dy))) {
                    let x = left.round() + (index * 8 + column) as f64 * f64::from(CELL[0]) + f64::from(dx);
                    put(x, top.round() + row as f64 * f64::from(CELL[1]) + f64::from(dy));
                }
            }
        }
    }
}

/// Every pixel the mean of the cells it covers, or the cell that it is in.
fn grey_picture(image: &mut RgbImage, at: [f64; 2], size: f64, side: usize, grey: &[u8]) {
    let scale = side as f64 / size;
    let range = |pixel: u32| {
        let from = (f64::from(pixel) * scale) as usize;
        let to = ((f64::from(pixel) + 1.0) * scale) as usize;
        from.min(side - 1)..to.clamp(from + 1, side.max(from + 1)).min(side)
    };
    for py in 0..size as u32 {
        for px in 0..size as u32 {
            let (mut sum, mut count) = (0_u32, 0);
            for y in range(py) {
                for x in range(px) {
                    sum += u32::from(grey[y * side + x]);
                    count += 1;
                }
            }
            image.put_pixel(at[0] as u32 + px, at[1] as u32 + py, Rgb([(sum / count.max(1)) as u8; 3]));
        }
    }
}
