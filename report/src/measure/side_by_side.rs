//! Several runs of the path tracer at the same time. Loading a scene and small images with shared fits, which are one
//! bucket, keep one core of a run busy; runs beside each other keep all.

use super::renderer::{Job, Renderer, Timing, threads};
use anyhow::Result;
use indicatif::ProgressBar;
use rayon::prelude::*;
use std::path::PathBuf;

/// What is rendered, and the files' prefix.
pub(crate) type Run<'a> = (Job<'a>, PathBuf);

/// [`Renderer::render`] of each, which share the cores. In the order of the runs.
pub(crate) fn render(renderer: &Renderer, runs: &[Run], size: u32, bar: &ProgressBar) -> Result<Vec<Vec<Timing>>> {
    let each = threads() / threads().min(runs.len() as u32).max(1);
    let one = |(job, prefix): &Run| {
        // A bar's position can be set by one run only.
        let timings = renderer.render_with(each, job, size, prefix, &ProgressBar::hidden())?;
        bar.inc(job.work);
        Ok(timings)
    };
    runs.par_iter().with_max_len(1).map(one).collect()
}
