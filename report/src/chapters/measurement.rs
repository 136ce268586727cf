//! Rendering with several seeds, and what the images say.

pub(crate) use super::outcome::{Outcome, Renderings};
use super::plan::Plan;
use super::scenes;
use crate::measure::image::read_pfm;
use crate::measure::metric::Reference;
use crate::measure::renderer::{Job, Renderer, Sampler, Timing, images};
use crate::measure::side_by_side;
use anyhow::{Context, Result};
use image::Rgb32FImage;
use indicatif::ProgressBar;
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use tempfile::TempDir;

/// The plain mean: every ratio is to it.
pub(crate) const BASELINE: &str = "mc";
/// noisefloor's default.
pub(crate) const DEFAULT: &str = "robust";
/// The thesis's estimator, for each channel.
pub(crate) const LEAST_SQUARES: &str = "least_squares";
/// Fits shared by neighbouring pixels.
pub(crate) const SHARED: &str = "shared";
/// The same, exactly unbiased where pixels are independent.
pub(crate) const SHARED_UNBIASED: &str = "shared_k_fold";

const SEED: u64 = 1;
/// Beyond those of any measurement.
const REFERENCE_SEEDS: [u64; 2] = [1_000_001, 1_000_002];

/// What is integrated, pixel by pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct View {
    pub(crate) scene: &'static str,
    /// Pixels on a side.
    pub(crate) size: u32,
    pub(crate) frame: u32,
    /// Samples of the reference, over what the scene's references have.
    pub(crate) precision: u32,
    /// Words of the command line that change what is integrated.
    pub(crate) options: &'static [&'static str],
}

impl View {
    pub(crate) fn new(scene: &'static str, size: u32) -> Self {
        Self { scene, size, frame: 0, precision: 1, options: &[] }
    }
}

/// Renderings that differ in their seeds alone.
#[derive(Clone, Copy)]
pub(crate) struct Experiment<'a> {
    pub(crate) view: View,
    pub(crate) spp: u32,
    pub(crate) order: u32,
    pub(crate) sampler: Sampler<'a>,
    pub(crate) estimators: &'a [&'a str],
    pub(crate) seeds: u32,
    /// Words of the command line that change how it is estimated.
    pub(crate) options: &'a [&'a str],
}

impl<'a> Experiment<'a> {
    /// Order 2, random samples, one seed.
    pub(crate) fn new(view: View, spp: u32, estimators: &'a [&'a str]) -> Self {
        Self { view, spp, order: 2, sampler: Sampler::Random, estimators, seeds: 1, options: &[] }
    }

    /// Tells experiments of random samples apart. None where the samples are not random: few sections share those, and
    /// their images are large.
    fn key(&self) -> Option<String> {
        let Self { view, spp, order, seeds, options, .. } = self;
        matches!(self.sampler, Sampler::Random).then(|| format!("{view:?} {spp} {order} {seeds} {options:?}"))
    }

    /// All words of the command line that it adds.
    fn options(&self, more: &[&'a str]) -> Vec<&'a str> {
        [self.view.options, self.options, more].concat()
    }
}

/// A reference that was rendered, and the files of its halves.
struct Known {
    reference: Rc<Reference>,
    halves: [PathBuf; 2],
}

/// Renders, and remembers references.
pub(crate) struct Measurement<'a> {
    pub(crate) plan: Plan,
    pub(crate) renderer: &'a Renderer,
    pub(crate) bar: &'a ProgressBar,
    scratch: TempDir,
    references: RefCell<BTreeMap<View, Known>>,
    /// Experiments of random samples: several sections show the same ones.
    outcomes: RefCell<BTreeMap<String, Outcome>>,
    /// Runs of the program so far.
    runs: Cell<u32>,
    /// Where the bar will be at the end of the section.
    section_end: Cell<u64>,
}

impl<'a> Measurement<'a> {
    pub(crate) fn new(plan: Plan, renderer: &'a Renderer, bar: &'a ProgressBar) -> Result<Self> {
        let scratch = tempfile::tempdir().context("cannot create a temporary folder")?;
        let (references, outcomes) = (RefCell::default(), RefCell::default());
        let (runs, section_end) = (Cell::new(0), Cell::new(0));
        Ok(Self { plan, renderer, bar, scratch, references, outcomes, runs, section_end })
    }

