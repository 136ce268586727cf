//! fit_image.cpp: a photograph learned by a network (figure 6.13): losses, errors of the gradient, and pictures.

use super::Training;
use super::program::Program;
use crate::measure::plot::{Axis, Plot, Series};
use crate::measure::table::Table;
use crate::measure::{progress, text};
use anyhow::{Context, Result, bail};
use image::imageops::{self, FilterType};
use image::{Rgb, RgbImage};
use std::fs;
use std::path::Path;
use xtask::paths;

const METHODS: [&str; 4] = ["uniform", "is", "omis3", "omis6"];
/// Pixels on a side of a picture on the sheet, and the part of the photograph that is shown larger: (left, top, side)
/// in 1/192 of its side. Whiskers and the nose.
const CELL: u32 = 384;
const PART: (u32, u32, u32) = (8, 116, 72);

/// Writes training-image*.csv, .md, .svg and .png; returns the tables.
pub(super) fn run(training: &Training) -> Result<String> {
    let program = Program::compile("fit_image.cpp", &training.archive)?;
    let (seeds, steps, batches) = if training.quick { ("1", "1000", "20") } else { ("1", "3000", "30") };
    let small = ["--seeds", seeds, "--steps", steps, "--batches", batches];
    let scratch = tempfile::tempdir().context("cannot create a temporary folder")?;
    let prefix = scratch.path().join("picture");
    let prefix_text = prefix.to_str().with_context(|| format!("{} is not Unicode", prefix.display()))?;
    let methods = METHODS.join(",");
    let bar = progress::bar(4)?;
    let run = |message: &'static str, more: &[&str]| -> Result<_> {
        bar.set_message(message);
        let written = program.run(&[&small[..], more].concat(), training.interrupted, |_| ());
        bar.inc(1);
        written
    };
    let losses = run("photograph", &["--methods", &methods, "--output", prefix_text])?;
    let strata = run("photograph, strata", &["--methods", "is,omis3,omis6", "--stratified"])?;
    let all = "is,balance3,omis3,balance6,omis6";
    let errors = run("photograph: variance", &["--methods", all, "--variance"])?;
    let strata_errors = run("photograph: variance, strata", &["--methods", all, "--variance", "--stratified"])?;
    bar.finish_and_clear();

    let output = training.output;
    output.write_text("training-image.csv", &losses.csv)?;
    output.write_text("training-image-stratified.csv", &strata.csv)?;
    output.write_text("training-image-variance.csv", &errors.csv)?;
    output.write_text("training-image-variance-stratified.csv", &strata_errors.csv)?;
    output.write_text("training-image-steps.svg", &loss_plot(&losses.csv, &strata.csv, "step", "steps")?)?;
    output.write_text("training-image-time.svg", &loss_plot(&losses.csv, &strata.csv, "seconds", "seconds")?)?;
    output.write_picture("training-image.png", &sheet(&prefix)?)?;
    let tables = format!(
        "Independent draws:\n\n{}\nDraws from strata:\n\n{}\n\
         Mean squared errors of the gradient's estimates over those of uniform sampling, at the same states, by the distance\n\
         of all parameters together and as the mean of each parameter's ratio. Independent draws:\n\n{}\n\
         Draws from strata:\n\n{}",
        losses.summary, strata.summary, errors.summary, strata_errors.summary
    );
    let heading = format!(
        "# A photograph learned by a network (figure 6.13)\n\n\
         Made by examples_c/fit_image.cpp: networks (seeds): {seeds}; {steps} steps{}; errors over {batches} batches.",
        training.quick_note()
    );
    output.write_text("training-image.md", &format!("{heading} {tables}"))?;
    Ok(format!("fit_image\n\n{tables}"))
}

