//! One picture of it all, small enough for a page: parts of the first scene's images, each above its errors.

use super::measure::{Measured, baseline, find, ratios};
use super::plan::{BASELINE, ESTIMATORS, Plan};
use crate::measure::filter::SIGMA;
use crate::measure::metric::Reference;
use crate::measure::part::Part;
use crate::measure::samplers::Choice;
use crate::measure::text;
use image::imageops::replace;
use image::{Rgb, RgbImage};

const GAP: u32 = 8;
const BACKGROUND: Rgb<u8> = Rgb([24, 24, 28]);

/// Pixels that are shown, and how large.
const PART: [u32; 2] = [108, 80];
const CORNER: [f64; 2] = [0.17, 0.49];
const ZOOM: u32 = 2;

const COLUMNS: [(Choice, &str, &str); 4] = [
    (BASELINE, ESTIMATORS[0], "random"),
    (Choice::Sobol, ESTIMATORS[0], "Owen-scrambled Sobol"),
    (Choice::Tile(2), ESTIMATORS[0], "tile"),
    (Choice::Tile(2), ESTIMATORS[2], "tile, shared fits"),
];

pub(crate) fn draw(plan: &Plan, all: &[Measured], reference: &Reference) -> RgbImage {
    let part = Part::new(CORNER, PART, ZOOM, reference);
    let [width, height] = PART.map(|size| size * ZOOM);
    let row_height = text::LINE + 2 * (height + GAP / 2) + text::LINE + GAP;
    let top = GAP + 2 * text::LINE;
    let mut picture = RgbImage::from_pixel(
        GAP + (width + GAP) * COLUMNS.len() as u32,
        top + row_height * plan.spp.len() as u32,
        BACKGROUND,
    );
    let title = format!(
        "Squared errors over those of as many random samples: raw, and as seen through a Gaussian of {SIGMA} pixels"
    );
    text::draw(&mut picture, GAP, GAP / 2, &title);
    let left = |index: usize| GAP + (width + GAP) * index as u32;
    for (index, (_, _, name)) in COLUMNS.iter().enumerate() {
        text::draw(&mut picture, left(index), GAP / 2 + text::LINE, name);
    }
    for (spp, y) in plan.spp.into_iter().zip((top..).step_by(row_height as usize)) {
        let cells = COLUMNS.map(|(choice, estimator, _)| find(all, choice, spp, estimator));
        let scale = cells[0].map_or(1.0, |one| part.error_scale(&one.image));
        let note = format!(
            "{spp} sample{} per pixel; below, errors from -{scale:.2} to {scale:.2}",
            if spp == 1 { "" } else { "s" }
        );
        text::draw(&mut picture, GAP, y, &note);
        let [images, errors] = [y + text::LINE, y + text::LINE + height + GAP / 2];
        for (index, one) in cells.into_iter().enumerate() {
            let Some(one) = one else { continue };
            let x = left(index);
            replace(&mut picture, &part.image(&one.image), x.into(), images.into());
            replace(&mut picture, &part.errors(&one.image, scale), x.into(), errors.into());
            let [raw, filtered] = ratios(one, baseline(all, one));
            text::draw(&mut picture, x, errors + height + 1, &format!("raw {raw:.2} filtered {filtered:.2}"));
        }
    }
    picture
}
