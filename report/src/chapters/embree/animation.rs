//! An animation, filtered along time and over the image: figures 5.23 and 5.24.

use super::Harness;
use crate::chapters::prelude::*;
use crate::measure::metric::Reference;
use crate::measure::renderer::{Job, View};
use image::Rgb32FImage;
use itertools::iproduct;
use std::rc::Rc;

/// The first is the thesis's, and what the temporal tile of [`CHOSEN`] samples had its settings chosen on; the second
/// has had no part in any choice.
const SCENES: [&str; 2] = ["animation", "dining"];
/// Samples per pixel of the temporal tile whose settings were chosen by rendering.
pub(super) const CHOSEN: u32 = 4;
/// Weight of the newest frame in the exponential moving average: what the temporal tiles were optimised for.
pub(super) const ALPHA: f64 = 0.2;
/// The figures' samples per pixel, the tile of as many that was optimised over frames too, and plan.toml's last frame.
const TEMPORAL: [(u32, &str, &str); 2] =
    [(1, "128_1SPP_2D_TEMPORAL", "animation_1"), (4, "64_4SPP_2D_TEMPORAL", "animation_4")];
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

/// Rows of what is seen: of each filter and seed the relMSE, filtered over the image too.
pub(super) fn measure(harness: &Harness) -> Result<Table> {
    let (plan, seeds) = (harness.plan, harness.plan.of("animation_seeds"));
    let mut all = Table::new("animation", "scene | spp | frame | filter | sampler | error");
    for (scene, &(spp, temporal, last)) in iproduct!(SCENES, plan.some(&TEMPORAL)) {
        let last = plan.of(last);
        let view = |frame| Ok(View { frame, ..harness.view(scene, plan.of("animation_size"), 1)? });
        let views = (0..last).map(view).collect::<Result<Vec<View>>>()?;
        let references = views.iter().map(|&view| harness.measurement.reference(view)).collect::<Result<Vec<_>>>()?;
        let ours = [("default sampler", "default"), ("shifted tile", "tile 2D"), ("temporal tile", temporal)];
        for (label, sampler) in ["random", "Owen-Sobol"].map(|name| (name, name)).into_iter().chain(ours) {
            let Some(sampler) = harness.measurement.renderer.sampler(sampler, spp) else { continue };
            let job = |&view: &View<'static>| Job { sampler: sampler.clone(), seeds, ..Job::new(view, spp, &["mc"]) };
            let jobs: Vec<Job> = views.iter().map(job).collect();
            let frames: Vec<Vec<Rgb32FImage>> =
                harness.measurement.render(&jobs)?.into_iter().flatten().map(|of| of.images).collect();
            for (name, kernel) in KERNELS {
                let weights = kernel(references.len());
                let reference = seen(&references, &weights);
                for seed in 0..seeds as usize {
                    let sequence: Vec<&Rgb32FImage> = frames.iter().map(|images| &images[seed]).collect();
                    let error = reference.errors(&filtered(&sequence, &weights))[1];
                    all.push([scene, &spp.to_string(), &last.to_string(), name, label, &error.to_string()]);
                }
            }
        }
    }
    Ok(all)
}

/// The references filtered along time.
fn seen(references: &[Rc<Reference>], weights: &[f64]) -> Reference {
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