pub(crate) fn loss_plot(csv: &str, strata: &str, column: &str, label: &str) -> Result<String> {
    let mut series = Vec::new();
    for (csv, name, dashed) in [(csv, "", false), (strata, ", strata", true)] {
        let rows = Table::parse(csv, "the trainer's table", ',')?;
        for method in rows.distinct("method")? {
            let mut line =
                rows.only("method", method)?.line(&format!("{method}{name}"), "step", column, ("psnr", 1.0))?;
            line.band.clear(); // The seeds' networks differ more than the methods do.
            line.dashed = dashed;
            line.colour = METHODS.iter().position(|other| *other == method);
            series.push(line);
        }
    }
    let series: Vec<Series> = series;
    let x = Axis { label, logarithmic: false, range: None };
    let y = Axis { label: "PSNR, dB", logarithmic: false, range: None };
    Plot { title: "A photograph, batches of 256 pixels, Adam", x, y, series: &series }.svg()
}

/// Side by side: the photograph and what was learned from it; below each a part of it, and the error.
fn sheet(prefix: &Path) -> Result<RgbImage> {
    let photograph = read_ppm(&paths::root().join("examples_c/data/house_cat.ppm"))?;
    let height = text::LINE + CELL;
    let mut sheet = RgbImage::new((METHODS.len() as u32 + 1) * CELL, 3 * height);
    let mut show = |column: usize, row: u32, name: &str, picture: &RgbImage| {
        let (x, y) = (column as u32 * CELL, row * height);
        text::draw(&mut sheet, x + 4, y, name);
        let large = imageops::resize(picture, CELL, CELL, FilterType::Nearest);
        imageops::replace(&mut sheet, &large, i64::from(x), i64::from(y + text::LINE));
    };
    let part = |picture: &RgbImage| -> RgbImage {
        let (left, top, side) = PART;
        let scale = |value: u32| value * picture.width().min(picture.height()) / 192;
        imageops::crop_imm(picture, scale(left), scale(top), scale(side), scale(side)).to_image()
    };
    show(0, 0, "photograph", &photograph);
    show(0, 1, "", &part(&photograph));
    for (column, method) in METHODS.iter().enumerate() {
        let result = read_ppm(&prefix.with_extension(format!("{method}.ppm")))?;
        let error = read_ppm(&prefix.with_extension(format!("{method}.error.ppm")))?;
        show(column + 1, 0, method, &result);
        show(column + 1, 1, "", &part(&result));
        show(column + 1, 2, "error, 8 times as bright", &error);
    }
    Ok(sheet)
}

/// Binary PPM as fit_image writes it: no comments.
fn read_ppm(path: &Path) -> Result<RgbImage> {
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    parse_ppm(&bytes).with_context(|| format!("{} is not the picture that was expected", path.display()))
}

fn parse_ppm(bytes: &[u8]) -> Result<RgbImage> {
    let mut parts = bytes.splitn(4, |byte| *byte == b'\n');
    let mut line = || parts.next().context("it ends early");
    let (kind, size, largest) = (line()?, String::from_utf8_lossy(line()?), line()?);
    if kind != b"P6" || largest != b"255" {
        bail!("no binary PPM of 8 bits");
    }
    let (width, height) = size.split_once(' ').context("no size")?;
    let (width, height): (u32, u32) = (width.parse()?, height.parse()?);
    let pixels = line()?;
    if pixels.len() as u64 != u64::from(width) * u64::from(height) * 3 {
        bail!("{} bytes for {width} x {height} pixels", pixels.len());
    }
    let at = |x: u32, y: u32, channel: u32| {
        let index = (u64::from(y) * u64::from(width) + u64::from(x)) * 3 + u64::from(channel);
        usize::try_from(index).ok().and_then(|index| pixels.get(index)).copied().unwrap_or(0)
    };
    Ok(RgbImage::from_fn(width, height, |x, y| Rgb([0, 1, 2].map(|channel| at(x, y, channel)))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ppm_is_read() {
        let picture = parse_ppm(b"P6\n2 1\n255\n\x01\x02\x03\n\x05\x06").expect("a picture");
        assert_eq!(picture.get_pixel(1, 0).0, [b'\n', 5, 6]);
        assert!(parse_ppm(b"P6\n2 1\n255\n12345").is_err());
        assert!(parse_ppm(b"P5\n2 1\n255\n12").is_err());
        assert!(parse_ppm(b"").is_err());
    }
}