    /// What follows advances the bar from `start` to `end` at most.
    pub(crate) fn begin_section(&self, start: u64, end: u64) {
        self.bar.set_position(start);
        self.section_end.set(end);
    }

    /// Where files that outlive one rendering go.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.scratch.path().join(name)
    }

    /// A new folder for the files of one run: none of another run can be taken for one of this.
    fn run_folder(&self) -> Result<TempDir> {
        self.runs.set(self.runs.get() + 1);
        let folder =
            tempfile::Builder::new().prefix(&format!("run-{}-", self.runs.get())).tempdir_in(self.scratch.path());
        folder.context("cannot create a temporary folder")
    }

    pub(crate) fn reference(&self, view: View) -> Result<Rc<Reference>> {
        if let Some(known) = self.references.borrow().get(&view) {
            return Ok(known.reference.clone());
        }
        self.bar.set_message(format!("{}: reference", view.scene));
        // Many pixels, few samples: the reference's error matters less.
        let divisor = self.plan.reference_divisor * if view.size >= self.plan.tile_size { 4 } else { 1 };
        let factor = view.precision * self.plan.reference_factor;
        let spp = (factor * scenes::find(view.scene)?.reference_spp / divisor).max(16);
        let index = self.references.borrow().len();
        let experiment = Experiment::new(view, spp, &[]);
        let prefixes = REFERENCE_SEEDS.map(|seed| self.path(&format!("half-{index}-{seed}")));
        let mut runs = Vec::new();
        for (seed, prefix) in REFERENCE_SEEDS.into_iter().zip(&prefixes) {
            let job = self.job(&experiment, seed, 1)?;
            runs.push((Job { options: view.options, ..job }, prefix.clone()));
        }
        self.side_by_side(&mut runs, view.size)?;
        let halves = prefixes.map(|prefix| prefix.with_extension("reference.pfm"));
        let reference = Rc::new(Reference::new(&read_pfm(&halves[0])?, &read_pfm(&halves[1])?));
        self.references.borrow_mut().insert(view, Known { reference: reference.clone(), halves });
        Ok(reference)
    }

    fn job<'b>(&self, experiment: &Experiment<'b>, seed: u64, seeds: u32) -> Result<Job<'b>> {
        let Experiment { view, spp, order, sampler, estimators, .. } = *experiment;
        let samples = f64::from(view.size).powi(2) * f64::from(spp) * f64::from(seeds);
        let work = samples * (scenes::find(view.scene)?.cost + 150.0 * estimators.len() as f64) * 1e-6;
        let work = (work as u64).min(self.section_end.get().saturating_sub(self.bar.position()));
        let (scene, frame) = (view.scene, view.frame);
        Ok(Job { scene, spp, order, seed, seeds, frame, sampler, estimators, options: &[], work })
    }

    /// Renders every seed; or takes what was rendered before with the same samples, and with these estimators and
    /// perhaps more.
    pub(crate) fn run(&self, experiment: &Experiment) -> Result<Outcome> {
        self.run_all(&[Some(*experiment)])?.pop().flatten().context("a rendering was lost")
    }

    /// As [`Self::run`] of each that there is, of one size, no two with the same samples, side by side: for sections
    /// that compare no times.
    pub(crate) fn run_all(&self, experiments: &[Option<Experiment>]) -> Result<Vec<Option<Outcome>>> {
        let is_new = |experiment: &&Experiment| self.known(experiment).is_none();
        let new: Vec<Experiment> = experiments.iter().flatten().filter(is_new).copied().collect();
        new.iter().try_for_each(|experiment| self.reference(experiment.view).map(|_| ()))?;
        let mut renderings = self.render(&new)?.into_iter();
        let mut outcome = |experiment: &Experiment| -> Result<Outcome> {
            if let Some(known) = self.known(experiment) {
                return Ok(known);
            }
            let renderings = renderings.next().context("a rendering was lost")?.into();
            let outcome = Outcome { reference: self.reference(experiment.view)?, renderings };
            if let Some(key) = experiment.key() {
                self.outcomes.borrow_mut().insert(key, outcome.clone());
            }
            Ok(outcome)
        };
        experiments.iter().map(|experiment| experiment.as_ref().map(&mut outcome).transpose()).collect()
    }

    /// What was rendered before, if all estimators were.
    fn known(&self, experiment: &Experiment) -> Option<Outcome> {
        let known = self.outcomes.borrow().get(&experiment.key()?)?.clone();
        experiment.estimators.iter().all(|estimator| known.of(estimator).is_ok()).then_some(known)
    }

    /// Of experiments of one size, without a reference; several side by side.
    pub(crate) fn render(&self, experiments: &[Experiment]) -> Result<Vec<Vec<Renderings>>> {
        let Some(first) = experiments.first() else { return Ok(Vec::new()) };
        self.bar.set_message(format!("{}: {} spp", first.view.scene, first.spp));
        let options: Vec<Vec<&str>> = experiments.iter().map(|experiment| experiment.options(&[])).collect();
        let folder = self.run_folder()?;
        let mut runs = Vec::new();
        for ((number, experiment), options) in experiments.iter().enumerate().zip(&options) {
            let job = Job { options, ..self.job(experiment, SEED, experiment.seeds)? };
            runs.push((job, folder.path().join(format!("picture-{number}"))));
        }
        let timings = self.side_by_side(&mut runs, first.view.size)?;
        let all = experiments.iter().zip(&runs).zip(&timings);
        all.map(|((experiment, (_, prefix)), timings)| Self::read(experiment, prefix, timings)).collect()
    }

    /// Together they advance the bar to the section's end at most.
    fn side_by_side(&self, runs: &mut [side_by_side::Run], size: u32) -> Result<Vec<Vec<Timing>>> {
        let mut left = self.section_end.get().saturating_sub(self.bar.position());
        for (job, _) in &mut *runs {
            job.work = job.work.min(left);
            left -= job.work;
        }
        side_by_side::render(self.renderer, runs, size, self.bar)
    }

    /// What a run has left.
    fn read(experiment: &Experiment, prefix: &Path, timings: &[Timing]) -> Result<Vec<Renderings>> {
        let Experiment { seeds, estimators, .. } = *experiment;
        let renderings = estimators.iter().map(|&estimator| {
            Ok(Renderings {
                estimator: estimator.to_owned(),
                images: images(prefix, estimator, SEED, seeds).map(|file| read_pfm(&file)).collect::<Result<_>>()?,
                timings: timings.iter().filter(|timing| timing.estimator == estimator).cloned().collect(),
            })
        });
        renderings.collect()
    }

    /// In batches of as many seeds, side by side: for each batch and estimator the mean, and the mean of (I - A)(I - B)
    /// pixel by pixel.
    pub(crate) fn statistics(&self, experiment: &Experiment, batches: u32) -> Result<Vec<Vec<[Rgb32FImage; 2]>>> {
        let Experiment { view, seeds, estimators, .. } = *experiment;
        self.reference(view)?;
        let references = self.references.borrow();
        let known = references.get(&view).context("the reference was lost")?;
        let files = known.halves.each_ref().map(|file| file.display().to_string()).join(",");
        let options = experiment.options(&["--statistics", &files]);
        let folder = self.run_folder()?;
        self.bar.set_message(format!("{}: {} seeds", view.scene, batches * seeds));
        let mut runs = Vec::new();
        for batch in 0..batches {
            let job = self.job(experiment, SEED + u64::from(batch * seeds), seeds)?;
            runs.push((Job { options: &options, ..job }, folder.path().join(format!("statistics-{batch}"))));
        }
        self.side_by_side(&mut runs, view.size)?;
        let one = |(_, prefix): &side_by_side::Run| -> Result<Vec<[Rgb32FImage; 2]>> {
            let read =
                |estimator: &str, what: &str| read_pfm(&prefix.with_extension(format!("{estimator}.{what}.pfm")));
            estimators.iter().map(|estimator| Ok([read(estimator, "mean")?, read(estimator, "mse")?])).collect()
        };
        runs.iter().map(one).collect()
    }
}
