//! The comparison picture: a part of every sampler's image, its errors beneath it, and their spectra (figure 5.20).

use super::plan::Scene;
use super::score::signed_errors;
use super::spectrum::{Spectra, WINDOW};
use crate::demo::image::{exposure, tone_map};
use crate::demo::metric::Reference;
use crate::demo::text;
use image::imageops::{FilterType, crop_imm, replace, resize};
use image::{Luma, Rgb, Rgb32FImage, RgbImage};

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

/// `columns`: the samplers' names.
pub(crate) fn draw(title: &str, columns: &[String], rows: &[Row], scene: &Scene, reference: &Reference) -> RgbImage {
    let part = Part::new(scene, reference);
    let side = part.side * part.zoom;
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

/// The part of the images that is shown, as squares of `zoom` pixels for each.
struct Part<'a> {
    reference: &'a Reference,
    x: u32,
    y: u32,
    side: u32,
    zoom: u32,
    exposure: f32,
}

impl<'a> Part<'a> {
    fn new(scene: &Scene, reference: &'a Reference) -> Self {
        let (width, height) = reference.image.dimensions();
        // Half an image, of whole spectra.
        let side = (width.min(height) / 2 / WINDOW as u32).max(1) * WINDOW as u32;
        let [x, y] = scene.crop;
        let corner = |at: f64, size: u32| ((at * f64::from(size)) as u32).min(size.saturating_sub(side));
        let zoom = (256 / side).max(1);
        let exposure = exposure(&reference.image);
        Self { reference, x: corner(x, width), y: corner(y, height), side, zoom, exposure }
    }

    fn enlarge(&self, image: &RgbImage) -> RgbImage {
        resize(image, image.width() * self.zoom, image.height() * self.zoom, FilterType::Nearest)
    }

    fn cut(&self, image: &RgbImage) -> RgbImage {
        self.enlarge(&crop_imm(image, self.x, self.y, self.side, self.side).to_image())
    }

    fn image(&self, image: &Rgb32FImage) -> RgbImage {
        self.cut(&tone_map(image, self.exposure))
    }

    /// The part's own errors, row after row.
    fn values(&self, image: &Rgb32FImage) -> Vec<f64> {
        let (errors, width) = (signed_errors(image, self.reference), image.width() as usize);
        let (x, y, side) = (self.x as usize, self.y as usize, self.side as usize);
        errors.chunks(width.max(1)).skip(y).take(side).flat_map(|row| row[x..x + side].iter().copied()).collect()
    }

    /// The 95th percentile of the errors' sizes.
    fn error_scale(&self, image: &Rgb32FImage) -> f64 {
        let mut errors: Vec<f64> = self.values(image).into_iter().map(f64::abs).collect();
        errors.sort_by(f64::total_cmp);
        errors.get(errors.len() * 95 / 100).copied().filter(|&scale| scale > 0.0).unwrap_or(1.0)
    }

    fn errors(&self, image: &Rgb32FImage, scale: f64) -> RgbImage {
        let errors = self.values(image);
        let grey = |x: u32, y: u32| {
            let error = errors[(y * self.side + x) as usize];
            (127.5 * (1.0 + (error / scale).clamp(-1.0, 1.0))).round() as u8
        };
        self.enlarge(&RgbImage::from_fn(self.side, self.side, |x, y| Rgb([grey(x, y); 3])))
    }

    fn spectra(&self, image: &Rgb32FImage) -> RgbImage {
        let spectra = Spectra::new(&self.values(image), self.side as usize).picture();
        self.enlarge(&RgbImage::from_fn(spectra.width(), spectra.height(), |x, y| {
            let Luma([grey]) = *spectra.get_pixel(x, y);
            Rgb([grey; 3])
        }))
    }
}
