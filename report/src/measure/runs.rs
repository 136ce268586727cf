//! Renderings of one size: made in a temporary folder, and read.

use super::image::read_pfm;
use super::metric::Reference;
use super::renderer::{Job, Renderer, Sampler, Timing};
use anyhow::{Context, Result};
use image::Rgb32FImage;
use indicatif::ProgressBar;
use std::path::PathBuf;
use tempfile::TempDir;

/// Of everything that is measured.
pub(crate) const SEED: u64 = 1;
const REFERENCE_SEEDS: [u64; 2] = [1001, 1002];

/// Runs of the path tracer, for square images that have `size` pixels on a side.
pub(crate) struct Runs<'a> {
    renderer: &'a Renderer,
    bar: &'a ProgressBar,
    size: u32,
    scratch: TempDir,
}

impl<'a> Runs<'a> {
    pub(crate) fn new(renderer: &'a Renderer, bar: &'a ProgressBar, size: u32) -> Result<Self> {
        let scratch = tempfile::tempdir().context("cannot create a temporary folder")?;
        Ok(Self { renderer, bar, size, scratch })
    }

    /// Says beside the progress bar what is going on.
    pub(crate) fn say(&self, message: String) {
        self.bar.set_message(message);
    }

    fn prefix(&self, scene: &str) -> PathBuf {
        self.scratch.path().join(scene)
    }

    pub(crate) fn render(&self, job: &Job) -> Result<Vec<Timing>> {
        self.renderer.render(job, self.size, &self.prefix(job.scene), self.bar)
    }

    /// What the latest run for that scene and estimator made.
    pub(crate) fn image(&self, scene: &str, estimator: &str) -> Result<Rgb32FImage> {
        read_pfm(&self.prefix(scene).with_extension(format!("{estimator}.pfm")))
    }

    /// Both halves of a reference, each of `spp` samples per pixel, and each adding `work` to the progress bar.
    pub(crate) fn reference(&self, scene: &str, spp: u32, work: u64) -> Result<Reference> {
        self.say(format!("{scene}: reference"));
        let half = |seed| {
            let sampler = Sampler::Random;
            let job =
                Job { scene, spp, order: 0, seed, seeds: 1, frame: 0, sampler, estimators: &[], options: &[], work };
            self.render(&job)?;
            self.image(scene, "reference")
        };
        let [a, b] = REFERENCE_SEEDS;
        Ok(Reference::new(&half(a)?, &half(b)?))
    }
}
