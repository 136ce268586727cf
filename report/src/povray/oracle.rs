//! Compiling and running tests/povray/oracle.cpp: the path tracer's samplers and estimators on stacks.

use super::{scenes::Scene, stack};
use crate::measure::image::read_pfm;
use crate::measure::interrupt::Interrupted;
use crate::measure::metric::Reference;
use crate::measure::renderer::{Job, Renderer, Sampler, images, threads};
use crate::measure::side_by_side;
use anyhow::{Context, Result, bail};
use image::Rgb32FImage;
use indicatif::ProgressBar;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use xtask::{paths, run};

/// Warnings are errors: the program is a test's.
const STRICT: [&str; 7] = ["-Wall", "-Wextra", "-pedantic", "-Werror", "-O2", "-std=c++17", "-Iinclude"];

/// Runs of the program side by side, at most: each holds the stack.
const RUNS: u32 = 4;

/// The compiled program, and where its pictures go.
pub(crate) struct Oracle {
    program: PathBuf,
    renderer: Renderer,
    scratch: TempDir,
}

/// What lies between the centres of a stack's cells; tests/povray/stack_integrand.hpp.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Model {
    Cells,
    Linear,
}

impl Model {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Cells => "cells",
            Self::Linear => "linear",
        }
    }
}

/// A stack as an integrand, and its exact mean.
pub(crate) struct View {
    path: PathBuf,
    size: u32,
    pub(crate) reference: Reference,
}

impl View {
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

/// What is rendered of a stack.
#[derive(Clone, Copy)]
pub(crate) struct Request<'a> {
    pub(crate) model: Model,
    pub(crate) spp: u32,
    /// Total degree of the fits.
    pub(crate) order: u32,
    pub(crate) sampler: Sampler<'a>,
    pub(crate) estimators: &'a [&'a str],
    /// So many, from 1 on.
    pub(crate) seeds: u32,
}

/// One estimator's renderings, seed by seed.
pub(crate) struct Renderings {
    pub(crate) images: Vec<Rgb32FImage>,
}

impl Oracle {
    /// Links the library in `archive`.
    pub(crate) fn build(archive: &Path, interrupted: Interrupted) -> Result<Self> {
        let folder = paths::output();
        fs::create_dir_all(&folder).with_context(|| format!("cannot create {}", folder.display()))?;
        let program = folder.join("oracle");
        let mut compiler = run::compiler("CXX", "c++");
        compiler.args(STRICT).arg("tests/povray/oracle.cpp").arg(archive).args(["-pthread", "-o"]).arg(&program);
        run::check(&mut compiler)?;
        let scratch = tempfile::tempdir().context("cannot create a temporary folder")?;
        Ok(Self { renderer: Renderer::new(program.clone(), interrupted), program, scratch })
    }

    /// The scene's stack, rendered if need be.
    pub(crate) fn view(&self, scene: &Scene, cells: &[u32], size: u32) -> Result<View> {
        let path = stack::get(scene, cells, size)?;
        let folder = tempfile::tempdir_in(self.scratch.path()).context("cannot create a temporary folder")?;
        let prefix = folder.path().join("exact");
        self.renderer.render(&job(path_text(&path)?, &[]), size, &prefix, &ProgressBar::hidden())?;
        let exact = read_pfm(&prefix.with_extension("reference.pfm"))?;
        Ok(View { path, size, reference: Reference::new(&exact, &exact) })
    }

    /// In the order of the request's estimators.
    pub(crate) fn render(&self, view: &View, request: &Request) -> Result<Vec<Renderings>> {
        let options = ["--model", request.model.name()];
        let Request { spp, order, sampler, estimators, seeds, .. } = *request;
        let job = Job { spp, order, sampler, estimators, ..job(path_text(&view.path)?, &options) };
        // Each run in a folder of its own: no file of another can be taken for one of this.
        let folder = tempfile::tempdir_in(self.scratch.path()).context("cannot create a temporary folder")?;
        // Shared fits make one bucket of so small an image, which one core renders: seeds keep the others busy.
        let parts = threads().min(RUNS).min(seeds).max(1);
        let runs: Vec<_> = (0..parts)
            .map(|part| [seeds * part / parts, seeds * (part + 1) / parts])
            .map(|[from, to]| Job { seed: 1 + u64::from(from), seeds: to - from, ..job })
            .map(|job| (job, folder.path().join(format!("picture-{}", job.seed))))
            .collect();
        side_by_side::render(&self.renderer, &runs, view.size, RUNS, &ProgressBar::hidden())?;
        let one = |name: &str| -> Result<Renderings> {
            let files = runs.iter().flat_map(|(job, prefix)| images(prefix, name, job.seed, job.seeds));
            let images = files.map(|file| read_pfm(&file)).collect::<Result<_>>()?;
            Ok(Renderings { images })
        };
        estimators.iter().map(|name| one(name)).collect()
    }

    /// What the program says of a stack of 32 x 32 pixels that it must refuse.
    pub(crate) fn refusal(&self, stack: &Path) -> Result<String> {
        let mut command = run::command(&self.program);
        command.args(["--width", "32", "--height", "32", "--spp", "1", "--scene"]).arg(stack);
        let output = command.arg("--output").arg(self.scratch.path().join("refused")).output();
        let output = output.with_context(|| format!("cannot start {}", self.program.display()))?;
        if output.status.code() != Some(1) {
            bail!("{} was not refused ({})", stack.display(), output.status);
        }
        Ok(String::from_utf8_lossy(&output.stderr).trim().to_owned())
    }

    pub(crate) fn scratch(&self) -> &Path {
        self.scratch.path()
    }
}

/// The exact mean.
fn job<'a>(stack: &'a str, options: &'a [&'a str]) -> Job<'a> {
    let sampler = Sampler::Random;
    Job { scene: stack, spp: 1, order: 0, seed: 1, seeds: 1, frame: 0, sampler, estimators: &[], options, work: 0 }
}

fn path_text(path: &Path) -> Result<&str> {
    path.to_str().with_context(|| format!("{} is not Unicode", path.display()))
}
