//! Is the plumbing right? Each check compares pictures, pixel by pixel, and fails if they differ by more than rounding.

use super::ours;
use super::render::{Renderer, Settings};
use super::scenes::{SCENES, UNCHANGED, example};
use anyhow::{Context, Result, bail};
use image::Rgb32FImage;
use std::fs;

const SMALL: [u32; 2] = [80, 60];
const TINY: [u32; 2] = [48, 36];
/// Scenes that must not change while noisefloor is off.
pub(crate) const EXAMPLES: usize = SCENES.len() + 1;
/// Cells of the grid of lights.
const CELLS: u32 = 256;

/// What the report says of them.
pub(crate) struct Checks {
    /// Pictures that were the same, bit for bit, stock and patched with noisefloor off.
    pub(crate) unchanged: usize,
    /// Frames with a point light each.
    pub(crate) frames: u32,
    /// Largest difference of their mean from the area light's picture, in units of 1/65535.
    pub(crate) difference: f64,
    /// Largest difference of a channel's mean in a picture with radiosity, in percent.
    pub(crate) radiosity: f64,
}

pub(crate) fn run(renderer: &Renderer) -> Result<Checks> {
    let unchanged = off_is_stock(renderer)?;
    let difference = points_make_the_light(renderer)?;
    threads_and_means(renderer)?;
    let radiosity = radiosity_is_as_bright(renderer)?;
    Ok(Checks { unchanged, frames: CELLS, difference, radiosity })
}

/// With noisefloor off, the patched program makes Debian's pictures: with antialiasing, both of its kinds, focal blur,
/// area lights and radiosity.
fn off_is_stock(renderer: &Renderer) -> Result<usize> {
    // One thread: stock POV-Ray's jitter and radiosity depend on which thread takes which block.
    let antialiased: [&[&str]; 2] = [&["+WT1", "+A0.3", "+AM2", "+J"], &["+WT1", "+A0.3", "+AM1", "-J"]];
    let plain: [&[&str]; 1] = [&["+WT1"]];
    let mut scenes: Vec<(&str, String, &[&[&str]])> = Vec::new();
    for scene in &SCENES {
        for (name, text) in scene.includes()? {
            renderer.provide(name, text.as_bytes())?;
        }
        scenes.push((scene.name, scene.original()?, &antialiased));
    }
    scenes.push((UNCHANGED, example(UNCHANGED)?, &plain)); // slow enough
    let mut compared = 0;
    for (name, text, kinds) in &scenes {
        renderer.provide("unchanged.pov", text.as_bytes())?;
        for (options, setting) in kinds.iter().zip([vec![], vec![("", "off".to_owned())]]) {
            let stock = renderer.stock_sized("unchanged.pov", TINY, options)?.image;
            let off = renderer.patched_sized("unchanged.pov", TINY, options, &setting)?.image;
            if off != stock {
                let worst = largest_difference(&off, &stock);
                bail!("{name} with {options:?}: with noisefloor off, the picture is not Debian's, by {worst}/65535");
            }
            compared += 1;
        }
    }
    println!("   off: {compared} pictures are Debian's, bit for bit");
    Ok(compared)
}

