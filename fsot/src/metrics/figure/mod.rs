//! Spectra and error curves as pictures: a sheet of lines, words and grey pictures, written as PNG or SVG.

mod plot;
mod raster;
mod sheet;
mod vector;

pub use sheet::Sheet;

use super::integration::PrefixError;
use super::spectrum::Spectrum;
use plot::{Axis, Curve, Plot};
use sheet::{Anchor, BLACK, Colour, Element, GREY};

const BLUE: Colour = [31, 90, 180];
const RED: Colour = [190, 50, 40];
/// The side of the picture of a spectrum, in pixels of the sheet.
const PICTURE: f64 = 512.0;

/// What a spectrum is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// A periodogram of points.
    Points,
    /// The error of a tile.
    Tile,
}

/// The periodogram with zero frequency in the centre, and beside it the radial average and the anisotropy.
///
/// Grey levels are `1 - 2^-power`: black no power, middle grey white noise.
pub fn spectrum(title: &str, spectrum: &Spectrum, of: Subject) -> Sheet {
    let unit = match of {
        Subject::Points => "principal frequencies",
        Subject::Tile => "cycles per pixel",
    };
    let mut sheet = Sheet::new(1240, 600);
    sheet.text([32.0, 32.0], Anchor::Start, title, BLACK);
    let grey = |p: &f64| (255.0 * (1.0 - libm::exp2(-p))).round().clamp(0.0, 255.0) as u8;
    let mut grey: Vec<u8> = spectrum.power.iter().map(grey).collect();
    // The mean says nothing, and a white dot would draw the eye.
    grey[spectrum.side / 2 * (spectrum.side + 1)] = 0;
    sheet.elements.push(Element::Picture { at: [32.0, 48.0], size: PICTURE, side: spectrum.side, grey });
    let end = spectrum.side as f64 / 2.0 / spectrum.unit;
    sheet.text([32.0 + PICTURE / 2.0, 584.0], Anchor::Middle, format!("-{end:.2} to {end:.2} {unit}"), BLACK);
    let x = Axis::linear(0.0, end);
    let power: Vec<[f64; 2]> = spectrum.rings.iter().map(|r| [r.frequency, r.power]).collect();
    let top = power.iter().fold(1.5, |m: f64, p| m.max(p[1]));
    let radial = Plot {
        title: "radial mean power (white noise 1)".into(),
        label: String::new(),
        x,
        y: Axis::linear(0.0, top * 1.05),
        curves: vec![Curve { points: power, colour: BLUE }],
        levels: vec![1.0],
    };
    radial.draw(&mut sheet, [640.0, 64.0, 1216.0, 280.0]);
    let anisotropy: Vec<[f64; 2]> = spectrum.rings.iter().map(|r| [r.frequency, r.anisotropy]).collect();
    // One realisation of an isotropic process is at 0 dB, the average of several lower.
    let isotropic = -10.0 * libm::log10(spectrum.realisations as f64);
    let levels = if of == Subject::Points { vec![isotropic] } else { Vec::new() };
    let finite = || anisotropy.iter().map(|p| p[1]).filter(|a| a.is_finite());
    let plot = Plot {
        title: "anisotropy in dB".into(),
        label: unit.into(),
        x,
        y: Axis::linear(finite().fold(isotropic - 10.0, f64::min), finite().fold(isotropic + 10.0, f64::max)),
        levels,
        curves: vec![Curve { points: anisotropy, colour: RED }],
    };
    plot.draw(&mut sheet, [640.0, 336.0, 1216.0, 552.0]);
    sheet
}

/// Errors against the number of points on logarithmic axes (figure 5.17): half-spaces in red, Gaussians in blue, and in
/// grey what random points have.
pub fn prefix_errors(title: &str, errors: &[PrefixError]) -> Sheet {
    let mut sheet = Sheet::new(900, 600);
    let curve = |value: &dyn Fn(&PrefixError) -> f64, colour| Curve {
        points: errors.iter().map(|e| [e.points as f64, value(e)]).collect(),
        colour,
    };
    // A set's relative error is the square of the ratio to random points.
    let curves = vec![
        curve(&|e| e.half_spaces / e.half_spaces_relative.sqrt(), GREY),
        curve(&|e| e.gaussians / e.gaussians_relative.sqrt(), GREY),
        curve(&|e| e.half_spaces, RED),
        curve(&|e| e.gaussians, BLUE),
    ];
    let values = || curves.iter().flat_map(|c| &c.points).map(|p| p[1]).filter(|v| v.is_finite() && *v > 0.0);
    let plot = Plot {
        title: "RMS error: half-spaces red, Gaussians blue, random points grey".into(),
        label: "points".into(),
        x: Axis::logarithmic(1.0, errors.last().map_or(2.0, |e| e.points.max(2) as f64)),
        y: Axis::logarithmic(values().fold(1.0, f64::min), values().fold(1e-9, f64::max)),
        curves,
        levels: Vec::new(),
    };
    sheet.text([32.0, 32.0], Anchor::Start, title, BLACK);
    plot.draw(&mut sheet, [96.0, 80.0, 876.0, 552.0]);
    sheet
}
