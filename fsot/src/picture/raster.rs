//! Drawing to pixels.

use super::colour::{decode, encode};
use super::drawing::{Blend, Drawing, Shape};
use crate::error::{Error, Result};
use crate::memory;
use image::{ExtendedColorType, ImageEncoder, Rgb, RgbImage};
use rayon::prelude::*;

/// Lines per row of pixels on which a shape's extent is taken; along a line coverage is exact.
const LINES: usize = 16;
/// Rows that one thread draws at a time.
const BAND: usize = 32;
/// The most pixels of a picture.
const MAX_PIXELS: f64 = 4e8;
/// The memory of a pixel: drawn, in a file or as grey, expected in double precision, its difference, and two of that
/// blurred.
const PIXEL: u64 = 3 + 3 + 8 + 3 * 4;

/// The pixels of a drawing of this size at `scale` pixels per unit, if there is memory to draw them and to say
/// [how alike](super::blurred_psnr) the drawing and its source are.
///
/// # Errors
///
/// [`Error::Input`] if the picture would have no pixels or more than 400 million, or need more memory than
/// [`memory::MOST`] or than the system gives.
pub fn check_size(size: [f32; 2], scale: f32) -> Result<(usize, usize)> {
    let [width, height] = size.map(|side| (f64::from(side) * f64::from(scale)).round().max(1.0));
    let drawable = width * height <= MAX_PIXELS && scale > 0.0;
    if !drawable {
        return Err(Error::Input(format!(
            "a picture of {width} x {height} pixels cannot be drawn: choose a size of at most 400 million pixels"
        )));
    }
    memory::check((width * height) as u64 * PIXEL).map_err(|_| {
        Error::Input(format!(
            "a picture of {width} x {height} pixels needs more memory than there is: choose a smaller size"
        ))
    })?;
    Ok((width as usize, height as usize))
}

/// Draws with anti-aliased edges, at `scale` pixels per unit.
///
/// # Errors
///
/// As [`check_size`].
pub fn rasterise(drawing: &Drawing, scale: f32) -> Result<RgbImage> {
    let (width, height) = check_size(drawing.size, scale)?;
    let value = |colour: u8| if drawing.linear { decode(f32::from(colour) / 255.0) } else { f32::from(colour) / 255.0 };
    let bands = reaching(drawing, scale, height.div_ceil(BAND));
    let mut bytes = vec![0_u8; width * height * 3];
    bytes.par_chunks_mut(width * BAND * 3).zip(bands).enumerate().for_each(|(band, (bytes, marks))| {
        let first = band * BAND;
        let mut pixels = vec![drawing.paper.map(value); bytes.len() / 3];
        let mut coverage = vec![0.0_f32; width + 1];
        for mark in marks {
            let mark = &drawing.marks[mark as usize];
            let colour = mark.colour.map(value);
            let [_, top, _, bottom] = bounds(&mark.shape).map(|at| at * scale);
            let rows = (top.max(first as f32) as usize).max(first)..(bottom.ceil().max(0.0) as usize);
            for row in rows.start..rows.end.min(first + pixels.len() / width) {
                let touched = cover(&mark.shape, scale, row, &mut coverage[..width]);
                let row = &mut pixels[(row - first) * width..(row - first + 1) * width];
                for (pixel, covered) in row[touched.clone()].iter_mut().zip(&mut coverage[touched]) {
                    let covered = std::mem::take(covered);
                    for (value, ink) in pixel.iter_mut().zip(colour) {
                        match drawing.blend {
                            Blend::Over => *value += covered * (ink - *value),
                            Blend::Multiply => *value *= 1.0 - covered * (1.0 - ink),
                        }
                    }
                }
            }
        }
        for (byte, value) in bytes.iter_mut().zip(pixels.as_flattened()) {
            let value = if drawing.linear { encode(*value) } else { *value };
            *byte = (value * 255.0 + 0.5) as u8;
        }
    });
    RgbImage::from_raw(width as u32, height as u32, bytes).ok_or_else(|| Error::input("the picture is too large"))
}

/// The content of a PNG file, of one channel if there are no colours.
///
/// # Errors
///
/// [`Error::Input`] if it cannot be encoded.
pub fn png(image: &RgbImage) -> Result<Vec<u8>> {
    let is_grey = image.pixels().all(|Rgb([red, green, blue])| red == green && green == blue);
    let grey: Vec<u8> = if is_grey { image.pixels().map(|pixel| pixel[0]).collect() } else { Vec::new() };
    let (pixels, colour) =
        if is_grey { (&grey, ExtendedColorType::L8) } else { (image.as_raw(), ExtendedColorType::Rgb8) };
    let mut bytes = Vec::new();
    image::codecs::png::PngEncoder::new(&mut bytes)
        .write_image(pixels, image.width(), image.height(), colour)
        .map_err(|error| Error::Input(format!("the picture cannot be encoded as PNG: {error}")))?;
    Ok(bytes)
}

/// For every band of rows, the marks that reach it, in their order.
fn reaching(drawing: &Drawing, scale: f32, bands: usize) -> Vec<Vec<u32>> {
    let mut reaching = vec![Vec::new(); bands];
    for (index, mark) in drawing.marks.iter().enumerate() {
        let [left, top, right, bottom] = bounds(&mark.shape).map(|at| at * scale);
        if ![left, top, right, bottom].iter().all(|at| at.is_finite()) || bottom < 0.0 {
            continue;
        }
        let from = (top.max(0.0) as usize / BAND).min(bands);
        let to = (bottom as usize / BAND + 1).min(bands);
        reaching[from..to.max(from)].iter_mut().for_each(|band| band.push(index as u32));
    }
    reaching
}

