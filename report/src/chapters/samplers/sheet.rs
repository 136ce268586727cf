//! The picture: a part of each sampler's error image, and beneath it the mean spectrum of its errors (figure 5.20).

use crate::chapters::chapter::Chapter;
use crate::chapters::pictures::write_small;
use crate::measure::image::read_pfm;
use crate::measure::output::Output;
use crate::measure::text;
use anyhow::Result;
use image::{Rgb, Rgb32FImage, RgbImage};
use std::path::Path;

const SHOWN: [(&str, &str); 5] = [
    ("random", "random"),
    ("sobol", "Owen-Sobol"),
    ("openqmc", "OpenQMC lattice-bn"),
    ("heitz", "Heitz"),
    ("tile", "tile"),
];
const COUNTS: [u32; 3] = [1, 4, 16];
/// Pixels of the image that are shown on a side, and how large each is.
const PART: u32 = 64;
const ZOOM: u32 = 2;
const GAP: u32 = 8;

pub(super) fn write(output: &Output, folder: &Path, chapter: &mut Chapter) -> Result<()> {
    let mut rows = Vec::new();
    for spp in COUNTS {
        let paths = SHOWN.map(|(file, _)| folder.join(format!("{file}-{spp}.pfm")));
        if paths.iter().all(|path| path.exists()) {
            rows.push((spp, paths.iter().map(|path| read_pfm(path)).collect::<Result<Vec<_>>>()?));
        }
    }
    let side = PART * ZOOM;
    let (row_height, top) = (2 * (side + GAP) + text::LINE, text::LINE + GAP);
    let size = (GAP + (side + GAP) * SHOWN.len() as u32, top + row_height * rows.len() as u32);
    let mut picture = RgbImage::from_pixel(size.0, size.1, Rgb([24, 24, 28]));
    for (column, (_, name)) in (0..).zip(SHOWN) {
        text::draw(&mut picture, GAP + (side + GAP) * column, GAP / 2, name);
    }
    for (line, (spp, images)) in (0..).zip(&rows) {
        let y = top + row_height * line;
        for (column, image) in (0..).zip(images) {
            let x = GAP + (side + GAP) * column;
            let scale = f64::from(*spp).sqrt();
            place(&mut picture, x, y, |x, y| error(image, x, y, scale));
            place(&mut picture, x, y + side + GAP, |x, y| power(image, x, y));
        }
        text::draw(&mut picture, GAP, y + 2 * side + GAP + GAP / 2, &format!("{spp} spp: errors; spectra"));
    }
    write_small(output, "samplers.png", &picture)?;
    chapter.section("What the errors look like", "figure 5.20");
    let part = chapter.setting("pixels on a side of the error images", PART);
    chapter.paragraph(&format!(
        "Errors of one half-plane, the first {part} x {part} pixels: grey is none, black and white two standard deviations of as many random \
         samples. Below each the mean power of errors over integrands of both families, frequency zero in the middle: white noise is middle \
         grey, black is no power."
    ));
    for spp in COUNTS {
        chapter.setting(format!("picture, {spp} samples"), spp);
    }
    chapter.picture("samplers.png", "error images and their spectra of five samplers");
    Ok(())
}

fn place(picture: &mut RgbImage, left: u32, top: u32, shade: impl Fn(u32, u32) -> f64) {
    for (y, x) in (0..PART).flat_map(|y| (0..PART).map(move |x| (y, x))) {
        // Few shades: noise does not compress.
        let grey = ((shade(x, y).clamp(0.0, 1.0) * 31.0).round() * 255.0 / 31.0) as u8;
        for (down, right) in (0..ZOOM).flat_map(|down| (0..ZOOM).map(move |right| (down, right))) {
            picture.put_pixel(left + x * ZOOM + right, top + y * ZOOM + down, Rgb([grey; 3]));
        }
    }
}

fn error(image: &Rgb32FImage, x: u32, y: u32, scale: f64) -> f64 {
    0.5 + 0.25 * scale * f64::from(image.get_pixel(x, y).0[0])
}

/// The mean of four frequencies.
fn power(image: &Rgb32FImage, x: u32, y: u32) -> f64 {
    let at = |dx, dy| f64::from(image.get_pixel(2 * x + dx, 2 * y + dy).0[1]);
    let mean = (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) / 4.0;
    1.0 - (-mean).exp2()
}
