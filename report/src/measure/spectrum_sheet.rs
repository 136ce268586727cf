//! The comparison picture: a part of every sampler's image, its errors beneath it, and their spectra (figure 5.20).

use super::part::Part;
use super::spectrum::WINDOW;
use crate::measure::metric::Reference;
use crate::measure::text;
use image::imageops::replace;
use image::{Rgb, Rgb32FImage, RgbImage};

const GAP: u32 = 8;
const BACKGROUND: Rgb<u8> = Rgb([24, 24, 28]);

/// Images side by side at most: a page is hardly wider. The reference is one of them.
const COLUMNS: usize = 4;

/// One image, or none where a sampler does not exist.
pub(crate) struct Cell<'a> {
    pub(crate) image: &'a Rgb32FImage,
    pub(crate) caption: String,
}

/// A row of images, in as many lines as it takes; the first sets the scale of its error pictures.
pub(crate) struct Row<'a> {
    pub(crate) name: String,
    pub(crate) cells: Vec<Option<Cell<'a>>>,
}

/// `names`: of the cells of a row. `crop`: the corner of the part that is shown, in images.
pub(crate) fn draw(title: &str, names: &[String], rows: &[Row], crop: [f64; 2], reference: &Reference) -> RgbImage {
    // Half an image, of whole spectra.
    let size = reference.image.width().min(reference.image.height());
    let side = (size / 2 / WINDOW as u32).max(1) * WINDOW as u32;
    let zoom = (256 / side).max(1);
    let part = Part::new(crop, [side; 2], zoom, reference);
    let side = side * zoom;
    // The last place is the reference's; lines are about equally long.
    let places = names.len() + 1;
    let lines = places.div_ceil(COLUMNS);
    let columns = places.div_ceil(lines);
    // A name, three pictures, a caption.
    let line_height = 3 * (side + GAP / 2) + 2 * text::LINE + GAP;
    let row_height = line_height * lines as u32;
    let top = GAP + text::LINE;
    let size = [GAP + (side + GAP) * columns as u32, top + row_height * rows.len() as u32];
    let mut picture = RgbImage::from_pixel(size[0], size[1], BACKGROUND);
    text::draw(&mut picture, GAP, GAP / 2, title);
    let below = |y: u32, number: u32| y + text::LINE + number * (side + GAP / 2);
    for (row, top) in rows.iter().zip((top..).step_by(row_height as usize)) {
        let place = |index: usize| {
            [GAP + (side + GAP) * (index % columns) as u32, top + line_height * (index / columns) as u32]
        };
        let scale = row.cells.iter().flatten().next().map_or(1.0, |cell| part.error_scale(cell.image));
        for (index, (cell, name)) in row.cells.iter().zip(names).enumerate() {
            let Some(cell) = cell else { continue };
            let [x, y] = place(index);
            text::draw(&mut picture, x, y, name);
            let panels = [part.image(cell.image), part.errors(cell.image, scale), part.spectra(cell.image)];
            for (number, panel) in (0..).zip(&panels) {
                replace(&mut picture, panel, x.into(), below(y, number).into());
            }
            text::draw(&mut picture, x, below(y, 3), &cell.caption);
        }
        let [x, y] = place(places - 1);
        text::draw(&mut picture, x, y, "reference");
        replace(&mut picture, &part.image(&reference.image), x.into(), below(y, 0).into());
        let notes = [
            row.name.as_str(),
            "",
            "below each its errors:",
            &format!("black -{scale:.2}, white +{scale:.2}"),
            "",
            "and their power spectra,",
            &format!("of {WINDOW} x {WINDOW} pixels each"),
        ];
        for (line, note) in (0..).zip(notes) {
            text::draw(&mut picture, x, below(y, 1) + GAP + line * text::LINE, note);
        }
    }
    picture
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_samplers_are_broken_into_lines_of_a_pages_width() {
        let image = Rgb32FImage::from_fn(128, 128, |x, y| Rgb([(1 + (x * 7 + y * 13) % 5) as f32; 3]));
        let reference = Reference::new(&image, &image);
        let names: Vec<String> = (0..9).map(|number| format!("sampler {number}")).collect();
        let cell = |number: usize| (number != 5).then(|| Cell { image: &image, caption: format!("caption {number}") });
        let rows = [Row { name: text::samples_per_pixel(1), cells: (0..names.len()).map(cell).collect() }];
        let picture = draw("title", &names, &rows, [0.25, 0.25], &reference);
        assert!(picture.width() <= 1200, "{}", picture.width());
        // Three lines of four places: ten of them are used, the sixth is that of the sampler which does not exist.
        let [across, down] = [picture.width() / 4, (picture.height() - GAP) / 3];
        let is_used = |index: u32| {
            let [x, y] = [index % 4 * across + across / 2, GAP + index / 4 * down + down / 6];
            picture.get_pixel(x, y) != &BACKGROUND
        };
        let used: Vec<u32> = (0..12).filter(|&index| is_used(index)).collect();
        assert_eq!(used, [0, 1, 2, 3, 4, 6, 7, 8, 9]);
    }
}
