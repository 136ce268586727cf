//! An animation, filtered along time and over the image: figures 5.23 and 5.24.

use super::Section;
use crate::chapters::measurement::{BASELINE, Experiment, View};
use crate::chapters::prelude::*;
use crate::measure::metric::Reference;
use crate::measure::renderer::Sampler;
use crate::measure::samplers::Choice;
use crate::measure::score;
use image::Rgb32FImage;

/// The first is the thesis's, and what the temporal tile of [`CHOSEN`] samples had its settings chosen on; the second
/// has had no part in any choice.
const SCENES: [&str; 2] = ["animation", "dining"];
/// Samples per pixel of the temporal tile whose settings were chosen by rendering.
const CHOSEN: u32 = 4;
/// Weight of the newest frame in the exponential moving average: what the temporal tiles were optimised for.
const ALPHA: f64 = 0.2;
/// The figures' samples per pixel, and the tile of as many that was optimised over frames too.
const TEMPORAL: [(u32, &str); 2] = [(1, "128_1SPP_2D_TEMPORAL"), (4, "64_4SPP_2D_TEMPORAL")];
/// Weights of so many frames, the newest first.
type Kernel = fn(usize) -> Vec<f64>;
/// Kernels and their names.
const KERNELS: [(&str, Kernel); 2] = [("moving average", average), ("eye", eye)];

fn average(frames: usize) -> Vec<f64> {
    normalized((0..frames).map(|age| ALPHA * (1.0 - ALPHA).powi(age as i32)).collect())
}

/// The eye's sustained and transient response at 60 frames a second: R. Mantiuk et al., "FovVideoVDP", 2021, with the
/// constants that fsot's kernel of this name has. Signed: a filter may subtract.
fn eye(frames: usize) -> Vec<f64> {
    const PEAK: f64 = 0.06;
    const WIDTH: f64 = 0.5;
    const TRANSIENT: f64 = 0.062_170_507_756_932;
    let times: Vec<f64> = (0..frames).map(|frame| (frame as f64 + 0.5) / 60.0 + 1e-4).collect();
    let log = |t: f64| (t / PEAK).ln();
    let sustained = |t: f64| (-log(t) * log(t) / (2.0 * WIDTH * WIDTH)).exp();
    let total: f64 = times.iter().map(|&t| sustained(t)).sum();
    let response = |t: f64| sustained(t) / total * (1.0 - TRANSIENT * log(t) / (WIDTH * WIDTH * t));
    normalized(times.into_iter().map(response).collect())
}

fn normalized(weights: Vec<f64>) -> Vec<f64> {
    let total: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| weight / total).collect()
}

/// The sum of the frames by their weights, the newest last.
fn filtered(frames: &[&Rgb32FImage], weights: &[f64]) -> Rgb32FImage {
    let mut sum = vec![0.0_f64; frames[0].as_raw().len()];
    for (frame, weight) in frames.iter().rev().zip(weights) {
        for (sum, &value) in sum.iter_mut().zip(frame.as_raw()) {
            *sum += weight * f64::from(value);
        }
    }
    let values = sum.into_iter().map(|value| value as f32).collect();
    Rgb32FImage::from_raw(frames[0].width(), frames[0].height(), values).unwrap_or_default()
}

