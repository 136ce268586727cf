//! The examples, stock and patched, at equal numbers of samples.

use super::Options;
use super::checks::sampling;
use super::render::{Renderer, Settings};
use super::scenes::{Kind, SCENES, Scene};
use crate::measure::metric::Reference;
use crate::measure::progress;
use crate::measure::score::Score;
use anyhow::Result;
use image::Rgb32FImage;
use indicatif::ProgressBar;

/// How a picture is made.
pub(crate) struct Method {
    pub(crate) name: &'static str,
    /// None: stock POV-Ray.
    settings: Option<&'static [(&'static str, &'static str)]>,
}

pub(crate) const STOCK: usize = 0;
pub(crate) const RANDOM: usize = 1;

pub(crate) const METHODS: [Method; 7] = [
    Method { name: "stock", settings: None },
    Method { name: "random", settings: Some(&[("", "samples"), ("SAMPLER", "random")]) },
    Method { name: "sobol", settings: Some(&[("", "samples"), ("SAMPLER", "sobol")]) },
    Method { name: "tile", settings: Some(&[("", "samples"), ("SAMPLER", "tile")]) },
    Method {
        name: "random, accumulator",
        settings: Some(&[("", "estimate"), ("SAMPLER", "random"), ("ESTIMATOR", "accumulator"), ("ORDER", "2")]),
    },
    Method { name: "random, estimate", settings: Some(&[("", "estimate"), ("SAMPLER", "random")]) },
    Method { name: "tile, estimate", settings: Some(&[("", "estimate"), ("SAMPLER", "tile")]) },
];

/// Stock POV-Ray has no seed. Which numbers of its generator a pixel gets depends on the pixels before it in a block,
/// so blocks of other sizes are other pictures; its focal blur depends on the pixel's place alone, and has but one.
const BLOCKS: [u32; 16] = [32, 8, 12, 16, 20, 24, 28, 36, 40, 44, 48, 52, 56, 60, 64, 10];
const REFERENCE_SEEDS: [u32; 2] = [1001, 1002];

/// One method on one scene at one number of samples.
pub(crate) struct Series {
    pub(crate) scene: usize,
    pub(crate) method: usize,
    pub(crate) spp: u32,
    pub(crate) scores: Vec<Score>,
    pub(crate) cpu_seconds: Vec<f64>,
    /// The first picture.
    pub(crate) image: Rgb32FImage,
}

/// An area light whose points move shading with shadow, against POV-Ray's own model, in which they do not.
pub(crate) struct Models {
    pub(crate) scene: &'static str,
    /// relMSE of the one with respect to the other.
    pub(crate) rel_mse: f64,
    /// The largest difference of a channel, as a part of the picture's largest value.
    pub(crate) largest: f64,
}

pub(crate) struct Measured {
    pub(crate) references: Vec<Reference>,
    pub(crate) series: Vec<Series>,
    pub(crate) models: Vec<Models>,
}

/// What is common to all patched pictures of a scene.
fn settings(scene: &Scene, seed: u32) -> [(&'static str, String); 3] {
    // As stock POV-Ray treats an area light: its points cast shadows, its centre shades.
    let pixel = if scene.kind == Kind::Lens { "box" } else { "center" };
    [("SEED", seed.to_string()), ("PIXEL", pixel.to_owned()), ("LIGHT", "shadow".to_owned())]
}

pub(crate) fn run(renderer: &Renderer, options: &Options) -> Result<Measured> {
    let samples: u32 = options.spp.iter().sum::<u32>() * options.seeds * METHODS.len() as u32;
    let bar = progress::bar(u64::from(samples + 3 * options.reference) * SCENES.len() as u64)?;
    let mut measured = Measured { references: Vec::new(), series: Vec::new(), models: Vec::new() };
    for (index, scene) in SCENES.iter().enumerate() {
        for (name, text) in scene.includes()? {
            renderer.provide(name, text.as_bytes())?;
        }
        renderer.provide("patched.pov", scene.original()?.as_bytes())?;
        let reference = reference(renderer, scene, options.reference, &bar)?;
        if scene.kind == Kind::AreaLight {
            measured.models.push(models(renderer, scene, options.reference, &reference)?);
        }
        bar.inc(u64::from(options.reference));
        for &spp in &options.spp {
            renderer.provide("stock.pov", scene.stock(spp)?.as_bytes())?;
            for (number, method) in METHODS.iter().enumerate() {
                bar.set_message(format!("{}: {}, {spp} samples", scene.name, method.name));
                let series = series(renderer, scene, method, spp, options.seeds, &reference)?;
                measured.series.push(Series { scene: index, method: number, ..series });
                bar.inc(u64::from(spp * options.seeds));
            }
        }
        measured.references.push(reference);
    }
    bar.finish_and_clear();
    Ok(measured)
}

fn reference(renderer: &Renderer, scene: &Scene, spp: u32, bar: &ProgressBar) -> Result<Reference> {
    bar.set_message(format!("{}: reference", scene.name));
    let half = |seed| -> Result<Rgb32FImage> {
        let mut all = sampling(spp, &[("SAMPLER", "sobol")]);
        all.extend(settings(scene, seed));
        let picture = renderer.patched("patched.pov", &all)?;
        bar.inc(u64::from(spp));
        Ok(picture.image)
    };
    let [a, b] = REFERENCE_SEEDS;
    Ok(Reference::new(&half(a)?, &half(b)?))
}

fn models(renderer: &Renderer, scene: &Scene, spp: u32, reference: &Reference) -> Result<Models> {
    let mut all = sampling(spp, &[("SAMPLER", "sobol")]);
    all.extend(settings(scene, REFERENCE_SEEDS[0]));
    all.retain(|(name, _)| *name != "LIGHT");
    let whole = renderer.patched("patched.pov", &all)?.image;
    let pairs = || whole.iter().zip(reference.image.iter());
    let brightest = whole.iter().copied().fold(0.0, f32::max);
    let largest = pairs().map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) / brightest;
    Ok(Models { scene: scene.name, rel_mse: reference.rel_mse(&whole), largest: f64::from(largest) })
}

fn series(
    renderer: &Renderer,
    scene: &Scene,
    method: &Method,
    spp: u32,
    seeds: u32,
    reference: &Reference,
) -> Result<Series> {
    let seeds = if method.settings.is_none() && scene.kind == Kind::Lens { 1 } else { seeds };
    let (mut scores, mut cpu_seconds, mut first) = (Vec::new(), Vec::new(), None);
    for seed in 0..seeds {
        let picture = match method.settings {
            None => {
                let block = BLOCKS[seed as usize % BLOCKS.len()];
                renderer.stock("stock.pov", &["+WT1", &format!("+BS{block}")])?
            }
            Some(own) => {
                let mut all: Settings = own.iter().map(|&(name, value)| (name, value.to_owned())).collect();
                all.push(("SPP", spp.to_string()));
                all.extend(settings(scene, seed));
                renderer.patched("patched.pov", &all)?
            }
        };
        scores.push(Score::new(&picture.image, reference));
        cpu_seconds.push(picture.cpu_seconds);
        first.get_or_insert(picture.image);
    }
    let image = first.unwrap_or_else(|| Rgb32FImage::new(renderer.width, renderer.height));
    Ok(Series { scene: 0, method: 0, spp, scores, cpu_seconds, image })
}

impl Measured {
    pub(crate) fn find(&self, scene: usize, method: usize, spp: u32) -> Option<&Series> {
        self.series.iter().find(|s| s.scene == scene && s.method == method && s.spp == spp)
    }
}
