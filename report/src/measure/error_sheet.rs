//! The comparison picture: every estimator's image beside the others', its error map beneath it.

use crate::measure::image::{exposure, tone_map};
use crate::measure::metric::Reference;
use crate::measure::text;
use colorous::INFERNO;
use image::imageops::{FilterType, replace, resize};
use image::{Rgb, Rgb32FImage, RgbImage};

/// One estimator's images: the same scene at two numbers of samples.
pub(crate) struct Column {
    pub(crate) title: String,
    /// (image, caption), one per row.
    pub(crate) cells: Vec<(Rgb32FImage, String)>,
}

const GAP: u32 = 8;
const BACKGROUND: Rgb<u8> = Rgb([24, 24, 28]);

/// `rows` names the rows of `Column::cells`; the first column's errors set the scale of all error maps.
pub(crate) fn draw(title: &str, rows: &[String], columns: &[Column], reference: &Reference) -> RgbImage {
    let (width, height) = reference.image.dimensions();
    // Pixels are shown as squares, so that the noise stays what it is.
    let zoom = (256 / width.max(1)).max(1);
    let (width, height) = (width * zoom, height * zoom);
    let top = GAP + 2 * text::LINE;
    let row_height = 2 * (height + text::LINE) + 2 * GAP;
    let columns_width = (width + GAP) * (columns.len() as u32 + 1);
    let mut picture =
        RgbImage::from_pixel(GAP + columns_width, top + row_height * rows.len() as u32 + 2 * text::LINE, BACKGROUND);
    text::draw(&mut picture, GAP, GAP / 2, title);

    let brightness = exposure(&reference.image);
    let scale = error_scale(columns, reference);
    let enlarge = |image: &RgbImage| resize(image, width, height, FilterType::Nearest);
    let place = |picture: &mut RgbImage, image: &RgbImage, x: u32, y: u32| {
        replace(picture, &enlarge(image), i64::from(x), i64::from(y));
    };

    for (index, column) in columns.iter().enumerate() {
        let x = GAP + (width + GAP) * index as u32;
        text::draw(&mut picture, x, top - text::LINE, &column.title);
        for (row, (image, caption)) in column.cells.iter().enumerate() {
            let y = top + row_height * row as u32;
            place(&mut picture, &tone_map(image, brightness), x, y);
            place(&mut picture, &false_color(image, reference, scale), x, y + height + GAP / 2);
            text::draw(&mut picture, x, y + 2 * height + GAP / 2, caption);
        }
    }
    let x = GAP + (width + GAP) * columns.len() as u32;
    text::draw(&mut picture, x, top - text::LINE, "reference");
    for (row, name) in rows.iter().enumerate() {
        let y = top + row_height * row as u32;
        place(&mut picture, &tone_map(&reference.image, brightness), x, y);
        text::draw(&mut picture, x, y + height + GAP, name);
    }
    let bar_top = picture.height().saturating_sub(2 * text::LINE - GAP);
    draw_scale(&mut picture, bar_top, scale);
    picture
}

/// The error shown brightest: the 99th percentile in the first column's first row.
fn error_scale(columns: &[Column], reference: &Reference) -> f64 {
    let Some((image, _)) = columns.first().and_then(|column| column.cells.first()) else { return 1.0 };
    let mut errors = reference.error_map(image);
    errors.sort_by(f64::total_cmp);
    errors.get(errors.len() * 99 / 100).copied().filter(|&scale| scale > 0.0).unwrap_or(1.0)
}

fn false_color(image: &Rgb32FImage, reference: &Reference, scale: f64) -> RgbImage {
    let errors = reference.error_map(image);
    let mut picture = RgbImage::new(image.width(), image.height());
    for (pixel, error) in picture.pixels_mut().zip(errors) {
        *pixel = Rgb(INFERNO.eval_continuous((error / scale).min(1.0)).into_array());
    }
    picture
}

fn draw_scale(picture: &mut RgbImage, y: u32, scale: f64) {
    let start = "error |I - R| / sqrt(R^2 + eps), the same scale everywhere:  0 ";
    let bar = 256;
    let left = GAP + text::width(start);
    text::draw(picture, GAP, y, start);
    for x in 0..bar {
        let color = Rgb(INFERNO.eval_continuous(f64::from(x) / f64::from(bar - 1)).into_array());
        for line in 2..text::LINE - 4 {
            if let Some(pixel) = picture.get_pixel_mut_checked(left + x, y + line) {
                *pixel = color;
            }
        }
    }
    text::draw(picture, left + bar + GAP, y, &format!("{scale:.3} and more"));
}
