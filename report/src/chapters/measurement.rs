//! Rendering with several seeds, and what the images say.

use crate::measure::image::read_pfm;
use crate::measure::metric::Reference;
use crate::measure::renderer::{Job, Renderer, Timing, View, images, threads};
use anyhow::{Context, Result};
use image::Rgb32FImage;
use indicatif::ProgressBar;
use rayon::prelude::*;
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::rc::Rc;
use tempfile::TempDir;

/// Beyond those of any measurement.
const REFERENCE_SEEDS: [u64; 2] = [1_000_001, 1_000_002];

/// What one estimator made.
pub(crate) struct Renderings {
    pub(crate) estimator: String,
    /// One for each seed.
    pub(crate) images: Vec<Rgb32FImage>,
    pub(crate) timings: Vec<Timing>,
}

/// What a job made; all estimators saw the same samples.
#[derive(Clone)]
pub(crate) struct Outcome {
    pub(crate) reference: Rc<Reference>,
    pub(crate) renderings: Rc<[Renderings]>,
}

impl Outcome {
    pub(crate) fn of(&self, estimator: &str) -> Result<&Renderings> {
        let found = self.renderings.iter().find(|renderings| renderings.estimator == estimator);
        found.with_context(|| format!("`{estimator}` was not rendered"))
    }
}

impl Renderings {
    /// Raw and filtered errors of each seed, highlights limited: on all threads, since images of samplers are large.
    pub(crate) fn seen(&self, reference: &Reference) -> Vec<[f64; 2]> {
        self.images.par_iter().map(|image| reference.errors(image)).collect()
    }
}

/// A reference that was rendered, and the files of its halves.
type Known = (Rc<Reference>, [PathBuf; 2]);

/// Renders, and remembers references.
pub(crate) struct Measurement<'a> {
    pub(crate) renderer: &'a Renderer,
    bar: &'a ProgressBar,
    scratch: TempDir,
    references: RefCell<BTreeMap<String, Known>>,
    /// What jobs of random samples made: several sections show the same ones. Others are not kept: few sections share
    /// those, and their images are large.
    outcomes: RefCell<BTreeMap<String, Outcome>>,
    /// Runs of the program so far: none's files can be taken for another's.
    runs: Cell<u32>,
}

impl<'a> Measurement<'a> {
    pub(crate) fn new(renderer: &'a Renderer, bar: &'a ProgressBar) -> Result<Self> {
        let scratch = tempfile::tempdir().context("cannot create a temporary folder")?;
        let (references, outcomes) = (RefCell::default(), RefCell::default());
        Ok(Self { renderer, bar, scratch, references, outcomes, runs: Cell::new(0) })
    }

