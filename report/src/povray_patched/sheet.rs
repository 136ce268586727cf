//! The contact sheet: for each scene a picture as a whole, and a part of it as every method makes it, with its errors.
//! Each row is named.

use super::measure::{METHODS, Measured};
use super::scenes::SCENES;
use crate::measure::part::Part;
use crate::measure::text;
use image::imageops::replace;
use image::{Rgb, RgbImage};

const GAP: u32 = 8;
const BACKGROUND: Rgb<u8> = Rgb([24, 24, 28]);
/// Pixels of a picture in a row of an enlarged part, and how much it is enlarged.
const SIDE: u32 = 64;
const ZOOM: u32 = 3;
/// In the order of the columns; `stock` first, whose errors set the scale.
const SHOWN: [&str; 5] = ["stock", "random", "tile", "random, estimate", "tile, estimate"];

pub(crate) fn draw(measured: &Measured, spp: u32) -> RgbImage {
    let cell = SIDE * ZOOM;
    let row_height = 2 * (cell + GAP / 2) + 3 * text::LINE + 2 * GAP;
    let columns = SHOWN.len() as u32 + 1;
    let top = GAP + text::LINE;
    let size = [GAP + (cell + GAP) * columns, top + row_height * SCENES.len() as u32];
    let mut picture = RgbImage::from_pixel(size[0], size[1], BACKGROUND);
    let left = |column: u32| GAP + (cell + GAP) * column;
    let title = format!(
        "POV-Ray's examples, {}: part of the picture, below it its errors, relMSE and filtered relMSE",
        text::samples_per_pixel(spp)
    );
    text::draw(&mut picture, GAP, GAP / 2, &title);
    for (index, scene) in SCENES.iter().enumerate() {
        let y = top + row_height * index as u32 + text::LINE;
        text::draw(&mut picture, GAP, y - text::LINE, &format!("{}: {}", scene.name, scene.description));
        let reference = &measured.references[index];
        let part = Part::new(scene.crop, [SIDE, SIDE], ZOOM, reference);
        let mut scale = None;
        for (column, name) in (0..).zip(SHOWN) {
            let Some(method) = METHODS.iter().position(|method| method.name == name) else { continue };
            let Some(series) = measured.find(index, method, spp) else { continue };
            let scale = *scale.get_or_insert_with(|| part.error_scale(&series.image));
            let x = left(column);
            text::draw(&mut picture, x, y, name);
            replace(&mut picture, &part.image(&series.image), x.into(), (y + text::LINE).into());
            let below = y + text::LINE + cell + GAP / 2;
            replace(&mut picture, &part.errors(&series.image, scale), x.into(), below.into());
            let score = &series.scores[0];
            let caption = format!("raw {:.1e} filtered {:.1e}", score.raw, score.filtered);
            text::draw(&mut picture, x, below + cell, &caption);
        }
        let x = left(SHOWN.len() as u32);
        text::draw(&mut picture, x, y, "reference");
        replace(&mut picture, &part.image(&reference.image), x.into(), (y + text::LINE).into());
        let whole = Part::new([0.0, 0.0], [u32::MAX, u32::MAX], 1, reference).image(&reference.image);
        let width = cell.min(whole.width());
        let height = whole.height() * width / whole.width().max(1);
        let whole = image::imageops::resize(&whole, width, height, image::imageops::FilterType::Triangle);
        replace(&mut picture, &whole, x.into(), (y + text::LINE + cell + GAP / 2).into());
        text::draw(&mut picture, x, y + text::LINE + cell + GAP + height, "the whole picture");
    }
    picture
}