pub(super) fn write(section: &mut Section) -> Result<()> {
    section.chapter.section("Animation", "figures 5.23 and 5.24");
    let plan = section.measurement.plan;
    section.chapter.setting("pixels on a side of the animation", plan.tile_size / 2);
    section.chapter.setting("weight of the newest frame", ALPHA);
    section.chapter.setting("seeds of the animation", plan.animation_seeds);
    section.chapter.setting("samples per pixel of the tile whose settings were chosen", CHOSEN);
    let tiles = section.measurement.renderer.tiles()?;
    let mut rows = Vec::new();
    let sizes = plan.some(&TEMPORAL).iter().zip(plan.animation);
    for (scene, (&(spp, temporal), last)) in
        SCENES.into_iter().flat_map(|scene| sizes.clone().map(move |size| (scene, size)))
    {
        let references = references(section, scene, last)?;
        let samplers = [
            ("random", Some(Sampler::Random)),
            ("Owen-Sobol", Some(Sampler::Sobol)),
            ("shifted tile", Choice::Tile(2).sampler(spp, &tiles)),
            ("temporal tile", tiles.find(temporal).map(Sampler::Tile)),
        ];
        let mut all = Vec::new();
        for (label, sampler) in samplers {
            let Some(sampler) = sampler else { continue };
            all.push((label, measure(section, scene, &references, sampler, spp)?));
        }
        let errors = |label: &str, kernel: usize| {
            all.iter().find(|(name, _)| *name == label).map(|(_, measured)| measured.errors[kernel].clone())
        };
        for (kernel, (name, _)) in KERNELS.iter().enumerate() {
            let random = errors("random", kernel).unwrap_or_default();
            for (label, measured) in &all {
                let own = &measured.errors[kernel];
                let thousandfold: Vec<f64> = own.iter().map(|error| 1e3 * error).collect();
                let error = Figure::new(Estimate::median(&thousandfold), Unit::RelMseE3);
                let ratio = Figure::new(Estimate::ratio(own, &random), Unit::Ratio);
                rows.push(row![scene, spp, last, *name, *label, error, ratio]);
            }
            if let Some(temporal) = errors("temporal tile", kernel) {
                for (other, words) in [("shifted tile", "the tile shifted anew"), ("random", "independent frames")] {
                    if let Some(other) = errors(other, kernel) {
                        let statement = format!("temporal tile over {words}, filtered in time and space, {spp} spp");
                        let estimate = Estimate::ratio(&temporal, &other);
                        section.targets.at_most(&statement, &format!("{scene}, {name}"), estimate, Unit::Ratio, 1.0);
                    }
                }
            }
        }
    }
    let columns = "scene | samples | frame | filter | sampler | relMSE x 1000 | over random";
    section.chapter.table("animation", columns, 5, rows);
    Ok(())
}

fn view(section: &Section, scene: &'static str, frame: u32) -> View {
    View { frame, ..View::new(scene, section.measurement.plan.tile_size / 2) }
}

/// Of the frames up to the last one that counts.
fn references(section: &Section, scene: &'static str, last: u32) -> Result<Vec<std::rc::Rc<Reference>>> {
    (0..last).map(|frame| section.measurement.reference(view(section, scene, frame))).collect()
}

struct Measured {
    /// Of each kernel and seed: relMSE of what is seen, filtered over the image too.
    errors: Vec<Vec<f64>>,
}

fn measure(
    section: &Section,
    scene: &'static str,
    references: &[std::rc::Rc<Reference>],
    sampler: Sampler,
    spp: u32,
) -> Result<Measured> {
    let seeds = section.measurement.plan.animation_seeds;
    let experiment =
        |frame| Experiment { sampler, seeds, ..Experiment::new(view(section, scene, frame), spp, &[BASELINE]) };
    let experiments: Vec<Experiment> = (0..references.len() as u32).map(experiment).collect();
    let frames = section.measurement.render(&experiments)?.into_iter().flatten().map(|renderings| renderings.images);
    let (frames, count): (Vec<_>, _) = (frames.collect(), references.len());
    let mut errors = Vec::new();
    for (_, kernel) in KERNELS {
        let weights = kernel(count);
        let reference = seen(references, &weights);
        let each = (0..seeds as usize).map(|seed| {
            let sequence: Vec<&Rgb32FImage> = frames.iter().map(|images| &images[seed]).collect();
            let seen = filtered(&sequence, &weights);
            score::errors(&seen, &reference)[1]
        });
        errors.push(each.collect());
    }
    Ok(Measured { errors })
}

/// The references filtered along time.
fn seen(references: &[std::rc::Rc<Reference>], weights: &[f64]) -> Reference {
    let [a, b] = [0, 1].map(|half| {
        let frames: Vec<&Rgb32FImage> = references.iter().map(|reference| &reference.images[half]).collect();
        filtered(&frames, weights)
    });
    Reference::new(&a, &b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn kernels_keep_a_constant() {
        for (name, kernel) in KERNELS {
            let weights = kernel(16);
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{name}");
            let frame = Rgb32FImage::from_pixel(2, 2, Rgb([3.0; 3]));
            let seen = filtered(&[&frame; 16], &weights);
            assert!(seen.iter().all(|value| (value - 3.0).abs() < 1e-5), "{name}");
        }
        assert!(average(16).windows(2).all(|pair| pair[0] > pair[1]));
        assert!(eye(16).iter().any(|&weight| weight < 0.0), "the transient response has a negative tail");
    }

    #[test]
    fn the_newest_frame_weighs_most() {
        let [old, new] = [1.0, 2.0].map(|value| Rgb32FImage::from_pixel(1, 1, Rgb([value; 3])));
        assert_eq!(filtered(&[&old, &new], &[0.75, 0.25]).as_raw()[0], 1.75);
    }
}