/// Left, top, right, bottom.
fn bounds(shape: &Shape) -> [f32; 4] {
    match shape {
        Shape::Disc { centre: [x, y], radius } => [x - radius, y - radius, x + radius, y + radius],
        Shape::Polygon(corners) => {
            corners.iter().fold([f32::INFINITY, f32::INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY], |all, [x, y]| {
                [all[0].min(*x), all[1].min(*y), all[2].max(*x), all[3].max(*y)]
            })
        }
    }
}

/// Where a horizontal line enters and leaves a shape.
fn crossing(shape: &Shape, line: f32) -> Option<(f32, f32)> {
    match shape {
        Shape::Disc { centre: [x, y], radius } => {
            let squared = radius * radius - (line - y) * (line - y);
            (squared > 0.0).then(|| (x - squared.sqrt(), x + squared.sqrt()))
        }
        Shape::Polygon(corners) => {
            let mut span: Option<(f32, f32)> = None;
            for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                if (a[1] <= line) == (b[1] <= line) {
                    continue;
                }
                let x = a[0] + (b[0] - a[0]) * ((line - a[1]) / (b[1] - a[1]));
                span = Some(span.map_or((x, x), |(left, right)| (left.min(x), right.max(x))));
            }
            span
        }
    }
}

/// Adds the covered part of each pixel of a row; returns the pixels that were touched.
fn cover(shape: &Shape, scale: f32, row: usize, coverage: &mut [f32]) -> std::ops::Range<usize> {
    let width = coverage.len() as f32;
    let (mut first, mut end) = (coverage.len(), 0);
    for line in 0..LINES {
        let y = row as f32 + (line as f32 + 0.5) / LINES as f32;
        let Some((left, right)) = crossing(shape, y / scale) else { continue };
        let (left, right) = ((left * scale).clamp(0.0, width), (right * scale).clamp(0.0, width));
        if right <= left {
            continue;
        }
        let (from, to) = (left as usize, (right.ceil() as usize).min(coverage.len()));
        for (pixel, covered) in coverage[from..to].iter_mut().enumerate() {
            let begin = (from + pixel) as f32;
            *covered += (right.min(begin + 1.0) - left.max(begin)) / LINES as f32;
        }
        (first, end) = (first.min(from), end.max(to));
    }
    first.min(end)..end
}

#[cfg(test)]
mod tests {
    use super::super::Mark;
    use super::*;

    fn darkness(image: &RgbImage) -> f64 {
        image.pixels().map(|pixel| 1.0 - f64::from(pixel.0[0]) / 255.0).sum()
    }

    #[test]
    fn areas_are_drawn_right_wherever_a_disc_lies() {
        for k in 0..50 {
            let centre = [10.0 + k as f32 * 0.137, 9.0 + k as f32 * 0.271];
            for radius in [0.6, 1.3, 4.2] {
                let mut drawing = Drawing::new([40.0, 40.0]);
                drawing.dots([&centre[..]], radius, super::super::BLACK);
                let area = std::f64::consts::PI * f64::from(radius).powi(2);
                let drawn = darkness(&rasterise(&drawing, 1.0).unwrap());
                assert!((drawn / area - 1.0).abs() < 0.02, "{centre:?} {radius}: {drawn} of {area}");
            }
        }
    }

    #[test]
    fn polygons_are_filled() {
        let mut drawing = Drawing::new([10.0, 10.0]);
        let corners = vec![[1.25, 1.0], [8.25, 1.0], [1.25, 9.0]];
        drawing.marks.push(Mark { shape: Shape::Polygon(corners), colour: [0; 3] });
        let drawn = darkness(&rasterise(&drawing, 3.0).unwrap()) / 9.0;
        assert!((drawn - 28.0).abs() < 0.1, "{drawn}");
    }

    #[test]
    fn inks_multiply_and_paint_hides() {
        let mut drawing = Drawing::new([2.0, 2.0]);
        drawing.dots([&[1.0, 1.0][..]], 5.0, [0, 255, 255]);
        drawing.dots([&[1.0, 1.0][..]], 5.0, [255, 0, 255]);
        assert_eq!(rasterise(&drawing, 1.0).unwrap().get_pixel(0, 0).0, [255, 0, 255]);
        drawing.blend = Blend::Multiply;
        assert_eq!(rasterise(&drawing, 1.0).unwrap().get_pixel(0, 0).0, [0, 0, 255]);
    }

    #[test]
    fn half_covered_pixels_are_means_of_values_or_of_light() {
        let mut drawing = Drawing::new([1.0, 1.0]);
        let half = Shape::Polygon(vec![[0.0, 0.0], [0.5, 0.0], [0.5, 1.0], [0.0, 1.0]]);
        drawing.marks.push(Mark { shape: half, colour: [0; 3] });
        assert_eq!(rasterise(&drawing, 1.0).unwrap().get_pixel(0, 0).0, [128; 3]);
        drawing.linear = true;
        assert_eq!(rasterise(&drawing, 1.0).unwrap().get_pixel(0, 0).0, [188; 3]);
    }

    #[test]
    fn shapes_outside_and_bands_below_are_no_trouble() {
        let mut drawing = Drawing::new([5.0, 100.0]);
        drawing.dots([&[-9.0, -9.0][..], &[2.0, 32.0], &[2.0, 150.0], &[f32::NAN, 1.0]], 1.0, [0; 3]);
        let drawn = darkness(&rasterise(&drawing, 1.0).unwrap());
        assert!((drawn - std::f64::consts::PI).abs() < 0.05, "{drawn}");
        assert!(matches!(rasterise(&Drawing::new([1e9, 1e9]), 1.0), Err(Error::Input(_))));
    }
}