/// An area light that is sampled at the centres of 16 x 16 cells is the mean of 256 point lights.
fn points_make_the_light(renderer: &Renderer) -> Result<f64> {
    let path = ours().join("grid.pov");
    let text = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
    renderer.provide("grid.pov", &text)?;
    let points = renderer.stock_mean("grid.pov", SMALL, CELLS)?;
    let settings = sampling(CELLS, &[("SAMPLER", "grid"), ("PIXEL", "center"), ("LIGHT", "whole")]);
    let light = renderer.patched_sized("grid.pov", SMALL, &["Declare=Area=1"], &settings)?.image;
    let difference = largest_difference(&light, &points);
    // Half a unit each for the picture and for the mean of 256 rounded ones, and single precision.
    let allowed = 1.1;
    if difference > allowed {
        bail!(
            "the area light differs from the mean of {CELLS} point lights by {difference}/65535, more than \
             {allowed}/65535"
        );
    }
    // A comparison of black pictures would not fail.
    let brightness = points.iter().map(|value| f64::from(*value)).sum::<f64>() / points.len() as f64;
    let shadow = renderer.patched_sized("grid.pov", SMALL, &["Declare=Area=1"], &vec![])?.image;
    if brightness < 0.05 || largest_difference(&shadow, &points) < 10.0 {
        bail!("the pictures that were compared are black, or all alike: the check says nothing");
    }
    println!("   area light against {CELLS} point lights: at most {difference:.2}/65535 apart");
    Ok(difference)
}

/// The picture does not depend on threads, and the estimator `mc` is the mean.
fn threads_and_means(renderer: &Renderer) -> Result<()> {
    for scene in &SCENES {
        renderer.provide("threads.pov", scene.original()?.as_bytes())?;
        let picture = |threads: &str, settings: &Settings| -> Result<Rgb32FImage> {
            Ok(renderer.patched_sized("threads.pov", SMALL, &[threads], settings)?.image)
        };
        let mut estimate = sampling(4, &[]);
        estimate[0].1 = "estimate".to_owned();
        if picture("+WT1", &estimate)? != picture("+WT4", &estimate)? {
            bail!("{}: the picture depends on the number of threads", scene.name);
        }
        let mean = picture("+WT2", &sampling(4, &[]))?;
        estimate.push(("ESTIMATOR", "mc".to_owned()));
        let difference = largest_difference(&picture("+WT2", &estimate)?, &mean);
        if difference > 1.01 {
            bail!("{}: the estimator `mc` differs from the mean by {difference}/65535", scene.name);
        }
    }
    println!("   threads: 1 and 4 make the same pictures");
    Ok(())
}

/// Radiosity from noisefloor's directions is as bright as from POV-Ray's, though no pixel is the same.
fn radiosity_is_as_bright(renderer: &Renderer) -> Result<f64> {
    renderer.provide("radiosity.pov", example(UNCHANGED)?.as_bytes())?;
    let stock = renderer.stock_sized("radiosity.pov", TINY, &["+WT1"])?.image;
    let settings = sampling(16, &[("PIXEL", "center"), ("LIGHT", "shadow")]);
    let ours = renderer.patched_sized("radiosity.pov", TINY, &["+WT1"], &settings)?.image;
    let mean =
        |image: &Rgb32FImage, channel: usize| image.pixels().map(|pixel| f64::from(pixel.0[channel])).sum::<f64>();
    let difference = |channel| 100.0 * (mean(&ours, channel) / mean(&stock, channel) - 1.0).abs();
    let worst = (0..3).map(difference).fold(0.0, f64::max);
    // Both interpolate between a few hundred points, each where its own cache happens to have them.
    let allowed = 2.0;
    if worst.is_nan() || worst >= allowed || ours == stock {
        bail!("{UNCHANGED}: the mean of a channel is {worst:.2} % off stock POV-Ray's, more than {allowed} %");
    }
    println!("   radiosity: each channel as bright as stock POV-Ray's, within {worst:.2} %");
    Ok(worst)
}

/// NOISEFLOOR=samples, so many of them, and more.
pub(crate) fn sampling<'a>(spp: u32, more: &[(&'a str, &str)]) -> Settings<'a> {
    let mut settings = vec![("", "samples".to_owned()), ("SPP", spp.to_string())];
    settings.extend(more.iter().map(|&(name, value)| (name, value.to_owned())));
    settings
}

/// In units of 1/65535.
fn largest_difference(a: &Rgb32FImage, b: &Rgb32FImage) -> f64 {
    let differences = a.iter().zip(b.iter()).map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs());
    differences.fold(0.0, f64::max) * 65535.0
}
