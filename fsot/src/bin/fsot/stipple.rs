//! `fsot stipple`.

mod args;
mod frames;

pub(crate) use args::Args;

use crate::drive::{drive, finish};
use crate::measure::in_file;
use args::Picture;
use fsot::counted::counted;
use fsot::error::{Error, Result};
use fsot::export::points::Table;
use fsot::optimize::Optimizer;
use fsot::picture::{blurred_psnr, check_size, png, rasterise};
use fsot::read;
use fsot::stipple::Stipple;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;

/// Stipples a picture or an animation.
pub(crate) fn run(args: &Args) -> Result<()> {
    match (&args.image, &args.frames) {
        (Some(image), None) => picture(args, image),
        (_, Some(frames)) => frames::animation(args, frames),
        (None, None) => Err(Error::input("give a picture, or the pictures of an animation with --frames")),
    }
}

fn picture(args: &Args, image: &Path) -> Result<()> {
    let format = Picture::of(&args.common.out)?;
    args.copies.check()?;
    args.common.check_outputs(args.copies.paths(), [image])?;
    let (photo, digest) = read::photo(image)?;
    let options = args.options(args.n.unwrap_or(0) as usize);
    let stipple = Stipple::new(&photo, &options).map_err(in_file(image))?;
    let size = args.size(stipple.spacing());
    check_size(photo.extent(), size as f32)?;
    let mut optimizer = Optimizer::new(stipple.problem.clone())?;
    let mut run = drive(&mut optimizer, &args.description(&[digest], &options), &args.common)?;

    let points = optimizer.points();
    drop(optimizer);
    let drawing = stipple.drawing(&points);
    let drawn = rasterise(&drawing, size as f32).map_err(|error| run.kept(error))?;
    let table = Table { points, classes: Some(stipple.labels()) };
    finish(&mut run, |outputs| {
        let picture = if format == Picture::Png { png(&drawn)? } else { format.encode(&drawing, size)? };
        outputs.add(&args.common.out, &picture)?;
        args.copies.add(outputs, &drawing, size, &table)
    })?;
    if args.common.is_silent() {
        return Ok(());
    }

    let sigma = stipple.spacing() * size as f32;
    let psnr = blurred_psnr(&drawn, &photo, sigma, args.linear(), !args.cmyk);
    let counts: Vec<String> = stipple.inks.iter().map(|dots| format!("{} {}", dots.range.len(), dots.name)).collect();
    let mut text = format!(
        "{} ({}), radius {:.2} px, drawn {} x {}\n",
        counted(options.points, "dot"),
        counts.join(", "),
        stipple.radius * size as f32,
        drawn.width(),
        drawn.height(),
    );
    run.describe(&mut text);
    text.push_str(&format!(
        "  blurred PSNR {psnr:.2} dB (both blurred by sigma {sigma:.2} px, the mean distance between dots)"
    ));
    let inks: BTreeMap<_, _> = stipple.inks.iter().map(|dots| (dots.name, dots.range.len())).collect();
    let json = json!({
        "points": options.points,
        "inks": inks,
        "radius": stipple.radius,
        "classes": stipple.problem.classes.len(),
        "blurred_psnr": psnr,
        "sigma_pixels": sigma,
        "run": run.json(),
    });
    args.common.print(args.copies.paths(), &text, &json)
}
