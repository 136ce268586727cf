//! Rendering one scene in every way, and what that says about the estimators.

use super::plan::{BASELINE, Plan, Scene};
use super::table::Row;
use crate::measure::metric::{Reference, median};
use crate::measure::renderer::{Job, Sampler, Timing};
use crate::measure::runs::{Runs, SEED};
use crate::measure::text;
use anyhow::{Context, Result};
use image::Rgb32FImage;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// The plain mean is rendered with up to so many times the samples. Beyond that (an estimator that is very slow beside
/// the scene) its relMSE is computed instead: it falls exactly as 1 / samples.
pub(crate) const EQUAL_TIME_LIMIT: u32 = 16;

pub(crate) struct Measured {
    pub(crate) reference: Reference,
    /// In the order of the table's rows.
    pub(crate) images: Vec<Rgb32FImage>,
    pub(crate) rows: Vec<Row>,
}

/// Everything that a measurement needs.
pub(crate) struct Measurement<'a> {
    pub(crate) runs: &'a Runs<'a>,
    pub(crate) plan: &'a Plan,
}

impl Measurement<'_> {
    fn render(&self, scene: &Scene, spp: u32, estimators: &[&str]) -> Result<Vec<Timing>> {
        let (order, work) = (scene.order, self.plan.work(scene, spp, estimators.len()));
        let sampler = Sampler::Random;
        let (scene, seed) = (scene.name, SEED);
        self.runs.render(&Job { scene, spp, order, seed, seeds: 1, frame: 0, sampler, estimators, options: &[], work })
    }

    pub(crate) fn scene(&self, scene: &'static Scene) -> Result<Measured> {
        let spp = self.plan.reference_spp(scene);
        let reference = self.runs.reference(scene.name, spp, self.plan.work(scene, spp, 0))?;
        let mut measured = Measured { reference, images: Vec::new(), rows: Vec::new() };
        for spp in self.plan.spp {
            self.runs.say(format!("{}: {}", scene.name, text::samples_per_pixel(spp)));
            self.estimators(scene, spp, &mut measured)?;
        }
        Ok(measured)
    }

    /// Renders `spp` samples with every estimator, then plain means that take as long as the estimators took.
    fn estimators(&self, scene: &'static Scene, spp: u32, measured: &mut Measured) -> Result<()> {
        let names = scene.estimators();
        let mut runs = Vec::new();
        for _ in 0..self.plan.repetitions {
            runs.push(self.render(scene, spp, &names)?);
        }
        let mut rel_mse = BTreeMap::new();
        for name in &names {
            let image = self.runs.image(scene.name, name)?;
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
                self.render(scene, rendered_spp, &[BASELINE])?;
                entry.insert(measured.reference.rel_mse(&self.runs.image(scene.name, BASELINE)?));
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
