//! Rendering one scene with every sampler.

use super::plan::{BASELINE, ESTIMATORS, Plan, Scene};
use crate::measure::metric::{Reference, median};
use crate::measure::renderer::{Job, Sampler, Timing};
use crate::measure::runs::{Runs, SEED};
use crate::measure::samplers::{Choice, Tiles};
use crate::measure::score::Score;
use crate::measure::text;
use anyhow::{Context, Result, bail};
use image::Rgb32FImage;

/// Everything that a measurement needs.
pub(crate) struct Measurement<'a> {
    pub(crate) runs: &'a Runs<'a>,
    pub(crate) plan: &'a Plan,
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
        estimators: &[&str],
    ) -> Result<Vec<Timing>> {
        let (order, work) = (scene.order, self.plan.work(scene, spp, estimators.len()));
        let (scene, seed) = (scene.name, SEED);
        self.runs.render(&Job { scene, spp, order, seed, seeds: 1, frame, sampler, estimators, options: &[], work })
    }

    pub(crate) fn reference(&self, scene: &Scene) -> Result<Reference> {
        let spp = self.plan.reference_spp(scene);
        self.runs.reference(scene.name, spp, self.plan.work(scene, spp, 0))
    }

    /// One frame by the plain mean.
    pub(crate) fn frame(&self, scene: &Scene, sampler: Sampler, spp: u32, frame: u32) -> Result<Rgb32FImage> {
        self.render(scene, sampler, spp, frame, &["mc"])?;
        self.runs.image(scene.name, "mc")
    }

    /// Every sampler that there is and every estimator, sampler by sampler within each number of samples.
    pub(crate) fn scene(&self, scene: &Scene, reference: &Reference) -> Result<Vec<Measured>> {
        let mut all = Vec::new();
        for spp in self.plan.spp {
            self.runs.say(format!("{}: {}", scene.name, text::samples_per_pixel(spp)));
            let choices: Vec<_> = scene
                .samplers
                .iter()
                .filter_map(|&choice| choice.sampler(spp, self.tiles).map(|sampler| (choice, sampler)))
                .collect();
            // frames[choice][estimator][frame]; frame by frame, so that all samplers meet the machine in the same mood.
            let mut frames: Vec<[Vec<Frame>; ESTIMATORS.len()]> = choices.iter().map(|_| Default::default()).collect();
            for frame in 0..self.plan.frames(scene) {
                for (index, &(_, sampler)) in choices.iter().enumerate() {
                    let timings = self.render(scene, sampler, spp, frame, &ESTIMATORS)?;
                    for (estimator, name) in ESTIMATORS.iter().enumerate() {
                        let image = self.runs.image(scene.name, name)?;
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

pub(crate) fn find<'a>(all: &'a [Measured], choice: Choice, spp: u32, estimator: &str) -> Option<&'a Measured> {
    all.iter().find(|one| (one.choice, one.spp, one.estimator) == (choice, spp, estimator))
}

/// The plain mean of random samples, as many as `of` has.
pub(crate) fn baseline<'a>(all: &'a [Measured], of: &Measured) -> Option<&'a Measured> {
    find(all, BASELINE, of.spp, ESTIMATORS[0])
}

/// The errors of `of` over those of `to`: raw, filtered.
pub(crate) fn ratios(of: &Measured, to: Option<&Measured>) -> [f64; 2] {
    let ratio = |error: fn(&Score) -> f64| to.map_or(f64::NAN, |to| error(&of.score) / error(&to.score));
    [ratio(|score| score.raw), ratio(|score| score.filtered)]
}
