//! The chapter of the Embree harness: what report/chapters/embree_runs.toml renders, a row for each image; and what
//! needs more than that.

mod animation;
mod pixels;
mod sign_flips;
mod unbiased;

use super::clock::Clock;
use super::measurement::{Measurement, Outcome};
use super::plan::Plan;
use super::prelude::*;
use super::program;
use crate::measure::metric::{LIMIT, Reference};
use crate::measure::renderer::{Job, Renderer, Sampler, View, table, threads};
use crate::measure::{filter, progress};
use image::Rgb32FImage;
use indicatif::ProgressBar;
use itertools::iproduct;
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use xtask::run;

/// What is rendered.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Runs {
    scenes: BTreeMap<String, Scene>,
    names: BTreeMap<String, String>,
    public: BTreeMap<String, String>,
    section: Vec<Section>,
}

/// What the report knows of a scene beyond what the program says.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Scene {
    dims: u32,
    lights: String,
    reference: u32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Section {
    name: String,
    /// Roughly.
    seconds: u64,
    runs: Vec<Run>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Run {
    scenes: Vec<String>,
    size: u32,
    spp: Vec<u32>,
    samplers: Vec<String>,
    order: Vec<u32>,
    /// Words of the command line.
    #[serde(default)]
    variants: BTreeMap<String, Vec<String>>,
    /// Samples of the reference, over what the scene's references have.
    precision: u32,
    #[serde(default)]
    side_by_side: bool,
    estimators: Vec<String>,
}

/// What all sections have.
struct Harness<'a> {
    plan: &'a Plan,
    runs: &'a Runs,
    measurement: Measurement<'a>,
    /// What writes points of public samplers.
    points: PathBuf,
}

/// What comes after the runs, and roughly its seconds.
const FURTHER: [u64; 3] = [55, 28, 23];

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let renderer = Renderer::new(xtask::renderers::embree()?)?;
    let points = program::build("--example", &["points".to_owned()], report.plan)?.remove(0);
    report.compiled();
    let runs: Runs = report.plan.read("embree_runs")?;
    let bar = progress::bar(runs.section.iter().map(|of| of.seconds).chain(FURTHER).sum())?;
    let measurement = Measurement::new(&renderer, &bar)?;
    let harness = Harness { plan: report.plan, runs: &runs, measurement, points };
    let mut all = Table::new("runs", COLUMNS);
    for section in &runs.section {
        timed(&bar, section.seconds, &section.name, || {
            section.runs.iter().try_for_each(|run| harness.measure(section, run, &mut all))
        })?;
    }
    let [of_animation, of_pixels, of_bias] = FURTHER;
    let animation = timed(&bar, of_animation, "animation", || animation::measure(&harness))?;
    let table = |name: &str| Ok(if name == "runs" { all.clone() } else { animation.clone() });
    let mut chapter = report.described(&table)?;
    chapter.setting("threads", threads());
    chapter.setting("relative errors are limited to", LIMIT);
    chapter.setting("filter's standard deviation, pixels", filter::SIGMA);
    chapter.setting("weight of the newest frame", animation::ALPHA);
    chapter.setting("samples per pixel of the tile whose settings were chosen", animation::CHOSEN);
    timed(&bar, of_pixels, "pixels", || pixels::write(&harness, &mut chapter))?;
    timed(&bar, of_bias, "bias", || unbiased::write(&harness, &mut chapter))?;
    bar.finish_and_clear();
    chapter.judge();
    Ok(chapter)
}

/// Where there is no terminal, and so no bar, the line that it says tells how far it is.
fn timed<T>(bar: &ProgressBar, seconds: u64, name: &str, measure: impl FnOnce() -> Result<T>) -> Result<T> {
    let clock = Clock::start();
    let measured = measure()?;
    bar.suspend(|| println!("   {name}: {:.0} s", clock.seconds()));
    bar.inc(seconds);
    Ok(measured)
}

const COLUMNS: &str = "section | scene | dims | lights | spp | sampler | variant | estimator | order | error | upper | \
                       lower | raw | filtered | same time | raw same time | frame | ns | overhead | added";