    /// Where files go that are needed until the end.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.scratch.path().join(name)
    }

    pub(crate) fn reference(&self, view: View) -> Result<Rc<Reference>> {
        let key = format!("{view:?}");
        if let Some((known, _)) = self.references.borrow().get(&key) {
            return Ok(known.clone());
        }
        let job = Job::new(view, view.reference, &[]);
        let runs = self.side_by_side(&REFERENCE_SEEDS.map(|seed| Job { seed, ..job.clone() }))?;
        let halves: Vec<PathBuf> = runs.into_iter().map(|(prefix, _)| prefix.with_extension("reference.pfm")).collect();
        let halves: [PathBuf; 2] = halves.try_into().ok().context("a reference was lost")?;
        let reference = Rc::new(Reference::new(&read_pfm(&halves[0])?, &read_pfm(&halves[1])?));
        self.references.borrow_mut().insert(key, (reference.clone(), halves));
        Ok(reference)
    }

    /// Renders every seed of each; or takes what was rendered before with the same samples, and with these estimators
    /// and perhaps more. No two may have the same samples. Side by side: where no times are compared.
    pub(crate) fn run(&self, jobs: &[Job]) -> Result<Vec<Outcome>> {
        let new: Vec<Job> = jobs.iter().filter(|job| self.known(job).is_none()).cloned().collect();
        new.iter().try_for_each(|job| self.reference(job.view).map(|_| ()))?;
        let mut renderings = self.render(&new)?.into_iter();
        let mut outcome = |job: &Job| -> Result<Outcome> {
            if let Some(known) = self.known(job) {
                return Ok(known);
            }
            let renderings = renderings.next().context("a rendering was lost")?.into();
            let outcome = Outcome { reference: self.reference(job.view)?, renderings };
            if let Some(key) = key(job) {
                self.outcomes.borrow_mut().insert(key, outcome.clone());
            }
            Ok(outcome)
        };
        jobs.iter().map(&mut outcome).collect()
    }

    /// What was rendered before, if all estimators were.
    fn known(&self, job: &Job) -> Option<Outcome> {
        let known = self.outcomes.borrow().get(&key(job)?)?.clone();
        job.estimators.iter().all(|estimator| known.of(estimator).is_ok()).then_some(known)
    }

    /// Without a reference; several side by side.
    pub(crate) fn render(&self, jobs: &[Job]) -> Result<Vec<Vec<Renderings>>> {
        let runs = self.side_by_side(jobs)?;
        let read = |(job, (prefix, timings)): (&Job, (PathBuf, Vec<Timing>))| {
            let renderings = job.estimators.iter().map(|&estimator| {
                let images = images(&prefix, estimator, job).map(|file| {
                    let image = read_pfm(&file)?;
                    std::fs::remove_file(file)?;
                    Ok(image)
                });
                Ok(Renderings {
                    estimator: estimator.to_owned(),
                    images: images.collect::<Result<_>>()?,
                    timings: timings.iter().filter(|timing| timing.estimator == estimator).cloned().collect(),
                })
            });
            renderings.collect()
        };
        jobs.iter().zip(runs).map(read).collect()
    }

    /// Several runs of the program at the same time, which share the cores: of each its files' prefix and times.
    /// Loading a scene and small images with shared fits, which are one bucket, keep one core of a run busy.
    fn side_by_side(&self, jobs: &[Job]) -> Result<Vec<(PathBuf, Vec<Timing>)>> {
        let Some(job) = jobs.first() else { return Ok(Vec::new()) };
        let what = if job.estimators.is_empty() { "reference".to_owned() } else { format!("{} spp", job.spp) };
        self.bar.set_message(format!("{}: {what}", job.view.scene));
        let each = threads() / threads().min(jobs.len() as u32).max(1);
        let first = self.runs.get();
        self.runs.set(first + jobs.len() as u32);
        let prefixes = (first..).map(|number| self.path(&format!("run-{number}")));
        let (runs, renderer): (Vec<(&Job, PathBuf)>, _) = (jobs.iter().zip(prefixes).collect(), self.renderer);
        let one = |(job, prefix): (&Job, PathBuf)| {
            let timings = renderer.render(job, &prefix, each)?;
            Ok((prefix, timings))
        };
        runs.into_par_iter().with_max_len(1).map(one).collect()
    }

    /// In batches of as many seeds, side by side: for each batch and estimator the mean, and the mean of (I - A)(I - B)
    /// pixel by pixel.
    pub(crate) fn statistics(&self, job: &Job, batches: u32) -> Result<Vec<Vec<[Rgb32FImage; 2]>>> {
        self.reference(job.view)?;
        let references = self.references.borrow();
        let (_, halves) = references.get(&format!("{:?}", job.view)).context("the reference was lost")?;
        let files = halves.each_ref().map(|file| file.display().to_string()).join(",");
        let options = [&job.options[..], &["--statistics", &files]].concat();
        let batch =
            |batch: u32| Job { seed: job.seed + u64::from(batch * job.seeds), options: options.clone(), ..job.clone() };
        let runs = self.side_by_side(&(0..batches).map(batch).collect::<Vec<_>>())?;
        let one = |(prefix, _): &(PathBuf, Vec<Timing>)| -> Result<Vec<[Rgb32FImage; 2]>> {
            let read =
                |estimator: &str, what: &str| read_pfm(&prefix.with_extension(format!("{estimator}.{what}.pfm")));
            job.estimators.iter().map(|estimator| Ok([read(estimator, "mean")?, read(estimator, "mse")?])).collect()
        };
        runs.iter().map(one).collect()
    }
}

/// Tells jobs of random samples apart.
fn key(job: &Job) -> Option<String> {
    let Job { view, spp, order, seeds, options, .. } = job;
    job.is_random().then(|| format!("{view:?} {spp} {order} {seeds} {options:?}"))
}
