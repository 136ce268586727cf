//! The contact sheet: every scene in a few ways.

use super::measure::{Measured, Points, find};
use crate::measure::image::{exposure, tone_map};
use crate::measure::output::Output;
use crate::measure::text;
use crate::report::pictures::write_small;
use anyhow::Result;
use image::imageops::{FilterType, replace, resize};
use image::{Rgb, RgbImage};

const GAP: u32 = 6;
/// Pixels of a picture on a side.
const SIZE: u32 = 128;
const BACKGROUND: Rgb<u8> = Rgb([24, 24, 28]);

/// Samples per pixel, points and estimator of each column.
const COLUMNS: [(u32, Points, &str); 6] = [
    (4, Points::Random, "mc"),
    (4, Points::Tile, "mc"),
    (4, Points::Tile, "shared"),
    (16, Points::Random, "mc"),
    (16, Points::Random, "robust"),
    (16, Points::Random, "shared"),
];

pub(super) fn write(output: &Output, all: &[Measured]) -> Result<()> {
    let step = SIZE + GAP;
    let (columns, rows) = (COLUMNS.len() as u32 + 1, all.len() as u32);
    let top = 2 * text::LINE;
    let mut sheet = RgbImage::from_pixel(GAP + columns * step, top + rows * step, BACKGROUND);
    for (column, (spp, points, estimator)) in COLUMNS.iter().enumerate() {
        let x = GAP + column as u32 * step;
        text::draw(&mut sheet, x, 0, &format!("{spp} {}", points.name()));
        text::draw(&mut sheet, x, text::LINE, estimator);
    }
    text::draw(&mut sheet, GAP + (columns - 1) * step, text::LINE, "exact");
    for (row, one) in all.iter().enumerate() {
        let y = top + row as u32 * step;
        let brightness = exposure(&one.reference.image);
        let ways = COLUMNS.iter().map(|&(spp, points, name)| Ok(&find(&one.all, spp, points, name)?.image));
        let images = ways.collect::<Result<Vec<_>>>()?;
        for (column, image) in images.into_iter().chain([&one.reference.image]).enumerate() {
            let x = GAP + column as u32 * step;
            // Enlarged, pixels are squares: the noise stays what it is.
            let picture = resize(&tone_map(image, brightness), SIZE, SIZE, FilterType::Nearest);
            replace(&mut sheet, &picture, i64::from(x), i64::from(y));
        }
    }
    write_small(output, "povray.png", &sheet)
}