impl<'a> Harness<'a> {
    /// `precision`: samples of the reference, over what the scene's references have.
    fn view<'b>(&self, scene: &'b str, size: u32, precision: u32) -> Result<View<'b>> {
        let known = self.runs.scenes.get(scene);
        let of = known.with_context(|| format!("embree_runs.toml knows no scene `{scene}`"))?;
        let factor = precision * self.plan.of("reference_factor");
        // Many pixels, few samples: the reference's error matters less.
        let is_large = size >= self.plan.of("tile_size");
        let divisor = self.plan.of("reference_divisor") * if is_large { 4 } else { 1 };
        Ok(View { scene, size, frame: 0, reference: (factor * of.reference / divisor).max(16) })
    }

    /// The points of a public sampler, as the program calls it.
    fn points(&self, name: &str, spp: u32, dims: u32) -> Result<Sampler> {
        let file = self.measurement.path(&format!("{name}-{spp}-{dims}.points"));
        if !file.exists() {
            run::check(run::command(&self.points).args([name, &*spp.to_string(), &dims.to_string()]).arg(&file))?;
        }
        Ok(table(&file))
    }

    fn measure(&self, section: &Section, run: &'a Run, all: &mut Table) -> Result<()> {
        let estimators: Vec<&str> = run.estimators.iter().map(String::as_str).collect();
        let plain = [(String::new(), Vec::new())].into();
        let variants = if run.variants.is_empty() { &plain } else { &run.variants };
        for scene in self.plan.some(&run.scenes) {
            let view = self.view(scene, run.size, run.precision)?;
            for &spp in &run.spp {
                let mut jobs: Vec<(Job, [String; 3])> = Vec::new();
                for (sampler, (variant, options), &order) in iproduct!(&run.samplers, variants, &run.order) {
                    let of = match self.runs.public.get(sampler) {
                        Some(name) => {
                            let dims = self.runs.scenes[scene].dims;
                            Some(self.points(name, spp, dims)?)
                        }
                        None => self.measurement.renderer.sampler(sampler, spp),
                    };
                    // There is no such tile.
                    let Some(of) = of else { continue };
                    let mut job = Job { order, sampler: of, ..Job::new(view, spp, &estimators) };
                    job.seeds = self.plan.of("seeds");
                    job.options = options.iter().map(String::as_str).collect();
                    jobs.push((job, [sampler.clone(), variant.clone(), order.to_string()]));
                }
                let (jobs, words): (Vec<Job>, Vec<_>) = jobs.into_iter().unzip();
                let outcomes: Vec<Outcome> = match run.side_by_side {
                    true => self.measurement.run(&jobs)?,
                    false => jobs.chunks(1).map(|job| self.measurement.run(job)).collect::<Result<Vec<_>>>()?.concat(),
                };
                let mut known = BTreeSet::new();
                for (outcome, [sampler, variant, order]) in outcomes.iter().zip(words) {
                    let Scene { dims, lights, .. } = &self.runs.scenes[scene];
                    let place = [&section.name, scene, &dims.to_string(), lights, &spp.to_string(), &sampler, &variant];
                    self.record(outcome, &place.map(String::as_str), &order, &mut known, all);
                }
            }
        }
        Ok(())
    }

    /// A row for each image. The first estimator has no order and nothing that it is compared with; it is the same in
    /// every run of the same samples, and stands there once.
    fn record(&self, outcome: &Outcome, place: &[&str], order: &str, known: &mut BTreeSet<String>, all: &mut Table) {
        let reference = &*outcome.reference;
        let errors = outcome.renderings.iter().map(|of| of.images.iter().map(|image| errors(reference, image)));
        let errors: Vec<Vec<[f64; 3]>> = errors.map(Iterator::collect).collect();
        let seen: Vec<Vec<[f64; 2]>> = outcome.renderings.iter().map(|of| of.seen(reference)).collect();
        for (index, of) in outcome.renderings.iter().enumerate() {
            let name = self.runs.names.get(&of.estimator).unwrap_or(&of.estimator).as_str();
            if index == 0 && !known.insert(place.join(", ")) {
                continue;
            }
            for (seed, [error, upper, lower]) in errors[index].iter().copied().enumerate() {
                let ([raw, filtered], time) = (seen[index][seed], &of.timings[seed]);
                let plain = &outcome.renderings[0].timings[seed];
                let slower = time.total_seconds / plain.total_seconds;
                let added = time.estimating_ns_per_sample - plain.estimating_ns_per_sample;
                let same_time = [error / errors[0][seed][0], raw / seen[0][seed][0]].map(|of| of * slower);
                let times = [time.frame(), time.estimating_ns_per_sample, 100.0 * added / plain.frame(), added];
                let compared = same_time.iter().chain(&times).enumerate();
                let compared =
                    compared.map(|(at, of)| if index == 0 && at != 2 { String::new() } else { of.to_string() });
                let words = place.iter().copied().chain([name, if index == 0 { "-" } else { order }]);
                let numbers = [error, upper, lower, raw, filtered].map(|number| number.to_string());
                all.push(words.map(str::to_owned).chain(numbers).chain(compared));
            }
        }
    }
}

/// relMSE of an image, and what its upper and its lower half add to it.
fn errors(reference: &Reference, image: &Rgb32FImage) -> [f64; 3] {
    let terms = reference.terms(image);
    let (upper, lower) = terms.split_at(terms.len() / 2);
    [reference.rel_mse(image), upper.iter().sum(), lower.iter().sum()]
}
