//! Rendering one scene in every way, and what that says about the estimators.

use super::plan::{BASELINE, Plan, Scene};
use super::table::Row;
use crate::demo::image::read_pfm;
use crate::demo::metric::{Reference, median};
use crate::demo::renderer::{Job, Renderer, Sampler, Timing};
use anyhow::{Context, Result, bail};
use image::Rgb32FImage;
use indicatif::ProgressBar;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::Path;

const SEED: u64 = 1;
const REFERENCE_SEEDS: [u64; 2] = [1001, 1002];

/// The plain mean is rendered with up to so many times the samples. Beyond that (an estimator that is very slow beside the
/// scene) its relMSE is computed instead: it falls exactly as 1 / samples.
pub(crate) const EQUAL_TIME_LIMIT: u32 = 16;

pub(crate) struct Measured {
    pub(crate) reference: Reference,
    /// In the order of the table's rows.
    pub(crate) images: Vec<Rgb32FImage>,
    pub(crate) rows: Vec<Row>,
}

/// Everything that a measurement needs.
pub(crate) struct Measurement<'a> {
    pub(crate) renderer: &'a Renderer,
    pub(crate) plan: &'a Plan,
    pub(crate) bar: &'a ProgressBar,
    pub(crate) scratch: &'a Path,
}

impl Measurement<'_> {
    fn render(&self, scene: &Scene, spp: u32, seed: u64, estimators: &[&str]) -> Result<Vec<Timing>> {
        let prefix = self.scratch.join(scene.name);
        let work = self.plan.work(scene, spp, estimators.len());
        let job = Job {
            scene: scene.name,
            size: self.plan.size,
            spp,
            order: scene.order,
            seed,
            frame: 0,
            threads: self.plan.threads,
            sampler: Sampler::Random,
            estimators,
            prefix: &prefix,
        };
        self.renderer.render(&job, self.bar, work)
    }

    fn image(&self, scene: &Scene, name: &str) -> Result<Rgb32FImage> {
        read_pfm(&self.scratch.join(format!("{}.{name}.pfm", scene.name)))
    }

    fn reference(&self, scene: &Scene) -> Result<Reference> {
        let mut halves = Vec::new();
        for seed in REFERENCE_SEEDS {
            self.render(scene, self.plan.reference_spp(scene), seed, &[])?;
            halves.push(self.image(scene, "reference")?);
        }
        match &halves[..] {
            [a, b] => Ok(Reference::new(a, b)),
            _ => bail!("a reference needs two halves"),
        }
    }

    pub(crate) fn scene(&self, scene: &'static Scene) -> Result<Measured> {
        self.bar.set_message(format!("{}: reference", scene.name));
        let reference = self.reference(scene)?;
        let mut measured = Measured { reference, images: Vec::new(), rows: Vec::new() };
        for spp in self.plan.spp {
            self.bar.set_message(format!("{}: {spp} samples per pixel", scene.name));
            self.estimators(scene, spp, &mut measured)?;
        }
        Ok(measured)
    }

    /// Renders `spp` samples with every estimator, then plain means that take as long as the estimators took.
    fn estimators(&self, scene: &'static Scene, spp: u32, measured: &mut Measured) -> Result<()> {
        let names = scene.estimators();
        let mut runs = Vec::new();
        for _ in 0..self.plan.repetitions {
            runs.push(self.render(scene, spp, SEED, &names)?);
        }
        let mut rel_mse = BTreeMap::new();
        for name in &names {
            let image = self.image(scene, name)?;
            rel_mse.insert(*name, measured.reference.rel_mse(&image));
            measured.images.push(image);
        }
        let plain = rel_mse.get(BASELINE).copied().context("no plain mean to compare with")?;

        let mut equal_time = BTreeMap::from([(spp, plain)]);
        for name in &names {
            let time_ratio = median(runs.iter().map(|run| ratio(run, name)));
            // Rounded up, in the plain mean's favour.
            let equal_spp = ((f64::from(spp) * time_ratio - 1e-9).ceil() as u32).max(spp);
            let rendered_spp = equal_spp.min(EQUAL_TIME_LIMIT * spp);
            if let Entry::Vacant(entry) = equal_time.entry(rendered_spp) {
                self.render(scene, rendered_spp, SEED, &[BASELINE])?;
                entry.insert(measured.reference.rel_mse(&self.image(scene, BASELINE)?));
            }
            let rendered = equal_time.get(&rendered_spp).copied().unwrap_or(f64::NAN);
            let plain_then = rendered * f64::from(rendered_spp) / f64::from(equal_spp);
            let own = rel_mse.get(name).copied().unwrap_or(f64::NAN);
            let of = |value: fn(&Timing) -> f64| median(runs.iter().filter_map(|run| find(run, name)).map(value));
            measured.rows.push(Row {
                scene: scene.name,
                estimator: (*name).to_owned(),
                order: scene.order,
                spp,
                rel_mse: own,
                ratio: own / plain,
                sampling_ns: of(|timing| timing.sampling_ns_per_sample),
                estimating_ns: of(|timing| timing.estimating_ns_per_sample),
                time_ratio,
                equal_time_spp: equal_spp,
                equal_time_ratio: own / plain_then,
            });
        }
        Ok(())
    }
}

fn find<'a>(run: &'a [Timing], name: &str) -> Option<&'a Timing> {
    run.iter().find(|timing| timing.estimator == name)
}

/// An estimator's total time over the plain mean's, within one run: both shared its samples and its machine.
fn ratio(run: &[Timing], name: &str) -> f64 {
    match (find(run, name), find(run, BASELINE)) {
        (Some(own), Some(plain)) => own.total_seconds / plain.total_seconds,
        _ => f64::NAN,
    }
}
