//! The contact sheet: every scene in a few ways. Each row is named, each column too.

use super::measure::{Measured, Points, find};
use crate::chapters::pictures::write_small;
use crate::measure::image::{exposure, tone_map};
use crate::measure::output::Output;
use crate::measure::text;
use anyhow::Result;
use image::imageops::{FilterType, replace, resize};
use image::{Rgb, RgbImage};

const GAP: u32 = 8;
/// Pixels of a picture on a side, about: each of its pixels becomes a square of whole pixels.
const SIZE: u32 = 144;
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
    let rendered = all.first().map_or(SIZE, |one| one.reference.image.width().max(1));
    let side = (SIZE / rendered).max(1) * rendered;
    let names = all.iter().map(|one| text::width(one.scene.name)).max().unwrap_or(0);
    let (step, left, top) = (side + GAP, 2 * GAP + names, 4 * text::LINE);
    let (columns, rows) = (COLUMNS.len() as u32 + 1, all.len() as u32);
    let mut sheet = RgbImage::from_pixel(left + columns * step, top + rows * step, BACKGROUND);
    text::draw(&mut sheet, GAP, 0, "Rows: scenes. Columns: samples per pixel and where they come from; estimator");
    for (column, (spp, points, estimator)) in COLUMNS.iter().enumerate() {
        let x = left + column as u32 * step;
        text::draw(&mut sheet, x, 2 * text::LINE, &format!("{spp} {}", points.name()));
        text::draw(&mut sheet, x, 3 * text::LINE, estimator);
    }
    text::draw(&mut sheet, left + (columns - 1) * step, 3 * text::LINE, "exact mean");
    for (row, one) in all.iter().enumerate() {
        let y = top + row as u32 * step;
        text::draw(&mut sheet, GAP, y + (side - text::LINE) / 2, one.scene.name);
        let brightness = exposure(&one.reference.image);
        let ways = COLUMNS.iter().map(|&(spp, points, name)| Ok(&find(&one.all, spp, points, name)?.image));
        let images = ways.collect::<Result<Vec<_>>>()?;
        for (column, image) in images.into_iter().chain([&one.reference.image]).enumerate() {
            let x = left + column as u32 * step;
            // Enlarged, pixels are squares: the noise stays what it is.
            let picture = resize(&tone_map(image, brightness), side, side, FilterType::Nearest);
            replace(&mut sheet, &picture, i64::from(x), i64::from(y));
        }
    }
    write_small(output, "povray.png", &sheet)
}
