//! `fsot stipple --frames`.

use super::args::{Args, Picture};
use crate::drive::{drive, finish};
use fsot::counted::counted;
use fsot::error::{Error, Result};
use fsot::export::points::Table;
use fsot::optimize::Optimizer;
use fsot::picture::{Photo, blurred_psnr, check_size, rasterise};
use fsot::read;
use fsot::stipple::{Animation, Windows};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Writes a drawing of all points to --out, and one per frame to OUT-0000.png, OUT-0001.png and so on.
pub(super) fn animation(args: &Args, pattern: &str) -> Result<()> {
    let format = Picture::of(&args.common.out)?;
    if args.common.out.extension().is_none() {
        let out = args.common.out.display();
        return Err(Error::Input(format!("{out}: every frame is a file, too: give a name that ends in .png or .svg")));
    }
    let pictures = matches(pattern)?;
    let count = |value: Option<u32>| value.unwrap_or(0) as usize;
    let windows =
        Windows { frames: pictures.len(), window: count(args.window), step: count(args.step), cyclic: args.cyclic };
    windows.check()?;
    let needed = windows.points();
    if let Some(n) = args.n.filter(|n| *n as usize != needed) {
        return Err(Error::Input(format!(
            "{} of {}, {} of them new in each, have {} together, not {n}: leave out -n",
            counted(windows.frames, "frame"),
            counted(windows.window, "point"),
            windows.step,
            counted(needed, "point")
        )));
    }
    let outs: Vec<PathBuf> = (0..windows.frames).map(|frame| numbered(&args.common.out, frame)).collect();
    args.copies.check()?;
    let outputs = args.copies.paths().chain(outs.iter().map(PathBuf::as_path));
    args.common.check_outputs(outputs, pictures.iter().map(PathBuf::as_path))?;

    let mut photos = Vec::with_capacity(pictures.len());
    let mut digests = Vec::with_capacity(pictures.len());
    for path in &pictures {
        let (photo, digest) = read::photo(path)?;
        photos.push(photo);
        digests.push(digest);
    }
    let options = args.options(needed);
    let animation = Animation::new(&photos, windows, &options)?;
    let size = args.size(animation.spacing());
    photos.iter().try_for_each(|photo| check_size(photo.extent(), size as f32).map(|_| ()))?;
    let mut optimizer = Optimizer::new(animation.problem.clone())?;
    let mut run = drive(&mut optimizer, &args.description(&digests, &options), &args.common)?;

    let points = optimizer.points();
    drop(optimizer);
    let table = Table { points, classes: None };
    finish(&mut run, |outputs| {
        for (frame, path) in outs.iter().enumerate() {
            outputs.add(path, &format.encode(&animation.frame(&table.points, frame), size)?)?;
        }
        let all = animation.all(&table.points);
        outputs.add(&args.common.out, &format.encode(&all, size)?)?;
        args.copies.add(outputs, &all, size, &table)
    })?;
    if args.common.is_silent() {
        return Ok(());
    }

    let sigma = animation.spacing() * size as f32;
    // Drawn once more: kept, all frames would take the memory that one may.
    let ratio = |(frame, photo): (usize, &Photo)| {
        let drawn = rasterise(&animation.frame(&table.points, frame), size as f32)?;
        Ok(blurred_psnr(&drawn, photo, sigma, args.linear(), true))
    };
    let ratios: Vec<f64> = photos.iter().enumerate().map(ratio).collect::<Result<_>>()?;
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    let worst = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    let mut text = format!(
        "{} in {} of {}, {} of them new in each\n",
        counted(needed, "point"),
        counted(windows.frames, "frame"),
        windows.window,
        windows.step,
    );
    run.describe(&mut text);
    text.push_str(&format!(
        "  blurred PSNR of the frames {mean:.2} dB in the mean, {worst:.2} dB at least \
         (sigma {sigma:.2} px, the mean distance between a frame's dots)"
    ));
    let json = json!({
        "points": needed,
        "windows": windows,
        "radii": animation.radii,
        "blurred_psnr": ratios,
        "sigma_pixels": sigma,
        "run": run.json(),
    });
    args.common.print(args.copies.paths(), &text, &json)
}

/// The files that a pattern matches, by name.
fn matches(pattern: &str) -> Result<Vec<PathBuf>> {
    let paths = glob::glob(pattern).map_err(|error| Error::Input(format!("`{pattern}` is not a pattern: {error}")))?;
    let mut pictures = Vec::new();
    for path in paths {
        let path = path.map_err(|error| Error::Io { path: error.path().to_owned(), source: error.into() })?;
        if path.is_file() {
            pictures.push(path);
        }
    }
    if pictures.is_empty() {
        return Err(Error::Input(format!("no file matches `{pattern}`: give the pictures of the frames, in quotes")));
    }
    pictures.sort();
    Ok(pictures)
}

/// `dir/name.png` of a frame: `dir/name-0007.png`.
fn numbered(out: &Path, frame: usize) -> PathBuf {
    let mut name = out.file_stem().unwrap_or_default().to_owned();
    name.push(format!("-{frame:04}."));
    name.push(out.extension().unwrap_or_default());
    out.with_file_name(name)
}
