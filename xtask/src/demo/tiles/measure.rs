//! Rendering one scene with every sampler.

use super::plan::{BASELINE, Choice, ESTIMATORS, ORDER, Plan, Scene, Tiles};
use super::score::Score;
use crate::demo::image::read_pfm;
use crate::demo::metric::{Reference, median};
use crate::demo::renderer::{Job, Renderer, Sampler, Timing};
use anyhow::{Context, Result, bail};
use image::Rgb32FImage;
use indicatif::ProgressBar;
use std::path::Path;

const SEED: u64 = 1;
const REFERENCE_SEEDS: [u64; 2] = [1001, 1002];

/// Everything that a measurement needs.
pub(crate) struct Measurement<'a> {
    pub(crate) renderer: &'a Renderer,
    pub(crate) plan: &'a Plan,
    pub(crate) bar: &'a ProgressBar,
    pub(crate) scratch: &'a Path,
    pub(crate) tiles: &'a Tiles,
}

/// One sampler and estimator at one number of samples.
pub(crate) struct Measured {
    pub(crate) choice: Choice,
    /// The tile's name, or nothing.
    pub(crate) tile: String,
    pub(crate) spp: u32,
    pub(crate) estimator: &'static str,
    /// The first frame.
    pub(crate) image: Rgb32FImage,
    pub(crate) score: Score,
    /// Time per sample and thread, in nanoseconds: making the points, and everything.
    pub(crate) drawing_ns: f64,
    pub(crate) total_ns: f64,
}

/// What one frame adds.
struct Frame {
    image: Rgb32FImage,
    score: Score,
    timing: Timing,
}

impl Measurement<'_> {
    fn render(
        &self,
        scene: &Scene,
        sampler: Sampler,
        spp: u32,
        frame: u32,
        seed: u64,
        estimators: &[&str],
    ) -> Result<Vec<Timing>> {
        let job = Job {
            scene: scene.name,
            size: self.plan.size,
            spp,
            order: ORDER,
            seed,
            frame,
            threads: self.plan.threads,
            sampler,
            estimators,
            prefix: &self.scratch.join(scene.name),
        };
        self.renderer.render(&job, self.bar, self.plan.work(scene, spp, estimators.len()))
    }

    fn image(&self, scene: &Scene, name: &str) -> Result<Rgb32FImage> {
        read_pfm(&self.scratch.join(format!("{}.{name}.pfm", scene.name)))
    }

    pub(crate) fn reference(&self, scene: &Scene) -> Result<Reference> {
        self.bar.set_message(format!("{}: reference", scene.name));
        let half = |seed| {
            self.render(scene, Sampler::Random, self.plan.reference_spp, 0, seed, &[])?;
            self.image(scene, "reference")
        };
        let [a, b] = REFERENCE_SEEDS;
        Ok(Reference::new(&half(a)?, &half(b)?))
    }

    /// One frame by the plain mean.
    pub(crate) fn frame(&self, scene: &Scene, sampler: Sampler, spp: u32, frame: u32) -> Result<Rgb32FImage> {
        self.render(scene, sampler, spp, frame, SEED, &["mc"])?;
        self.image(scene, "mc")
    }

    /// Every sampler that there is and every estimator, sampler by sampler within each number of samples.
    pub(crate) fn scene(&self, scene: &Scene, reference: &Reference) -> Result<Vec<Measured>> {
        let mut all = Vec::new();
        for spp in self.plan.spp {
            self.bar.set_message(format!("{}: {spp} samples per pixel", scene.name));
            let choices: Vec<_> = scene
                .samplers
                .iter()
                .filter_map(|&choice| choice.sampler(spp, self.tiles).map(|sampler| (choice, sampler)))
                .collect();
            // frames[choice][estimator][frame]; frame by frame, so that all samplers meet the machine in the same mood.
            let mut frames: Vec<[Vec<Frame>; 2]> = choices.iter().map(|_| Default::default()).collect();
            for frame in 0..self.plan.frames {
                for (index, &(_, sampler)) in choices.iter().enumerate() {
                    let timings = self.render(scene, sampler, spp, frame, SEED, &ESTIMATORS)?;
                    for (estimator, name) in ESTIMATORS.iter().enumerate() {
                        let image = self.image(scene, name)?;
                        let score = Score::new(&image, reference);
                        let timing = timings.iter().find(|timing| timing.estimator == *name).cloned();
                        let timing = timing.context("the path tracer printed no times")?;
                        frames[index][estimator].push(Frame { image, score, timing });
                    }
                }
            }
            for ((choice, sampler), frames) in choices.into_iter().zip(frames) {
                for (estimator, frames) in ESTIMATORS.into_iter().zip(frames) {
                    let tile = if let Sampler::Tile(name) = sampler { name.to_owned() } else { String::new() };
                    all.push(summary(choice, tile, spp, estimator, frames)?);
                }
            }
        }
        Ok(all)
    }
}

fn summary(choice: Choice, tile: String, spp: u32, estimator: &'static str, frames: Vec<Frame>) -> Result<Measured> {
    let scores: Vec<Score> = frames.iter().map(|frame| frame.score).collect();
    let time = |of: fn(&Timing) -> f64| median(frames.iter().map(|frame| of(&frame.timing)));
    let drawing_ns = time(|timing| timing.drawing_ns_per_sample);
    let total_ns = time(|timing| timing.sampling_ns_per_sample + timing.estimating_ns_per_sample);
    let Some(first) = frames.into_iter().next() else { bail!("no frame was rendered") };
    Ok(Measured { choice, tile, spp, estimator, image: first.image, score: Score::mean(&scores), drawing_ns, total_ns })
}

/// The plain mean of random samples, as many as `of` has.
pub(crate) fn baseline<'a>(all: &'a [Measured], of: &Measured) -> Option<&'a Measured> {
    all.iter().find(|one| one.choice == BASELINE && one.estimator == ESTIMATORS[0] && one.spp == of.spp)
}
