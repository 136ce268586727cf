//! The comparison picture: a part of every sampler's image, its errors beneath it, and their spectra (figure 5.20).

use super::part::Part;
use super::spectrum::WINDOW;
use crate::measure::metric::Reference;
use crate::measure::text;
use image::imageops::replace;
use image::{Rgb, Rgb32FImage, RgbImage};

const GAP: u32 = 8;
const BACKGROUND: Rgb<u8> = Rgb([24, 24, 28]);

/// One image, or none where a sampler does not exist.
pub(crate) struct Cell<'a> {
    pub(crate) image: &'a Rgb32FImage,
    pub(crate) caption: String,
}

/// A row of images; the first sets the scale of its error pictures.
pub(crate) struct Row<'a> {
    pub(crate) name: String,
    pub(crate) cells: Vec<Option<Cell<'a>>>,
}

/// `columns`: their names. `crop`: the corner of the part that is shown, in images.
pub(crate) fn draw(title: &str, columns: &[String], rows: &[Row], crop: [f64; 2], reference: &Reference) -> RgbImage {
    // Half an image, of whole spectra.
    let size = reference.image.width().min(reference.image.height());
    let side = (size / 2 / WINDOW as u32).max(1) * WINDOW as u32;
    let zoom = (256 / side).max(1);
    let part = Part::new(crop, [side; 2], zoom, reference);
    let side = side * zoom;
    let row_height = 3 * (side + GAP / 2) + 2 * text::LINE;
    let top = GAP + 2 * text::LINE;
    let mut picture = RgbImage::from_pixel(
        GAP + (side + GAP) * (columns.len() as u32 + 1),
        top + row_height * rows.len() as u32 + GAP,
        BACKGROUND,
    );
    text::draw(&mut picture, GAP, GAP / 2, title);
    let left = |index: usize| GAP + (side + GAP) * index as u32;
    for (index, name) in columns.iter().map(String::as_str).chain(["reference"]).enumerate() {
        text::draw(&mut picture, left(index), top - text::LINE, name);
    }
    let below = |y: u32, line: u32| y + line * (side + GAP / 2);
    for (row, y) in rows.iter().zip((top..).step_by(row_height as usize)) {
        let scale = row.cells.iter().flatten().next().map_or(1.0, |cell| part.error_scale(cell.image));
        for (index, cell) in row.cells.iter().enumerate() {
            let Some(cell) = cell else { continue };
            let x = left(index);
            let panels = [part.image(cell.image), part.errors(cell.image, scale), part.spectra(cell.image)];
            for (line, panel) in (0..).zip(&panels) {
                replace(&mut picture, panel, x.into(), below(y, line).into());
            }
            text::draw(&mut picture, x, below(y, 3), &cell.caption);
        }
        let x = left(columns.len());
        replace(&mut picture, &part.image(&reference.image), x.into(), y.into());
        let errors = format!("errors: black -{scale:.2},");
        let notes = [
            row.name.as_str(),
            "",
            &errors,
            &format!("white +{scale:.2}"),
            "",
            "power spectra of",
            "32 x 32 pixels each",
        ];
        for (line, note) in (0..).zip(notes) {
            text::draw(&mut picture, x, below(y, 1) + GAP + line * text::LINE, note);
        }
    }
    picture
}
